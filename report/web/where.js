
// Where the mismatch is: part, time, state, frequency.
const where = (() => {
  const { el, byId } = plots;
  const { axis, largest, scaled } = quantities;
  const { v, terms, PARTS, placeOf, guilty, hide, traceOf } = verdict;

  // Measured loops, coloured by the energy beyond the noise; the largest on top.
  const heatedLoops = trace => {
    const sorted = [...trace.excess].sort((a, b) => a - b);
    const most = sorted[Math.floor(sorted.length * 0.98)] || 1;
    const level = trace.excess.map(e => Math.min(11, Math.floor(Math.sqrt(Math.max(0, e) / most) * 12)));
    const x = axis(trace.abscissa_label, largest(trace.abscissa)), y = scaled(trace.unit, largest(trace.measured));
    const xs = trace.abscissa.map(value => value * x.factor);
    const paint = u => {
      const { ctx } = u;
      const point = i => [u.valToPos(xs[i], "x", true), u.valToPos(trace.measured[i] * y.factor, "y", true)];
      ctx.save();
      ctx.lineWidth = 2 * devicePixelRatio;
      ctx.lineCap = "round";
      for (let shade = 0; shade < 12; shade++) {
        ctx.beginPath();
        ctx.strokeStyle = charts.heat(shade / 11);
        for (let i = 1; i < xs.length; i++)
          if (level[i] === shade) { ctx.moveTo(...point(i - 1)); ctx.lineTo(...point(i)); }
        ctx.stroke();
      }
      ctx.restore();
      return null;
    };
    const inUnit = values => values.map(value => value * y.factor);
    const plot = figures.loops("where-state", "Position on the loops", x.label, `${trace.channel} [${y.unit}]`, [
      { label: "measured", color: "measured", x: xs, y: inUnit(trace.measured), time: trace.time, isHeated: true },
      { label: "predicted", color: "predicted", x: xs, y: inUnit(trace.before), time: trace.time, width: 0.9 },
    ], { below: true, height: 390, paint: curve => curve.isHeated && paint });
    plot.root.parentNode.querySelector(".key").append(charts.rampKey("noise", "far beyond it"));
  };

  // The parts from the command to the sensors; those of the named terms stand out.
  const chain = () => {
    for (const place of new Set(PARTS.filter(part => !v.specimen || part !== "numerical").map(placeOf))) {
      const node = el("div", { textContent: place[0].toUpperCase() + place.slice(1) });
      if (guilty.has(place)) node.className = "guilty";
      if (place === placeOf(v.where.part)) node.append(el("small", { textContent: v.where.channel }));
      byId("chain").append(node);
    }
  };

  const draw = () => {
    const w = v.where;
    if (v.verdict === "none" || !w.channel) return hide("where");
    const isRuled = terms.some(c => c.is_rule) && terms.some(c => !c.is_rule);
    const isNamed = w.of === "named terms", energy = isNamed ? "the energy" : "the energy beyond the noise";
    const on = w.record ? `, on ${w.record}` : "", rule = "with the right hysteresis rule";
    byId("where-text").textContent =
      (isNamed ? `Energy of the contribution of the named terms to the prediction${isRuled ? ` ${rule}` : ""}${on}. It has no noise`
        : `Energy of the residual beyond the noise${on}, before any term is named${isRuled ? `, but ${rule}` : ""}`) +
      `. The smallest sets of cells that hold 80 % of it` +
      `${w.intervals_s.length ? ` cover ${quantities.ranges(w.intervals_s, "s")}` : ""}` +
      `${w.intervals_rows.length ? ` cover rows ${quantities.ranges(w.intervals_rows, "")}` : ""}` +
      `${w.band_Hz.length ? `${w.intervals_s.length ? " and" : " cover"} ${quantities.ranges(w.band_Hz, "Hz")}` : ""}.`;
    chain();
    const trace = traceOf(w.record, w.channel);
    const profile = name => w.profiles.find(p => p.name === name && p.edges.length > 1);
    const along = profile("time") || profile("row");
    if (along) {
      const unit = trace && scaled(trace.unit, largest(trace.measured));
      charts.timeStrip("where-time", `${along.name === "row" ? "Rows" : "Time"} of the mismatch`, along, [...w.intervals_s, ...w.intervals_rows],
        trace && { x: trace.time, y: trace.measured.map(value => value * unit.factor) },
        trace ? { name: `${trace.channel}, measured; below: share of ${energy}`, label: `[${unit.unit}]` } : { name: `share of ${energy}` });
    }
    if (trace && trace.abscissa.length && trace.excess.length) heatedLoops(trace);
    const cells = w.state_map.length ? w.state_map : w.state;
    if (cells.length) charts.stateMap("where-state", `State: share of ${energy} [%]`, cells, w.state);
    if (profile("frequency"))
      charts.histogram("where-profiles", "Frequency, in third octaves", profile("frequency"), "frequency [Hz]", w.band_Hz, true);
    for (const p of w.profiles.filter(other => !["time", "row", "frequency"].includes(other.name) && other.edges.length > 1)) {
      const x = axis(`${p.name} [${p.unit}]`, largest(p.edges));
      charts.histogram("where-profiles", `Over ${p.name}`, { ...p, edges: p.edges.map(e => e * x.factor) }, x.label, []);
    }
  };

  return { draw };
})();
