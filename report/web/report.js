"use strict";
// Draws the report from the data in the page.
(() => {
  const { data, unpack, times, gaps, el, byId, table } = plots;
  const { loops, lines } = figures;
  const n = data.numbers;
  plots.marks.synthetic = n.synthetic;
  const AXIS_NAME = { long: "longitudinal", lat: "lateral" };

  const axisNamed = name => data.axes.find(a => a.name === name);
  const MODELS = ["numerical", "improved", "beside"];
  const speed = () => (n.beside.rate === 1 ? "at true speed" : `${n.beside.rate} times slower`);
  const labelOf = name => (name === "beside" ? `${n.beside.name.replaceAll("_", " ")}, ${speed()}` : name);
  const styled = (name, label = name) => ({ label, color: name, dash: theme.DASH[name] });

  // --- header ------------------------------------------------------------------------------------
  const fixed = (value, digits) => (value == null ? "–" : value.toFixed(digits));
  const axes = Object.entries(n.axes);
  const has = section => !n.left_out.some(left => left.section === section);
  const bandName = b => `${b.from_Hz}–${b.to_Hz} Hz`;

  // The diagnosis of this test, above the test itself.
  const found = () => {
    const v = n.diagnosis;
    if (!v) return;
    byId("found").hidden = false;
    byId("found-chip").append(sentence.chip(v), "Diagnosis of the simulation");
    if (v.synthetic) byId("found-chip").append(el("span", { className: "badge", textContent: "synthetic recordings" }));
    sentence.write(v, "found");
    const file = (name, text) => [el("a", { href: name, textContent: text }), " · "];
    byId("found-files").append(...file("diagnosis.html", "details and proof"),
      ...(v.improved_model ? file("improved.toml", "the improved model") : []),
      el("a", { href: "verdict.json", textContent: "its numbers" }));
  };

  // Changes of an operator: a list, and marks on the figures over time.
  const changes = () => {
    const value = (v, unit) => `${+v.toPrecision(6)}${unit === "1" ? "" : ` ${unit}`}`;
    for (const c of n.operator_changes) {
      const text = `${c.signal}: ${value(c.from, c.unit)} → ${value(c.to, c.unit)}`;
      figures.time.marks.push({ time: c.time_s, text });
      byId("change-list").append(el("li", {}, el("b", { textContent: `${c.time_s.toFixed(3)} s` }), ` ${text}`));
    }
    byId("changes").hidden = !n.operator_changes.length;
  };

  // States of the safety layer, and its trip.
  const safety = () => {
    byId("safety-section").hidden = !n.safety.length;
    const trip = n.safety.find(c => c.state === "trip");
    if (trip) figures.time.marks.push({ time: trip.time_s, text: `safety trip: ${trip.text}` });
    byId("safety-text").textContent = trip
      ? `The safety layer tripped at ${trip.time_s.toFixed(3)} s and brought the machine to rest.`
      : "The safety layer passed every command unchanged until the stop.";
    byId("safety-list").append(...n.safety.map(c => el("li", {},
      el("b", { textContent: `${c.time_s.toFixed(3)} s` }), ` ${c.state}${c.text ? `: ${c.text}` : ""}`)));
  };

  const header = () => {
    document.title = `${n.name} · rths report`;
    byId("title").textContent = n.name.replaceAll("_", " ");
    byId("subtitle").append(
      `${n.motion} · ${Number(n.duration_s.toPrecision(4))} s · ${n.clock === "wall" ? "in real time" : "in virtual time"}, ` +
      `${n.processes} process${n.processes === 1 ? "" : "es"} · ${n.meta.started}` +
      (n.achieved_rate && Math.abs(n.achieved_rate - n.rate) > 0.01 * n.rate
        ? ` · ${fixed(n.achieved_rate, 2)} s of wall time per second of the model, planned ${n.rate}` : ""),
      ...(n.synthetic ? [el("span", { className: "badge", textContent: "synthetic specimen and machine" })] : []));
    const slow = (n.slow_downs === 0 ? "no slow-downs" : `${n.slow_downs} slow-downs`) +
      (n.slow_downs_excused ? ` (and ${n.slow_downs_excused} while the host was late)` : "");
    const good = n.conclusive && n.slow_downs === 0;
    byId("verdict").textContent = n.ending
      ? `Inconclusive: the test ended at ${fixed(n.duration_s, 2)} of ${n.planned_duration_s} s. Reason: ${n.ending}.`
      : n.conclusive
      ? `${n.integration_steps} integration steps at ${Math.round(n.control_rate_hz)} Hz` +
        (has("predictor-corrector") ? ` control, ${slow}` : "") +
        (n.steps_excused ? `; ${n.steps_excused} steps excused because the host was late` : "")
      : `Not conclusive: ${n.broken.length} ${n.broken.length === 1 ? "condition is" : "conditions are"} broken`;
    byId("verdict").classList.add(good ? "good" : "bad");
    byId("broken").hidden = n.conclusive;
    byId("broken").append(...n.broken.map(b => el("li", { textContent: b.text })));
    cards();
  };

  const cards = () => {
    const card = (name, value, unit, note) => byId("cards").append(el("div", { className: "card" },
      el("div", { className: "name", textContent: name }),
      el("div", { className: "value" }, value, " ", el("small", { textContent: unit })),
      el("div", { className: "note", textContent: note })));
    const each = (key, digits) => axes.map(([, a]) => fixed(a[key], digits)).join(" / ");
    for (const [name, a] of axes)
      card(`delay, ${AXIS_NAME[name]}`,
        (a.delay_raw_ms == null ? "" : `${fixed(a.delay_raw_ms, 1)} → `) + fixed(a.delay_compensated_ms, 1), "ms",
        `median over 2 s windows: ${fixed(a.delay_in_windows_median_ms, 1)} ms`);
    if (data.numerical.length)
      card("response against numerical", each("numerical_difference_percent", 1), "%", "of the displacement, rms" +
        (data.improved.length ? `; against improved: ${each("improved_difference_percent", 1)} %` : ""));
    if (!axes.length) return;
    const worst = a => a.tracking_bands.reduce((most, b) => (b.nrms_percent > most.nrms_percent ? b : most), a.tracking_bands[0]);
    if (n.vertical) card("vertical force", fixed(n.vertical.rms_percent, 2), "%", `RMS error / peak to peak; delay ${fixed(n.vertical.delay_ms, 1)} ms`);
    card("NRMS", each("nrms_percent", 2), "%", "RMS error / largest command; most of it at " +
      axes.map(([, a]) => bandName(worst(a))).filter((name, i, all) => all.indexOf(name) === i).join(" and "));
    card("peak displacement", each("peak_displacement_mm", 0), "mm",
      data.numerical.length ? `numerical: ${each("numerical_peak_displacement_mm", 0)}` : "");
    card("peak shear", each("peak_shear_kN", 0), "kN", data.numerical.length ? `numerical: ${each("numerical_peak_shear_kN", 0)}` : "");
    if (has("predictor-corrector")) card("predict / correct", `${fixed(n.predict_ms_mean, 1)} / ${fixed(n.correct_ms_mean, 1)}`, "ms", "mean of a step");
  };

  // Sections that this run lacks show the reason instead of their figures.
  const leftOut = () => {
    const SECTION = { response: "response", tracking: "tracking", compensation: "ats",
      "predictor-corrector": "steps", "floor spectra": "floors" };
    for (const { section, reason } of n.left_out) {
      const text = `Left out: ${reason}.`;
      if (!SECTION[section]) {
        byId("scope").append(el("li", { textContent: `Without ${section}: ${reason}.` }));
        continue;
      }
      const figures = byId(SECTION[section]);
      figures.hidden = true;
      figures.parentElement.querySelector("p").textContent = text;
    }
  };

  // --- figures -----------------------------------------------------------------------------------
  const response = () => {
    const measured = a => ({ u: unpack(a.step_displacement_mm), f: unpack(a.step_force_kN) });
    const start = unpack(data.steps.start_s);
    const models = MODELS.map(label => {
      const axes = {};
      for (const m of data[label])
        axes[m.name] = { u: unpack(m.loop_displacement_mm), f: unpack(m.loop_force_kN), time: times(m.displacement_mm) };
      return { label, axes };
    }).filter(m => Object.keys(m.axes).length);
    if (data.numerical.length)
      byId("response-text").append(" The numerical result has a model instead of the specimen, and no machine.");
    if (data.improved.length) byId("response-text").append(" The improved result has the improved model of the diagnosis.");
    if (n.beside)
      byId("response-text").append(` ${labelOf("beside")}, is another test, in ${n.beside.folder}` +
        `${n.beside.ending ? `, which ended early: ${n.beside.ending}` : ""}.`);
    // The test in front of the results with a model instead of the specimen.
    const beside = (pick, of) => [
      ...models.map(m => ({ ...styled(m.label, labelOf(m.label)), x: of(m.axes)[0], y: of(m.axes)[1], time: Object.values(m.axes)[0].time, width: 1.3 })),
      { ...styled("hybrid"), x: pick[0], y: pick[1], width: 1.3, time: start },
    ];
    for (const a of data.axes) {
      const h = measured(a);
      loops("response", `Hysteresis, ${AXIS_NAME[a.name]}`, "displacement [mm]", "shear force [kN]",
        beside([h.u, h.f], m => [m[a.name].u, m[a.name].f]));
    }
    if (data.axes.length < 2) return;
    const [x, y] = [measured(axisNamed("long")), measured(axisNamed("lat"))];
    loops("response", "Displacement orbit", "longitudinal [mm]", "lateral [mm]",
      beside([x.u, y.u], m => [m.long.u, m.lat.u]), { equal: true });
    loops("response", "Shear-force interaction", "longitudinal [kN]", "lateral [kN]",
      beside([x.f, y.f], m => [m.long.f, m.lat.f]), { equal: true });
  };

  // The response over time and, below, the differences from the test: the curves lie on each other.
  // Step i of the test reaches time (i + 1) Δt of a model; both are drawn at the time of the recording.
  const overTime = () => {
    const start = Array.from(unpack(data.steps.start_s)), group = { ...figures.group("response"), marks: figures.time.marks };
    for (const a of data.axes) {
      const u = Array.from(unpack(a.step_displacement_mm)).slice(0, start.length);
      const at = (m, t) => {
        const y = m.y, place = (t - m.start) / m.interval, i = Math.floor(place + 1e-6);
        return i < 0 || i + 1 >= y.length ? null : y[i] + (place - i) * (y[i + 1] - y[i]);
      };
      const models = MODELS.flatMap(label => {
        const m = data[label].find(one => one.name === a.name);
        if (!m) return [];
        const series = { ...m.displacement_mm, y: unpack(m.displacement_mm.values) };
        return [{ ...styled(label, labelOf(label)), width: 1.3, y: start.map((_, i) => at(series, (i + 1) * n.integration_step_s)) }];
      });
      if (!models.length) return;
      lines("over-time", `Response, ${AXIS_NAME[a.name]}`, start, "time [s]", "displacement [mm]",
        [...models, { ...styled("hybrid"), width: 1.3, y: u }], { group, height: 220 });
      lines("over-time", `Difference from the test, ${AXIS_NAME[a.name]}`, start, "time [s]", "difference [mm]",
        models.map(m => ({ ...m, y: m.y.map((y, i) => (y == null ? null : y - u[i])) })), { group, height: 180 });
    }
  };

  // Largest magnitudes of all runs shown.
  const peaks = () => {
    if (!axes.length) return;
    const rows = [["hybrid", "peak_displacement_mm", "peak_shear_kN", null]];
    for (const m of MODELS.filter(label => data[label].length))
      rows.push([labelOf(m), `${m}_peak_displacement_mm`, `${m}_peak_shear_kN`, `${m}_difference_percent`]);
    table("peaks", ["largest magnitude", ...axes.flatMap(([name]) => [`${AXIS_NAME[name]}: displacement [mm]`, "shear [kN]", "difference, rms [%]"])],
      rows.map(([label, ...keys]) => [label, ...axes.flatMap(([name, a]) => {
        const all = { ...a, ...(n.beside && n.beside.axes[name]) };
        return keys.map((key, i) => (key ? fixed(all[key], i === 1 ? 0 : 1) : "–"));
      })]));
  };

  const tracking = () => {
    if (!axes.length) return;
    if (!has("predictor-corrector")) byId("tracked").textContent = "Target of the solver";
    const first = data.axes[0];
    for (const a of data.axes)
      lines("tracking", `Displacement, ${AXIS_NAME[a.name]}`, times(a.command_mm), "time [s]", "displacement [mm]", [
        { ...styled("command"), y: unpack(a.command_mm.values), width: 1.8 },
        { ...styled("hybrid", "measured"), y: unpack(a.measured_mm.values), width: 1.2 },
      ], { height: 220 });
    const flat = (t, value) => Array.from(t, () => value);
    const t = times(first.delay_ms);
    const raw = data.axes.filter(a => n.axes[a.name].delay_raw_ms != null);
    lines("tracking", "Tracking delay", t, "time [s]", "delay [ms]", [
      ...data.axes.map(a => ({ ...styled(a.name, AXIS_NAME[a.name]), y: gaps(unpack(a.delay_ms.values)), width: 1.8 })),
      ...raw.map(a => ({ label: `${AXIS_NAME[a.name]}, without compensation`, color: a.name, dash: theme.DASH.raw,
        y: flat(t, n.axes[a.name].delay_raw_ms), width: 1.2 })),
    ], { height: 240 });
    lines("tracking", "Normalised RMS error", times(first.nrms_percent), "time [s]", "NRMS [%]",
      data.axes.map(a => ({ ...styled(a.name, AXIS_NAME[a.name]), y: unpack(a.nrms_percent.values), width: 1.8 })),
      { height: 200 });
  };

  // The force of a controlled vertical axis.
  const vertical = () => {
    const v = n.vertical;
    if (!v) return;
    byId("vertical-section").hidden = false;
    byId("vertical-text").textContent = "Force on the specimen that the controller commands, and the measured one without the " +
      `inertia of the platen. Delay ${fixed(v.delay_ms, 2)}\u2009ms; RMS error ${fixed(v.rms_percent, 2)}\u2009% of the command's ` +
      `${Math.round(v.peak_to_peak_kN)}\u2009kN peak to peak` +
      (v.coherence_1_to_15_Hz == null ? "." : `; coherence from 1 to 15\u2009Hz at least ${fixed(v.coherence_1_to_15_Hz, 2)}.`);
    lines("vertical", "Vertical force", times(data.vertical.command_kN), n.rate === 1 ? "time [s]" : "model time [s]", "force [kN]", [
      { ...styled("command"), y: unpack(data.vertical.command_kN.values), width: 1.8 },
      { ...styled("hybrid", "measured"), y: unpack(data.vertical.measured_kN.values), width: 1.2 },
    ], { height: 220, ...(n.rate === 1 ? {} : { group: figures.group("") }) });
    const f = unpack(data.vertical.frequencies_Hz), shown = f.filter(frequency => frequency <= 25).length;
    if (!f.length) return;
    lines("vertical", "Coherence", f.slice(0, shown), "frequency [Hz]", "coherence [–]", [
      { ...styled("hybrid", "measured force with the commanded one"), y: unpack(data.vertical.coherence).slice(0, shown), width: 1.5 },
    ], { height: 220, group: figures.group("") });
    table("vertical-table", ["band", "gain", "delay [ms]", "coherence", "error / largest change of the command [%]"],
      v.tracking_bands.map(b => [bandName(b), fixed(b.gain, 3), fixed(b.delay_ms, 1), fixed(b.coherence, 2), fixed(b.nrms_percent, 2)]));
  };

  // Gain, delay and error of each band in which the command has energy.
  const bands = () => {
    const ofAxis = (a, i) => {
      const b = a.tracking_bands[i];
      return [fixed(b.gain, 3), fixed(b.delay_ms, 1), fixed(b.coherence, 2), fixed(b.nrms_percent, 2)];
    };
    const first = axes.length ? axes[0][1].tracking_bands : [];
    const rows = first.map((b, i) => [bandName(b), ...axes.flatMap(([, a]) => ofAxis(a, i))]);
    if (!axes.some(([, a]) => a.tracking_bands.some(b => b.gain != null))) return;
    byId("bands").hidden = false;
    table("band-table", ["band", ...axes.flatMap(([name]) => [`${AXIS_NAME[name]}: gain`, "delay [ms]", "coherence", "NRMS [%]"])], rows);
  };

  const ats = () => {
    if (!has("compensation")) return;
    const plot = (key, caption, unit) => lines("ats", caption, times(data.axes[0][key]), "time [s]", unit,
      data.axes.map(a => ({ ...styled(a.name, AXIS_NAME[a.name]), y: unpack(a[key].values), width: 1.2 })));
    plot("a0", "a₀", "a₀ [–]");
    plot("a1_ms", "a₁", "a₁ [ms]");
    plot("a2_ms2", "a₂", "a₂ [ms²]");
  };

  const steps = () => {
    if (!has("predictor-corrector")) return;
    const s = data.steps;
    const [predict, slow, correct] = [unpack(s.predict_ms), unpack(s.slow_ms), unpack(s.correct_ms)];
    const sum = (...parts) => parts[0].map((_, i) => parts.reduce((total, p) => total + p[i], 0));
    const area = (name, label, y, shown) => ({ ...styled(name, label), y, shown, fill: `${name}-fill`, width: 1 });
    lines("steps", "States per step, stacked", unpack(s.start_s).slice(0, predict.length), "time [s]", "duration [ms]", [
      area("correct", "correct", sum(predict, slow, correct), correct),
      area("slow", "slow-down", sum(predict, slow), slow),
      area("predict", "predict", predict, predict),
    ], { height: 220 });
  };

  // A large structure: loads at rest and during the test, and its first modes.
  const largeStructure = () => {
    const s = data.structure;
    if (!structure.draw("structure", s.sketch)) return;
    byId("structure-section").hidden = false;
    byId("structure-text").textContent = "The structure's bearings and its first modes on their initial stiffness. Grey: at rest. " +
      (n.bearings_lifted === undefined ? ""
        : n.bearings_lifted === 0 ? "No bearing lifted off during the test."
        : `During the test, at most ${n.bearings_lifted} of its bearings lifted off at a time.`);
    const least = unpack(s.least_MN.values);
    if (!least.length) return;
    lines("structure-loads", "Loads of the bearings during the test", times(s.least_MN), "model time [s]", "load [MN]", [
      { ...styled("numerical", "largest"), y: unpack(s.largest_MN.values), width: 1.2 },
      { ...styled("hybrid", "least"), y: least, width: 1.2 },
    ], { height: 200, group: figures.group("") });
  };

  const floors = () => {
    if (!data.floors.length) return;
    const place = n.spectrum_elevation_m === undefined ? "" : `, at elevation ${n.spectrum_elevation_m}\u2009m`;
    byId("floor-text").textContent = `5\u2009% damping${place}: the largest magnitude over ` +
      "time of the absolute acceleration vector of an oscillator in two directions.";
    const f = unpack(data.frequencies_Hz);
    for (const floor of data.floors)
      lines("floors", (floor.floor[0].toUpperCase() + floor.floor.slice(1)).replaceAll("_", " "), f, "frequency [Hz]", "acceleration [m/s²]",
        floor.spectra.slice().reverse().map(s => ({
          ...styled(s.of, labelOf(s.of)), y: unpack(s.values), width: s.of === "hybrid" ? 2 : 1.5,
        })), { logX: true, logY: true, height: 320 });
  };

  const host = () => {
    const lateness = unpack(data.host_late_ms.values);
    if (lateness.length) {
      byId("host-note").textContent =
        "Lateness of the host: wake-up latency of an idle 1 ms thread. " +
        "Steps in which it reaches one control period are excused. If more than 1 % are excused, the test is not conclusive.";
      const t = times(data.host_late_ms);
      lines("host", "Host lateness, largest of each 10 ms", t, "time [s]", "lateness [ms]", [
        { ...styled("host"), y: lateness, width: 1 },
        { ...styled("limit", "one control period"), y: Array.from(t, () => 1000 / n.control_rate_hz), width: 1.2 },
      ], { height: 200, logY: true, measured: true });
    } else {
      byId("host-note").textContent =
        n.clock === "virtual" ? "This run was in virtual time. It makes no statement about real time." +
          (n.real_time ? ` Before, in real time, the host was ${n.real_time}: that attempt is in real_time.h5, ` +
            "and no number on this page is from it." : "")
          : "The lateness of the host was not recorded. The run makes no statement about real time.";
    }
    table("nodes", ["node", "steps", "late p50 [ms]", "p99", "max", "overruns", "stale reads", "not recorded"],
      Object.entries(n.nodes).map(([name, s]) => [name, s.steps, fixed(s.late_p50_ms, 3), fixed(s.late_p99_ms, 3),
        fixed(s.late_max_ms, 3), s.overruns, s.stale_reads, n.drops[name] ?? "–"]));
    if (n.hops.length === 0) return;
    table("hops", ["updates of", "reach host", "after p50 [ms]", "p99", "max", "age of the words p99 [ms]", "max"],
      n.hops.map((h) => [h.from, h.to, fixed(h.delay_p50_ms, 3), fixed(h.delay_p99_ms, 3), fixed(h.delay_max_ms, 2),
        fixed(h.age_p99_ms, 1), fixed(h.age_max_ms, 1)]));
  };

  const numbers = () => {
    const rows = [
      ["raw delay, cross-correlation [ms]", "delay_raw_ms", 2], ["raw delay, minimum RMS [ms]", "delay_raw_min_rms_ms", 2],
      ["raw NRMS [%]", "nrms_raw_percent", 2], ["compensated delay, cross-correlation [ms]", "delay_compensated_ms", 2],
      ["compensated delay, minimum RMS [ms]", "delay_compensated_min_rms_ms", 2],
      ["compensated delay, median over 2 s windows [ms]", "delay_in_windows_median_ms", 2],
      ["compensated delay, of largest magnitude in 2 s windows [ms]", "delay_in_windows_max_ms", 2],
      ["NRMS [%]", "nrms_percent", 2], ["NRMS, largest of 2 s windows [%]", "nrms_in_windows_max_percent", 2],
      ["largest error / largest command [%]", "peak_error_percent", 2], ["peak displacement [mm]", "peak_displacement_mm", 1],
      ["peak displacement, numerical [mm]", "numerical_peak_displacement_mm", 1],
      ["displacement, numerical against hybrid, rms [%]", "numerical_difference_percent", 1],
      ["displacement, improved against hybrid, rms [%]", "improved_difference_percent", 1], ["peak shear [kN]", "peak_shear_kN", 0],
      ["peak shear, numerical [kN]", "numerical_peak_shear_kN", 0], ["compensator ticks at a limit", "compensator_ticks_at_a_limit", 0],
    ];
    table("numbers", ["", ...axes.map(([name]) => AXIS_NAME[name])],
      rows.map(([label, key, digits]) => [label, ...axes.map(([, a]) => fixed(a[key], digits))]));
  };

  const scope = () => {
    for (const text of n.scope) byId("scope").append(el("li", { textContent: text }));
    if (axes.some(([, a]) => a.delay_raw_ms != null))
      byId("scope").append(el("li", { textContent: "The raw delay comes from a second run of the same targets in virtual time, " +
        "with the settings of the experiment's [uncompensated]." }));
    byId("reproduce").append("Every number is in ", el("code", { textContent: "report.json" }),
      ", the recording in ", el("code", { textContent: "run.h5" }), `. Made with rths ${n.meta.version}; to run it again: `,
      el("code", { textContent: n.command }), ".");
  };

  for (const draw of [found, changes, header, response, overTime, peaks, safety, tracking, bands, vertical, ats, steps, largeStructure, floors, host, numbers, scope, leftOut]) draw();
  plots.done();
})();
