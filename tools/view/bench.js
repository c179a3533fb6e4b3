// bench: speed against error as `hooke bench` measured it: one line a method, a dot a run; the pointer tells which.
"use strict";
view.bench = (() => {
  const { el, svg } = view.dom;
  const { short } = view.numbers;
  const W = 640, H = 380, LEFT = 64, RIGHT = 96, TOP = 14, BOTTOM = 44;

  const errorOf = (row, metric) => row[metric === "x" || metric === "v" ? `error_${metric}_rms` : metric === "energy"
    ? "energy_drift" : `error_${metric}`];

  const decades = (low, high) => {
    const list = [];
    for (let e = Math.ceil(Math.log10(low)); e <= Math.floor(Math.log10(high)); e++) list.push(10 ** e);
    return list;
  };

  const described = (row, error) => [row.integrator, row.dt ? `step ${short(row.dt)} s` : null, row.tol ? `tolerance ${short(row.tol)}` : null,
    row.substeps ? `${row.substeps} substeps` : null, `error ${short(error)}`, `cost ${short(row.wall_s)} s`, row.verdict]
    .filter(Boolean).join(" · ");

  const make = (bench) => {
    const points = bench.rows.map((row) => ({ row, error: errorOf(row, bench.metric), cost: row.wall_s }))
      .filter((p) => p.error > 0 && p.cost > 0);
    if (!points.length) return null;
    const span = (list) => [Math.min(...list) / 1.5, Math.max(...list) * 1.5];
    const [e0, e1] = span(points.map((p) => p.error)), [c0, c1] = span(points.map((p) => p.cost));
    const place = (v, low, high, from, to) => from + Math.log(v / low) / Math.log(high / low) * (to - from);
    const x = (v) => place(v, e0, e1, LEFT, W - RIGHT), y = (v) => place(v, c0, c1, H - BOTTOM, TOP);
    const chart = svg("svg", { class: "bench-chart", viewBox: `0 0 ${W} ${H}`, role: "img", "aria-label": "speed against error" });
    for (const v of decades(e0, e1)) chart.append(svg("line", { class: "grid", x1: x(v), x2: x(v), y1: TOP, y2: H - BOTTOM }),
      svg("text", { x: x(v), y: H - BOTTOM + 16, "text-anchor": "middle" }, short(v)));
    for (const v of decades(c0, c1)) chart.append(svg("line", { class: "grid", x1: LEFT, x2: W - RIGHT, y1: y(v), y2: y(v) }),
      svg("text", { x: LEFT - 8, y: y(v) + 4, "text-anchor": "end" }, short(v)));
    const unit = { x: "RMS error of the positions, m", v: "RMS error of the velocities, m/s", energy: "energy drift, relative" };
    chart.append(svg("text", { x: (LEFT + W - RIGHT) / 2, y: H - 8, "text-anchor": "middle" }, unit[bench.metric] || `error of ${bench.metric}`),
      svg("text", { transform: `translate(14 ${(TOP + H - BOTTOM) / 2}) rotate(-90)`, "text-anchor": "middle" }, "wall time, s"));
    const said = el("p", { class: "told", role: "status" }, bench.recommendation && bench.recommendation.text || "");
    const rest = said.textContent;
    const methods = [...new Set(points.map((p) => p.row.integrator))];
    methods.forEach((name, k) => {
      const own = points.filter((p) => p.row.integrator === name).sort((a, b) => a.error - b.error);
      const line = svg("g", { class: `method line-${k % 6}` }, svg("path", { class: "line",
        d: own.map((p, j) => `${j ? "L" : "M"}${x(p.error).toFixed(1)} ${y(p.cost).toFixed(1)}`).join("") }));
      for (const p of own) line.append(svg("circle", { class: p.row.pareto ? "dot best" : "dot", r: p.row.pareto ? 5 : 3.5,
        cx: x(p.error), cy: y(p.cost), tabindex: 0, onpointerenter: () => { said.textContent = described(p.row, p.error); },
        onfocus: () => { said.textContent = described(p.row, p.error); }, onpointerleave: () => { said.textContent = rest; } },
      svg("title", {}, described(p.row, p.error))));
      const last = own[0];
      line.append(svg("text", { x: x(last.error) - 8, y: y(last.cost) - 8, class: "label" }, name));
      chart.append(line);
    });
    return el("section", { class: "bench" }, el("h2", {}, "Speed against error"), chart, said);
  };

  return { make };
})();
