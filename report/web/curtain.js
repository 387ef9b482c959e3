
// A line divides every figure: before on its left, after on its right. One slider moves all lines.
const curtain = (() => {
  const { el } = plots;
  const followers = new Set();  // figures
  const sliders = [];
  const kHeight = 400;
  const group = figures.group("proof");
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
    return figures.strokeCurve(u, xs, ys, style, left, width);
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
    ctx.fillStyle = theme.color("noise");
    ctx.fillRect(bbox.left, top, bbox.width, bottom - top);
  };

  const paint = curve => (u, i) => (u.mode === 2 ? cutCurve(u, ...u.data[i], curve) : cutCurve(u, u.data[0], u.data[i], curve));

  // Curves are {label, color, width, side, y}; loops have an x that goes back and forth.
  const loops = (container, caption, xLabel, yLabel, x, time, curves, parted) => {
    const plot = figures.loops(container, caption, xLabel, yLabel, curves.map(c => ({ ...c, x, time })),
      { paint, below: true, height: kHeight });
    if (parted) addHandle(plot);
  };
  const histories = (container, caption, yLabel, time, curves, parted, options = {}) => {
    const plot = figures.lines(container, caption, time, options.timeLabel || "time [s]", yLabel, curves,
      { paint, group, height: kHeight, behind: options.noise ? noiseBand(options.noise) : undefined, ...options });
    if (options.noise)
      plot.root.parentNode.querySelector(".key").append(el("span", {}, plots.swatch({ color: "noise-line", fill: "noise" }), "noise alone, ±2σ"));
    if (parted) addHandle(plot);
  };

  // Called before other figures replace these.
  const clear = () => {
    followers.clear();
    for (const list of [group.plots, group.cursors, group.tellers]) list.length = 0;
  };

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

  return { loops, histories, slider, clear };
})();
