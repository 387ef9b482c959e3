
// The sentence of a verdict, at the top of both pages.
const sentence = (() => {
  const { el } = plots;
  const { share, percent } = quantities;

  // Index behind the first semicolon outside brackets.
  const endOfMain = text => {
    let depth = 0;
    for (let i = 0; i < text.length; i++) {
      depth += "([".includes(text[i]) - ")]".includes(text[i]);
      if (text[i] === ";" && depth === 0) return i + 1;
    }
    return text.length;
  };
  // The first sentence is the verdict; its beginning is highlighted.
  const write = (v, container, rest) => {
    const end = /[.!?]\s+(?=[A-Z])/.exec(v.sentence);
    const first = end ? v.sentence.slice(0, end.index + 1) : v.sentence;
    const main = endOfMain(first);
    container.append(first.slice(0, main), el("span", { className: "detail", textContent: first.slice(main) }));
    rest.textContent = end ? v.sentence.slice(end.index + 1).trim() : "";
  };
  const chip = v => el("span", { className: `chip ${v.verdict}`,
    textContent: { missing: "missing", none: "nothing missing", unknown: "unknown" }[v.verdict] });

  const card = (container, name, value, note) => container.append(el("div", { className: "card" },
    el("div", { className: "name", textContent: name }), el("div", { className: "value", textContent: value }),
    el("div", { className: "note", textContent: note })));
  // Error before and after on the record that nothing was fitted to, and how much that explains.
  const proofCards = (v, container) => {
    const proof = v.fit[v.proof_record], score = proof || Object.values(v.fit)[0], isMissing = v.verdict === "missing";
    if (score)
      card(container, proof ? "error on the unseen record" : "error on the fitted record",
        (isMissing ? `${percent(score.nrmse_before)} → ` : "") + percent(score.nrmse_after), `noise alone: ${percent(score.noise_floor)}`);
    if (isMissing && v.causes.some(c => c.explained_fraction != null))
      card(container, "explained", share(v.proof.explained_fraction), "of the systematic residual");
  };

  return { write, chip, card, proofCards };
})();
