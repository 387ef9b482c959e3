
// The verdict in the page, and functions of its sections.
const verdict = (() => {
  const { data, unpack, el, byId } = plots;
  const v = data.verdict;
  plots.marks.synthetic = v.synthetic;
  const terms = [...v.causes, ...v.guesses]; // of the improved simulation
  const hasTerms = terms.length > 0;
  const proof = v.fit[v.proof_record];
  const named = new Set(terms.map(c => c.name));
  const tied = new Set(terms.flatMap(c => c.alternatives.map(a => a.name)));
  const PARTS = ["numerical", "actuator", "machine", "bearing", "structure", "sensor"];
  // In a word: of what was tested, where the records do not tell it from its machine.
  const isObject = part => ["machine", "bearing", "structure"].includes(part);
  const isFree = ["system", "structure"].includes(v.specimen);
  const placeOf = part => (v.specimen && isObject(part) ? v.specimen : isFree && part === "actuator" ? "input" : part === "numerical" ? "numerical part" : part);
  const guilty = new Set(hasTerms ? terms.map(c => placeOf(c.part)) : [placeOf(v.where.part)]);
  const hide = (...ids) => { for (const id of ids) byId(id).hidden = true; };
  // Without a refit or a named term, the predictions before and after are the same.
  const unpacked = t => {
    const values = Object.fromEntries(["time", "abscissa", "measured", "before", "after", "excess"].map(k => [k, Array.from(unpack(t[k]))]));
    values.without = Object.fromEntries(Object.entries(t.without || {}).map(([name, packed]) => [name, Array.from(unpack(packed))]));
    if (!values.before.length) values.before = values.after;
    if (!values.after.length) values.after = values.before;
    return { ...t, ...values };
  };
  const traces = data.traces.map(unpacked).filter(t => t.time.length > 1 && t.measured.length && t.before.length);
  const traceOf = (record, channel) => traces.find(t => t.record === record && t.channel === channel) ||
    traces.find(t => t.record === record);

  const tableOf = (head, rows, textColumns) => {
    const cells = (tag, row) => row.map((cell, i) => {
      const node = el(tag, { className: textColumns.includes(i) ? "text" : "" });
      node.append(cell);
      return node;
    });
    return el("table", {}, el("thead", {}, el("tr", {}, ...cells("th", head))),
      el("tbody", {}, ...rows.map(row => el("tr", {}, ...cells("td", row)))));
  };

  return { v, terms, hasTerms, proof, named, tied, PARTS, placeOf, guilty, hide, traces, traceOf, tableOf };
})();
