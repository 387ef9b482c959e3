
// Draws the comparison of two runs from the data in the page.
(() => {
  const { data, unpack, el, byId, table } = plots;
  const { brief, percent, scaled, largest } = quantities;
  const n = data.comparison;
  const BASELINE = { label: "baseline", color: "numerical" };
  const OTHER = { label: "other", color: "hybrid", dash: theme.DASH.beside };
  const DIFFERENCE = { label: "other − baseline", color: "improved" };

  const header = () => {
    const differing = n.signals.filter(s => !s.equal).length;
    document.title = "rths comparison";
    byId("title").textContent = differing ? `${differing} of ${n.signals.length} signals differ` : "Nothing differs";
    byId("files").append("baseline ", n.baseline, el("br"), "other ", n.other);
    byId("verdict").textContent = n.judged
      ? `${n.broken} of ${n.signals.length} signals are outside their tolerance.`
      : `Compared from ${brief(n.from_s, 6)} to ${brief(n.to_s, 6)} s, without a tolerance.`;
    if (n.shift_s) byId("verdict").append(` ${brief(1e3 * n.shift_s, 5)} ms are removed from the times of the other.`);
    byId("why").hidden = !n.why;
    if (n.why) byId("why").textContent = n.why.sentence;
  };

  const settings = () => {
    byId("settings-section").hidden = !n.settings.length;
    if (n.settings.length)
      table("settings", ["setting", "baseline", "other"], n.settings.map(s => [s.key, s.baseline || "absent", s.other || "absent"]));
  };

  const row = s => {
    const { factor, unit } = scaled(s.unit === "1" ? "" : s.unit, Math.max(s.peak, s.other_peak));
    const size = value => brief(value * factor);
    return [s.signal === s.other ? s.signal : `${s.signal} = ${s.other}`, size(s.peak), size(s.other_peak), size(s.rms_difference),
      s.relative_rms == null ? "–" : percent(s.relative_rms), s.delay_s == null ? "–" : `${brief(1e3 * s.delay_s)} ms`, unit || "–"];
  };
  const notes = s => [s.explanation, s.broken_at_s == null ? "" :
    `outside its tolerance in ${s.broken_samples} samples, first at ${brief(s.broken_at_s, 6)} s`].filter(Boolean);
  const list = (box, listed) => {
    table(box, ["signal", "peak", "other", "rms difference", "of rms", "delay", "unit"], listed.map(row));
    byId(box).querySelectorAll("tbody tr").forEach((tr, i) => {
      for (const note of notes(listed[i])) tr.firstChild.append(el("br"), el("small", { textContent: note }));
    });
  };
  const signals = () => {
    const differing = n.signals.filter(s => !s.equal);
    byId("signals-text").textContent = `${n.signals.length - differing.length} of ${n.signals.length} common signals are equal to the last bit.` +
      [["the baseline", n.only_baseline], ["the other", n.only_other]].filter(([, names]) => names.length)
        .map(([where, names]) => ` Only in ${where}: ${names.length}, such as ${names[0]}.`).join("");
    if (differing.length) list("signals", differing.slice(0, data.most));
    const rest = differing.slice(data.most);
    if (!rest.length) return;
    byId("signals").after(el("details", {}, el("summary", { textContent: `${rest.length} more signals that differ` }),
      el("div", { id: "rest", className: "table" })));
    list("rest", rest);
  };

  const curves = () => {
    byId("curves-section").hidden = !data.curves.length;
    for (const curve of data.curves) {
      const time = Array.from(unpack(curve.time), t => t + curve.start_s);
      const baseline = unpack(curve.baseline), other = unpack(curve.other);
      const difference = other.map((value, i) => value - baseline[i]);
      const of = (values, parts) => {
        const { factor, unit } = scaled(curve.unit === "1" ? "" : curve.unit, Math.max(...values.map(largest)));
        return [`[${unit || "–"}]`, values.map((one, i) => ({ ...parts[i], y: Array.from(one, v => v * factor) }))];
      };
      const [unit, both] = of([baseline, other], [BASELINE, OTHER]);
      figures.lines("curves", curve.signal, time, "time [s]", `value ${unit}`, both);
      const [small, one] = of([difference], [DIFFERENCE]);
      figures.lines("curves", `${curve.signal}, difference`, time, "time [s]", `difference ${small}`, one, { height: 160 });
    }
  };

  for (const draw of [header, settings, signals, curves]) draw();
  plots.done();
})();
