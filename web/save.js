
// Figures that leave the page: as PNG, SVG and CSV.
const save = (() => {
  const { el } = plots;
  const WIDTH = 760, HEIGHT = 440, BOX = { left: 74, right: 20, top: 62, bottom: 52 };

  // Light colours, as on paper, whatever the page shows.
  const onPaper = draw => {
    const { classList } = document.documentElement, isPrint = classList.contains("print");
    classList.add("print");
    try { return draw(); } finally { if (!isPrint) classList.remove("print"); }
  };

  const logTicks = (low, high) => {
    const list = [];
    for (let p = Math.floor(Math.log10(low)); p <= Math.ceil(Math.log10(high)); p++)
      for (const m of [1, 2, 5]) if (m * 10 ** p >= low && m * 10 ** p <= high) list.push(m * 10 ** p);
    return list;
  };

  // A picture of curves {label, color, dash, width, fill, x, y} in the given view.
  const pictureOf = ({ caption, xLabel, yLabel, curves, view, logX, logY }) => {
    const { svg } = charts, [width, height] = [WIDTH, HEIGHT + 18 * Math.ceil(curves.length / 3 - 1)];
    const top = BOX.top + height - HEIGHT, bottom = height - BOX.bottom, right = width - BOX.right;
    const x = charts.scale(view.x, [BOX.left, right], logX), y = charts.scale(view.y, [bottom, top], logY);
    const text = (at, content, attributes = {}) => svg("text", { x: at[0], y: at[1], fill: theme.color("ink"), ...attributes }, content);
    const line = (x1, y1, x2, y2, attributes) => svg("line", { x1, y1, x2, y2, ...attributes });
    const picture = svg("svg", { xmlns: "http://www.w3.org/2000/svg", viewBox: `0 0 ${width} ${height}`, width, height,
      "font-family": "system-ui, sans-serif", "font-size": 12 });
    picture.append(svg("rect", { width, height, fill: "#ffffff" }), text([BOX.left, 20], caption, { "font-size": 14, "font-weight": 600 }));
    const ticksOf = ([low, high], log, most) => (log ? logTicks(low, high) : quantities.ticks(low, high, most));
    const label = (v, list, log) => (log ? String(+v.toPrecision(2)) : quantities.tick(v, list));
    const xs = ticksOf(view.x, logX, 8), ys = ticksOf(view.y, logY, 7);
    for (const v of xs) picture.append(line(x(v), top, x(v), bottom, { stroke: theme.color("grid") }),
      text([x(v), bottom + 17], label(v, xs, logX), { "text-anchor": "middle" }));
    for (const v of ys) picture.append(line(BOX.left, y(v), right, y(v), { stroke: theme.color("grid") }),
      text([BOX.left - 7, y(v) + 4], label(v, ys, logY), { "text-anchor": "end" }));
    const middle = (top + bottom) / 2;
    picture.append(text([(BOX.left + right) / 2, height - 12], xLabel, { "text-anchor": "middle" }),
      text([16, middle], yLabel, { "text-anchor": "middle", transform: `rotate(-90 16 ${middle})` }),
      svg("clipPath", { id: "box" }, svg("rect", { x: BOX.left, y: top, width: right - BOX.left, height: bottom - top })));
    const drawn = svg("g", { "clip-path": "url(#box)", fill: "none", "stroke-linejoin": "round" });
    curves.forEach((c, i) => {
      const style = { stroke: theme.color(c.color), "stroke-width": c.width || 1.4, "stroke-dasharray": (c.dash || []).join(" ") };
      let d = "", isOpen = false;
      for (let k = 0; k < c.x.length; k++) {
        const isPoint = c.y[k] != null && Number.isFinite(c.y[k]) && (!logY || c.y[k] > 0) && (!logX || c.x[k] > 0);
        if (isPoint) d += `${isOpen ? "L" : "M"}${x(c.x[k]).toFixed(1)} ${y(c.y[k]).toFixed(1)}`;
        isOpen = isPoint;
      }
      if (c.fill && d) drawn.append(svg("path", { d: `${d}L${x(c.x[c.x.length - 1])} ${bottom}L${x(c.x[0])} ${bottom}Z`, fill: theme.color(c.fill), stroke: "none" }));
      drawn.append(svg("path", { d, ...style }));
      const at = [BOX.left + (i % 3) * 225, 42 + 18 * Math.floor(i / 3)];
      picture.append(line(at[0], at[1] - 4, at[0] + 24, at[1] - 4, style), text([at[0] + 30, at[1]], c.label));
    });
    picture.append(drawn, svg("rect", { x: BOX.left, y: top, width: right - BOX.left, height: bottom - top, fill: "none", stroke: theme.color("tick") }));
    if (plots.marks.synthetic) picture.append(text([right - 8, bottom - 8], "synthetic", { "text-anchor": "end", fill: theme.color("soft") }));
    return picture;
  };

  // A picture of the page, with the styles that the page gives it.
  const copyOf = original => {
    const copy = original.cloneNode(true), of = [copy, ...copy.querySelectorAll("*")];
    [original, ...original.querySelectorAll("*")].forEach((from, i) => {
      const style = getComputedStyle(from);
      for (const key of ["fill", "stroke", "stroke-width", "stroke-dasharray", "font-family", "font-size"]) of[i].setAttribute(key, style.getPropertyValue(key));
      of[i].removeAttribute("class");
      of[i].removeAttribute("style");
    });
    const { width, height } = original.getBoundingClientRect();
    for (const [key, value] of Object.entries({ xmlns: "http://www.w3.org/2000/svg", width, height })) copy.setAttribute(key, value);
    copy.prepend(charts.svg("rect", { width, height, fill: "#ffffff" }));
    return copy;
  };

  const cell = value => {
    if (value == null || Number.isNaN(value)) return "";
    return /[",\n]/.test(value) ? `"${String(value).replaceAll('"', '""')}"` : typeof value === "number" ? String(+value.toPrecision(7)) : value;
  };
  const csvOf = ({ head, rows }) => [head, ...rows].map(row => row.map(cell).join(",")).join("\n") + "\n";
  // Of stacked curves, the parts that are `shown`. One column of x where all curves share it, else a pair of columns for each curve.
  const tableOf = ({ xLabel, yLabel, curves }) => {
    const isShared = curves.every(c => c.x === curves[0].x);
    const columns = isShared ? [[xLabel, curves[0].x], ...curves.map(c => [`${c.label}: ${yLabel}`, c.shown || c.y])]
      : curves.flatMap(c => [[`${c.label}: ${xLabel}`, c.x], [`${c.label}: ${yLabel}`, c.shown || c.y]]);
    const rows = Array.from({ length: Math.max(...columns.map(([, values]) => values.length)) }, (_, i) => columns.map(([, values]) => values[i]));
    return { head: columns.map(([name]) => name), rows };
  };

  const serialised = picture => new XMLSerializer().serializeToString(picture);
  const pngOf = async picture => {
    const image = new Image();
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(serialised(picture))}`;
    await image.decode();
    const canvas = el("canvas", { width: 2 * image.width, height: 2 * image.height });
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    return new Promise(resolve => canvas.toBlob(resolve, "image/png"));
  };
  const leave = (name, blob) => {
    const link = el("a", { download: name, href: URL.createObjectURL(blob) });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };

  // With #figures, the page turns into its figures, for a program: name and base64 of a file on each line.
  const offered = [];
  const base64 = blob => new Promise(resolve => {
    const reader = new FileReader();
    reader.onload = () => resolve(reader.result.slice(reader.result.indexOf(",") + 1));
    reader.readAsDataURL(blob);
  });
  const handOver = async () => {
    const open = el("iframe");  // as long as it is not closed, the page counts as not loaded, and the program waits
    document.body.append(open);
    open.contentDocument.open();
    for (const fold of document.querySelectorAll("details")) fold.open = true;
    const lines = [], used = {};
    try {
      for (const { name, makers } of offered) {
        used[name] = (used[name] || 0) + 1;
        const own = used[name] > 1 ? `${name}_${used[name]}` : name;
        for (const [kind, make] of Object.entries(makers)) lines.push(`${own}.${kind.toLowerCase()} ${await base64(await make())}`);
      }
      document.body.replaceChildren(el("pre", { id: "figures", textContent: `\n${lines.join("\n")}\n` }));
    } finally {
      open.remove();
    }
  };
  addEventListener("DOMContentLoaded", () => { if (location.hash === "#figures") handOver(); });

  // Buttons at the caption of a figure. `content` is {picture, table}: functions, asked when a button is pressed.
  const offer = (box, content) => {
    const caption = box.querySelector("figcaption"), title = caption.firstChild.textContent;
    const name = title.normalize("NFKD").toLowerCase().replace(/[^a-z0-9]+/g, "_").replace(/^_+|_+$/g, "");
    const picture = () => onPaper(content.picture);
    const makers = {
      PNG: () => pngOf(picture()),
      SVG: () => new Blob([serialised(picture())], { type: "image/svg+xml" }),
      CSV: () => new Blob([csvOf(content.table())], { type: "text/csv" }),
    };
    offered.push({ name, makers });
    caption.append(el("span", { className: "save" }, ...Object.entries(makers).map(([kind, make]) => {
      const button = el("button", { type: "button", textContent: kind, title: `save this figure as ${kind}` });
      button.addEventListener("click", async () => leave(`${name}.${kind.toLowerCase()}`, await make()));
      return button;
    })));
  };
  const curves = (box, describe) => offer(box, { picture: () => pictureOf(describe()), table: () => tableOf(describe()) });
  const chart = (box, table) => offer(box, { picture: () => copyOf(box.querySelector(".picture > svg")), table });

  return { curves, chart };
})();
