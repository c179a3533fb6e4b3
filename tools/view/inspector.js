// inspector: what is known of the particle that is picked: id, position, velocity, channels, forces by name.
"use strict";
view.inspector = (() => {
  const { el, clear } = view.dom;
  const { short } = view.numbers;

  const vector = (numbers, i, components, origin) => {
    const list = [];
    for (let c = 0; c < components; c++) list.push(numbers[i * components + c] + (origin ? origin[c] : 0));
    return list;
  };
  const said = (list, unit) => `${list.map((v) => short(v, 5)).join(", ")}${unit ? ` ${unit}` : ""}`;

  const make = (node, close) => {
    const show = (layer, index) => {
      clear(node).hidden = !layer;
      if (!layer) return;
      const { frame, source } = layer, rows = [["position", said(vector(frame.x, index, 3, source.origin), "m")]];
      for (const f of source.fields) {
        const numbers = frame.values[f.name];
        if (!numbers) continue;
        const v = vector(numbers, index, f.components);
        rows.push([f.label, said(v, f.unit) + (f.components === 3 ? ` (${short(Math.hypot(...v), 4)})` : "")]);
      }
      if (frame.pins.includes(index)) rows.push(["pinned", "yes"]);
      node.append(el("button", { class: "close", title: "let go (escape)", onclick: close }, "×"),
        el("h2", {}, `Particle ${frame.ids[index]}`), el("dl", {}, rows.map(([k, v]) => [el("dt", {}, k), el("dd", {}, v)])));
    };
    show(null);
    return { show };
  };

  return { make };
})();
