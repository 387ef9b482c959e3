
// The results of runs, and two of them compared.
const runsPage = (() => {
  const { el, byId } = plots;
  const FIGURES = [["nrms_percent", "NRMS [%]"], ["delay_compensated_ms", "delay [ms]"], ["peak_displacement_mm", "peak [mm]"], ["peak_shear_kN", "shear [kN]"],
    ["numerical_difference_percent", "against numerical [%]"]];
  const chosen = new Set();
  const both = values => (values ? Object.values(values).map(v => quantities.brief(v)).join(" / ") : "–");
  const href = (run, file) => `run/${[...run.folder.split("/"), file].map(encodeURIComponent).join("/")}`;

  const row = run => {
    const box = el("input", { type: "checkbox", ariaLabel: `choose ${run.folder}`, checked: chosen.has(run.folder) });
    box.addEventListener("change", () => {
      box.checked ? chosen.add(run.folder) : chosen.delete(run.folder);
      byId("compare").disabled = chosen.size !== 2;
    });
    const links = ["report", "diagnosis"].filter(key => run[key]).flatMap(key => [el("a", { href: href(run, run[key]), textContent: key }), " "]);
    const conclusive = run.conclusive === undefined ? "–" : run.conclusive ? "yes" : "no";
    return el("tr", {}, el("td", {}, box), el("td", { className: "left", textContent: new Date(run.time_s * 1000).toISOString().slice(0, 16).replace("T", " ") }),
      el("td", { className: "left", textContent: run.name || run.folder, title: run.folder }), el("td", { className: run.conclusive ? "good" : "", textContent: conclusive }),
      ...FIGURES.map(([key]) => el("td", { textContent: both(run.figures?.[key]) })),
      el("td", { className: "left", textContent: run.verdict || run.note || "" }), el("td", { className: "left" }, ...links));
  };
  const read = async () => {
    const answer = await fetch("runs.json");
    if (!answer.ok) return byId("runs").replaceChildren(await answer.text());
    const runs = await answer.json();
    for (const folder of [...chosen]) if (!runs.some(r => r.folder === folder)) chosen.delete(folder);
    byId("compare").disabled = chosen.size !== 2;
    if (!runs.length) return byId("runs").replaceChildren("There are no runs in this folder.");
    const head = ["", "date [UTC]", "experiment", "conclusive", ...FIGURES.map(f => f[1]), "verdict or note", ""];
    return byId("runs").replaceChildren(el("table", {}, el("thead", {}, el("tr", {}, ...head.map(h => el("th", { textContent: h })))), el("tbody", {}, ...runs.map(row))));
  };
  const compare = async () => {
    const [a, b] = [...chosen];
    byId("comparison-section").hidden = false;
    byId("comparison").textContent = "comparing…";
    const answer = await fetch(`compare?a=${encodeURIComponent(a)}&b=${encodeURIComponent(b)}`);
    byId("comparison").textContent = await answer.text();
  };
  byId("compare").addEventListener("click", compare);
  byId("reload").addEventListener("click", read);
  return { read };
})();
