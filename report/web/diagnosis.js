
// Draws the verdict of a diagnosis, section by section.
(() => {
  const { el, byId } = plots;
  const { number, share, percent, estimate, axis, largest, scaled } = quantities;
  const { v, terms, hasTerms, named, tied, placeOf, hide, traceOf, tableOf } = verdict;

  // --- header ------------------------------------------------------------------------------------
  const header = () => {
    document.title = `${v.case} · rths diagnosis`;
    byId("eyebrow").append(` · ${v.case}`);
    byId("eyebrow").prepend(sentence.chip(v));
    if (v.synthetic) byId("eyebrow").append(el("span", { className: "badge", textContent: "synthetic recordings" }));
    sentence.write(v, "verdict");
  };

  // Each section is folded below its heading. Paper shows all of it.
  const fold = () => {
    const folds = [];
    for (const section of document.querySelectorAll("main > section")) {
      const [heading, ...content] = section.children;
      folds.push(el("details", { className: "fold" }, el("summary", {}, heading), ...content));
      section.append(folds[folds.length - 1]);
    }
    let closed = [];
    addEventListener("beforeprint", () => {
      closed = folds.filter(one => !one.open);
      for (const one of closed) one.open = true;
    }, true);
    addEventListener("afterprint", () => { for (const one of closed) one.open = false; }, true);
  };

  // --- form, causes, model -----------------------------------------------------------------------
  const form = () => {
    if (!v.descriptions.length) return hide("form");
    const law = v.descriptions.find(d => d.of_terms), forms = v.descriptions.filter(d => !d.of_terms);
    if (hasTerms) {
      byId("form-title").textContent = law ? "Form of all guessed causes together" : "Form of the remainder";
      byId("form-text").textContent = law ? `Together the guessed causes draw one curve, ${law.form}, which is shown where the ` +
        `records visit it: any other law of this form explains them as well.${forms.length ? " The bars are forms of the residual that remains." : ""}` :
        "A systematic residual remains beside the named causes. Its form is its mean over the quantity on which it depends. It is " +
        "scored on a record that it was not fitted to; held samples and sudden changes are found on each record.";
    }
    charts.rows(byId("form-ranks"), forms.map((d, i) => ({
      title: d.form, value: Math.max(0, d.share ?? 0), shown: share(d.share), kind: i ? "" : "named" })));
    if (v.next_test)
      byId("form-ranks").append(el("p", { className: "callout" }, el("b", { textContent: "Next test: " }), v.next_test));
    const best = law || forms.find(d => d.x.length > 1);
    if (!best) return;
    const trace = traceOf(v.where.record, v.where.channel);
    const x = axis(best.x_label, largest(best.x)), y = scaled(trace ? trace.unit : "", largest(best.y));
    charts.bandCurve("form-curve", law ? `${law.form} of all guessed causes together` : `${best.form} with its band of two standard deviations`,
      law ? "sum of the causes" : "mean of the residual", best.x.map(value => value * x.factor), best.y.map(value => value * y.factor),
      best.band.map(value => value * y.factor), x.label, `${law ? "sum" : "residual"} [${y.unit || "–"}]`);
  };

  const kMostRows = 12;
  const causes = () => {
    if (!v.evidence.length) return hide("what");
    if (!hasTerms) byId("what-title").textContent = "Tried candidates";
    byId("what-text").textContent = "Gain of each single candidate of the catalogue in log-likelihood per observation [nat], " +
      "on blocks that it was not fitted to. All other free parameters are fitted again. 90 % intervals from resampling. " +
      (hasTerms ? "Dark: named. Light: tied with it. Grey: others." : "None is accepted.");
    const places = Math.max(1, Math.min(4, 1 - Math.floor(Math.log10(Math.max(...v.evidence.map(e => Math.abs(e.gain_nat ?? 0)), 1e-9)))));
    const items = v.evidence.map(e => ({ title: e.title || e.name, name: e.name, value: e.gain_nat, low: e.ci90[0], high: e.ci90[1],
      shown: e.gain_nat == null ? "–" : quantities.decimals(e.gain_nat, places), kind: named.has(e.name) ? "named" : tied.has(e.name) ? "tied" : "" }));
    charts.rows(byId("evidence"), items.slice(0, kMostRows));
    if (items.length <= kMostRows) return;
    const more = el("details", {}, el("summary", { textContent: `${items.length - kMostRows} more candidates` }));
    charts.rows(more, items.slice(kMostRows));
    byId("evidence").append(more);
  };

  const parameterRow = (name, p) => {
    const e = estimate(p.value, p.ci95, p.unit);
    return [name, e.value, `${e.low} to ${e.high}`, e.unit || "–"];
  };
  const fragment = () => {
    if (!v.improved_model) return;
    const pre = el("pre");
    for (const line of v.improved_model.trimEnd().split("\n")) {
      const kind = /^\s*#/.test(line) ? "c" : /^\s*\[/.test(line) ? "k" : "";
      pre.append(el("span", { className: kind, textContent: line }), "\n");
    }
    const button = el("button", { type: "button", textContent: "Copy" });
    button.addEventListener("click", async () => {
      try {
        await navigator.clipboard.writeText(v.improved_model);
      } catch {
        getSelection().selectAllChildren(pre);
        document.execCommand("copy");
      }
      button.textContent = "Copied";
      setTimeout(() => { button.textContent = "Copy"; }, 1600);
    });
    byId("fragment").append(el("div", { className: "paste" },
      el("h3", { textContent: /^\[model/m.test(v.improved_model) ? "Improved model (improved/case.toml)" : "Improved model to paste (improved.toml)" }), pre, button));
  };

  const model = () => {
    if (!hasTerms && !v.improved_model) return hide("model");
    for (const c of terms) {
      const card = el("div", { className: "cause" }, el("h3", { textContent: (v.guesses.includes(c) ? "Perhaps: " : "") + (c.title || c.name) }),
        el("p", { className: "facts" }, el("code", { textContent: c.name }),
          ` · ${placeOf(c.part)}, ${c.channel}`,
          c.explained_fraction == null ? "" : ` · explains ${share(c.explained_fraction)}`));
      if (c.equation) card.append(el("div", { className: "equation", textContent: c.equation }));
      const rows = Object.entries(c.parameters).map(([name, p]) => parameterRow(name.replace(/^.*\./, "").replaceAll("_", " "), p));
      if (rows.length) card.append(el("div", { className: "table" }, tableOf(["parameter", "value", "95 % interval", "unit"], rows, [0, 3])));
      byId("causes").append(card);
    }
    fragment();
  };

  // Intervals of the improved simulation.
  const bands = () => {
    const r = v.improved_response;
    if (!r) return hide("bands");
    byId("bands-text").textContent = "Peaks and floor spectra of the purely numerical result with the improved model. The 95 % " +
      `intervals carry those of the parameters of the specimen${r.remainder_counted ? " and the remaining error of the force" :
        "; the remaining error of the force is not counted"}, by ${r.runs} simulations.`;
    byId("peaks").append(tableOf(["peak", "value", "95 % interval", "unit"],
      r.peaks.map(p => parameterRow(p.name.replace(".", ", "), p)), [0, 3]));
    for (const s of r.spectra)
      figures.lines("band-spectra", `Floor spectrum, ${s.floor}, ${number(100 * r.damping_ratio, 2)} % damping`, r.frequency_Hz,
        "frequency [Hz]", "acceleration [m/s²]", [
          { label: "95 % interval", color: "noise-line", width: 1, y: s.low.map(y => (y > 0 ? y : null)) },
          { label: "95 % interval, upper end", color: "noise-line", width: 1, y: s.high },
          { label: "improved simulation", color: "after", width: 1.6, y: s.acceleration_m_per_s2 },
        ], { logX: true, logY: true, height: 320 });
  };

  const limits = () => {
    for (const limit of v.limits) byId("limit-list").append(el("li", { textContent: limit }));
    if (!v.limits.length) byId("limit-list").remove();
    if (v.next_test && !v.descriptions.length) {
      byId("next").className = "callout";
      byId("next").append(el("b", { textContent: "Next test: " }), v.next_test);
    } else byId("next").remove();
    byId("reproduce").append(v.noise_model ? `Noise: ${v.noise_model}. ` : "", "Every number is in ",
      el("code", { textContent: "verdict.json" }), ", every curve in ", el("code", { textContent: "predictions/" }), v.seconds != null ? `. The diagnosis took ${number(v.seconds, 2)} s.` : ".");
  };

  for (const draw of [header, fold, budget.draw, where.draw, form, causes, model, bands, proof.draw, proof.rivals, limits]) draw();
  plots.done();
})();
