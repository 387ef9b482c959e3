
// Figures in SVG, redrawn at the width of the page: histograms, maps, curves with bands.
const charts = (() => {
  const { el, figure } = plots;
  const { ticks, tick, percent } = quantities;
  const HEAT = ["heat-0", "heat-1", "heat-2", "heat-3"];  // from noise to far beyond it

  const svg = (tag, attributes = {}, ...children) => {
    const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
    node.append(...children);
    return node;
  };
  const text = (x, y, content, attributes = {}) => svg("text", { x, y, ...attributes }, content);

  // `draw` returns a function that tells the values at a point of the picture: null, or a title and lines.
  const responsive = (box, height, summary, draw) => {
    let drawn = 0, tell = () => null;
    const container = el("div", { className: "picture" }), tip = el("div", { className: "tip", hidden: true });
    box.append(container);
    box.setAttribute("aria-label", summary);
    const redraw = () => {
      const width = Math.floor(container.clientWidth);
      if (width < 60) return;
      drawn = width;
      const picture = svg("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": summary });
      tell = draw(picture, width, height);
      if (plots.marks.synthetic)
        picture.append(text(width - 10, 13, "synthetic", { "text-anchor": "end", class: "stamp" }));
      container.replaceChildren(picture, tip);
    };
    redraw();
    new ResizeObserver(() => requestAnimationFrame(() => { if (Math.floor(container.clientWidth) !== drawn) redraw(); })).observe(container);
    theme.onChange(redraw);
    container.addEventListener("mousemove", event => {
      const area = container.getBoundingClientRect(), left = event.clientX - area.left, top = event.clientY - area.top;
      const told = tell(left, top);
      tip.hidden = !told;
      if (!told) return;
      tip.replaceChildren(el("b", { textContent: told[0] }), ...told.slice(1).map(line => el("div", { textContent: line })));
      tip.style.left = left > drawn / 2 ? "" : `${left + 14}px`;
      tip.style.right = left > drawn / 2 ? `${drawn - left + 14}px` : "";
      tip.style.top = `${Math.max(0, Math.min(top - 10, height - tip.offsetHeight))}px`;
    });
    container.addEventListener("mouseleave", () => { tip.hidden = true; });
  };
  const brief = value => quantities.brief(value, 3);
  const shareText = share => `${share > 0 ? percent(share) : "no more than noise"}`;
  // Tells the cell of a profile below the cursor.
  const cellAt = (profile, x, label) => left => {
    const i = profile.share.findIndex((_, c) => left >= x(profile.edges[c]) && left < x(profile.edges[c + 1]));
    return i < 0 ? null : [`${brief(profile.edges[i])} to ${brief(profile.edges[i + 1])} ${unitOf(label)}`.trim(), shareText(profile.share[i])];
  };
  const unitOf = label => /\[(.*)\]/.exec(label)?.[1] ?? "";
  const summaryOf = (caption, profile, label) => {
    const i = profile.share.indexOf(Math.max(...profile.share));
    return `${caption}: the largest share, ${shareText(profile.share[i])}, lies between ${brief(profile.edges[i])} and ${brief(profile.edges[i + 1])} ${unitOf(label)}.`;
  };
  const cellsOf = (profile, label) => ({ head: [`from: ${label}`, `to: ${label}`, "share [-]"],
    rows: profile.share.map((share, i) => [profile.edges[i], profile.edges[i + 1], share]) });
  // Index of the number nearest to a value.
  const nearest = (values, value) => values.reduce((best, v, i) => (Math.abs(v - value) < Math.abs(values[best] - value) ? i : best), 0);

  // Converts a value to a coordinate, linearly or logarithmically.
  const scale = (domain, range, log = false) => {
    const f = log ? Math.log : v => v;
    const [a, b] = domain.map(f);
    return v => range[0] + (f(v) - a) / (b - a || 1) * (range[1] - range[0]);
  };
  const logTicks = (low, high) => {
    const list = [];
    for (let p = Math.floor(Math.log10(low)); p <= Math.ceil(Math.log10(high)); p++)
      for (const m of [1, 2, 5]) {
        const v = m * 10 ** p;
        if (v >= low * 0.999 && v <= high * 1.001) list.push(v);
      }
    return list;
  };

  const xAxis = (picture, x, domain, y, label, log) => {
    const list = log ? logTicks(...domain) : ticks(...domain, 8);
    for (const v of list) {
      picture.append(svg("line", { x1: x(v), x2: x(v), y1: y, y2: y + 4, class: "axis-line" }),
        text(x(v), y + 16, log ? String(+v.toPrecision(2)) : tick(v, list), { "text-anchor": "middle" }));
    }
    picture.append(svg("line", { x1: x(domain[0]), x2: x(domain[1]), y1: y, y2: y, class: "axis-line" }),
      text((x(domain[0]) + x(domain[1])) / 2, y + 33, label, { "text-anchor": "middle", class: "label" }));
  };
  const yAxis = (picture, y, domain, left, right, label) => {
    const list = ticks(...domain, Math.max(3, Math.round(Math.abs(y(domain[0]) - y(domain[1])) / 42)));
    for (const v of list)
      picture.append(svg("line", { x1: left, x2: right, y1: y(v), y2: y(v), class: "grid-line" }),
        text(left - 7, y(v) + 4, tick(v, list), { "text-anchor": "end" }));
    const middle = (y(domain[0]) + y(domain[1])) / 2;
    picture.append(text(12, middle, label, { "text-anchor": "middle", class: "label", transform: `rotate(-90 12 ${middle})` }));
  };
  const path = (xs, ys, x, y) => {
    let d = "";
    for (let i = 0; i < xs.length; i++)
      if (Number.isFinite(ys[i])) d += `${d ? "L" : "M"}${x(xs[i]).toFixed(1)} ${y(ys[i]).toFixed(1)}`;
    return d;
  };

  const inside = (intervals, from, to) => intervals.some(([a, b]) => (from + to) / 2 >= a && (from + to) / 2 <= b);
  const bars = (picture, profile, x, y, intervals) => {
    profile.share.forEach((share, i) => {
      if (!(share > 0)) return;
      const [from, to] = [profile.edges[i], profile.edges[i + 1]];
      const left = x(from) + 0.5, width = Math.max(1, x(to) - x(from) - 1);
      picture.append(svg("rect", { x: left, width, y: y(share * 100), height: Math.max(0, y(0) - y(share * 100)), rx: 1,
        class: inside(intervals, from, to) ? "cell hot" : "cell" }));
    });
  };

  // Energy beyond the noise, cell by cell; the cells that hold 80 % of it are highlighted.
  // On a logarithmic axis, a first cell that begins at 0 is drawn as wide as the next.
  const positive = edges => (edges[0] > 0 ? edges : [edges[1] ** 2 / edges[2], ...edges.slice(1)]);
  const histogram = (container, caption, given, label, intervals, log = false) => {
    const profile = log && given.edges.length > 2 ? { ...given, edges: positive(given.edges) } : given;
    const box = figure(container, caption, []);
    responsive(box, 230, summaryOf(caption, profile, label), (picture, width, height) => {
      const domain = [profile.edges[0], profile.edges[profile.edges.length - 1]];
      const top = Math.max(...profile.share) * 100 || 1;
      const x = scale(domain, [46, width - 8], log), y = scale([0, top * 1.06], [height - 40, 18]);
      yAxis(picture, y, [0, top], 46, width - 8, "[%]");
      bars(picture, profile, x, y, intervals);
      xAxis(picture, x, domain, height - 40, label, log);
      return cellAt(profile, x, label);
    });
    save.chart(box, () => cellsOf(given, label));
  };

  // Measurement over time, and below it the mismatch over time.
  const timeStrip = (container, caption, profile, intervals, curve, units) => {
    const box = figure(container, caption, [{ label: units.name, color: "measured" }]);
    const isTime = profile.name === "time", label = isTime ? "[s]" : "[-]";
    responsive(box, curve ? 250 : 170, summaryOf(caption, profile, label), (picture, width, height) => {
      const domain = [profile.edges[0], profile.edges[profile.edges.length - 1]];
      const x = scale(domain, [58, width - 8]);
      const split = curve ? 120 : 8;
      for (const [a, b] of intervals)
        picture.append(svg("rect", { x: x(a), width: Math.max(1, x(b) - x(a)), y: 4, height: height - 44, class: "interval-of" }));
      if (curve) {
        const most = quantities.largest(curve.y) * 1.05 || 1;
        const y = scale([-most, most], [split - 8, 6]);
        yAxis(picture, y, [-most, most], 58, width - 8, units.label);
        picture.append(svg("path", { d: path(curve.x, curve.y, x, y), class: "measured" }));
      }
      const top = Math.max(...profile.share) * 100 || 1;
      const y = scale([0, top * 1.06], [height - 40, split + 10]);
      yAxis(picture, y, [0, top], 58, width - 8, "[%]");
      bars(picture, profile, x, y, intervals);
      xAxis(picture, x, domain, height - 40, isTime ? "time [s]" : "row");
      const cell = cellAt(profile, x, label);
      return left => {
        const told = cell(left);
        if (!told || !curve) return told;
        const time = domain[0] + (left - 58) / (width - 66) * (domain[1] - domain[0]), i = nearest(curve.x, time);
        return [...told, `measured: ${brief(curve.y[i])} ${unitOf(units.label)} at ${isTime ? `${curve.x[i].toFixed(2)} s` : `row ${curve.x[i]}`}`];
      };
    });
    save.chart(box, () => cellsOf(profile, isTime ? "time [s]" : "row"));
  };

  const mixed = (a, b, share) => {
    const channel = (hex, i) => parseInt(hex.slice(1 + 2 * i, 3 + 2 * i), 16);
    return `rgb(${[0, 1, 2].map(i => Math.round(channel(a, i) + (channel(b, i) - channel(a, i)) * share)).join(",")})`;
  };
  /// Colour of 0 (noise) to 1 (the most beyond it).
  const heat = share => {
    const at = Math.min(1, Math.max(0, share)) * (HEAT.length - 1), stop = Math.min(HEAT.length - 2, Math.floor(at));
    return mixed(theme.color(HEAT[stop]), theme.color(HEAT[stop + 1]), at - stop);
  };
  const rampKey = (from, to) => el("span", { className: "ramp" }, from, el("b"), to);

  // Displacement by velocity; the cells that hold 80 % are outlined.
  const stateMap = (container, caption, cells, chosen) => {
    const box = figure(container, caption, []);
    box.querySelector(".key").append(rampKey("noise", "largest share"),
      el("span", { textContent: "outlined: holds 80 %" }));
    const ends = key => [Math.min(...cells.map(c => c[key][0])), Math.max(...cells.map(c => c[key][1]))];
    const size = pair => Math.max(...pair.map(Math.abs));
    const u = ends("displacement_m"), v = ends("velocity_m_per_s");
    const du = quantities.axis("displacement [m]", size(u)), dv = quantities.axis("velocity [m/s]", size(v));
    const most = Math.max(...cells.map(c => c.share)) || 1;
    const same = (a, b) => a.displacement_m[0] === b.displacement_m[0] && a.velocity_m_per_s[0] === b.velocity_m_per_s[0];
    const cellText = c => `${dv.label.replace(/ \[.*/, "")} ${c.velocity_m_per_s.map(value => brief(value * dv.factor)).join(" to ")} ${dv.unit}`;
    const top = cells.reduce((best, c) => (c.share > best.share ? c : best), cells[0]);
    const title = c => `displacement ${c.displacement_m.map(value => brief(value * du.factor)).join(" to ")} ${du.unit}`;
    responsive(box, 390, `${caption}: the largest share, ${shareText(top.share)}, lies at ${title(top)}, ${cellText(top)}.`, (picture, width, height) => {
      const domain = { x: u.map(value => value * du.factor), y: v.map(value => value * dv.factor) };
      const x = scale(domain.x, [58, width - 8]), y = scale(domain.y, [height - 40, 18]);
      yAxis(picture, y, domain.y, 58, width - 8, dv.label);
      const outlines = [];
      for (const cell of cells) {
        const [left, right] = cell.displacement_m.map(value => x(value * du.factor));
        const [bottom, top] = cell.velocity_m_per_s.map(value => y(value * dv.factor));
        const at = { x: left + 1, y: top + 1, width: Math.max(1, right - left - 2), height: Math.max(1, bottom - top - 2), rx: 2 };
        const level = Math.max(0, cell.share) / most;
        picture.append(svg("rect", { ...at, fill: level > 0 ? heat(Math.sqrt(level)) : "var(--ground)" }));
        if (chosen.some(c => same(c, cell)))
          outlines.push(svg("rect", { ...at, class: "chosen" }));
        if (cell.share >= 0.015 && at.width > 26)
          outlines.push(text((left + right) / 2, (top + bottom) / 2 + 4, (cell.share * 100).toFixed(0),
            { "text-anchor": "middle", style: `fill:${level > 0.35 ? "var(--on-heat)" : "var(--ink)"}` }));
      }
      picture.append(...outlines);
      xAxis(picture, x, domain.x, height - 40, du.label);
      return (left, y0) => {
        const cell = cells.find(c => left >= x(c.displacement_m[0] * du.factor) && left < x(c.displacement_m[1] * du.factor) &&
          y0 <= y(c.velocity_m_per_s[0] * dv.factor) && y0 > y(c.velocity_m_per_s[1] * dv.factor));
        return cell ? [shareText(cell.share), title(cell), cellText(cell)] : null;
      };
    });
    save.chart(box, () => ({ head: ["displacement from [m]", "to [m]", "velocity from [m/s]", "to [m/s]", "share [-]"],
      rows: cells.map(c => [...c.displacement_m, ...c.velocity_m_per_s, c.share]) }));
  };

  // A curve with the band of its standard deviation; of a curve without one, `band` is empty.
  const bandCurve = (container, caption, label, x, y, band, xLabel, yLabel) => {
    const box = figure(container, caption, [{ label, color: "after" }]);
    const low = y.map((value, i) => value - 2 * (band[i] || 0)), high = y.map((value, i) => value + 2 * (band[i] || 0));
    const [least, largest] = [Math.min(...y.filter(Number.isFinite)), Math.max(...y.filter(Number.isFinite))];
    responsive(box, 320, `${caption}: from ${brief(least)} to ${brief(largest)} ${unitOf(yLabel)}.`, (picture, width, height) => {
      const finite = [...low, ...high].filter(Number.isFinite);
      const domain = { x: [Math.min(...x), Math.max(...x)], y: [Math.min(...finite), Math.max(...finite)] };
      const sx = scale(domain.x, [62, width - 8]), sy = scale(domain.y, [height - 42, 18]);
      yAxis(picture, sy, domain.y, 62, width - 8, yLabel);
      const back = path([...x].reverse(), [...low].reverse(), sx, sy).replace(/^M/, "L");
      picture.append(svg("path", { d: `${path(x, high, sx, sy)}${back}Z`, class: "band" }),
        svg("path", { d: path(x, y, sx, sy), class: "mean" }));
      xAxis(picture, sx, domain.x, height - 42, xLabel);
      return left => {
        const i = nearest(x.map(sx), left);
        const spread = band.length ? ` ± ${brief(2 * band[i])}` : "";
        return [`${brief(x[i])} ${unitOf(xLabel)}`, `${brief(y[i])}${spread} ${unitOf(yLabel)}`];
      };
    });
    const columns = [x, y, band].filter(column => column.length);
    save.chart(box, () => ({ head: [xLabel, yLabel, `standard deviation: ${yLabel}`].slice(0, columns.length),
      rows: x.map((_, i) => columns.map(column => column[i])) }));
  };

  // Autocorrelation over the lags, with the bound for noise.
  const correlogram = (container, caption, values, bound) => {
    const box = figure(container, caption, bound ? [{ label: "95 % of the lags of noise", color: "noise-line", fill: "noise" }] : []);
    const beyond = values.filter(value => bound && Math.abs(value ?? 0) > bound).length;
    responsive(box, 190, `${caption}; ${beyond} of ${values.length} lags lie beyond the bound of noise.`, (picture, width, height) => {
      const top = Math.max(0.2, bound || 0, ...values.map(value => Math.abs(value ?? 0))) * 1.1;
      const domain = [0, values.length + 1];
      const x = scale(domain, [46, width - 8]), y = scale([-top, top], [height - 40, 14]);
      if (bound)
        picture.append(svg("rect", { x: 46, width: width - 54, y: y(bound), height: y(-bound) - y(bound), class: "noise" }));
      yAxis(picture, y, [-top, top], 46, width - 8, "[–]");
      values.forEach((value, i) => {
        if (value == null) return;
        const kind = bound && Math.abs(value) > bound ? "lag hot" : "lag";
        picture.append(svg("line", { x1: x(i + 1), x2: x(i + 1), y1: y(0), y2: y(value), class: kind }),
          svg("circle", { cx: x(i + 1), cy: y(value), r: 2.4, class: kind }));
      });
      picture.append(svg("line", { x1: 46, x2: width - 8, y1: y(0), y2: y(0), class: "axis-line" }));
      xAxis(picture, x, domain, height - 40, "lag [samples]");
      return left => {
        const i = nearest(values.map((_, lag) => x(lag + 1)), left);
        return [`lag ${i + 1}`, values[i] == null ? "–" : values[i].toFixed(3)];
      };
    });
    save.chart(box, () => ({ head: ["lag [samples]", "correlation [-]"], rows: values.map((value, i) => [i + 1, value]) }));
  };

  // Rows of name, bar and value. All bars begin at 0 and share one scale.
  const rows = (container, items, options = {}) => {
    const ends = items.flatMap(i => [0, i.value, i.low ?? 0, i.high ?? 0, options.floor ?? 0]).filter(Number.isFinite);
    const at = scale([Math.min(...ends), Math.max(...ends)], [0, 100]);
    const grid = el("div", { className: "rows" });
    const mark = (className, from, to) => {
      const node = el("span", { className });
      node.style.left = `${at(Math.min(from, to))}%`;
      if (to !== undefined) node.style.width = `${Math.abs(at(to) - at(from))}%`;
      return node;
    };
    for (const item of items) {
      const track = el("div", { className: "track" }, mark(`bar ${item.kind || ""}`, 0, item.value));
      const zero = el("span", { className: "zero" });
      zero.style.left = `${at(0)}%`;
      track.append(zero);
      if (item.low != null && item.high != null) track.append(mark("whisker", item.low, item.high));
      if (options.floor != null) {
        const floor = el("span", { className: "floor", title: options.floorTitle || "" });
        floor.style.left = `${at(options.floor)}%`;
        track.append(floor);
      }
      const name = el("div", { className: "name", textContent: item.title });
      if (item.name && item.name !== item.title) name.append(el("code", { textContent: item.name }));
      grid.append(name, track, el("div", { className: "value", textContent: item.shown }));
    }
    container.append(grid);
    return grid;
  };

  return { svg, text, responsive, histogram, timeStrip, stateMap, bandCurve, correlogram, rows, heat, rampKey, percent, scale };
})();
