
// Pictures of a large structure: its modes, and the loads of its bearings.
const structure = (() => {
  const { figure } = plots;
  const { svg, text, responsive } = charts;

  // Seen from above, at an angle.
  const [COS, SIN] = [Math.cos(Math.PI / 6), Math.sin(Math.PI / 6)];
  const project = ([x, y, z]) => [COS * (x - y), -z - 0.5 * SIN * (x + y)];
  const bounds = points => [0, 1].flatMap(k => [Math.min(...points.map(p => p[k])), Math.max(...points.map(p => p[k]))]);
  // Places points in a picture, with one scale for both directions.
  const placed = (points, width, height, margin) => {
    const [left, right, top, bottom] = bounds(points);
    const by = Math.min((width - 2 * margin) / (right - left || 1), (height - 2 * margin) / (bottom - top || 1));
    const [dx, dy] = [(width - by * (right - left)) / 2, (height - by * (bottom - top)) / 2];
    return ([x, y]) => [dx + by * (x - left), dy + by * (y - top)];
  };
  const dot = ([cx, cy], r, attributes) => svg("circle", { cx: cx.toFixed(1), cy: cy.toFixed(1), r, ...attributes });

  const mode = (container, sketch, one) => {
    const [long, lat, vert] = one.mass_percent;
    const caption = `${one.frequency_Hz.toFixed(2)} Hz: ${long.toFixed(0)}\u00a0% of the mass in long, ${lat.toFixed(0)}\u00a0% in lat, ${vert.toFixed(0)}\u00a0% up`;
    const box = figure(container, caption, []);
    const heights = sketch.nodes_m.map(p => p[2]);
    const reach = 0.18 * (Math.max(...heights) - Math.min(...heights) || 1);
    const moved = sketch.nodes_m.map((p, i) => p.map((v, k) => v + reach * one.shape[i][k]));
    responsive(box, 260, caption, (picture, width, height) => {
      const at = placed([...sketch.nodes_m, ...moved].map(project), width, height, 14);
      for (const p of sketch.nodes_m) picture.append(dot(at(project(p)), 1.1, { fill: theme.css("tick") }));
      moved.forEach((p, i) => {
        const size = Math.hypot(...one.shape[i]);
        picture.append(dot(at(project(p)), 1.6, { fill: theme.css("numerical"), opacity: (0.25 + 0.75 * Math.min(1, size)).toFixed(2) }));
      });
      return () => null;
    });
  };

  const loads = (container, sketch) => {
    const [least, most] = [Math.min(...sketch.loads_MN), Math.max(...sketch.loads_MN)];
    const areEqual = most - least < 0.01;
    const caption = `Loads of the bearings at rest: ${areEqual ? "" : `${least.toFixed(2)} to `}${most.toFixed(2)} MN`;
    const box = figure(container, caption, []);
    const points = sketch.bearings_m.map(([x, y]) => [x, -y]);
    responsive(box, 260, `${caption}; number ${sketch.tested + 1} is tested`, (picture, width, height) => {
      const at = placed(points, width, height - 18, 26);
      const places = points.map(at);
      const gap = Math.min(...places.slice(1).map(([x, y]) => Math.hypot(x - places[0][0], y - places[0][1])), 40);
      const radius = Math.max(2, Math.min(7, 0.42 * gap));
      places.forEach((p, i) => picture.append(dot(p, radius, {
        fill: theme.css("numerical"), opacity: areEqual ? 1 : (0.12 + 0.88 * (sketch.loads_MN[i] - least) / (most - least)).toFixed(2) })));
      picture.append(dot(places[sketch.tested], radius + 3, { fill: "none", stroke: theme.css("hybrid"), "stroke-width": 2.2 }),
        text(width / 2, height - 6, `${areEqual ? "" : "darker: more load; "}ring: the tested bearing`, { "text-anchor": "middle" }));
      return (x, y) => {
        const i = places.findIndex(p => Math.hypot(p[0] - x, p[1] - y) < radius + 1);
        return i < 0 ? null : [`bearing ${i + 1}`, `${sketch.loads_MN[i].toFixed(3)} MN at rest`];
      };
    });
  };

  // Fills the section; without a sketch it stays hidden.
  const draw = (container, sketch) => {
    if (!sketch) return false;
    loads(container, sketch);
    for (const one of sketch.modes) mode(container, sketch, one);
    return true;
  };
  return { draw };
})();
