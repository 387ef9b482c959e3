
// A verdict's sentence, as both pages open with it.
const sentence = (() => {
  const { el } = plots;
  const { share, percent } = quantities;

  // Up to the first semicolon that is in no brackets.
  const heartOf = text => {
    let depth = 0;
    for (let i = 0; i < text.length; i++) {
      depth += "([".includes(text[i]) - ")]".includes(text[i]);
      if (text[i] === ";" && depth === 0) return i + 1;
    }
    return text.length;
  };
  // The first sentence is the verdict; its heart stands out.
  const write = (v, place, rest) => {
    const end = /[.!?]\s+(?=[A-Z])/.exec(v.sentence);
    const first = end ? v.sentence.slice(0, end.index + 1) : v.sentence;
    const heart = heartOf(first);
    place.append(first.slice(0, heart), el("span", { className: "detail", textContent: first.slice(heart) }));
    rest.textContent = end ? v.sentence.slice(end.index + 1).trim() : "";
  };
  const chip = v => el("span", { className: `chip ${v.verdict}`,
    textContent: { missing: "missing", none: "nothing missing", unknown: "unknown" }[v.verdict] });

  const card = (place, name, value, note) => place.append(el("div", { className: "card" },
    el("div", { className: "name", textContent: name }), el("div", { className: "value", textContent: value }),
    el("div", { className: "note", textContent: note })));
  // Error before and after on the record that nothing was fitted to, and how much that explains.
  const proofCards = (v, place) => {
    const proof = v.fit[v.proof_record], score = proof || Object.values(v.fit)[0], isMissing = v.verdict === "missing";
    if (score)
      card(place, proof ? "error on the unseen record" : "error where it was fitted",
        (isMissing ? `${percent(score.nrmse_before)} → ` : "") + percent(score.nrmse_after), `noise alone: ${percent(score.noise_floor)}`);
    if (isMissing)
      card(place, "explained", share(Math.min(1, v.causes.reduce((sum, c) => sum + (c.explained_fraction || 0), 0))), "of what was unexplained");
  };

  return { write, chip, card, proofCards };
})();
