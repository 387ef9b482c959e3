
// Any word of the ring: search, figures, parameters.
const signalsPage = (() => {
  const { el, byId } = plots;
  const MOST = 150;  // rows
  let rows = [], chosen = [];  // figures {figure, words}

  const words = () => live.state.map?.words || [];
  const matching = () => {
    const parts = byId("search").value.toLowerCase().split(/\s+/).filter(Boolean);
    return words().map((w, i) => [w, i]).filter(([w]) => parts.every(p => w.name.toLowerCase().includes(p)));
  };
  const shownValue = (word, value) => {
    if (value == null || Number.isNaN(value)) return "–";
    const named = Object.entries(word.values || {}).find(([, v]) => v === value);
    if (named) return named[0];
    const q = quantities.scaled(word.unit === "1" ? "-" : word.unit, Math.abs(value));
    return `${quantities.number(value * q.factor, 4)} ${q.unit}`.trim();
  };

  const remember = () => sessionStorage.setItem("rths-figures",
    JSON.stringify(chosen.map(c => c.words.map(i => words()[i].name))));
  const drawFigure = list => {
    const names = list.map(i => words()[i].name), units = new Set(list.map(i => words()[i].unit));
    const figure = moving.lines("signal-plots", names.length === 1 ? names[0] : `${names.length} signals`,
      units.size === 1 ? [...units][0] : "1", list.map(i => ({ label: words()[i].name, word: i })), { height: 200 });
    const close = el("button", { type: "button", className: "reset", textContent: "remove" });
    const entry = { figure, words: list };
    close.addEventListener("click", () => {
      chosen = chosen.filter(c => c !== entry);
      moving.remove(figure);
      changed();
    });
    figure.box.querySelector("figcaption").append(close);
    return entry;
  };
  const changed = () => {
    byId("no-plots").hidden = chosen.length > 0;
    remember();
    moving.watchVisible();
    live.draw();
  };
  const add = i => {
    const last = chosen[chosen.length - 1];
    if (byId("same-plot").checked && last && !last.words.includes(i) && words()[last.words[0]].unit === words()[i].unit) {
      moving.remove(last.figure);
      chosen[chosen.length - 1] = drawFigure([...last.words, i]);
    } else {
      chosen.push(drawFigure([i]));
    }
    changed();
  };

  // A parameter: its new value, and the token if the page has none.
  const parameter = word => {
    const value = el("input", { type: "text", ariaLabel: `new value of ${word.name}`, placeholder: "new value" });
    const token = el("input", { type: "password", ariaLabel: "token", placeholder: "token", hidden: live.hasToken() });
    const answer = el("span", { className: "shown", role: "status" });
    const act = async () => {
      const error = await live.set(word.name, value.value, token.hidden ? undefined : token.value);
      answer.textContent = error || "done";
      if (/token/.test(error)) token.hidden = false;
    };
    const button = el("button", { type: "button", textContent: "set" });
    button.addEventListener("click", act);
    for (const input of [value, token]) input.addEventListener("keydown", event => { if (event.key === "Enter") act(); });
    return el("span", { className: "parameter" }, value, token, button, answer);
  };
  const row = ([word, i]) => {
    const button = el("button", { type: "button", textContent: "show", title: `show ${word.name}` });
    button.addEventListener("click", () => add(i));
    const value = el("td"), age = el("td"), last = el("td", {}, button);
    if (word.parameter) last.append(" ", parameter(word));
    const range = word.low === undefined ? "" : `expected ${quantities.brief(word.low)} to ${quantities.brief(word.high)} ${word.unit}`;
    rows.push({ word, i, value, age });
    return el("tr", {}, el("td", { textContent: word.name, title: range }), value, el("td", { textContent: word.node }), age, last);
  };
  const list = () => {
    const found = matching();
    rows = [];
    byId("words").replaceChildren(...found.slice(0, MOST).map(row));
    byId("found-count").textContent = found.length > MOST ? `${found.length} signals, the first ${MOST}` : `${found.length} signals`;
    update();
  };
  const update = () => {
    if (byId("page-signals").hidden || !live.state.values) return;
    for (const r of rows) {
      const age = live.state.ages[r.i];
      r.value.textContent = shownValue(r.word, live.state.values[r.i]);
      r.age.textContent = Number.isNaN(age) ? "not yet" : testPage.age(age);
    }
  };
  // The same figures on another ring, where it has the words.
  const build = () => {
    for (const c of chosen) moving.remove(c.figure);
    const names = JSON.parse(sessionStorage.getItem("rths-figures") || "[]");
    chosen = names.map(n => n.map(live.find).filter(i => i !== undefined)).filter(n => n.length).map(drawFigure);
    byId("no-plots").hidden = chosen.length > 0;
    list();
  };

  byId("search").addEventListener("input", list);
  byId("search").addEventListener("keydown", event => {
    const found = matching();
    if (event.key === "Enter" && found.length) add(found[0][1]);
  });
  live.on("map", build);
  live.on("values", update);
  return { list };
})();
