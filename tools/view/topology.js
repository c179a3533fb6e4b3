// topology: what a frame's edges and triangles leave to be drawn beside a surface: edges that belong to no surface,
// particles that belong to neither, and pins that hold something. It is found once for each topology.
"use strict";
view.topology = (() => {
  const find = (frame) => {
    const { n, edges, triangles, pins } = frame;
    const onSurface = new Uint8Array(n), joined = new Uint8Array(n), pinned = new Uint8Array(n), holds = new Uint8Array(n);
    for (const i of triangles) onSurface[i] = joined[i] = 1;
    for (const i of edges) joined[i] = 1;
    for (const i of pins) pinned[i] = 1;
    const loose = [];
    const meet = (i, j) => {
      if (pinned[i] && !pinned[j]) holds[i] = 1;
      if (pinned[j] && !pinned[i]) holds[j] = 1;
    };
    for (let e = 0; e < edges.length; e += 2) {
      const i = edges[e], j = edges[e + 1];
      if (!onSurface[i] || !onSurface[j]) loose.push(i, j);
      meet(i, j);
    }
    for (let t = 0; t < triangles.length; t += 3)
      for (let c = 0; c < 3; c++) meet(triangles[t + c], triangles[t + (c + 1) % 3]);
    const alone = [];
    for (let i = 0; i < n; i++) if (!joined[i]) alone.push(i);
    return { edges: Uint32Array.from(loose), alone: Uint32Array.from(alone),
      pins: pins.filter((i) => holds[i] || !joined[i]), surface: triangles.length > 0 };
  };

  const known = new Map(); // a topology's number, of one source, to what was found
  const of = (source, frame) => {
    if (!known.has(source)) known.set(source, { number: undefined });
    const last = known.get(source);
    if (last.number !== frame.topology || last.n !== frame.n || last.of !== frame.edges)
      known.set(source, { number: frame.topology, n: frame.n, of: frame.edges, ...find(frame) });
    return known.get(source);
  };

  return { of };
})();
