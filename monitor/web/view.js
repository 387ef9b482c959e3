
// The frame of the page: tabs, time, keys, the state of ring and connection.
(() => {
  const { byId } = plots;
  const TABS = ["test", "signals", "ring", "runs"];
  const DEFAULT_SPAN = 20000;
  const state = byId("state");

  const open = name => {
    for (const tab of TABS) {
      byId(`tab-${tab}`).setAttribute("aria-selected", String(tab === name));
      byId(`tab-${tab}`).tabIndex = tab === name ? 0 : -1;
      byId(`page-${tab}`).hidden = tab !== name;
    }
    byId("time-bar").hidden = !["test", "signals"].includes(name);
    location.hash = name;
    if (name === "runs") runsPage.read();
    requestAnimationFrame(() => { moving.watchVisible(); live.draw(); });
  };
  const current = () => TABS.find(tab => !byId(`page-${tab}`).hidden);
  TABS.forEach((tab, i) => {
    byId(`tab-${tab}`).addEventListener("click", () => open(tab));
    byId(`tab-${tab}`).addEventListener("keydown", event => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      event.stopPropagation();
      const next = TABS[(i + step + TABS.length) % TABS.length];
      open(next);
      byId(`tab-${next}`).focus();
    });
  });

  // --- time ---------------------------------------------------------------------------------------
  const showView = () => {
    const { span, to } = live.view, [from, end] = live.shown();
    byId("pause").textContent = to === null ? "pause" : "live";
    byId("pause").setAttribute("aria-pressed", String(to !== null));
    if ([...byId("span").options].some(o => +o.value === span)) byId("span").value = String(span);
    else byId("span").selectedIndex = -1;
    byId("scroll").value = to === null || !live.state.now ? 1000 : Math.round(to / live.state.now * 1000);
    const kind = to !== null ? "paused" : live.state.status?.live === false ? "ended" : "live";
    byId("shown").textContent = `${kind}, ${Math.max(0, from).toFixed(2)} to ${Math.max(0, end).toFixed(2)} s`;
  };
  byId("pause").addEventListener("click", live.pause);
  byId("back").addEventListener("click", () => live.scroll(-0.25));
  byId("forward").addEventListener("click", () => live.scroll(0.25));
  byId("closer").addEventListener("click", () => live.zoom(0.5));
  byId("wider").addEventListener("click", () => live.zoom(2));
  byId("span").addEventListener("change", () => live.show(+byId("span").value, live.view.to));
  byId("scroll").addEventListener("input", () => {
    const share = +byId("scroll").value / 1000;
    live.show(live.view.span, share >= 1 ? null : share * live.state.now);
  });
  live.on("view", showView);
  live.on("values", showView);
  live.on("status", showView);

  const KEYS = {
    " ": live.pause, ArrowLeft: () => live.scroll(-0.25), ArrowRight: () => live.scroll(0.25), "+": () => live.zoom(0.5), "-": () => live.zoom(2),
    l: () => live.show(DEFAULT_SPAN, null), "/": () => { open("signals"); byId("search").focus(); },
  };
  TABS.forEach((tab, i) => { KEYS[String(i + 1)] = () => open(tab); });
  document.addEventListener("keydown", event => {
    const isTyping = /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName);
    const isPressing = event.target.tagName === "BUTTON" && event.key === " ";
    if (isTyping || isPressing || event.ctrlKey || event.metaKey || event.altKey || !KEYS[event.key]) return;
    event.preventDefault();
    KEYS[event.key]();
  });

  // --- state --------------------------------------------------------------------------------------
  const showState = () => {
    const { status, map, connected } = live.state;
    const says = (text, kind) => {
      if (state.textContent !== text) state.textContent = text;
      state.className = `state ${kind}`;
    };
    if (!connected) return says("no connection to rths view; trying again. It may have ended, or has too many pages", "bad");
    if (!status) return says("connected", "");
    if (!status.live) return says(status.note, map ? "bad" : "");
    return says(`${status.epoch > 1 ? `another ring of this name, number ${status.epoch} of this page; ` : ""}map ${map?.map ?? ""}, live`, "good");
  };
  live.on("connection", showState);
  live.on("status", showState);
  live.on("map", map => {
    byId("title").textContent = map.ring;
    document.title = `${map.ring} · rths view`;
    requestAnimationFrame(moving.watchVisible);
    showState();
  });
  addEventListener("resize", () => moving.watchVisible());

  open(TABS.includes(location.hash.slice(1)) ? location.hash.slice(1) : "test");
  live.connect();
  plots.done();
})();
