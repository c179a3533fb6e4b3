// colours: numbers to colours by the maps that pictures have (plugins/common/colour), the colours of things, the legend.
"use strict";
view.colours = (() => {
  const { el, clear } = view.dom;
  const tables = {}; // name -> 512 x (red, green, blue, 255)

  const things = {}; // name -> [red, green, blue], 0 to 1

  // shared: what the page's data have of it (tools/common/view/shared.lua)
  const load = async (shared) => {
    for (const [name, id] of Object.entries(shared.maps))
      tables[name] = await view.codec.unpack(document.getElementById(id).textContent);
    for (const [name, colour] of Object.entries(shared.things)) {
      things[name] = colour.map((v) => v / 255);
      document.documentElement.style.setProperty(`--${name.replaceAll(" ", "-")}`, `rgb(${colour.join(" ")})`);
    }
    Object.assign(view.colours, { solids: shared.solids, radii: shared.radii, groups: shared.groups.map((colour) => colour.map((v) => v / 255)) });
  };

  // The colour of a thing; by night, where it has another one then, that.
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const thing = (name) => dark.matches && things[`${name} at night`] || things[name];

  const range = (low, high, map) => {
    const most = Math.max(Math.abs(low), Math.abs(high)) || 1;
    if (!(low <= high)) return { low: 0, high: 1, map };
    if (map === "diverging") return { low: -most, high: most, map };
    return high > low ? { low, high, map } : { low: low - most * 1e-3, high: high + most * 1e-3, map };
  };

  // The range of numbers that the colours of a map stand for; around zero where it has a middle. lowest, highest: of all numbers;
  // below, above: some saturate, they lie beyond that end by more than two neighbouring colours tell apart.
  const scale = (low, high, map, lowest = low, highest = high) => {
    const s = range(low, high, map), step = (s.high - s.low) / (tables[map].length / 4);
    return { ...s, below: lowest < s.low - step, above: highest > s.high + step };
  };

  // Red, green and blue, 0 to 1, of each number into `into`; a number that is none is grey.
  const paint = (numbers, s, into) => {
    const table = tables[s.map], size = table.length / 4, factor = size / (s.high - s.low);
    for (let i = 0; i < numbers.length; i++) {
      const place = (numbers[i] - s.low) * factor;
      if (Number.isNaN(place)) { into[3 * i] = into[3 * i + 1] = into[3 * i + 2] = 0.5; continue; }
      const k = 4 * Math.min(Math.max(Math.floor(place), 0), size - 1);
      into[3 * i] = table[k] / 255;
      into[3 * i + 1] = table[k + 1] / 255;
      into[3 * i + 2] = table[k + 2] / 255;
    }
  };

  // The colour of a group; there are eight, in turn.
  const group = (k) => view.colours.groups[k % view.colours.groups.length];

  // Of each particle that of its group.
  const paintGroups = (groups, into) => groups.forEach((k, i) => into.set(group(k), 3 * i));

  // names: of the groups; used: those that are there
  const groupLegend = (node, names, used) => {
    clear(node).hidden = false;
    const MOST = 12, shown = used.slice(0, MOST), entry = (k) => {
      const sample = el("i", {});
      sample.style.background = `rgb(${group(k).map((v) => Math.round(255 * v)).join(",")})`;
      return el("span", { class: "legend-group" }, sample, names[k]);
    };
    node.append(el("div", { class: "legend-title" }, "group"), el("div", { class: "legend-groups" }, shown.map(entry),
      used.length > MOST ? el("span", {}, `and ${used.length - MOST} more`) : null));
  };

  // Ends beyond which numbers lie are pointed, in the colour that those have.
  const bar = ({ map, below, above }) => {
    const table = tables[map], stops = [];
    for (let k = 0; k <= 32; k++) {
      const i = 4 * Math.round(k / 32 * (table.length / 4 - 1));
      stops.push(`rgb(${table[i]},${table[i + 1]},${table[i + 2]}) ${(100 * k / 32).toFixed(2)}%`);
    }
    const strip = el("div", { class: "legend-bar" });
    strip.style.background = `linear-gradient(90deg, ${stops.join(", ")})`;
    const point = (side, on, k) => {
      const node = el("div", { class: `legend-point ${side}`, hidden: !on });
      node.style.background = `rgb(${table.slice(k, k + 3).join(",")})`;
      return node;
    };
    return el("div", { class: "legend-row" }, point("below", below, 0), strip, point("above", above, table.length - 4));
  };

  const legend = (node, title, s) => {
    clear(node).hidden = !title;
    if (!title) return;
    const { short } = view.numbers;
    node.append(el("div", { class: "legend-title" }, title), bar(s), el("div", { class: "legend-ends" },
      el("span", {}, `${s.below ? "≤ " : ""}${short(s.low, 3)}`), el("span", {}, short((s.low + s.high) / 2, 3)),
      el("span", {}, `${s.above ? "≥ " : ""}${short(s.high, 3)}`)));
  };

  return { load, thing, scale, paint, legend, group, paintGroups, groupLegend };
})();
