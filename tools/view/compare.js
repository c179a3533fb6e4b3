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

  // m, for each particle of `a` the distance to the one of the same id in `b`; none: NaN.
  const distances = (a, b, originA, originB) => {
    const list = new Float32Array(a.n).fill(NaN);
    const d = originA.map((v, c) => v - originB[c]);
    for (let i = 0, k = 0; i < a.n; i++) {
      while (k < b.n && b.ids[k] < a.ids[i]) k++;
      if (k < b.n && b.ids[k] === a.ids[i])
        list[i] = Math.hypot(a.x[3 * i] - b.x[3 * k] + d[0], a.x[3 * i + 1] - b.x[3 * k + 1] + d[1], a.x[3 * i + 2] - b.x[3 * k + 2] + d[2]);
    }
    return list;
  };

  return { nearest, distances };
})();
