
// The ring: nodes, other hosts, violations of ownership, events.
(() => {
  const { byId } = plots;
  const ms = value => (value == null ? "–" : (value * 1000).toFixed(2));

  // A gateway writes the ages and delays of the nodes of other hosts, and the clocks of these.
  const hosts = () => {
    const rows = [];
    for (const word of live.state.map.words) {
      const [, host, node] = /^gateway\.([^.]+)\.age\.(.+)$/.exec(word.name) || [];
      if (node) rows.push([node, host, ms(live.value(word.name)), ms(live.value(`gateway.${host}.delay.${node}`))]);
    }
    byId("hosts-section").hidden = rows.length === 0;
    if (rows.length) testPage.fill("ring-hosts", ["updates of", "reach host", "age of the words [ms]", "delay [ms]"], rows);
  };
  const violations = look => {
    byId("no-violations").hidden = look.violations.length > 0;
    if (!look.violations.length) return byId("violations").replaceChildren();
    return testPage.fill("violations", ["word", "owner", "stored by", "value", "times", "first"],
      look.violations.map(v => [v.word, v.owner, v.writers, v.value, v.count, `${v.time_s.toFixed(3)} s`]), () => ["bad"]);
  };
  live.on("status", message => {
    if (!message.look || byId("page-ring").hidden) return;
    testPage.nodes("ring-nodes", message.look);
    testPage.events("ring-events", message.look);
    violations(message.look);
    hosts();
  });
})();
