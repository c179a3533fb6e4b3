// inspector: what is known of the particle that is picked: id, position, velocity, channels, forces by name.
"use strict";
view.inspector = (() => {
  const { el, clear } = view.dom;
  const { within } = view.numbers;

  const vector = (numbers, i, components, origin) => {
    const list = [];
    for (let c = 0; c < components; c++) list.push(numbers[i * components + c] + (origin ? origin[c] : 0));
    return list;
  };
  const said = (list, error, unit) => `${list.map((v) => within(v, error)).join(", ")}${unit ? ` ${unit}` : ""}`;

  const make = (node, close) => {
    const show = (layer, index) => {
      clear(node).hidden = !layer;
      if (!layer) return;
      const { frame, source } = layer, rows = [["position", said(vector(frame.x, index, 3, source.origin), source.error.positions, "m")]];
      for (const f of source.fields) {
        const numbers = frame.values[f.name];
        if (!numbers) continue;
        const v = vector(numbers, index, f.components);
        rows.push([f.label, said(v, f.error, f.unit) + (f.components === 3 ? ` (${within(Math.hypot(...v), f.error)})` : "")]);
      }
      if (source.groups.length) rows.push(["group", source.groups[frame.groups[index]]]);
      if (frame.pins.includes(index)) rows.push(["pinned", "yes"]);
      node.append(el("button", { class: "close", title: "let go (escape)", onclick: close }, "×"),
        el("h2", {}, `Particle ${frame.ids[index]}`), el("dl", {}, rows.map(([k, v]) => [el("dt", {}, k), el("dd", {}, v)])));
    };
    show(null);
    return { show };
  };

  return { make };
})();
