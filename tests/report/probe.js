// Uses a page as a person does, and writes one line for each question that the page has to answer.
// In the frame of a narrow page it only measures.
(async () => {
  const lines = [];
  const say = (question, answer) => lines.push(`${question}: ${answer}`);
  const pause = () => new Promise(resume => setTimeout(resume, 150));
  const find = caption => [...document.querySelectorAll("figure")].find(f => f.querySelector("figcaption").firstChild.textContent === caption);
  const mouse = (area, type, x, y, buttons = 0) => {
    const box = area.getBoundingClientRect();
    area.dispatchEvent(new MouseEvent(type, { bubbles: true, cancelable: true, view: window, buttons,
      clientX: box.left + box.width * x, clientY: box.top + box.height * y }));
  };
  const hover = async (area, x, y) => {
    mouse(area, "mouseenter", x, y);
    mouse(area, "mousemove", x, y);
    await pause();
  };
  const drag = async (area, from, to) => {
    await hover(area, ...from);
    mouse(area, "mousedown", ...from, 1);
    mouse(area, "mousemove", ...to, 1);
    await pause();
    mouse(area, "mouseup", ...to);
    await pause();
  };
  const picture = f => f.querySelector("canvas").toDataURL();
  // The picture when no layout changes it any more: a busy host draws late.
  const settled = async f => {
    for (let k = 0, last = ""; k < 20; ++k) {
      const now = picture(f);
      if (now === last) return now;
      last = now;
      await pause();
    }
    return picture(f);
  };
  const told = f => (f.querySelector(".tip").hidden ? "nothing" : f.querySelector(".tip").textContent);

  const fits = (view, name) => {
    const texts = [...view.document.querySelectorAll(".card, .card *")];
    say(`${name} cards fit`, texts.length > 0 && texts.every(t => t.scrollWidth <= t.clientWidth + 1 || getComputedStyle(t).display === "inline"));
    say(`${name} page fits`, view.document.documentElement.scrollWidth <= view.innerWidth);
  };

  const askLoops = async () => {
    const f = find(probed.loops), area = f.querySelector(".u-over"), first = await settled(f);
    await hover(area, 0.5, 0.5);
    say("loop tells", told(f));
    await drag(area, [0.2, 0.2], [0.6, 0.7]);
    say("loop zooms", picture(f) !== first && !f.querySelector(".reset").hidden);
    f.querySelector(".reset").click();
    await pause();
    say("loop zooms out", picture(f) === first && f.querySelector(".reset").hidden);
    const button = f.querySelector("button.curve");
    button.click();
    await pause();
    say("legend hides", picture(f) !== first && button.getAttribute("aria-pressed") === "false");
    button.click();
    await pause();
    say("legend shows", picture(f) === first && button.getAttribute("aria-pressed") === "true");
  };
  // Moves over the figure until it tells of the mark of an operator's change.
  const askMark = async f => {
    for (let at = 0.02; at < 1; at += 0.002) {
      mouse(f.querySelector(".u-over"), "mousemove", at, 0.5);
      if (told(f).includes(" → ")) break;
    }
    say("mark tells", told(f));
  };
  const askTime = async () => {
    const f = find(probed.time), other = find(probed.beside), first = [await settled(f), await settled(other)];
    await hover(f.querySelector(".u-over"), 0.5, 0.5);
    say("time tells", told(f));
    say("beside it tells", told(other));
    if (probed.mark) await askMark(other);
    await drag(f.querySelector(".u-over"), [0.2, 0.5], [0.6, 0.5]);
    say("times zoom together", picture(f) !== first[0] && picture(other) !== first[1]);
    other.querySelector(".u-over").dispatchEvent(new MouseEvent("dblclick", { bubbles: true }));
    await pause();
    say("times zoom out", picture(f) === first[0] && picture(other) === first[1]);
  };
  const askChart = async () => {
    const f = find(probed.chart);
    mouse(f.querySelector(".picture"), "mousemove", 0.4, 0.5);
    say("chart tells", told(f));
  };
  // Distances of colours (CIELAB) to eyes without one kind of cones, after Machado et al. 2009.
  const EYES = {
    protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
    tritanopia: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
  };
  const times = (matrix, v) => matrix.map(row => row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
  const seen = (name, eye) => {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    const linear = [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16) / 255)
      .map(c => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
    const rgb = times(eye, linear).map(c => Math.min(1, Math.max(0, c)));
    const [x, y, z] = times([[0.4339, 0.3762, 0.1899], [0.2126, 0.7152, 0.0722], [0.0177, 0.1095, 0.8729]], rgb)
      .map(t => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116));
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
  };
  const askColours = name => {
    for (const [a, b] of probed.pairs)
      for (const [kind, eye] of Object.entries(EYES)) {
        const [p, q] = [seen(a, eye), seen(b, eye)];
        const distance = Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
        if (!(distance > 20)) say("alike", `${a} and ${b} to ${kind} on ${name}: ${distance.toFixed(0)}`);
      }
  };
  const askPaper = async () => {
    const ground = () => getComputedStyle(document.body).backgroundColor;
    const f = find(probed.loops), screen = picture(f);
    say("screen", ground());
    askColours("the screen");
    dispatchEvent(new Event("beforeprint"));
    await pause();
    const widths = [...document.querySelectorAll(".uplot")].map(u => u.offsetWidth);
    say("paper", ground());
    askColours("paper");
    say("paper fits", widths.length > 0 && Math.max(...widths) <= 700);
    dispatchEvent(new Event("afterprint"));
    await pause();
    say("screen again", picture(f) === screen);
  };
  const askNarrow = async () => {
    const frame = document.createElement("iframe");
    frame.style.cssText = "position: fixed; top: 0; left: 0; width: 400px; height: 800px; border: 0";
    frame.src = location.href;
    const loaded = new Promise(resume => { frame.onload = resume; });
    document.body.append(frame);
    await loaded;
    fits(frame.contentWindow, "narrow");
    frame.remove();
  };

  if (window !== top) return;
  const pre = document.createElement("pre");
  try {
    for (const fold of document.querySelectorAll("details")) fold.open = true;
    await pause();
    const labels = [...document.querySelectorAll("figure")].map(f => f.getAttribute("aria-label") || "");
    say("summaries", labels.length > 0 && labels.every(label => label.endsWith(".")));
    fits(window, "wide");
    await askLoops();
    await askTime();
    if (probed.chart) await askChart();
    await askPaper();
    await askNarrow();
  } catch (error) {
    say("failed", error.stack);
  }
  pre.id = "probe";
  pre.textContent = `\n${lines.join("\n")}\n`;
  document.body.prepend(pre);
})();
