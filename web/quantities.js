
// Formats numbers for reading: SI prefixes, and as many digits as their intervals justify.
const quantities = (() => {
  const PREFIXES = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"]];
  const NEVER_LARGE = "m s", NEVER_SMALL = "Hz";

  // The prefix belongs to a unit's first factor, if that has no exponent: 4.2e6 N/m is 4.2 MN/m.
  const scaled = (unit, size) => {
    const bare = unit === "-" ? "" : unit;
    const first = /^(N|Pa|J|W|V|A|Hz|m|s)(?![A-Za-z0-9²³^])/.exec(bare);
    if (!first || !(size > 0) || !Number.isFinite(size)) return { factor: 1, unit: bare };
    const usable = PREFIXES.filter(([f]) =>
      !(f > 1 && NEVER_LARGE.split(" ").includes(first[1])) && !(f < 1 && first[1] === NEVER_SMALL));
    const [f, prefix] = usable.find(([f]) => size >= f * 0.99999) || usable[usable.length - 1];
    return { factor: 1 / f, unit: prefix + bare };
  };

  const SUPERSCRIPT = "⁰¹²³⁴⁵⁶⁷⁸⁹";
  const raised = n => (n < 0 ? "⁻" : "") + String(Math.abs(n)).replace(/\d/g, d => SUPERSCRIPT[d]);
  const decimals = (value, count) => {
    const text = value.toFixed(Math.max(0, Math.min(12, count)));
    return text.replace("-", "−").replace(/\B(?=(\d{3})+(?!\d))(?<!\.\d*)/g, "\u202f");
  };
  const magnitude = value => Math.floor(Math.log10(Math.abs(value)));
  const number = (value, digits = 3) => {
    if (value == null) return "–";
    if (value === 0) return "0";
    const power = magnitude(value);
    if (power >= 6 || power < -4) return `${decimals(value / 10 ** power, digits - 1)}·10${raised(power)}`;
    return decimals(value, digits - 1 - power);
  };
  // Without trailing zeros: 0.5 instead of 0.500.
  const brief = (value, digits = 3) => number(value, digits).replace(/(\.\d*?)0+(?=$|·)/, "$1").replace(/\.(?=$|·)/, "");
  const share = value => {
    if (value == null) return "–";
    const tiny = value !== 0 && Math.abs(value) < 0.01;
    return `${tiny ? (value > 0 ? "< 1" : "> −1") : decimals(value * 100, 0)}\u2009%`;
  };
  const percent = value => {
    if (value == null) return "–";
    const p = value * 100, size = Math.abs(p);
    return `${size > 0 && size < 0.1 ? number(p, 2) : decimals(p, size < 10 ? 2 : size < 100 ? 1 : 0)}\u2009%`;
  };

  // Value and interval in one unit, to two digits of the interval's half width.
  const estimate = (value, [low, high], unit) => {
    const size = Math.max(...[value, low, high].filter(v => v != null).map(Math.abs), 0);
    const s = scaled(unit, size);
    const half = (high - low) / 2 * s.factor;
    const tiny = size * s.factor < 1e-4 || size * s.factor >= 1e6;
    const show = v => {
      if (v == null) return "–";
      if (tiny || !(half > 0)) return number(v * s.factor, 4);
      return decimals(v * s.factor, 1 - magnitude(half));
    };
    return { value: show(value), low: show(low), high: show(high), unit: s.unit };
  };

  // For "displacement [m]" with values up to 0.2: the factor, and "displacement [mm]".
  const axis = (label, size) => {
    const parts = /^(.*?)\s*\[(.*)\]$/.exec(label) || [null, label, ""];
    const s = scaled(parts[2], size);
    return { factor: s.factor, unit: s.unit, label: s.unit ? `${parts[1]} [${s.unit}]`.trim() : parts[1] };
  };
  const largest = values => values.reduce((most, v) => (Math.abs(v) > most ? Math.abs(v) : most), 0);

  // Round numbers between two limits.
  const ticks = (low, high, most) => {
    const raw = (high - low) / most;
    if (!(raw > 0)) return [low];
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 5, 10].find(m => m * power >= raw * 0.999);
    const list = [];
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) list.push(i * step);
    return list;
  };
  const tick = (value, list) => {
    const step = list.length > 1 ? Math.abs(list[1] - list[0]) : Math.abs(value) || 1;
    let places = 0;
    while (places < 9 && Math.abs(step * 10 ** places - Math.round(step * 10 ** places)) > 1e-6 * step * 10 ** places) places++;
    return decimals(value, places);
  };

  // Joins intervals that touch.
  const joined = intervals => intervals.reduce((list, [a, b]) => {
    const last = list[list.length - 1];
    if (last && a <= last[1] * (1 + 1e-6)) last[1] = Math.max(last[1], b);
    else list.push([a, b]);
    return list;
  }, []);
  const ranges = (intervals, unit) => {
    const list = joined([...intervals].sort((p, q) => p[0] - q[0]));
    const shown = list.slice(0, 4).map(([a, b]) => `${brief(a)} to ${brief(b)}`);
    return `${shown.join(", ")} ${unit}${list.length > 4 ? ` (and ${list.length - 4} more)` : ""}`;
  };

  return { decimals, brief, share, joined, ranges, scaled, number, percent, estimate, axis, largest, ticks, tick };
})();
