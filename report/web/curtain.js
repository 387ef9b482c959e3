
// A line divides every figure: before on its left, after on its right. One slider moves all lines.
const curtain = (() => {
  const { el, axisStyle, figure, fit, padded, extent, strokeCurve, watermark, watermarkBelow } = plots;
  const COLOR = { measured: "#aab6c1", before: "#c8501e", after: "#0b5c8a", noise: "#e4e9ed" };
  const followers = new Set();  // figures
  const sliders = [];
  const kHeight = 400;
  let position = 0.5;

  const moveTo = share => {
    position = Math.min(1, Math.max(0, share));
    for (const follow of [...followers, ...sliders]) follow();
  };

  // A curve, cut off at the line.
  const cutCurve = (u, xs, ys, style) => {
    const { bbox } = u;
    const edge = bbox.width * position;
    const left = style.side === "after" ? bbox.left + edge : bbox.left;
    const width = style.side === "before" ? edge : style.side === "after" ? bbox.width - edge : bbox.width;
    return strokeCurve(u, xs, ys, style, left, width);
  };

  // The draggable line; it follows the slider and the other figures.
  const addHandle = u => {
    const handle = el("div", { className: "handle" },
      el("span", { className: "before", textContent: "before" }), el("span", { className: "after", textContent: "after" }));
    const drag = event => {
      const box = u.over.getBoundingClientRect();
      moveTo((event.clientX - box.left) / box.width);
    };
    handle.addEventListener("mousedown", event => event.stopPropagation());
    handle.addEventListener("pointerdown", event => {
      event.preventDefault();
      handle.setPointerCapture(event.pointerId);
      handle.addEventListener("pointermove", drag);
    });
    handle.addEventListener("pointerup", () => handle.removeEventListener("pointermove", drag));
    u.over.append(handle);
    const follow = () => {
      handle.style.left = `${position * 100}%`;
      u.redraw(false);
    };
    followers.add(follow);
    handle.style.left = `${position * 100}%`;
  };

  // Band of the noise, behind the curves.
  const noiseBand = half => u => {
    const { ctx, bbox } = u;
    const top = Math.max(bbox.top, u.valToPos(half, "y", true));
    const bottom = Math.min(bbox.top + bbox.height, u.valToPos(-half, "y", true));
    ctx.fillStyle = COLOR.noise;
    ctx.fillRect(bbox.left, top, bbox.width, bottom - top);
  };

  const quantityAxis = (label, extra = {}) =>
    axisStyle(label, { values: (u, splits) => splits.map(value => quantities.tick(value, splits)), ...extra });
  const keyOf = (curves, noise) => [...curves.map(c => ({ label: c.label, color: c.color })),
    ...(noise ? [{ label: "noise alone, ±2σ", color: "#c3ccd4" }] : [])];

  // Curves are {label, color, width, side, y}; loops have an x that goes back and forth.
  const loops = (container, caption, xLabel, yLabel, x, curves, parted) => {
    const box = figure(container, caption, keyOf(curves));
    const rangeX = padded(...extent([x])), rangeY = padded(...extent(curves.map(c => c.y)));
    const plot = new uPlot({
      mode: 2, width: 400, height: 320, legend: { show: false }, cursor: { show: false },
      scales: { x: { time: false, range: () => rangeX }, y: { range: () => rangeY } },
      axes: [quantityAxis(xLabel), quantityAxis(yLabel, { size: 54 })],
      series: [null, ...curves.map(c => ({ paths: (u, i) => cutCurve(u, ...u.data[i], c),
        facets: [{ scale: "x", auto: false }, { scale: "y", auto: false }] }))],
      hooks: { draw: [watermarkBelow] },
    }, [null, ...curves.map(c => [x, c.y])], box);
    if (parted) addHandle(plot);
    fit(box, plot, () => kHeight);
  };

  const histories = (container, caption, yLabel, time, curves, parted, options = {}) => {
    const box = figure(container, caption, keyOf(curves, options.noise));
    const plot = new uPlot({
      width: 400, height: 240, legend: { show: false },
      cursor: { y: false, points: { show: false }, sync: { key: "proof", setSeries: false } },
      scales: { x: { time: false }, y: options.range ? { range: () => options.range } : {} },
      axes: [quantityAxis("time [s]"), quantityAxis(yLabel, { size: 54 })],
      series: [{}, ...curves.map(c => ({ points: { show: false },
        paths: (u, i) => cutCurve(u, u.data[0], u.data[i], c) }))],
      hooks: { drawAxes: options.noise ? [noiseBand(options.noise)] : [], draw: [watermark] },
    }, [time, ...curves.map(c => c.y)], box);
    if (parted) addHandle(plot);
    fit(box, plot, () => options.height || kHeight);
  };

  // Called before other figures replace these.
  const clear = () => followers.clear();

  // The slider with the errors of both sides.
  const slider = container => {
    const input = el("input", { type: "range", min: 0, max: 1000, ariaLabel: "before and after" });
    const [before, after, hint] = [el("b"), el("b"), el("div", { className: "hint" })];
    input.addEventListener("input", () => moveTo(input.value / 1000));
    container.append(el("div", { className: "slider" }, el("div", { className: "side before" }, "before", before), input,
      el("div", { className: "side after" }, "after", after), hint));
    const follow = () => {
      input.value = position * 1000;
      input.style.setProperty("--at", `${position * 100}%`);
    };
    sliders.push(follow);
    follow();
    return (errors, text) => {
      [before.textContent, after.textContent] = errors;
      hint.textContent = text;
    };
  };

  return { COLOR, quantityAxis, loops, histories, slider, clear };
})();
