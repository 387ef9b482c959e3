
// The page of the test: its state, motion, force, loops, nodes and events.
const testPage = (() => {
  const { el, byId } = plots;
  const AXIS_NAME = { long: "longitudinal", lat: "lateral" };
  const SLOTS_PER_S = 1000, NEAR_LIMIT = 0.8;
  let cards = {}, axes = [], figuresHere = [];

  const ms = seconds => (seconds == null ? "–" : (seconds * 1000).toFixed(2));
  const stateClass = node => (node.state === "vanished" ? "bad" : node.state === "alive" ? "good" : "");
  const age = seconds => (seconds == null ? "–" : seconds < 1 ? `${(seconds * 1000).toFixed(0)} ms` : `${seconds.toFixed(1)} s`);

  // Replaces the content of a table only where it differs, so that a selection stays.
  const fill = (container, head, rows, classes = () => []) => {
    const box = byId(container);
    if (!box.firstChild || box.querySelectorAll("tbody tr").length !== rows.length) {
      box.replaceChildren();
      plots.table(container, head, rows);
    }
    const trs = box.querySelectorAll("tbody tr");
    rows.forEach((row, r) => row.forEach((text, c) => {
      const cell = trs[r].children[c];
      if (cell.textContent !== String(text)) cell.textContent = text;
      const name = classes(r)[c] || "";
      if (cell.className !== name) cell.className = name;
    }));
  };
  const nodeRows = look => look.nodes.filter(n => n.state !== "absent" || n.age_s != null);
  const nodes = (container, look) => {
    const list = nodeRows(look);
    fill(container, ["node", "state", "heartbeats [Hz]", "writes [1/s]", "last write", "late [ms]", "most late [ms]", "step [ms]", "overruns", "stale reads", "not read here"],
      list.map(n => [n.node, n.plain ? `${n.state}, plain` : n.state, n.rate_hz.toFixed(1), n.writes_per_s.toFixed(0), age(n.age_s), ms(n.late_s), ms(n.late_max_s),
        ms(n.duration_s), n.overruns ?? "–", n.stale_reads ?? "–", n.lost]),
      r => ["", stateClass(list[r])]);
  };
  const events = (container, look) => {
    const list = [...look.events].reverse();
    const newest = list.length ? String(list[0].number) : "";
    if (byId(container).dataset.newest === newest) return;
    byId(container).dataset.newest = newest;
    byId(container).replaceChildren(...list.map(e => el("li", { className: e.bad ? "bad" : "" },
      el("time", { textContent: `${e.time_s.toFixed(3)} s` }), el("span", { textContent: e.text }))));
  };

  const card = (key, name) => {
    const value = el("div", { className: "value" }), note = el("div", { className: "note" });
    const part = el("span"), limit = el("div", { className: "limit", hidden: true }, part);
    byId("test-cards").append(el("div", { className: "card" }, el("div", { className: "name", textContent: name }), value, note, limit));
    cards[key] = { value, note, limit, part };
  };
  // A quantity with its share of a limit of the safety layer, as a bar.
  const setLimited = (key, value, unit, limit, note) => {
    const q = quantities.axis(`[${unit}]`, Math.max(Math.abs(value), (limit ?? 0) / 100, 1e-3)), share = Math.abs(value) / limit;
    setCard(key, `${quantities.number(value * q.factor, 3)} ${q.unit}`, limit ? `${quantities.percent(share)} of ${quantities.brief(limit * q.factor)} ${q.unit}` : note);
    if (!cards[key] || !limit) return;
    cards[key].limit.hidden = false;
    cards[key].part.style.width = `${Math.min(100, share * 100)}%`;
    cards[key].part.className = share > NEAR_LIMIT ? "near" : "";
  };
  const setCard = (key, value, note = "", bad = false) => {
    if (!cards[key]) return;
    cards[key].value.textContent = value;
    cards[key].value.style.color = bad ? "var(--bad)" : "";
    cards[key].note.textContent = note;
  };

  // The first of some words that the ring has.
  const first = (...names) => names.find(name => live.find(name) !== undefined);
  const wordsOf = (roles, axis) => {
    const c = roles.controller;
    return {
      name: axis.axis,
      target: first(`monitor.${c}.target.out.${axis.axis}`, axis.target),
      command: first(axis.command),
      measured: first(axis.displacement, axis.machine_displacement),
      force: first(axis.force, axis.machine_force),
      machineForce: first(axis.machine_force),
    };
  };
  const unitOf = name => live.state.map.words[live.find(name)].unit;
  const curve = (label, name, style = {}) => ({ label, word: live.find(name), ...style });

  const difference = (a, b) => () => {
    const p = live.data(a), q = live.data(b);
    if (!p || !q) return null;
    const mean = (d, i) => (d[i & ~1] + d[i | 1]) / 2;
    return p.map((_, i) => mean(p, i) - mean(q, i));
  };

  const titleOf = axis => AXIS_NAME[axis.name] || axis.name;
  const motionOf = axis => {
    const motion = [axis.measured && curve("measured", axis.measured, { color: "c1" }),
      axis.command && curve("command", axis.command, { color: "command" }),
      axis.target && curve("target", axis.target, { color: "c0", dash: [6, 4] })].filter(Boolean);
    return motion.length && moving.lines("test-plots", `Displacement, ${titleOf(axis)}`, unitOf(axis.measured || axis.command || axis.target), motion, { quantity: "displacement" });
  };
  const forceOf = axis => {
    const force = [axis.force && curve("specimen", axis.force, { color: "c1" }),
      axis.machineForce && axis.machineForce !== axis.force && curve("machine", axis.machineForce, { color: "c4", dash: [5, 4] })].filter(Boolean);
    return force.length && moving.lines("test-plots", `Force, ${titleOf(axis)}`, unitOf(axis.force || axis.machineForce), force, { quantity: "force" });
  };
  const errorOf = axis => {
    if (!axis.command || !axis.measured) return null;
    const [a, b] = [live.find(axis.measured), live.find(axis.command)];
    return moving.lines("test-plots", `Tracking error, ${titleOf(axis)}`, unitOf(axis.command),
      [{ label: "measured − command", color: "c3", words: [a, b], of: difference(a, b) }], { quantity: "error", height: 160 });
  };
  const loopsOf = list => {
    const label = (quantity, name) => `${quantity} [${unitOf(name)}]`;
    const made = list.filter(a => a.measured && a.force).map(a => moving.loop("test-loops", `Force by displacement, ${titleOf(a)}`,
      { label: label("displacement", a.measured), word: live.find(a.measured) }, { label: label("force", a.force), word: live.find(a.force) }));
    const [p, q] = list.filter(a => a.measured);
    if (p && q) made.push(moving.loop("test-loops", "Orbit",
      { label: label(`displacement, ${p.name}`, p.measured), word: live.find(p.measured) },
      { label: label(`displacement, ${q.name}`, q.measured), word: live.find(q.measured) }, true));
    return made;
  };

  const stateWords = () => live.state.map.words.map(w => w.name).filter(name => name.endsWith(".pc.state"));
  const build = map => {
    for (const figure of figuresHere) moving.remove(figure);
    byId("test-cards").replaceChildren();
    cards = {};
    axes = map.roles.axes.map(axis => wordsOf(map.roles, axis));
    figuresHere = [motionOf, forceOf, errorOf].flatMap(draw => axes.map(draw)).filter(Boolean);
    const durations = [["predict", "predict"], ["correct", "correct"], ["slow_down", "slow"]]
      .map(([name, color]) => [`monitor.${map.roles.controller}.pc.${name}_time`, name.replace("_", "-"), color]).filter(([word]) => first(word));
    if (durations.length) figuresHere.push(moving.lines("test-plots", "Predictor-corrector, time in each state of a step", "s",
      durations.map(([word, label, color]) => curve(label, word, { color })), { quantity: "duration", height: 160 }));
    figuresHere.push(...loopsOf(axes));
    byId("loop-section").hidden = !axes.some(a => a.measured && (a.force || axes.length > 1));
    card("time", "time of the test");
    card("safety", "safety layer");
    if (stateWords().length) card("pc", "predictor-corrector");
    for (const axis of axes) {
      if (map.limits?.[axis.name] && axis.measured) card(`motion.${axis.name}`, `displacement, ${titleOf(axis)}`);
      if (map.limits?.[axis.name] && axis.machineForce) card(`force.${axis.name}`, `force, ${titleOf(axis)}`);
      if (axis.command && axis.measured) card(`error.${axis.name}`, `tracking error, ${titleOf(axis)}`);
    }
    card("late", "latest step");
    card("overruns", "overruns");
  };

  const drawLimits = look => {
    const layers = look.safety;
    setCard("safety", layers.length ? layers.map(l => l.state).join(", ") : "none", layers.some(l => l.trip) ? "tripped" : layers.length ? `in front of ${layers.map(l => l.node).join(", ")}` : "the ring has no safety layer",
      layers.some(l => l.trip));
    const text = layers.filter(l => l.trip).map(l => `Safety layer of ${l.node} tripped: ${l.trip}`).join(" · ");
    if (byId("trips").textContent !== text) byId("trips").textContent = text;
  };
  const status = message => {
    const look = message.look;
    if (!look) return;
    drawLimits(look);
    nodes("test-nodes", look);
    events("test-events", look);
    const late = look.nodes.filter(n => n.late_max_s != null);
    const worst = late.reduce((most, n) => (n.late_max_s > (most?.late_max_s ?? -1) ? n : most), null);
    setCard("late", worst ? `${ms(worst.late_max_s)} ms` : "–", worst ? worst.node : "");
    const over = late.reduce((sum, n) => sum + (n.overruns || 0), 0);
    setCard("overruns", late.length ? String(over) : "–", late.filter(n => n.overruns).map(n => `${n.node} ${n.overruns}`).join(", "));
  };
  const values = () => {
    const map = live.state.map;
    if (!map) return;
    const time = live.value(map.roles.time), clock = live.value(first(`monitor.${map.roles.controller}.clock.out`));
    setCard("time", time != null ? `${time.toFixed(2)} s` : clock != null ? `${clock.toFixed(2)} s` : "–",
      `watched for ${(live.state.now / SLOTS_PER_S).toFixed(0)} s`);
    const pc = stateWords()[0];
    if (pc) {
      const slow = live.value(pc.replace(/state$/, "slow_down_time"));
      setCard("pc", map.pc_states[String(live.value(pc))] ?? "–", slow == null ? "" : `slow-down in the last step ${ms(slow)} ms`, slow > 0);
    }
    for (const axis of axes) {
      const limits = map.limits?.[axis.name];
      if (limits && axis.measured) setLimited(`motion.${axis.name}`, live.value(axis.measured), unitOf(axis.measured), limits.displacement, "");
      if (limits && axis.machineForce) setLimited(`force.${axis.name}`, live.value(axis.machineForce), unitOf(axis.machineForce), limits.force, "");
      if (axis.command && axis.measured)
        setLimited(`error.${axis.name}`, live.value(axis.measured) - live.value(axis.command), unitOf(axis.command), limits?.tracking, "measured − command");
    }
  };

  live.on("map", build);
  live.on("status", status);
  live.on("values", values);
  return { nodes, events, fill, age };
})();
