// The connection to the server, and what it has sent: the words of the ring, their newest values, and the history of
// the words that are watched.
const live = (() => {
  const LIVE = 1, RANGE = 2, VALUES = 3;  // kinds of frames
  const HEADER_BYTES = 32, CAPACITY = 8192, FEWEST_INTERVALS = 1250;
  const SHORTEST = 50, LONGEST = 1800000;  // shown [ms]
  const query = new URLSearchParams(location.search);
  let token = query.get("token") || sessionStorage.getItem("rths-token") || "";
  if (query.has("token")) {
    sessionStorage.setItem("rths-token", token);
    history.replaceState(null, "", location.pathname + location.hash);
  }

  const listeners = {};
  const on = (what, act) => (listeners[what] ||= []).push(act);
  const tell = (what, value) => { for (const act of listeners[what] || []) act(value); };

  const state = { map: null, status: null, values: null, ages: null, now: 0, connected: false, trouble: "" };
  const positions = new Map();  // of words, by name
  let socket = null, request = 0, asked = 0, latest = 0;
  const replies = new Map();

  const send = message => { if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message)); };

  // --- the watched words --------------------------------------------------------------------------
  // Time in ms since the server's look began; `to` is null while the page follows.
  const view = { span: 20000, to: null };
  let watched = [], pixels = FEWEST_INTERVALS;
  // Intervals: twice the time, and beside it the lowest and the highest value of each word. A line through them has both.
  const buffer = { x: new Float64Array(2 * CAPACITY), begin: 0, end: 0, next: null, words: new Map() };
  const clear = () => {
    buffer.begin = buffer.end = 0;
    buffer.next = null;
    buffer.words = new Map(watched.map(w => [w, new Float32Array(2 * CAPACITY)]));
  };
  const widthBits = () => Math.min(14, Math.max(0, Math.ceil(Math.log2(view.span / pixels))));
  const ask = () => {
    if (!state.map) return;
    clear();
    latest = asked = ++request;
    const bits = widthBits(), from = Math.floor(((view.to ?? state.now) - view.span) / 2 ** bits) * 2 ** bits;
    if (view.to === null) return send({ watch: watched, width_bits: bits, from, id: asked });
    send({ watch: [], id: 0 });
    return send({ range: watched, width_bits: bits, from, intervals: Math.ceil(view.span / 2 ** bits) + 2, id: asked });
  };
  const append = (header, body) => {
    const { from, width, intervals, words } = header;
    if (buffer.next !== null && buffer.next !== from) { buffer.begin = buffer.end = 0; }
    const count = Math.min(intervals, CAPACITY);
    if (buffer.end + count > CAPACITY) {
      const keep = Math.min(buffer.end - buffer.begin, CAPACITY - count), at = buffer.end - keep;
      for (const values of [buffer.x, ...buffer.words.values()]) values.copyWithin(0, 2 * at, 2 * buffer.end);
      buffer.begin = 0;
      buffer.end = keep;
    }
    const skip = intervals - count;
    const names = new Uint32Array(body, HEADER_BYTES, words);
    const extents = new Float32Array(body, HEADER_BYTES + 4 * words);
    for (let i = 0; i < 2 * count; i++) buffer.x[2 * buffer.end + i] = (from + (skip + (i >> 1)) * width) / 1000;
    names.forEach((w, n) => buffer.words.get(w)?.set(extents.subarray(2 * (n * intervals + skip), 2 * (n + 1) * intervals), 2 * buffer.end));
    buffer.end += count;
    buffer.next = from + intervals * width;
    const first = (buffer.next - view.span) / 1000 - width / 1000;
    if (view.to === null) while (buffer.begin < buffer.end && buffer.x[2 * buffer.begin] < first) buffer.begin++;
  };

  // Of the time that is shown: the lowest and the highest value of each interval, and its time twice.
  const shownOf = values => values?.subarray(2 * buffer.begin, 2 * buffer.end);
  const data = word => shownOf(buffer.words.get(word));
  const times = () => shownOf(buffer.x);
  const shown = () => {
    const to = view.to ?? (buffer.next ?? state.now);
    return [(to - view.span) / 1000, to / 1000];
  };

  // Many messages of a burst are drawn once.
  let isDrawing = false;
  const draw = () => {
    if (isDrawing) return;
    isDrawing = true;
    requestAnimationFrame(() => { isDrawing = false; tell("draw"); });
  };

  const watch = words => {
    const wanted = [...new Set(words)].filter(w => w != null);
    if (wanted.length === watched.length && wanted.every((w, i) => w === watched[i])) return;
    watched = wanted;
    ask();
  };
  const newest = () => Math.max(state.now, view.to === null ? buffer.next ?? 0 : 0);
  const show = (span, to) => {
    view.span = Math.min(LONGEST, Math.max(SHORTEST, span));
    view.to = to === null || to >= newest() ? null : Math.max(Math.min(view.span, newest()), to);
    ask();
    tell("view");
    draw();
  };
  const pause = () => show(view.span, view.to === null ? Math.max(1, newest() - 1) : null);
  const scroll = share => show(view.span, (view.to ?? state.now) + share * view.span);
  const zoom = factor => {
    const to = view.to === null ? null : view.to + (factor - 1) * view.span / 2;
    show(view.span * factor, to);
  };
  const setWidth = width => {
    const before = widthBits();
    pixels = Math.max(FEWEST_INTERVALS, width);
    if (widthBits() !== before) ask();
  };

  // --- messages -----------------------------------------------------------------------------------
  const receiveText = message => {
    if (message.kind === "map") {
      state.map = message;
      state.values = state.ages = null;
      state.now = 0;
      view.to = null;
      positions.clear();
      message.words.forEach((word, i) => positions.set(word.name, i));
      clear();
      tell("map", message);
      ask();
      tell("view");
    } else if (message.kind === "status") {
      state.status = message;
      tell("status", message);
    } else if (message.kind === "set") {
      replies.get(message.id)?.(message.error);
      replies.delete(message.id);
    }
  };
  const receiveFrame = body => {
    const u = new Uint32Array(body, 0, 8), from = new Float64Array(body, 8, 1)[0];
    const header = { kind: u[0], epoch: u[1], from, width: u[4], intervals: u[5], words: u[6], id: u[7] };
    if (header.epoch !== state.map?.epoch) return;
    if (header.kind === VALUES) {
      state.values = new Float32Array(body, HEADER_BYTES, header.words);
      state.ages = new Float32Array(body, HEADER_BYTES + 4 * header.words, header.words);
      state.now = from;
      tell("values");
      return;
    }
    if (header.id !== latest || (header.kind !== LIVE && header.kind !== RANGE)) return;
    append(header, body);
    if (header.intervals > 0 || header.kind === RANGE) draw();
  };
  const connect = () => {
    socket = new WebSocket(`ws://${location.host}/ws${token ? `?token=${encodeURIComponent(token)}` : ""}`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => { state.connected = true; tell("connection"); };
    socket.onmessage = event => (typeof event.data === "string" ? receiveText(JSON.parse(event.data)) : receiveFrame(event.data));
    socket.onclose = () => {
      state.connected = false;
      tell("connection");
      setTimeout(connect, 1000);
    };
  };
  setInterval(() => send({ alive: 1 }), 2000);

  // Changes a parameter; resolves to the reason why not, or "".
  const set = (name, value, given) => new Promise(resolve => {
    if (socket?.readyState !== WebSocket.OPEN) return resolve("there is no connection");
    const id = ++request;
    replies.set(id, resolve);
    if (given) { token = given; sessionStorage.setItem("rths-token", given); }
    send({ set: `${name}=${value}`, token: given ?? token, id });
  });

  const find = name => positions.get(name);
  const value = name => {
    const i = positions.get(name);
    return i === undefined || !state.values ? null : state.values[i];
  };

  return { state, view, on, connect, watch, data, times, shown, show, pause, scroll, zoom, setWidth, set, find, value, draw,
    hasToken: () => token !== "" };
})();

// Figures that follow the time that is shown. They zoom together and share their cursor.
const moving = (() => {
  const { el } = plots;
  const MARGIN = 0.06, COLORS = ["c0", "c1", "c2", "c3", "c4", "c5"];
  const colorOf = i => COLORS[i % COLORS.length];
  const shownFigures = new Set();
  live.on("draw", () => { for (const figure of shownFigures) figure.follow(); });

  const extentOf = arrays => {
    let low = Infinity, high = -Infinity;
    for (const values of arrays)
      for (const v of values) { if (v < low) low = v; if (v > high) high = v; }
    return low > high ? null : [low, high];
  };
  // Without values, as while an answer is awaited, the scale stays.
  const padded = (extent, before) => {
    if (!extent) return before;
    const [low, high] = extent, margin = MARGIN * (high - low) || Math.abs(high) * MARGIN || 1;
    return [low - margin, high + margin];
  };
  // The unit stays while the values shrink, so that it does not flicker.
  const scaleFor = (label, before, size) => {
    const now = quantities.axis(label, size);
    return before && size * before.factor >= 0.5 && size * before.factor < 5000 ? before : now;
  };
  // A figure follows the time while it can be seen, at most once for each pixel that the time moves.
  const place = (box, plot, height, draw, words) => {
    let width = 0, isSeen = false, drawn = {};
    const resize = () => {
      const now = Math.floor(box.clientWidth);
      if (now <= 0 || now === width) return;
      plot.setSize({ width: width = now, height: height(width) });
      drawn = {};
      live.draw();
    };
    const follow = () => {
      if (!isSeen) return;
      const [from, to] = live.shown(), span = to - from, moved = (to - drawn.to) / span * width;
      if (live.view.to === null && span === drawn.span && moved >= 0 && moved < 1) return;
      drawn = { to, span };
      draw();
    };
    box.setAttribute("aria-label", box.querySelector("figcaption").firstChild.textContent);
    resize();
    new ResizeObserver(() => requestAnimationFrame(resize)).observe(box);
    new IntersectionObserver(entries => {
      isSeen = entries[entries.length - 1].isIntersecting;
      drawn = {};
      follow();
    }).observe(box);
    theme.onChange(draw);
    const figure = { box, plot, follow, draw, words };
    shownFigures.add(figure);
    return figure;
  };
  const legend = (box, curves, toggle) => curves.map((curve, i) => {
    const shown = el("b");
    const button = el("button", { type: "button", className: "curve", title: "show or hide this curve" },
      plots.swatch(curve), curve.label, shown);
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      const show = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(show));
      toggle(i, show);
    });
    box.querySelector(".key").append(button);
    return shown;
  });
  const tickValues = scale => (u, splits) => splits.map(v => quantities.tick(v * scale().factor, splits.map(s => s * scale().factor)));

  // Curves {label, color, dash, word} of one unit over time. `options.of` computes others from the words' arrays.
  const lines = (container, caption, unit, curves, options = {}) => {
    const box = plots.figure(container, caption, []);
    const label = `${options.quantity || "value"} [${unit === "1" ? "-" : unit}]`;
    let scale = null, range = [0, 1];
    const styled = curves.map((c, i) => ({ color: colorOf(i), ...c }));
    // Without a graphics processor, a line of one pixel takes a tenth of the time of a wider one.
    const stroke = c => ({ stroke: () => theme.color(c.color), width: 1, dash: c.dash, points: { show: false }, spanGaps: false });
    const arrays = () => [live.times(), ...styled.map(c => (c.of ? c.of() : live.data(c.word)) || new Float32Array(live.times().length))];
    const select = u => {
      const { left, width } = u.select;
      if (width > 4) {
        const from = u.posToVal(left, "x") * 1000, to = u.posToVal(left + width, "x") * 1000;
        live.show(to - from, to);
      }
      u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    };
    const tellValues = u => {
      const i = u.cursor.idx;
      styled.forEach((c, n) => {
        const at = (i ?? u.data[0].length - 1) & ~1, low = u.data[n + 1]?.[at], high = u.data[n + 1]?.[at + 1];
        const text = high === undefined || Number.isNaN(high) ? "–" : quantities.number((low + high) / 2 * (scale?.factor ?? 1), 4);
        if (values[n].textContent !== text) values[n].textContent = text;
      });
    };
    const plot = new uPlot({
      width: 400, height: options.height || 220, legend: { show: false },
      cursor: { y: false, points: { show: false }, sync: { key: "time", setSeries: false }, drag: { x: true, y: false, setScale: false },
        bind: { dblclick: () => () => { live.show(20000, null); return null; } } },
      scales: { x: { time: false, range: () => live.shown() }, y: { range: () => range } },
      axes: [figures.axisStyle("time [s]"), figures.axisStyle(label, { size: 54, values: tickValues(() => scale ?? { factor: 1 }) })],
      series: [{}, ...styled.map(stroke)],
      hooks: { setSelect: [select], setCursor: [u => tellValues(u)] },
    }, arrays(), box);
    const values = legend(box, styled, (n, show) => plot.setSeries(n + 1, { show }));
    plot.root.tabIndex = 0;
    plot.root.setAttribute("role", "img");
    plot.root.addEventListener("keydown", event => { if (event.key === "Escape") live.show(20000, null); });
    const unitText = el("span", { className: "unit" });
    box.querySelector("figcaption").append(unitText);
    const draw = () => {
      const now = arrays();
      const extent = extentOf(now.slice(1).filter((_, i) => plot.series[i + 1].show));
      range = padded(extent, range);
      if (extent || !scale) scale = scaleFor(label, scale, Math.max(Math.abs(range[0]), Math.abs(range[1])));
      if (plot.axes[1].label !== scale.label) plot.axes[1].label = scale.label;
      if (unitText.textContent !== scale.unit) unitText.textContent = scale.unit;
      plot.setData(now);
      tellValues(plot);
      box.setAttribute("aria-label", `${caption}: ${styled.map((c, n) => `${c.label} ${values[n].textContent} ${scale.unit}`).join(", ")}.`);
    };
    return place(box, plot, () => options.height || 220, draw, styled.flatMap(c => c.words || [c.word]));
  };

  // Two words against each other: the means of their intervals.
  const loop = (container, caption, x, y, equal = false) => {
    const box = plots.figure(container, caption, []);
    const means = word => { const d = live.data(word); return Float32Array.from({ length: d ? d.length / 2 : 0 }, (_, i) => (d[2 * i] + d[2 * i + 1]) / 2); };
    let xs = [], ys = [], view = { x: [-1, 1], y: [-1, 1] };
    const scales = { x: null, y: null };
    const facets = [{ scale: "x", auto: false }, { scale: "y", auto: false }];
    const plot = new uPlot({
      mode: 2, width: 400, height: 300, legend: { show: false },
      cursor: { show: false },
      scales: { x: { time: false, range: () => view.x }, y: { range: () => view.y } },
      axes: [figures.axisStyle(x.label, { values: tickValues(() => scales.x ?? { factor: 1 }) }),
             figures.axisStyle(y.label, { size: 54, values: tickValues(() => scales.y ?? { factor: 1 }) })],
      series: [null, { paths: u => figures.strokeCurve(u, xs, ys, { color: "c0" }), facets }],
    }, [null, [[0], [0]]], box);
    plot.root.setAttribute("role", "img");
    const draw = () => {
      xs = means(x.word);
      ys = means(y.word);
      const extents = [extentOf([xs]), extentOf([ys])];
      if (!extents[0] || !extents[1]) return;
      view = { x: padded(extents[0]), y: padded(extents[1]) };
      if (equal) {
        const sides = { x: plot.bbox.width, y: plot.bbox.height };
        const perPixel = Math.max(...["x", "y"].map(key => (view[key][1] - view[key][0]) / sides[key]));
        for (const key of ["x", "y"]) {
          const middle = (view[key][0] + view[key][1]) / 2, half = perPixel * sides[key] / 2;
          view[key] = [middle - half, middle + half];
        }
      }
      for (const [key, given, i] of [["x", x, 0], ["y", y, 1]]) {
        scales[key] = scaleFor(given.label, scales[key], Math.max(...view[key].map(Math.abs)));
        plot.axes[i].label = scales[key].label;
      }
      plot.batch(() => { for (const key of ["x", "y"]) plot.setScale(key, { min: view[key][0], max: view[key][1] }); });
      plot.redraw(false);
      const size = (key, label) => `${quantities.brief(view[key][0] * scales[key].factor)} to ${quantities.brief(view[key][1] * scales[key].factor)} ${scales[key].unit}${label}`;
      box.setAttribute("aria-label", `${caption}: ${size("x", "")}, ${size("y", "")}.`);
    };
    return place(box, plot, width => Math.round(Math.min(width * 0.8, 340)), draw, [x.word, y.word]);
  };

  const remove = figure => {
    shownFigures.delete(figure);
    theme.forget(figure.draw);
    figure.plot.destroy();
    figure.box.remove();
  };
  const visibleWords = () => [...shownFigures].filter(f => f.box.offsetParent !== null).flatMap(f => f.words);
  const widest = () => Math.max(0, ...[...shownFigures].filter(f => f.box.offsetParent !== null).map(f => f.box.clientWidth - 60));
  const watchVisible = () => {
    if (widest() > 0) live.setWidth(widest());
    live.watch(visibleWords());
  };

  return { lines, loop, remove, watchVisible, all: shownFigures };
})();
