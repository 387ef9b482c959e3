// Uses the live page as a person does, and returns a line for each question that the page has to answer.
// `asked` names the questions; `token` is that of the page.
const lines = [];
const say = (question, answer) => lines.push(`${question}: ${answer}`);
const byId = id => document.getElementById(id);
const pause = ms => new Promise(resume => setTimeout(resume, ms));
// Waits until something is so, at most 10 s.
const until = async is => {
  for (let i = 0; i < 500; i++) {
    if (is()) return true;
    await pause(20);
  }
  return false;
};
const press = (key, on = document.body) => on.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
const type = (input, text) => {
  input.value = text;
  input.dispatchEvent(new Event("input", { bubbles: true }));
};
const find = caption => {
  const found = [...document.querySelectorAll("figure")].find(f => f.querySelector("figcaption").firstChild.textContent === caption);
  found?.scrollIntoView({ block: "center" });  // figures that nobody sees are not drawn
  return found;
};
const isSeen = figure => {
  const { top, bottom } = figure.box.getBoundingClientRect();
  return bottom > 0 && top < innerHeight;
};
const valueIn = (f, i = 0) => f.querySelectorAll("button.curve b")[i].textContent;
const picture = f => f.querySelector("canvas").toDataURL();
const drag = (area, from, to) => {
  const box = area.getBoundingClientRect();
  const mouse = (kind, x, buttons) => area.dispatchEvent(new MouseEvent(kind, { bubbles: true, cancelable: true, view: window, buttons,
    clientX: box.left + box.width * x, clientY: box.top + box.height / 2 }));
  mouse("mouseenter", from, 0);
  mouse("mousemove", from, 0);
  mouse("mousedown", from, 1);
  mouse("mousemove", to, 1);
  mouse("mouseup", to, 0);
};
const shown = () => byId("shown").textContent;
const interval = () => shown().match(/(\d+\.\d+) to (\d+\.\d+)/).slice(1).map(Number);
const search = async text => {
  byId("tab-signals").click();
  type(byId("search"), text);
  await pause(50);
};
const rows = () => [...byId("words").querySelectorAll("tr")];

const questions = {
  test: async () => {
    say("state", await until(() => byId("state").textContent.includes("live")));
    const f = find("Displacement, longitudinal");
    const values = new Set();
    await until(() => values.add(valueIn(f)).size > 10);
    say("values move", values.size > 10);
    const before = picture(f);
    say("curves move", await until(() => picture(f) !== before));
    say("unit", f.querySelector(".unit").textContent);
    say("safety", document.querySelectorAll("#test-cards .value")[1].textContent);
    say("nodes", [...document.querySelectorAll("#test-nodes tbody tr")].map(r => `${r.children[0].textContent} ${r.children[1].textContent}`).join(", "));
    const ofLoop = find("Force by displacement, longitudinal");
    say("loop", await until(() => ofLoop.getAttribute("aria-label")?.includes("mm")));
    say("fits", document.documentElement.scrollWidth <= innerWidth);
    say("limits", [...document.querySelectorAll("#test-cards .limit:not([hidden])")].map(bar => bar.previousSibling.textContent.replace(/.* of /, "").replace("\u202f", " ")).join(", "));
    say("ground", getComputedStyle(document.body).backgroundColor);
  },
  time: async () => {
    await until(() => live.state.now > 4000);
    const f = find("Displacement, longitudinal");
    byId("pause").click();
    say("paused", await until(() => shown().startsWith("paused")));
    await pause(600);
    const [from, to] = interval(), still = picture(f);
    await pause(400);
    say("stands still", picture(f) === still && interval()[1] === to);
    byId("closer").click();
    byId("closer").click();
    byId("closer").click();
    await pause(300);
    const near = interval();
    say("zooms in", Math.abs((near[1] - near[0]) / (to - Math.max(0, from)) - 0.125) < 0.6 && picture(f) !== still);
    byId("back").click();
    await pause(300);
    say("scrolls back", interval()[1] < near[1]);
    const wide = interval();
    drag(f.querySelector(".u-over"), 0.25, 0.75);
    await pause(400);
    const dragged = interval();
    say("drag zooms", dragged[1] - dragged[0] < 0.7 * (wide[1] - wide[0]) && shown().startsWith("paused"));
    const others = moving.all.size;
    say("all figures follow", others > 3 && [...moving.all].filter(g => g.plot.mode === 1 && isSeen(g))
      .every(g => Math.abs(g.plot.scales.x.max - live.shown()[1]) < 0.05));
    byId("scroll").value = 1000;
    byId("scroll").dispatchEvent(new Event("input"));
    say("live again", await until(() => shown().startsWith("live")));
  },
  seen: async () => {
    await until(() => live.state.now > 2000);
    scrollTo(0, 0);
    await pause(200);
    const drawn = new Map([...moving.all].map(f => [f, 0]));
    for (const f of moving.all)
      for (const draw of ["setData", "redraw"]) {
        const original = f.plot[draw];
        f.plot[draw] = (...given) => { drawn.set(f, drawn.get(f) + 1); return original(...given); };
      }
    await pause(1000);
    const unseen = [...moving.all].filter(f => !isSeen(f));
    say("draws what is seen", [...moving.all].filter(isSeen).every(f => drawn.get(f) > 3));
    say("draws nothing else", unseen.length > 0 && unseen.every(f => drawn.get(f) === 0));
    unseen[0].box.scrollIntoView();
    say("draws what is scrolled to", await until(() => drawn.get(unseen[0]) > 3));
  },
  keys: async () => {
    press(" ");
    say("space pauses", await until(() => shown().startsWith("paused")));
    const span = live.view.span;
    press("+");
    say("plus zooms", live.view.span < span);
    press("ArrowLeft");
    press("l");
    say("l follows", await until(() => shown().startsWith("live")));
    press("/");
    say("slash searches", document.activeElement === byId("search"));
    type(byId("search"), "command");
    press("Enter", byId("search"));
    say("enter shows", await until(() => find("monitor.xpc.pc.command.long")));
    byId("search").blur();
    press("3");
    say("digit opens", !byId("page-ring").hidden);
    byId("tab-ring").focus();
    press("ArrowLeft", byId("tab-ring"));
    say("arrows open", !byId("page-signals").hidden && document.activeElement === byId("tab-signals"));
    say("focus is shown", [...document.querySelectorAll("button, input, select")].every(e => e.tabIndex >= 0 || e.getAttribute("role") === "tab"));
  },
  signals: async () => {
    await search("xpc displ long");
    say("search", rows().map(r => r.children[0].textContent).join(", "));
    rows()[0].querySelector("button").click();
    say("figure", await until(() => find("monitor.xpc.displacement.out.long")));
    byId("same-plot").checked = true;
    await search("pc.command.long");
    rows()[0].querySelector("button").click();
    const f = await until(() => find("2 signals")) && find("2 signals");
    say("two signals", f.querySelectorAll("button.curve").length);
    await until(() => valueIn(f) !== "–" && valueIn(f, 1) !== "–");
    byId("pause").click();
    await until(() => f.querySelector(".unit").textContent === "mm");
    await pause(300);
    const over = f.querySelector(".u-over").getBoundingClientRect();
    f.querySelector(".u-over").dispatchEvent(new MouseEvent("mousemove", { bubbles: true, clientX: over.left + over.width * 0.98, clientY: over.top + 20 }));
    await pause(100);
    // The machine is 0.1 mm behind.
    say("difference", (parseFloat(valueIn(f, 1).replace("−", "-")) - parseFloat(valueIn(f).replace("−", "-"))).toFixed(1));
    say("writer", rows()[0].children[2].textContent);
    say("last write", await until(() => /ms$/.test(rows()[0].children[3].textContent)));
    f.querySelector("figcaption button").click();
    say("removed", !find("2 signals"));
  },
  parameter: async () => {
    await search("gain");
    const [value, given] = rows()[0].querySelectorAll("input");
    const button = [...rows()[0].querySelectorAll("button")].find(b => b.textContent === "set");
    const answer = () => rows()[0].querySelector("[role=status]").textContent;
    const set = async text => {
      rows()[0].querySelector("[role=status]").textContent = "";
      value.value = text;
      button.click();
      await until(() => answer() !== "");
      return answer();
    };
    say("without token", await set("2"));
    given.value = "wrong";
    say("wrong token", await set("2"));
    given.value = token;
    say("beyond its range", await set("7"));
    say("with token", await set("2"));
    say("value", await until(() => rows()[0].children[1].textContent === "2.000"));
    say("event", await until(() => byId("test-events").textContent.includes("tune.srmd.gain: 1 to 2")));
  },
  ring: async () => {
    byId("tab-ring").click();
    say("hop", await until(() => byId("ring-hosts").querySelector("tbody tr")) &&
      [...byId("ring-hosts").querySelectorAll("tbody td")].map(cell => cell.textContent).join(" "));
    say("violation", await until(() => byId("violations").querySelector("tbody tr")) && byId("violations").querySelector("tbody td").textContent);
    say("is said", byId("no-violations").hidden);
  },
  runs: async () => {
    byId("tab-runs").click();
    await until(() => byId("runs").querySelectorAll("tbody tr").length === 2);
    say("runs", [...byId("runs").querySelectorAll("tbody tr")].map(r => r.children[2].textContent).sort().join(", "));
    say("report", byId("runs").querySelector("a").getAttribute("href"));
    for (const box of byId("runs").querySelectorAll("input")) box.click();
    byId("compare").click();
    say("compared", await until(() => /one and two|two and one/.test(byId("comparison").textContent)));
  },
  trip: async () => {
    say("ready", await until(() => byId("state").textContent.includes("live") && live.state.now > 1000));
    while (!byId("trips").textContent) await pause(2);
    say("tripped at", Date.now());
    say("cause", byId("trips").textContent);
    say("listed", await until(() => byId("test-events").querySelector(".bad")));
  },
  restart: async () => {
    await until(() => byId("state").textContent.includes("live") && moving.all.size > 3);
    const before = theme.pictures.size;
    say("ended", await until(() => byId("state").textContent.includes("has ended")) && shown().split(",")[0]);
    say("another", await until(() => byId("state").textContent.includes("another ring")));
    await search("extra.4");
    say("its words", rows().length);
    byId("tab-test").click();
    say("moves", await until(() => valueIn(find("Displacement, longitudinal")) !== "–"));
    say("keeps no figure of the first", theme.pictures.size === before && moving.all.size <= before);
  },
};
for (const name of asked) await questions[name]();
say("errors", document.body.dataset.error || "none");
return lines.join("\n");
