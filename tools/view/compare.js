// compare: two runs at the same time: which frame of one belongs to which of the other, and how far their particles are
// apart.
"use strict";
view.compare = (() => {
  // The frame of the source nearest to time t.
  const nearest = (source, t) => {
    let low = 0, high = source.count - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if ((source.time(middle) + source.time(middle + 1)) / 2 < t) low = middle + 1; else high = middle;
    }
    return low;
  };

  const rise = (ids) => ids.every((id, k) => k === 0 || id > ids[k - 1]);

  // For each of the ids in order its place in a list; -1: it is not there. A run under way may have renumbered its
  // particles, so that ids do not rise.
  const finder = (a, b) => {
    if (!rise(a) || !rise(b)) {
      const place = new Map(Array.from(b, (id, k) => [id, k]));
      return (id) => place.get(id) ?? -1;
    }
    let k = 0;
    return (id) => {
      while (k < b.length && b[k] < id) k++;
      return k < b.length && b[k] === id ? k : -1;
    };
  };

  // m, for each particle of `a` the distance to the one of the same id in `b`; none: NaN.
  const distances = (a, b, originA, originB) => {
    const list = new Float32Array(a.n).fill(NaN), find = finder(a.ids, b.ids);
    const d = originA.map((v, c) => v - originB[c]);
    for (let i = 0; i < a.n; i++) {
      const k = find(a.ids[i]);
      if (k >= 0)
        list[i] = Math.hypot(a.x[3 * i] - b.x[3 * k] + d[0], a.x[3 * i + 1] - b.x[3 * k + 1] + d[1], a.x[3 * i + 2] - b.x[3 * k + 2] + d[2]);
    }
    return list;
  };

  return { nearest, distances };
})();
