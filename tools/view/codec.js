// codec: packed text back to numbers: base64, deflate (the browser's own), and the differences between frames. The
// writing half, and what the bytes mean, is in tools/native/view/motion_code.h.
"use strict";
view.codec = (() => {
  const NONE = 65535;

  const bytesOf = (text) => {
    const binary = atob(text.trim());
    const bytes = new Uint8Array(binary.length);
    for (let k = 0; k < binary.length; k++) bytes[k] = binary.charCodeAt(k);
    return bytes;
  };

  const unpack = async (text) => {
    const stream = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  };

  const indices = (bytes) => {
    const count = bytes.length / 4;
    const list = new Uint32Array(count);
    let last = 0;
    for (let k = 0; k < count; k++) {
      const d = bytes[k] | (bytes[count + k] << 8) | (bytes[2 * count + k] << 16) | (bytes[3 * count + k] << 24);
      last = (last + d) >>> 0;
      list[k] = last;
    }
    return list;
  };

  // For each particle its index among those of before, -1 where it is new; both lists of ids rise. null: the same.
  const match = (before, now, count) => {
    if (before === now) return null;
    const old = new Int32Array(count).fill(-1);
    if (before && now) {
      for (let i = 0, k = 0; i < count; i++) {
        while (k < before.length && before[k] < now[i]) k++;
        if (k < before.length && before[k] === now[i]) old[i] = k;
      }
    }
    return old;
  };

  const gather = (values, old, components) => {
    const n = old.length, from = values.length / components;
    const moved = new Uint16Array(n * components);
    for (let c = 0; c < components; c++)
      for (let i = 0; i < n; i++) if (old[i] >= 0) moved[c * n + i] = values[c * from + old[i]];
    return moved;
  };

  // The frames of a block one after the other, as they are asked for: each an array of n x components whole numbers,
  // component by component. ids(k): the ids of frame k of the block, or just a number of particles, all of them new
  // where it is another.
  class Block {
    constructor(bytes, components, ids) {
      Object.assign(this, { bytes, components, ids, at: 0, frames: [], last: null, before: null, seen: null, of: undefined });
    }

    frame(k) {
      while (this.frames.length <= k) this.frames.push(this.next(this.frames.length));
      return this.frames[k];
    }

    follow(ids, n) {
      const fresh = !this.seen;
      const old = fresh ? null : typeof ids === "number"
        ? (ids === this.of ? null : new Int32Array(n).fill(-1)) : match(this.of, ids, n);
      this.of = ids;
      if (fresh) {
        this.seen = new Uint8Array(n);
        this.last = this.before = new Uint16Array(n * this.components);
      } else if (old) {
        const seen = this.seen;
        this.seen = new Uint8Array(n);
        for (let i = 0; i < n; i++) if (old[i] >= 0) this.seen[i] = seen[old[i]];
        this.last = gather(this.last, old, this.components);
        this.before = gather(this.before, old, this.components);
      }
    }

    next(k) {
      const ids = this.ids(k), n = typeof ids === "number" ? ids : ids.length;
      this.follow(ids, n);
      const { bytes, components, last, before, seen } = this;
      const count = n * components, mode = bytes[this.at], low = this.at + 1, high = low + count;
      const one = (mode & 1) === 1, corrected = mode > 2;
      const now = new Uint16Array(count);
      for (let c = 0, at = 0; c < components; c++)
        for (let i = 0, off = 0; i < n; i++, at++) {
          const z = bytes[low + at] | (bytes[high + at] << 8);
          const d = z & 1 ? -((z + 1) >> 1) : z >> 1;
          const s = seen[i];
          if (s === 0) {
            now[at] = (i ? now[at - 1] : 0) + d; // here and below modulo 2^16
            off = 0;
          } else {
            off = corrected ? off + d : d;
            now[at] = (s === 1 || one ? last[at] : 2 * last[at] - before[at]) + off;
          }
        }
      for (let i = 0; i < n; i++) if (seen[i] < 2) seen[i]++;
      this.at = high + count;
      this.before = last;
      this.last = now;
      return now;
    }
  }

  // Whole numbers, component by component, as numbers, particle by particle, from `origin` (one per component).
  const values = (whole, components, low, step, origin) => {
    const n = whole.length / components;
    const list = new Float32Array(whole.length);
    for (let c = 0; c < components; c++) {
      const base = low[c] - (origin ? origin[c] : 0);
      for (let i = 0; i < n; i++) {
        const q = whole[c * n + i];
        list[i * components + c] = q === NONE ? NaN : base + q * step;
      }
    }
    return list;
  };

  return { unpack, indices, Block, values };
})();
