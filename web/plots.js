
// Functions of both pages: unpacking of numbers, elements of a page. For tests, the body has the
// attributes data-figures (number of drawn figures) and data-error.
const plots = (() => {
  window.addEventListener("error", e => { document.body.dataset.error = e.message; });

  const data = JSON.parse(document.getElementById("data").textContent);
  const marks = { synthetic: false };  // printed on each picture
  let drawn = 0;

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

  // A sample of a curve {color, dash} or of a filled area {color, fill}.
  const swatch = curve => {
    const node = el("span", { className: "swatch" });
    const color = `stroke="${theme.css(curve.color)}"`;
    node.innerHTML = '<svg width="24" height="10" aria-hidden="true">' + (curve.fill
      ? `<rect x="4" y="0" width="16" height="10" rx="2" fill="${theme.css(curve.fill)}" ${color}/>`
      : `<line x1="0" x2="24" y1="5" y2="5" stroke-width="2.4" ${color} stroke-dasharray="${(curve.dash || []).join(" ")}"/>`) + "</svg>";
    return node;
  };
  const figure = (container, caption, key) => {
    const legend = el("div", { className: "key" }, ...key.map(k => el("span", {}, swatch(k), k.label)));
    const box = el("figure", {}, el("figcaption", { textContent: caption }), legend);
    byId(container).append(box);
    drawn += 1;
    return box;
  };

  const table = (container, head, rows) => {
    const body = el("tbody");
    for (const row of rows) body.append(el("tr", {}, ...row.map(cell => el("td", { textContent: cell }))));
    byId(container).append(el("table", {},
      el("thead", {}, el("tr", {}, ...head.map(h => el("th", { textContent: h })))), body));
  };

  const done = () => { document.body.dataset.figures = drawn; };

  return { data, marks, unpack, times, gaps, el, byId, swatch, figure, table, done };
})();
