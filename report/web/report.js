"use strict";
// Draws the report from the data in the page. Everything stays in this file's one function; what a
// test wants to know stands on the body: data-figures (how many were drawn) and data-error.
(() => {
  window.addEventListener("error", e => { document.body.dataset.error = e.message; });

  const data = JSON.parse(document.getElementById("data").textContent);
  const n = data.numbers;
  const COLOR = {
    hybrid: "#c0392b", numerical: "#1f6fb2", "fixed base": "#7f8c8d", input: "#2c3e50",
    long: "#0b6e99", lat: "#d9730d", predict: "#f0b429", correct: "#2a9d8f", slow: "#b3261e",
    host: "#5b6875", limit: "#b3261e",
  };
  const AXIS_NAME = { long: "longitudinal", lat: "lateral" };
  let figures = 0;

  // --- data --------------------------------------------------------------------------------------
  const unpack = text => {
    const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
    return new Float32Array(bytes.buffer);
  };
  const times = s => Float64Array.from({ length: unpack(s.values).length }, (_, i) => s.start + i * s.interval);
  // uPlot has a gap where a value is null; in our data it is no number.
  const gaps = values => Array.from(values, v => (Number.isNaN(v) ? null : v));
  const axisNamed = name => data.axes.find(a => a.name === name);
  const modelNamed = name => data.numerical.find(a => a.name === name);

  // --- page parts --------------------------------------------------------------------------------
  const el = (tag, attributes = {}, ...children) => {
    const node = Object.assign(document.createElement(tag), attributes);
    node.append(...children);
    return node;
  };
  const byId = id => document.getElementById(id);

  const figure = (place, caption, key) => {
    const legend = el("div", { className: "key" });
    for (const k of key) {
      const line = el("i", { className: k.dashed ? "dashed" : "" });
      line.style.borderTopColor = k.color;
      legend.append(el("span", {}, line, k.label));
    }
    const box = el("figure", {}, el("figcaption", { textContent: caption }), legend);
    byId(place).append(box);
    figures += 1;
    return box;
  };

  // Synthetic data says so on the picture itself.
  const watermark = u => {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.fillStyle = "rgba(91,104,117,.75)";
    ctx.textAlign = "right";
    ctx.fillText("synthetic", bbox.left + bbox.width - 6 * devicePixelRatio, bbox.top + 14 * devicePixelRatio);
    ctx.restore();
  };
  const axisStyle = (label, extra = {}) => ({
    label, labelSize: 18, labelGap: 0, size: 32, labelFont: "12px system-ui", font: "11px system-ui", stroke: "#5b6875",
    grid: { stroke: "#edf0f2", width: 1 }, ticks: { stroke: "#d5dadf", width: 1, size: 5 }, ...extra,
  });
  // Redraws at the width the page gives; a figure knows its height from its width.
  const fit = (box, plot, height) => {
    let drawn = 0;
    new ResizeObserver(() => requestAnimationFrame(() => {
      const width = Math.floor(box.clientWidth);
      if (width > 0 && width !== drawn) plot.setSize({ width: drawn = width, height: height(width) });
    })).observe(box);
  };

  const padded = (low, high) => {
    const margin = 0.06 * (high - low || 1);
    return [low - margin, high + margin];
  };
  const extent = arrays => {
    let low = Infinity, high = -Infinity;
    for (const values of arrays) for (const v of values) { if (v < low) low = v; if (v > high) high = v; }
    return [low, high];
  };

  // Curves whose x goes back and forth: loops and orbits.
  const drawCurve = (u, index) => {
    const [xs, ys] = u.data[index];
    const { ctx } = u;
    const s = u.series[index];
    ctx.save();
    ctx.beginPath();
    ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    ctx.clip();
    ctx.beginPath();
    for (let i = 0; i < xs.length; i++) {
      const x = u.valToPos(xs[i], "x", true), y = u.valToPos(ys[i], "y", true);
      i ? ctx.lineTo(x, y) : ctx.moveTo(x, y);
    }
    ctx.lineWidth = s.lineWidth * devicePixelRatio;
    ctx.strokeStyle = s.color;
    ctx.lineJoin = "round";
    ctx.stroke();
    ctx.restore();
    return null;
  };
  const loops = (place, caption, xLabel, yLabel, curves, equal = false) => {
    const box = figure(place, caption, curves.map(c => ({ label: c.label, color: c.color })));
    let x = padded(...extent(curves.map(c => c.x))), y = padded(...extent(curves.map(c => c.y)));
    if (equal) {
      const half = Math.max(x[1] - x[0], y[1] - y[0]) / 2;
      const around = r => { const m = (r[0] + r[1]) / 2; return [m - half, m + half]; };
      [x, y] = [around(x), around(y)];
    }
    const height = width => Math.round(Math.min(width * 0.78, 430));
    const plot = new uPlot({
      mode: 2, width: 400, height: 320, legend: { show: false }, cursor: { show: false },
      scales: { x: { time: false, range: () => x }, y: { range: () => y } },
      axes: [axisStyle(xLabel), axisStyle(yLabel, { size: 52 })],
      series: [null, ...curves.map(c => ({ color: c.color, lineWidth: c.width || 1.3, paths: drawCurve,
        facets: [{ scale: "x", auto: false }, { scale: "y", auto: false }] }))],
      hooks: { draw: [watermark] },
    }, [null, ...curves.map(c => [c.x, c.y])], box);
    fit(box, plot, height);
  };

  // On a logarithmic axis: 1, 2 and 5 of each decade carry a number.
  const logTicks = {
    filter: (u, splits) => splits.map(v => ("125".includes(v.toExponential()[0]) && v.toExponential().length < 6 ? v : null)),
    values: (u, splits) => splits.map(v => (v == null ? "" : String(+v.toPrecision(2)))),
  };

  // Curves over time or frequency.
  const cursorGroup = uPlot.sync("time");
  const lines = (place, caption, x, xLabel, yLabel, curves, options = {}) => {
    const box = figure(place, caption, curves);
    const height = width => Math.round(options.height || Math.min(Math.max(width * 0.62, 220), 280));
    const plot = new uPlot({
      width: 400, height: 240, legend: { show: false },
      cursor: options.logX ? { y: false } : { y: false, sync: { key: cursorGroup.key, setSeries: false } },
      scales: {
        x: { time: false, distr: options.logX ? 3 : 1 },
        y: { distr: options.logY ? 3 : 1, range: options.range ? () => options.range : undefined },
      },
      axes: [axisStyle(xLabel, options.logX ? logTicks : {}),
             axisStyle(yLabel, { size: 46, ...(options.logY ? logTicks : {}) })],
      series: [{}, ...curves.map(c => ({
        stroke: c.color, width: c.width || 1.4, dash: c.dashed ? [5, 4] : undefined,
        fill: c.fill, points: { show: false }, spanGaps: false,
      }))],
      bands: options.bands,
      hooks: { draw: options.measured ? [] : [watermark] },
    }, [x, ...curves.map(c => c.y)], box);
    fit(box, plot, height);
  };

  const table = (place, head, rows) => {
    const body = el("tbody");
    for (const row of rows) body.append(el("tr", {}, ...row.map(cell => el("td", { textContent: cell }))));
    byId(place).append(el("table", {},
      el("thead", {}, el("tr", {}, ...head.map(h => el("th", { textContent: h })))), body));
  };

  // --- header ------------------------------------------------------------------------------------
  const fixed = (value, digits) => (value == null ? "–" : value.toFixed(digits));
  const axes = Object.entries(n.axes);

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
        (n.steps_excused ? `; ${n.steps_excused} steps excused by the host's own lateness` : "")
      : `Inconclusive: the host itself was late in ${n.steps_excused} of ${n.integration_steps} steps. Run again.`;
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
    const model = name => {
      const m = modelNamed(name);
      return m && { u: unpack(m.loop_displacement_mm), f: unpack(m.loop_force_kN) };
    };
    const pair = (pick, other) => {
      const curves = [];
      if (other) curves.push({ label: "numerical", color: COLOR.numerical, x: other[0], y: other[1], width: 1.2 });
      curves.push({ label: "hybrid", color: COLOR.hybrid, x: pick[0], y: pick[1], width: 1.2 });
      return curves;
    };
    for (const a of data.axes) {
      const h = measured(a), m = model(a.name);
      loops("response", `Hysteresis, ${AXIS_NAME[a.name]}`, "displacement [mm]", "shear force [kN]",
        pair([h.u, h.f], m && [m.u, m.f]));
    }
    if (data.axes.length < 2) return;
    const [x, y] = [measured(axisNamed("long")), measured(axisNamed("lat"))];
    const [mx, my] = [model("long"), model("lat")];
    loops("response", "Displacement orbit", "longitudinal [mm]", "lateral [mm]",
      pair([x.u, y.u], mx && [mx.u, my.u]), true);
    loops("response", "Shear-force interaction", "longitudinal [kN]", "lateral [kN]",
      pair([x.f, y.f], mx && [mx.f, my.f]), true);
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
        "How late a thread that does nothing but wake every millisecond was let run: the host's own lateness. " +
        "Steps in which it reaches one control period are excused; more than 1 % of them makes a run inconclusive.";
      const t = times(data.host_late_ms);
      lines("host", "Host lateness, largest of each 10 ms", t, "time [s]", "[ms]", [
        { label: "host", color: COLOR.host, y: lateness, width: 1 },
        { label: "one control period", color: COLOR.limit, dashed: true, y: Array.from(t, () => 1000 / n.control_rate_hz), width: 1.2 },
      ], { height: 200, logY: true, measured: true });
    } else {
      byId("host-note").textContent =
        "This run was in virtual time: nothing was late, and nothing here is a claim about real time.";
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
      ["compensated delay in windows of 2 s, median [ms]", "delay_in_windows_median_ms", 2],
      ["compensated delay in windows of 2 s, largest [ms]", "delay_in_windows_max_ms", 2],
      ["NRMS [%]", "nrms_percent", 2], ["NRMS in windows of 2 s, largest [%]", "nrms_in_windows_max_percent", 2],
      ["largest error / largest command [%]", "peak_error_percent", 2], ["peak displacement [mm]", "peak_displacement_mm", 1],
      ["peak displacement, numerical [mm]", "numerical_peak_displacement_mm", 1], ["peak shear [kN]", "peak_shear_kN", 0],
      ["peak shear, numerical [kN]", "numerical_peak_shear_kN", 0], ["ATS ticks at a limit", "ats_ticks_at_a_limit", 0],
    ];
    table("numbers", ["", ...axes.map(([name]) => AXIS_NAME[name])],
      rows.map(([label, key, digits]) => [label, ...axes.map(([, a]) => fixed(a[key], digits))]));
    byId("reproduce").append("Every number is in ", el("code", { textContent: "report.json" }),
      ", the recording in ", el("code", { textContent: "run.h5" }), `. Made with rths ${n.meta.version}; to run it again: `,
      el("code", { textContent: "./lab demo" }), ".");
  };

  for (const draw of [header, response, tracking, ats, steps, floors, host, numbers]) draw();
  document.body.dataset.figures = figures;
})();
