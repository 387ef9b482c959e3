"use strict";
// Draws the report from the data in the page.
(() => {
  const { data, unpack, times, gaps, el, byId, loops, lines, table } = plots;
  const n = data.numbers;
  plots.marks.synthetic = n.synthetic;
  const COLOR = {
    hybrid: "#c0392b", numerical: "#1f6fb2", improved: "#1a7f4b", "fixed base": "#7f8c8d", input: "#2c3e50",
    long: "#0b6e99", lat: "#d9730d", predict: "#f0b429", correct: "#2a9d8f", slow: "#b3261e",
    host: "#5b6875", limit: "#b3261e",
  };
  const AXIS_NAME = { long: "longitudinal", lat: "lateral" };

  const axisNamed = name => data.axes.find(a => a.name === name);
  const MODELS = ["numerical", "improved"];

  // --- header ------------------------------------------------------------------------------------
  const fixed = (value, digits) => (value == null ? "–" : value.toFixed(digits));
  const axes = Object.entries(n.axes);

  // The diagnosis of this test, above the test itself.
  const found = () => {
    const v = n.diagnosis;
    if (!v) return;
    byId("found").hidden = false;
    byId("found-chip").append(sentence.chip(v), "Diagnosis of the simulation");
    if (v.synthetic) byId("found-chip").append(el("span", { className: "badge", textContent: "synthetic recordings" }));
    sentence.write(v, byId("found-sentence"), byId("found-rest"));
    sentence.proofCards(v, byId("found-cards"));
    const differences = key => axes.map(([, a]) => fixed(a[key], 1)).join(" / ");
    if (data.improved.length)
      sentence.card(byId("found-cards"), "simulation against test",
        `${differences("numerical_difference_percent")} → ${differences("improved_difference_percent")}\u2009%`,
        `of its displacement, rms, ${axes.map(([name]) => AXIS_NAME[name]).join(" / ")}`);
    const file = (name, text) => [el("a", { href: name, textContent: text }), " · "];
    byId("found-files").append(...file("diagnosis.html", "details and proof"),
      ...(v.improved_model ? file("improved.toml", "the improved model") : []),
      el("a", { href: "verdict.json", textContent: "its numbers" }));
  };

  const header = () => {
    document.title = `${n.name} · rths report`;
    byId("title").textContent = n.name.replaceAll("_", " ");
    byId("subtitle").append(
      `${n.motion} · ${n.duration_s} s · ${n.clock === "wall" ? "in real time" : "in virtual time"}, ` +
      `${n.processes} process${n.processes === 1 ? "" : "es"} · ${n.meta.started}`,
      el("span", { className: "badge", textContent: "synthetic specimen and machine" }));
    const slow = (n.slow_downs === 0 ? "no slow-downs" : `${n.slow_downs} slow-downs`) +
      (n.slow_downs_excused ? ` (and ${n.slow_downs_excused} while the host was late)` : "");
    const good = n.conclusive && n.slow_downs === 0;
    byId("verdict").textContent = n.conclusive
      ? `${n.integration_steps} integration steps at ${Math.round(n.control_rate_hz)} Hz control, ${slow}` +
        (n.steps_excused ? `; ${n.steps_excused} steps excused because the host was late` : "")
      : `Inconclusive: the host was late in ${n.steps_excused} of ${n.integration_steps} steps. Run again.`;
    byId("verdict").classList.add(good ? "good" : "bad");

    const card = (name, value, unit, note) => byId("cards").append(el("div", { className: "card" },
      el("div", { className: "name", textContent: name }),
      el("div", { className: "value" }, value, " ", el("small", { textContent: unit })),
      el("div", { className: "note", textContent: note })));
    const paperDelay = { long: "6.3", lat: "3.8" };
    for (const [name, a] of axes)
      card(`delay, ${AXIS_NAME[name]}`,
        (a.delay_raw_ms == null ? "" : `${fixed(a.delay_raw_ms, 1)} → `) + fixed(a.delay_compensated_ms, 1), "ms",
        `paper: about 60 → ${paperDelay[name]} ms`);
    card("NRMS", axes.map(([, a]) => fixed(a.nrms_percent, 2)).join(" / "), "%", "RMS error / largest command; paper: < 1 %");
    card("peak displacement", axes.map(([, a]) => fixed(a.peak_displacement_mm, 0)).join(" / "), "mm",
      "numerical: " + axes.map(([, a]) => fixed(a.numerical_peak_displacement_mm, 0)).join(" / "));
    card("peak shear", axes.map(([, a]) => fixed(a.peak_shear_kN, 0)).join(" / "), "kN",
      "numerical: " + axes.map(([, a]) => fixed(a.numerical_peak_shear_kN, 0)).join(" / "));
    card("predict / correct", `${fixed(n.predict_ms_mean, 1)} / ${fixed(n.correct_ms_mean, 1)}`, "ms", "mean of a step; paper: 3 / 7");
  };

  // --- figures -----------------------------------------------------------------------------------
  const response = () => {
    const measured = a => ({ u: unpack(a.step_displacement_mm), f: unpack(a.step_force_kN) });
    const models = MODELS.map(label => {
      const axes = {};
      for (const m of data[label]) axes[m.name] = { u: unpack(m.loop_displacement_mm), f: unpack(m.loop_force_kN) };
      return { label, axes };
    }).filter(m => Object.keys(m.axes).length);
    // The test in front of the results with a model instead of the specimen.
    const beside = (pick, of) => [
      ...models.map(m => ({ label: m.label, color: COLOR[m.label], x: of(m.axes)[0], y: of(m.axes)[1], width: 1.2 })),
      { label: "hybrid", color: COLOR.hybrid, x: pick[0], y: pick[1], width: 1.2 },
    ];
    for (const a of data.axes) {
      const h = measured(a);
      loops("response", `Hysteresis, ${AXIS_NAME[a.name]}`, "displacement [mm]", "shear force [kN]",
        beside([h.u, h.f], m => [m[a.name].u, m[a.name].f]));
    }
    if (data.axes.length < 2) return;
    const [x, y] = [measured(axisNamed("long")), measured(axisNamed("lat"))];
    loops("response", "Displacement orbit", "longitudinal [mm]", "lateral [mm]",
      beside([x.u, y.u], m => [m.long.u, m.lat.u]), true);
    loops("response", "Shear-force interaction", "longitudinal [kN]", "lateral [kN]",
      beside([x.f, y.f], m => [m.long.f, m.lat.f]), true);
  };

  const tracking = () => {
    const first = data.axes[0];
    for (const a of data.axes)
      lines("tracking", `Displacement, ${AXIS_NAME[a.name]}`, times(a.command_mm), "time [s]", "[mm]", [
        { label: "command", color: COLOR.input, y: unpack(a.command_mm.values), width: 1.6 },
        { label: "measured", color: COLOR.hybrid, y: unpack(a.measured_mm.values), width: 1.1 },
      ], { height: 220 });
    const flat = (t, value) => Array.from(t, () => value);
    const t = times(first.delay_ms);
    const raw = data.axes.filter(a => n.axes[a.name].delay_raw_ms != null);
    lines("tracking", "Tracking delay", t, "time [s]", "[ms]", [
      ...data.axes.map(a => ({ label: AXIS_NAME[a.name], color: COLOR[a.name], y: gaps(unpack(a.delay_ms.values)), width: 1.8 })),
      ...raw.map(a => ({ label: `${AXIS_NAME[a.name]}, without compensation`, color: COLOR[a.name], dashed: true,
        y: flat(t, n.axes[a.name].delay_raw_ms), width: 1.2 })),
    ], { height: 240 });
    lines("tracking", "Normalised RMS error", times(first.nrms_percent), "time [s]", "[%]",
      data.axes.map(a => ({ label: AXIS_NAME[a.name], color: COLOR[a.name], y: unpack(a.nrms_percent.values), width: 1.8 })),
      { height: 200 });
  };

  const ats = () => {
    const plot = (key, caption, unit) => lines("ats", caption, times(data.axes[0][key]), "time [s]", unit,
      data.axes.map(a => ({ label: AXIS_NAME[a.name], color: COLOR[a.name], y: unpack(a[key].values), width: 1.2 })));
    plot("a0", "a₀", "[–]");
    plot("a1_ms", "a₁", "[ms]");
    plot("a2_ms2", "a₂", "[ms²]");
  };

  const steps = () => {
    const s = data.steps;
    const [predict, slow, correct] = [unpack(s.predict_ms), unpack(s.slow_ms), unpack(s.correct_ms)];
    const sum = (...parts) => parts[0].map((_, i) => parts.reduce((total, p) => total + p[i], 0));
    lines("steps", "States per step, stacked", unpack(s.start_s), "time [s]", "[ms]", [
      { label: "correct", color: COLOR.correct, y: sum(predict, slow, correct), fill: "#cdeae6", width: 1 },
      { label: "slow-down", color: COLOR.slow, y: sum(predict, slow), fill: "#f2c4c0", width: 1 },
      { label: "predict", color: COLOR.predict, y: predict, fill: "#fbe3a8", width: 1 },
    ], { height: 220 });
  };

  const floors = () => {
    const f = unpack(data.frequencies_Hz);
    for (const floor of data.floors)
      lines("floors", floor.floor[0].toUpperCase() + floor.floor.slice(1), f, "frequency [Hz]", "[m/s²]",
        floor.spectra.slice().reverse().map(s => ({
          label: s.of, color: COLOR[s.of], dashed: s.of === "input", y: unpack(s.values), width: s.of === "hybrid" ? 2 : 1.4,
        })), { logX: true, logY: true, height: 320 });
  };

  const host = () => {
    const lateness = unpack(data.host_late_ms.values);
    if (lateness.length) {
      byId("host-note").textContent =
        "Lateness of the host: wake-up latency of an idle 1 ms thread. " +
        "Steps in which it reaches one control period are excused. If more than 1 % are excused, the run is inconclusive.";
      const t = times(data.host_late_ms);
      lines("host", "Host lateness, largest of each 10 ms", t, "time [s]", "[ms]", [
        { label: "host", color: COLOR.host, y: lateness, width: 1 },
        { label: "one control period", color: COLOR.limit, dashed: true, y: Array.from(t, () => 1000 / n.control_rate_hz), width: 1.2 },
      ], { height: 200, logY: true, measured: true });
    } else {
      byId("host-note").textContent =
        "This run was in virtual time. It makes no statement about real time.";
    }
    table("nodes", ["node", "steps", "late p50 [ms]", "p99", "max", "overruns", "stale reads", "not recorded"],
      Object.entries(n.nodes).map(([name, s]) => [name, s.steps, fixed(s.late_p50_ms, 3), fixed(s.late_p99_ms, 3),
        fixed(s.late_max_ms, 3), s.overruns, s.stale_reads, n.drops[name] ?? "–"]));
  };

  const numbers = () => {
    const rows = [
      ["raw delay, cross-correlation [ms]", "delay_raw_ms", 2], ["raw delay, minimum RMS [ms]", "delay_raw_min_rms_ms", 2],
      ["raw NRMS [%]", "nrms_raw_percent", 2], ["compensated delay, cross-correlation [ms]", "delay_compensated_ms", 2],
      ["compensated delay, minimum RMS [ms]", "delay_compensated_min_rms_ms", 2],
      ["compensated delay, median over 2 s windows [ms]", "delay_in_windows_median_ms", 2],
      ["compensated delay, largest of 2 s windows [ms]", "delay_in_windows_max_ms", 2],
      ["NRMS [%]", "nrms_percent", 2], ["NRMS, largest of 2 s windows [%]", "nrms_in_windows_max_percent", 2],
      ["largest error / largest command [%]", "peak_error_percent", 2], ["peak displacement [mm]", "peak_displacement_mm", 1],
      ["peak displacement, numerical [mm]", "numerical_peak_displacement_mm", 1],
      ["displacement, numerical against hybrid, rms [%]", "numerical_difference_percent", 1], ["peak shear [kN]", "peak_shear_kN", 0],
      ["peak shear, numerical [kN]", "numerical_peak_shear_kN", 0], ["ATS ticks at a limit", "ats_ticks_at_a_limit", 0],
    ];
    table("numbers", ["", ...axes.map(([name]) => AXIS_NAME[name])],
      rows.map(([label, key, digits]) => [label, ...axes.map(([, a]) => fixed(a[key], digits))]));
    byId("reproduce").append("Every number is in ", el("code", { textContent: "report.json" }),
      ", the recording in ", el("code", { textContent: "run.h5" }), `. Made with rths ${n.meta.version}; to run it again: `,
      el("code", { textContent: "./lab demo" }), ".");
  };

  for (const draw of [found, header, response, tracking, ats, steps, floors, host, numbers]) draw();
  plots.done();
})();
