
// The mismatch budget: response of test, simulation and improved simulation, and the share of each part.
const budget = (() => {
  const { data, unpack, el, byId } = plots;
  const { percent, share } = quantities;
  const { v, hide, tableOf } = verdict;
  const AXIS = { long: "longitudinal", lat: "lateral" };
  const PART = {
    tracking: "tracking of the machine", force: "measurement of the force", specimen: "specimen",
    machine: "friction and inertia of the machine", numerical: "numerical side", host: "lateness of the host",
  };

  const pictures = () => {
    const group = figures.group("budget");
    for (const r of data.responses) {
      const time = Array.from(unpack(r.time)), mm = packed => Array.from(unpack(packed)).map(x => 1e3 * x);
      const test = mm(r.measured);
      const models = [
        { label: "simulation", color: "before", dash: theme.DASH.before, width: 1.3, y: mm(r.simulated) },
        { label: "all parts as identified", color: "after", width: 1.3, y: mm(r.improved) },
      ];
      figures.lines("budget-curves", `Response, ${AXIS[r.axis]}`, time, "time [s]", "displacement [mm]",
        [{ label: "test", color: "measured", width: 3, y: test }, ...models], { group });
      figures.lines("budget-curves", `Difference from the test, ${AXIS[r.axis]}`, time, "time [s]", "difference [mm]",
        models.map(m => ({ ...m, y: m.y.map((y, i) => y - test[i]) })), { group, height: 180 });
    }
  };

  const shares = () => {
    const axes = v.budget.axes;
    const rows = Object.keys(PART).map(part => [PART[part], ...axes.map(a => share(a.shares[part]))]);
    rows.push(["remainder", ...axes.map(a => share(a.remainder))]);
    rows.push(["sum", ...axes.map(a => share(Object.values(a.shares).reduce((sum, s) => sum + s, a.remainder)))]);
    rows.push(["difference of the simulation, rms", ...axes.map(a => percent(a.difference_before))]);
    rows.push(["difference with all parts as identified, rms", ...axes.map(a => percent(a.difference_after))]);
    rows.push(["displacement less command, rms", ...axes.map(a => percent(a.tracking_nrms))]);
    rows.push(["delay of the transfer system", ...axes.map(a => `${(1e3 * a.transfer_system.delay_s).toFixed(1)} ms`)]);
    rows.push(["dead band of the transfer system",
      ...axes.map(a => `${(1e3 * a.transfer_system.parameters.dead_band.value).toFixed(2)} mm`)]);
    rows.push(["its error on unseen motion", ...axes.map(a => percent(a.held_out_nrms ?? a.transfer_system.nrms))]);
    byId("budget-table").append(tableOf(["part", ...axes.map(a => AXIS[a.axis])], rows, [0]));
  };

  const draw = () => {
    if (!v.budget) return hide("budget");
    pictures();
    shares();
  };

  return { draw };
})();
