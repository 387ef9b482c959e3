
// The proof: errors, before and after, residual; and the alternatives.
const proof = (() => {
  const { el, byId } = plots;
  const { number, share, percent, axis, largest, scaled } = quantities;
  const { v, terms, hasTerms, hide, traces, traceOf, tableOf } = verdict;

  const scores = () => {
    const entries = Object.entries(v.fit);
    const values = entries.flatMap(([, s]) => [s.nrmse_before, s.nrmse_after, s.noise_floor]).filter(value => value > 0);
    if (!values.length) return;
    const at = charts.scale([Math.min(...values) / 1.15, Math.max(...values) * 1.15], [0, 100], true);
    const dot = (tag, value, color) => {
      const node = el(tag);
      node.style.left = `${at(value)}%`;
      if (color) node.style.background = color;
      return node;
    };
    const dots = s => {
      const box = el("div", { className: "dots" });
      const both = s.nrmse_before > 0 && s.nrmse_after > 0;
      if (s.noise_floor > 0) box.append(dot("u", s.noise_floor));
      if (both && hasTerms) {
        const line = el("i"), [a, b] = [at(s.nrmse_after), at(s.nrmse_before)].sort((p, q) => p - q);
        line.style.left = `${a}%`;
        line.style.width = `${b - a}%`;
        box.append(line, dot("b", s.nrmse_before, "var(--before)"));
      }
      if (s.nrmse_after > 0) box.append(dot("b", s.nrmse_after, "var(--after)"));
      return box;
    };
    const columns = [["record", ([record]) => record], ["use", ([record, s]) => (record === v.proof_record ? "proof" : s.use.replace("_", " "))],
      ["as stated", ([, s]) => percent(s.nrmse_stated)],
      ...(hasTerms ? [["before", ([, s]) => percent(s.nrmse_before)], ["after", ([, s]) => percent(s.nrmse_after)]]
        : [["fitted", ([, s]) => percent(s.nrmse_after)]]),
      ["noise alone", ([, s]) => percent(s.noise_floor)], [hasTerms ? "variance after" : "variance", ([, s]) => number(s.variance_after, 3)],
      [hasTerms ? "before → after, dotted: noise" : "dotted: noise", ([, s]) => dots(s)]];
    const table = tableOf(columns.map(([title]) => title), entries.map(entry => columns.map(([, cell]) => cell(entry))),
      [0, 1, columns.length - 1]);
    table.querySelectorAll("tbody tr").forEach((row, i) => {
      row.children[1].classList.add("use");
      if (entries[i][0] === v.proof_record) row.className = "proof";
    });
    byId("scores").append(table);
  };

  const std = values => {
    const mean = values.reduce((sum, x) => sum + x, 0) / values.length;
    return Math.sqrt(values.reduce((sum, x) => sum + (x - mean) ** 2, 0) / values.length);
  };

  // Measurement and prediction on one record; with a dividing line if a term is named.
  const curves = trace => {
    curtain.clear();
    byId("proof-curves").replaceChildren();
    byId("proof-residual").replaceChildren();
    const y = scaled(trace.unit, largest(trace.measured));
    const inUnit = values => values.map(value => value * y.factor);
    const pair = hasTerms
      ? [{ label: "predicted before", color: "before", dash: theme.DASH.before, side: "before", width: 1.3, y: inUnit(trace.before) },
        { label: "predicted after", color: "after", side: "after", width: 1.3, y: inUnit(trace.after) }]
      : [{ label: "predicted", color: "after", width: 1.3, y: inUnit(trace.after) }];
    const measured = { label: "measured", color: "measured", width: 3, y: inUnit(trace.measured) };
    const label = `${trace.channel} [${y.unit || "–"}]`;
    if (trace.abscissa.length) {
      const x = axis(trace.abscissa_label, largest(trace.abscissa));
      curtain.loops("proof-curves", "Loops", x.label, label, trace.abscissa.map(value => value * x.factor), trace.time, [measured, ...pair], hasTerms);
    }
    curtain.histories("proof-curves", "Time history", label, trace.time, [measured, ...pair], hasTerms, { timeLabel: trace.time_label });
    const errors = pair.map(c => ({ ...c, label: c.label.replace("predicted", "measured − predicted"), width: 1,
      y: c.y.map((value, i) => measured.y[i] - value) }));
    const floor = v.fit[trace.record] && v.fit[trace.record].noise_floor;
    const e = scaled(trace.unit, largest(errors.flatMap(c => c.y)) / y.factor);
    for (const c of errors) c.y = c.y.map(value => value / y.factor * e.factor);
    const most = 1.05 * Math.max(...errors.map(c => largest(c.y)));
    curtain.histories("proof-residual", "Residual", `residual [${e.unit || "–"}]`, trace.time, errors, hasTerms,
      { timeLabel: trace.time_label, height: 220, noise: floor ? 2 * floor * std(trace.measured) * e.factor : 0, range: [-most, most] });
  };

  // Error of a prediction as in the table: offset removed.
  const errorOf = (trace, prediction) =>
    std(trace.measured.map((value, i) => value - prediction[i])) / std(trace.measured);

  // Figures of the chosen record and channel; "before" lacks all named causes, or one of them.
  const shown = first => {
    const setErrors = hasTerms ? curtain.slider(byId("curtain")) : () => {};
    let shownTrace = first, leftOut = "";
    const show = trace => {
      shownTrace = trace;
      const s = v.fit[trace.record] || {};
      const without = trace.without[leftOut];
      setErrors([percent(without ? errorOf(trace, without) : s.nrmse_before), percent(s.nrmse_after)],
        `noise alone: ${percent(s.noise_floor)}. Drag the line in ` +
        "any figure, or the slider. Drag across a figure to zoom in, double-click to zoom out.");
      curves(without ? { ...trace, before: without } : trace);
    };
    const causes = [...new Set(traces.flatMap(t => Object.keys(t.without)))];
    if (hasTerms && causes.length) {
      const choice = el("select", { ariaLabel: "cause left out before" });
      choice.append(el("option", { value: "", textContent: "all named causes" }));
      for (const name of causes)
        choice.append(el("option", { value: name, textContent: `${name.replaceAll("_", " ")} alone` }));
      choice.addEventListener("change", () => { leftOut = choice.value; show(shownTrace); });
      byId("curtain").append(el("div", { className: "choice" }, "Left out before: ", choice));
    }
    if (traces.length > 1) {
      const choice = el("select", { ariaLabel: "record and channel" });
      traces.forEach((t, i) => choice.append(el("option", { value: i, selected: t === first, textContent: `${t.record} · ${t.channel}` })));
      choice.addEventListener("change", () => show(traces[choice.value]));
      byId("curtain").append(el("div", { className: "choice" }, "Shown: ", choice));
    }
    show(first);
  };

  const draw = () => {
    if (!hasTerms) byId("proof-title").textContent = "Residual";
    byId("proof-text").textContent = (v.proof_record
      ? `${v.proof_record} was used neither for fitting nor for choosing. `
      : "No record was held out: the following is not a proof. ") +
      "Errors are root mean squares over the standard deviation of the measurement." + (hasTerms
      ? " “Before” is refitted without the named terms, so that the comparison shows more than a better fit." : "");
    scores();
    const first = traceOf(v.proof_record, v.where.channel) || traces[0];
    if (first) shown(first);
    if (v.residual_correlation.length)
      charts.correlogram("proof-correlation", `Autocorrelation of the residual: ${v.residual_white ? "white" : "not white"}`,
        v.residual_correlation, v.correlation_bound);
  };

  const rivals = () => {
    const others = terms.flatMap(c => c.alternatives.map(a => ({ ...a, of: c })));
    if (!v.ablation.length && !others.length) return hide("rivals");
    byId("rivals-text").textContent = v.ablation.length
      ? "Error on the record of the proof after a change of the named terms and a refit. Dotted: noise alone." : "";
    const as = verdict.proof ? [{ title: "as named", value: verdict.proof.nrmse_after, shown: percent(verdict.proof.nrmse_after), kind: "named" }] : [];
    if (v.ablation.length)
      charts.rows(byId("ablation"), [...as, ...v.ablation.map(a => ({ title: a.what.replaceAll("_", " "), value: a.nrmse,
        shown: percent(a.nrmse), kind: a.what.startsWith("without") ? "before" : "" }))], { floor: verdict.proof && verdict.proof.noise_floor });
    if (!others.length) return;
    byId("alternatives").append(el("h3", { textContent: "Tied candidates" }), tableOf(["term", "instead of", "share of its gain", "separating test", "separation"],
      others.map(a => [a.title || a.name, a.of.title || a.of.name, share(a.share), a.test || "none known",
        a.test && a.sigma != null ? `${number(a.sigma, 3)} σ` : "–"]), [0, 1, 3]));
  };

  return { draw, rivals };
})();
