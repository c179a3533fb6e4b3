// sight: what hides what from the eye. Points and corners are in clip coordinates (x, y, w), a linear image of the space around the
// eye with the eye at 0; there the line of sight to p meets the triangle a, b, c where det(p, b, c), det(p, c, a) and det(p, a, b)
// have one sign, at t p with t = det(a, b, c) / their sum (Moller and Trumbore, J. Graphics Tools 2(1), 1997, by Cramer's rule).
// How opaque an obstacle is that hides the motion is as in pictures (plugins/common/occlusion).
"use strict";
view.sight = (() => {
  const FRONT = 1, BACK = -1, BOTH = 0; // of triangles, which sides are drawn
  const POINTS = 128, LEAST = 16, TESTS = 1 << 17; // of a sample; lines of sight times triangles of one thing, some 2 ms

  // The rows of a matrix that make x, y and w of places.
  const rows = (m) => [0, 1, 3].map((r) => [m[r], m[4 + r], m[8 + r], m[12 + r]]);

  const clip = (matrix, x, count) => {
    const [h, v, w] = rows(matrix.elements), out = new Float64Array(3 * count);
    for (let i = 0; i < 3 * count; i += 3) {
      const a = x[i], b = x[i + 1], c = x[i + 2];
      out[i] = h[0] * a + h[1] * b + h[2] * c + h[3];
      out[i + 1] = v[0] * a + v[1] * b + v[2] * c + v[3];
      out[i + 2] = w[0] * a + w[1] * b + w[2] * c + w[3];
    }
    return out;
  };

  const matrixOf = (camera, object) => new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse)
    .multiply(object.matrixWorld);

  // Where, as a share of the way to the point that begins at p[i], its line of sight meets the triangle; Infinity: nowhere.
  const meets = (p, i, q, a, b, c, side) => {
    const px = p[i], py = p[i + 1], pw = p[i + 2];
    const ax = q[a], ay = q[a + 1], aw = q[a + 2], bx = q[b], by = q[b + 1], bw = q[b + 2], cx = q[c], cy = q[c + 1], cw = q[c + 2];
    const u = px * (by * cw - bw * cy) + py * (bw * cx - bx * cw) + pw * (bx * cy - by * cx);
    const v = px * (cy * aw - cw * ay) + py * (cw * ax - cx * aw) + pw * (cx * ay - cy * ax);
    if (u * v < 0) return Infinity;
    const w = px * (ay * bw - aw * by) + py * (aw * bx - ax * bw) + pw * (ax * by - ay * bx), sum = u + v + w;
    if (u * w < 0 || v * w < 0 || sum === 0) return Infinity;
    const volume = ax * (by * cw - bw * cy) + ay * (bw * cx - bx * cw) + aw * (bx * cy - by * cx);
    if (volume * side < 0) return Infinity;
    const t = volume / sum;
    return t > 0 ? t : Infinity;
  };

  // Triangles that may hide what is within `reach` of the place (x, y) of a view that goes from -1 to 1.
  class Blockers {
    constructor(x, y, reach) { Object.assign(this, { x, y, reach, parts: [] }); }

    // thing: { x, count, index (null: corners in turn), object, side }
    add(camera, thing) {
      const q = clip(matrixOf(camera, thing.object), thing.x, thing.count), { index } = thing, near = [];
      const corners = index ? index.length : thing.count;
      for (let k = 0; k + 2 < corners; k += 3) {
        const t = [0, 1, 2].map((c) => 3 * (index ? index[k + c] : k + c));
        if (this.near(q, t, 0, this.x, this.reach[0]) && this.near(q, t, 1, this.y, this.reach[1])) near.push(...t);
      }
      this.parts.push({ thing, q, near });
    }

    // Whether the triangle is seen there in this direction; one that reaches behind the eye may be seen anywhere.
    near(q, t, c, at, reach) {
      let low = Infinity, high = -Infinity;
      for (const k of t) {
        if (!(q[k + 2] > 0)) return q[k + 2] <= 0; // a corner that is no number belongs to no triangle that is drawn
        low = Math.min(low, q[k + c] / q[k + 2]);
        high = Math.max(high, q[k + c] / q[k + 2]);
      }
      return low <= at + reach && high >= at - reach;
    }

    // Whether something is in front of the point; its own triangles, which have it as their corner `index` of `thing`, are not. The
    // margin is that of recorded places, 1.3e-5 of the motion's extent, for an eye that is as near as a tenth of that.
    hide(p, x, index) {
      for (const { thing, q, near } of this.parts) {
        const own = thing.x === x ? 3 * index : -1;
        for (let k = 0; k < near.length; k += 3)
          if (near[k] !== own && near[k + 1] !== own && near[k + 2] !== own
            && meets(p, 0, q, near[k], near[k + 1], near[k + 2], thing.side) < 1 - 1.3e-4) return true;
      }
      return false;
    }
  }

  // The middle of a view that has both, and half its size: of a ball around the origin of an object; null: not all is before the eye.
  const box = (matrix, { center, radius }) => {
    const x = new Float64Array(24);
    for (let k = 0; k < 8; k++) ["x", "y", "z"].forEach((name, c) => { x[3 * k + c] = center[name] + (k >> c & 1 ? radius : -radius); });
    const q = clip(matrix, x, 8), low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    for (let k = 0; k < 24; k += 3) {
      if (!(q[k + 2] > 0)) return null;
      for (let c = 0; c < 2; c++) {
        low[c] = Math.min(low[c], q[k + c] / q[k + 2]);
        high[c] = Math.max(high[c], q[k + c] / q[k + 2]);
      }
    }
    return { low, high };
  };

  // Notes in `hidden` which of the points the thing hides; their share.
  const hiddenBy = (camera, points, thing, hidden) => {
    const count = points.length / 3, { index } = thing, corners = index ? index.length : thing.count;
    const matrix = matrixOf(camera, thing.object);
    const every = Math.max(1, Math.min(Math.ceil(count * corners / 3 / TESTS), Math.floor(count / LEAST)));
    const bounds = box(matrix, thing.sphere), outside = (i) => bounds && !(points[i + 2] > 0 && [0, 1].every((c) =>
      points[i + c] >= bounds.low[c] * points[i + 2] && points[i + c] <= bounds.high[c] * points[i + 2]));
    const at = (k) => index ? index[k] : k;
    let q = null, tried = 0, number = 0;
    for (let i = 0; i < count; i += every, tried++) {
      if (outside(3 * i)) continue;
      q = q || clip(matrix, thing.x, thing.count);
      let is = false;
      for (let k = 0; k + 2 < corners && !is; k += 3)
        is = meets(points, 3 * i, q, 3 * at(k), 3 * at(k + 1), 3 * at(k + 2), thing.side) < 0.999;
      if (!is) continue;
      number++;
      hidden.fill(1, i, i + every);
    }
    return tried ? number / tried : 0;
  };

  // Whether a closed mesh encloses a place, both in its own coordinates: the solid angles of its triangles (van Oosterom and Strackee,
  // IEEE Trans. Biomed. Eng. 30(2), 1983, eq. 8) add up to 4 pi inside, 0 outside, and about 2 pi on a face.
  const encloses = ({ x, count, index }, place) => {
    const corners = index ? index.length : count, [a, b, c] = [0, 1, 2].map(() => new THREE.Vector3()), cross = new THREE.Vector3();
    let angle = 0;
    for (let k = 0; k + 2 < corners; k += 3) {
      [a, b, c].forEach((v, j) => v.fromArray(x, 3 * (index ? index[k + j] : k + j)).sub(place));
      const [p, q, r] = [a.length(), b.length(), c.length()];
      angle += 2 * Math.atan2(a.dot(cross.crossVectors(b, c)), p * q * r + a.dot(b) * r + b.dot(c) * p + c.dot(a) * q);
    }
    return angle > 3 * Math.PI;
  };

  const smooth = (from, to, x) => {
    const t = Math.min(Math.max((x - from) / (to - from), 0), 1);
    return t * t * (3 - 2 * t);
  };

  // The opacity of each thing, 1 to 0.18, for the points, which are in clip coordinates: only where all together hide more than
  // half of them do those that hide some fade, without a jump.
  const opacities = (camera, points, things) => {
    const hidden = new Uint8Array(points.length / 3), shares = things.map((thing) => hiddenBy(camera, points, thing, hidden));
    const all = hidden.length ? hidden.reduce((sum, one) => sum + one, 0) / hidden.length : 0;
    return shares.map((share) => 1 - 0.82 * smooth(0.5, 0.75, all) * Math.min(share / 0.1, 1));
  };

  return { FRONT, BACK, BOTH, POINTS, Blockers, clip, matrixOf, encloses, opacities };
})();
