
// Curves that answer questions: values under the cursor, a legend that switches curves, zoom.
const figures = (() => {
  const { el, figure, swatch, marks } = plots;
  const WIDTH = 1.4, NEAR = 6;  // of a curve, and of the cursor to a mark [px]
  // Pictures over time that zoom together and share their cursor, and the marks on them.
  const group = key => ({ key, plots: [], marks: [], cursors: [], tellers: [] });
  const time = group("time");

  const number = value => {
    if (value == null || !Number.isFinite(value)) return "–";
    const size = Math.abs(value);
    return size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(2) : value.toFixed(size >= 100 ? 1 : size >= 1 ? 2 : 4);
  };
  const unitOf = label => /\[(.*)\]/.exec(label)?.[1].replace(/^[–-]$/, "") ?? "";
  const quantity = (value, label) => `${number(value)} ${unitOf(label)}`.trim();
  const nameOf = label => label.replace(/\s*\[.*\]/, "");

  // --- drawing -----------------------------------------------------------------------------------
  const stamp = (u, y) => {
    if (!marks.synthetic) return;
    const { ctx, bbox } = u;
    ctx.save();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.fillStyle = theme.color("soft");
    ctx.textAlign = "right";
    ctx.fillText("synthetic", bbox.left + bbox.width - 6 * devicePixelRatio, y);
    ctx.restore();
  };
  const watermark = u => stamp(u, u.bbox.top + 14 * devicePixelRatio);
  const watermarkBelow = u => stamp(u, u.bbox.top + u.bbox.height - 8 * devicePixelRatio);

  const axisStyle = (label, extra = {}) => ({
    label, labelSize: 18, labelGap: 0, size: 32, labelFont: "12px system-ui", font: "11px system-ui",
    stroke: () => theme.color("soft"), grid: { stroke: () => theme.color("grid"), width: 1 },
    ticks: { stroke: () => theme.color("tick"), width: 1, size: 5 },
    values: (u, splits) => splits.map(v => (v == null ? "" : quantities.tick(v, splits))), ...extra,
  });
  // On a logarithmic axis: 1, 2 and 5 of each decade carry a number.
  const logTicks = {
    filter: (u, splits) => splits.map(v => ("125".includes(v.toExponential()[0]) && v.toExponential().length < 6 ? v : null)),
    values: (u, splits) => splits.map(v => (v == null ? "" : String(+v.toPrecision(2)))),
  };
  const padded = (low, high) => {
    const margin = 0.06 * (high - low || 1);
    return [low - margin, high + margin];
  };
  const extent = arrays => {
    let low = Infinity, high = -Infinity;
    for (const values of arrays)
      for (const v of values) { if (v == null || Number.isNaN(v)) continue; if (v < low) low = v; if (v > high) high = v; }
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
    ctx.lineWidth = (style.width || WIDTH) * devicePixelRatio;
    ctx.strokeStyle = theme.color(style.color);
    ctx.setLineDash((style.dash || []).map(part => part * devicePixelRatio));
    ctx.lineJoin = "round";
    ctx.stroke();
    ctx.restore();
    return null;
  };

  // Redraws at the width of the page; `height` computes the height from the width.
  const fit = (box, plot, height) => {
    let drawn = 0;
    const draw = () => {
      const width = Math.floor(box.clientWidth);
      if (width > 0 && width !== drawn) plot.setSize({ width: drawn = width, height: height(width) });
    };
    draw();
    new ResizeObserver(() => requestAnimationFrame(draw)).observe(box);
    theme.onChange(resized => { if (resized) draw(); plot.redraw(false, true); });  // with the ticks of this width
  };

  // --- legend, readout, zoom ---------------------------------------------------------------------
  const legend = (box, plot, curves) => {
    const key = box.querySelector(".key");
    curves.forEach((curve, i) => {
      if (!curve.label) return;
      const button = el("button", { type: "button", className: "curve", title: "show or hide this curve" }, swatch(curve), curve.label);
      button.setAttribute("aria-pressed", "true");
      button.addEventListener("click", () => {
        const show = button.getAttribute("aria-pressed") !== "true";
        button.setAttribute("aria-pressed", String(show));
        plot.setSeries(i + 1, { show });
      });
      key.append(button);
    });
  };

  // Rows of name and value beside the cursor.
  const readout = u => {
    const tip = el("div", { className: "tip", hidden: true });
    u.over.append(tip);
    return (left, top, head, rows) => {
      tip.hidden = !rows;
      if (!rows) return;
      tip.replaceChildren(el("b", { textContent: head }), ...rows.map(([curve, text]) =>
        el("div", {}, ...(curve ? [swatch(curve), curve.label, " "] : []), el("span", { textContent: text }))));
      const { clientWidth: width, clientHeight: height } = u.over;
      tip.style.left = left > width / 2 ? "" : `${left + 14}px`;
      tip.style.right = left > width / 2 ? `${width - left + 14}px` : "";
      tip.style.top = `${Math.max(0, Math.min(top - 10, height - tip.offsetHeight))}px`;
    };
  };

  // A button that undoes the zoom; so do a double click and the escape key.
  const zoomOut = (box, plot, reset) => {
    const button = el("button", { type: "button", className: "reset", textContent: "zoom out", hidden: true });
    button.addEventListener("click", reset);
    box.querySelector("figcaption").append(button);
    plot.root.tabIndex = 0;
    plot.root.addEventListener("keydown", event => { if (event.key === "Escape") reset(); });
    return isZoomed => { button.hidden = !isZoomed; };
  };

  const summary = (caption, curves, xLabel, yLabel) => {
    const range = (values, label) => {
      const [low, high] = extent([values]);
      return low > high ? "no values" : `${quantity(low, label)} to ${quantity(high, label)}`;
    };
    const listed = curves.filter(c => c.label);
    return `${caption} over ${nameOf(xLabel)} from ${range(listed[0]?.x ?? curves[0].x, xLabel)}: ` +
      `${listed.map(c => `${c.label} ${range(c.y, yLabel)}`).join("; ")}.`;
  };
  const describe = (box, plot, text) => {
    box.setAttribute("aria-label", text);
    plot.root.setAttribute("role", "img");
    plot.root.setAttribute("aria-label", text);
  };

  // --- loops and orbits --------------------------------------------------------------------------
  // The point of a visible curve nearest to the cursor, in pixels.
  const nearest = (u, curves, left, top) => {
    let best = null, least = 40 ** 2;
    curves.forEach((curve, c) => {
      if (!curve.label || !u.series[c + 1].show) return;
      for (let i = 0; i < curve.x.length; i++) {
        const x = u.valToPos(curve.x[i], "x"), y = u.valToPos(curve.y[i], "y");
        const distance = (x - left) ** 2 + (y - top) ** 2;
        if (distance < least) { least = distance; best = { curve, i, x, y }; }
      }
    });
    return best;
  };
  // Curves {label, color, dash, width, x, y} whose x goes back and forth.
  const loops = (container, caption, xLabel, yLabel, curves, options = {}) => {
    const box = figure(container, caption, []);
    let home = { x: padded(...extent(curves.map(c => c.x))), y: padded(...extent(curves.map(c => c.y))) };
    if (options.equal) {
      const half = Math.max(home.x[1] - home.x[0], home.y[1] - home.y[0]) / 2;
      const around = r => { const m = (r[0] + r[1]) / 2; return [m - half, m + half]; };
      home = { x: around(home.x), y: around(home.y) };
    }
    let view = home;
    const facets = [{ scale: "x", auto: false }, { scale: "y", auto: false }];
    const show = next => {
      view = next;
      plot.batch(() => { for (const key of ["x", "y"]) plot.setScale(key, { min: view[key][0], max: view[key][1] }); });
      zoomed(view !== home);
      point(null);
    };
    const select = u => {
      const { left, top, width, height } = u.select;
      if (width > 4 && height > 4)
        show({ x: [u.posToVal(left, "x"), u.posToVal(left + width, "x")], y: [u.posToVal(top + height, "y"), u.posToVal(top, "y")] });
      u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    };
    const paint = curve => options.paint?.(curve) || (u => strokeCurve(u, curve.x, curve.y, curve));
    const plot = new uPlot({
      mode: 2, width: 400, height: 320, legend: { show: false },
      cursor: { x: false, y: false, points: { show: false }, drag: { x: true, y: true, setScale: false },
        bind: { dblclick: () => () => { show(home); return null; } } },
      scales: { x: { time: false, range: () => view.x }, y: { range: () => view.y } },
      axes: [axisStyle(xLabel, options.axis), axisStyle(yLabel, { size: 54, ...options.axis })],
      series: [null, ...curves.map(c => ({ paths: paint(c), facets }))],
      hooks: { draw: [options.below ? watermarkBelow : watermark], setSelect: [select] },
    }, [null, ...curves.map(c => [c.x, c.y])], box);
    const zoomed = zoomOut(box, plot, () => show(home));
    const tell = readout(plot), dot = el("div", { className: "dot", hidden: true });
    plot.over.append(dot);
    const point = found => {
      dot.hidden = !found;
      if (!found) return tell(0, 0, "", null);
      dot.style.left = `${found.x}px`;
      dot.style.top = `${found.y}px`;
      const { curve, i } = found;
      const when = curve.time ? [[null, `at ${number(curve.time[i])} s`]] : [];
      return tell(found.x, found.y, curve.label,
        [[null, `${nameOf(xLabel)} ${quantity(curve.x[i], xLabel)}`], [null, `${nameOf(yLabel)} ${quantity(curve.y[i], yLabel)}`], ...when]);
    };
    plot.over.addEventListener("mousemove", event => {
      const area = plot.over.getBoundingClientRect();
      point(nearest(plot, curves, event.clientX - area.left, event.clientY - area.top));
    });
    plot.over.addEventListener("mouseleave", () => point(null));
    legend(box, plot, curves);
    describe(box, plot, summary(caption, curves, xLabel, yLabel));
    save.curves(box, () => ({ caption, xLabel, yLabel, view, curves: curves.filter((c, i) => c.label && plot.series[i + 1].show) }));
    fit(box, plot, options.height ? () => options.height : width => Math.round(Math.min(width * 0.78, 430)));
    return plot;
  };

  // --- curves over time or frequency -------------------------------------------------------------
  const drawMarks = marked => u => {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.strokeStyle = theme.color("accent");
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
    for (const mark of marked) {
      const x = u.valToPos(mark.time, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    }
    ctx.restore();
  };
  // All pictures of a group show the same interval.
  const follow = (u, others) => {
    const { min, max } = u.scales.x;
    for (const other of others)
      if (other.scales.x.min !== min || other.scales.x.max !== max) other.setScale("x", { min, max });
  };
  const endsOf = u => [u.data[0][0], u.data[0][u.data[0].length - 1]];
  // Two cursors that stay where a click sets them; a third click removes both.
  const drawCursors = over => u => {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.strokeStyle = theme.color("ink");
    ctx.lineWidth = devicePixelRatio;
    over.cursors.forEach((at, i) => {
      const x = u.valToPos(at, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width) return;
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      ctx.font = `600 ${11 * devicePixelRatio}px system-ui, sans-serif`;
      ctx.fillStyle = theme.color("ink");
      ctx.fillText("AB"[i], x + 3 * devicePixelRatio, bbox.top + 11 * devicePixelRatio);
    });
    ctx.restore();
  };
  // Values at both cursors and their differences, below the figure.
  const cursorTeller = (box, plot, over, x, curves, xLabel, yLabel) => {
    const told = el("p", { className: "cursors", hidden: true });
    box.append(told);
    over.tellers.push(() => {
      told.hidden = !over.cursors.length;
      const [a, b] = over.cursors.map(at => plot.valToIdx(at));
      const parts = b === undefined ? [`A: ${nameOf(xLabel)} ${quantity(x[a], xLabel)}`]
        : [`B − A: ${nameOf(xLabel)} ${quantity(x[b] - x[a], xLabel)}`];
      curves.forEach((c, i) => {
        if (!c.label || !plot.series[i + 1].show) return;
        const y = c.shown || c.y;
        parts.push(`${c.label} ${quantity(b === undefined ? y[a] : y[b] == null || y[a] == null ? null : y[b] - y[a], yLabel)}`);
      });
      told.textContent = over.cursors.length ? parts.join(" · ") : "";
      plot.redraw(false);
    });
    const set = cursors => {
      over.cursors = cursors;
      for (const tell of over.tellers) tell();
    };
    let pressed = 0;
    plot.over.addEventListener("mousedown", event => { pressed = event.clientX; });
    plot.over.addEventListener("click", event => {
      if (Math.abs(event.clientX - pressed) > 3) return;  // a zoom
      const at = x[plot.posToIdx(event.clientX - plot.over.getBoundingClientRect().left)];
      set(over.cursors.length < 2 ? [...over.cursors, at].sort((a, b) => a - b) : []);
    });
    plot.over.addEventListener("dblclick", () => set([]));
    plot.root.addEventListener("keydown", event => { if (event.key === "Escape") set([]); });
  };
  // Curves {label, color, dash, width, fill, y} over one x.
  const lines = (container, caption, x, xLabel, yLabel, curves, options = {}) => {
    const box = figure(container, caption, []);
    const over = options.logX ? group("") : options.group || time;
    let tell = () => {}, zoomed = () => {};
    const reset = () => {
      const ends = over.plots.map(endsOf);
      plot.setScale("x", { min: Math.min(...ends.map(e => e[0])), max: Math.max(...ends.map(e => e[1])) });
    };
    const onScale = (u, key) => {
      if (key !== "x") return;
      const [first, last] = endsOf(u);
      const least = (last - first) / 1000;  // pictures of a group may end a few samples apart
      zoomed(u.scales.x.min - first > least || last - u.scales.x.max > least);
      if (over.plots.includes(u)) follow(u, over.plots);
    };
    const showValues = u => {
      const { left, top, idx } = u.cursor;
      if (idx == null || left < 0) return tell(0, 0, "", null);
      const rows = curves.map((c, i) => [c, quantity((c.shown || c.y)[idx], yLabel), i]).filter(([c, , i]) => c.label && u.series[i + 1].show);
      const near = over.marks.filter(mark => Math.abs(u.valToPos(mark.time, "x") - left) < NEAR);
      return tell(left, top < 0 ? 10 : top, `${nameOf(xLabel)} ${quantity(x[idx], xLabel)}`, [...rows, ...near.map(mark => [null, mark.text])]);
    };
    const plot = new uPlot({
      width: 400, height: 240, legend: { show: false },
      cursor: { y: false, points: { size: 6, fill: (u, i) => theme.color(curves[i - 1].color) },
        ...(over.key ? { sync: { key: over.key, setSeries: false } } : {}), bind: { dblclick: () => () => { reset(); return null; } } },
      scales: {
        x: { time: false, distr: options.logX ? 3 : 1 },
        y: { distr: options.logY ? 3 : 1, range: options.range ? () => options.range : undefined },
      },
      axes: [axisStyle(xLabel, options.logX ? logTicks : options.axis || {}),
             axisStyle(yLabel, { size: options.logY ? 46 : 54, ...(options.logY ? logTicks : options.axis || {}) })],
      series: [{}, ...curves.map(c => ({
        stroke: () => theme.color(c.color), width: c.width || WIDTH, dash: c.dash, points: { show: false }, spanGaps: false,
        fill: c.fill ? () => theme.color(c.fill) : undefined, ...(options.paint ? { paths: options.paint(c) } : {}),
      }))],
      hooks: { drawAxes: options.behind ? [options.behind] : [], setScale: [onScale],
        draw: [drawMarks(over.marks), drawCursors(over), ...(options.measured ? [] : [watermark])], setCursor: [showValues] },
    }, [x, ...curves.map(c => c.y)], box);
    tell = readout(plot);
    zoomed = zoomOut(box, plot, reset);
    over.plots.push(plot);
    cursorTeller(box, plot, over, x, curves, xLabel, yLabel);
    legend(box, plot, curves);
    describe(box, plot, summary(caption, curves.map(c => ({ ...c, x, y: c.shown || c.y })), xLabel, yLabel));
    const viewOf = ({ min, max }) => [min, max];
    save.curves(box, () => ({ caption, xLabel, yLabel, logX: options.logX, logY: options.logY,
      view: { x: viewOf(plot.scales.x), y: viewOf(plot.scales.y) },
      curves: curves.map(c => ({ ...c, x })).filter((c, i) => c.label && plot.series[i + 1].show) }));
    fit(box, plot, width => Math.round(options.height || Math.min(Math.max(width * 0.62, 220), 280)));
    plot.over.addEventListener("mouseleave", () => tell(0, 0, "", null));
    return plot;
  };

  return { time, group, axisStyle, padded, extent, strokeCurve, loops, lines };
})();
