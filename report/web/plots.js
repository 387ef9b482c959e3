"use strict";
// Functions of both pages: unpacking of numbers, elements of a page, curves. For tests, the body has the
// attributes data-figures (number of drawn figures) and data-error.
const plots = (() => {
  window.addEventListener("error", e => { document.body.dataset.error = e.message; });

  const data = JSON.parse(document.getElementById("data").textContent);
  const marks = { synthetic: false };  // printed on each picture
  let figures = 0;

  // --- data --------------------------------------------------------------------------------------
  const unpack = text => {
    const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
    return new Float32Array(bytes.buffer);
  };
  const times = s => Float64Array.from({ length: unpack(s.values).length }, (_, i) => s.start + i * s.interval);
  // uPlot draws a gap where a value is null; the data have NaN there.
  const gaps = values => Array.from(values, v => (Number.isNaN(v) ? null : v));

  // --- elements ----------------------------------------------------------------------------------
  const el = (tag, attributes = {}, ...children) => {
    const node = Object.assign(document.createElement(tag), attributes);
    node.append(...children);
    return node;
  };
  const byId = id => document.getElementById(id);

  const figure = (container, caption, key) => {
    const legend = el("div", { className: "key" });
    for (const k of key) {
      const line = el("i", { className: k.dashed ? "dashed" : "" });
      line.style.borderTopColor = k.color;
      legend.append(el("span", {}, line, k.label));
    }
    const box = el("figure", {}, el("figcaption", { textContent: caption }), legend);
    byId(container).append(box);
    figures += 1;
    return box;
  };

  // Marks pictures of synthetic data.
  const stamp = (u, y) => {
    if (!marks.synthetic) return;
    const { ctx, bbox } = u;
    ctx.save();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.fillStyle = "rgba(91,104,117,.75)";
    ctx.textAlign = "right";
    ctx.fillText("synthetic", bbox.left + bbox.width - 6 * devicePixelRatio, y);
    ctx.restore();
  };
  const watermark = u => stamp(u, u.bbox.top + 14 * devicePixelRatio);
  const watermarkBelow = u => stamp(u, u.bbox.top + u.bbox.height - 8 * devicePixelRatio);
  const axisStyle = (label, extra = {}) => ({
    label, labelSize: 18, labelGap: 0, size: 32, labelFont: "12px system-ui", font: "11px system-ui", stroke: "#5b6875",
    grid: { stroke: "#edf0f2", width: 1 }, ticks: { stroke: "#d5dadf", width: 1, size: 5 }, ...extra,
  });
  // Redraws at the width of the page; `height` computes the height from the width.
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

  // A curve through its points, clipped to an interval of the picture; by default to the whole picture.
  const strokeCurve = (u, xs, ys, style, left = u.bbox.left, width = u.bbox.width) => {
    const { ctx } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, u.bbox.top, width, u.bbox.height);
    ctx.clip();
    ctx.beginPath();
    for (let i = 0; i < xs.length; i++) {
      const x = u.valToPos(xs[i], "x", true), y = u.valToPos(ys[i], "y", true);
      i ? ctx.lineTo(x, y) : ctx.moveTo(x, y);
    }
    ctx.lineWidth = style.width * devicePixelRatio;
    ctx.strokeStyle = style.color;
    ctx.lineJoin = "round";
    ctx.stroke();
    ctx.restore();
    return null;
  };
  // Curves whose x goes back and forth: loops and orbits.
  const drawCurve = (u, index) => {
    const { lineWidth, color } = u.series[index];
    return strokeCurve(u, ...u.data[index], { width: lineWidth, color });
  };
  const loops = (container, caption, xLabel, yLabel, curves, equal = false) => {
    const box = figure(container, caption, curves.map(c => ({ label: c.label, color: c.color })));
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
  const lines = (container, caption, x, xLabel, yLabel, curves, options = {}) => {
    const box = figure(container, caption, curves);
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

  const table = (container, head, rows) => {
    const body = el("tbody");
    for (const row of rows) body.append(el("tr", {}, ...row.map(cell => el("td", { textContent: cell }))));
    byId(container).append(el("table", {},
      el("thead", {}, el("tr", {}, ...head.map(h => el("th", { textContent: h })))), body));
  };

  const done = () => { document.body.dataset.figures = figures; };

  return { data, marks, unpack, times, gaps, el, byId, figure, watermark, watermarkBelow, axisStyle, fit, padded, extent,
    strokeCurve, drawCurve, loops, logTicks, lines, table, done };
})();
