
// The headline of a verdict and its three answers, at the top of both pages.
const sentence = (() => {
  const { el, byId } = plots;
  const QUESTIONS = { missing: "What is missing, and where", certainty: "How sure", next: "What now" };

  const chip = v => el("span", { className: `chip ${v.verdict}`,
    textContent: { missing: "missing", none: "nothing missing", unknown: "unknown" }[v.verdict] });

  // `prefix` names the elements: prefix-sentence, prefix-cards and prefix-rest.
  const write = (v, prefix) => {
    byId(`${prefix}-sentence`).textContent = v.headline ?? v.sentence;
    if (!v.answers) return;  // of an earlier version
    byId(`${prefix}-cards`).append(...Object.entries(QUESTIONS).map(([key, question]) => el("div", { className: "card answer" },
      el("div", { className: "name", textContent: question }), el("p", { textContent: v.answers[key] }))));
    byId(`${prefix}-rest`).append(el("summary", { textContent: "In full" }), el("p", { textContent: v.sentence }));
  };

  return { write, chip };
})();
