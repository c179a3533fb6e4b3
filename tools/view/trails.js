// trails: where particles have been: lines through their places at the frames before, which fade into the page.
"use strict";
view.trails = (() => {
  const LENGTH = 120;   // frames
  const PIECES = 60000; // of all particles together, at most

  const paper = () => new THREE.Color(getComputedStyle(document.documentElement).getPropertyValue("--paper").trim()).toArray();

  class Trails {
    // redraw(): called when frames that were missing have come
    constructor(source, uniforms, redraw) {
      Object.assign(this, { source, redraw, of: null });
      this.segments = new view.segments.Segments(uniforms, false);
      this.segments.own.least.value = 1.1;
      this.mesh = this.segments.mesh;
      this.forget();
    }

    forget() {
      this.places = new Map(); // frame -> { ids, x }
      this.asked = new Set();
    }

    length(n) { return Math.max(Math.min(LENGTH, Math.floor(PIECES / Math.max(n, 1))), 1); }

    // Of one particle its place alone.
    note(frame) {
      if (this.of === "all") return void this.places.set(frame.k, { ids: frame.ids, x: frame.x });
      const i = frame.ids.indexOf(this.of);
      this.places.set(frame.k, i < 0 ? { ids: [], x: [] } : { ids: [this.of], x: frame.x.slice(3 * i, 3 * i + 3) });
    }

    // of: "all", the id of a particle, or null; tint: the colour of what stands for no number
    show(frame, of, tint) {
      if (of !== this.of) this.forget();
      Object.assign(this, { of, frame, tint });
      if (of === null) return this.segments.count(0);
      this.note(frame);
      this.back = this.length(of === "all" ? frame.n : 1);
      for (const k of this.places.keys()) if (k > frame.k || k < frame.k - 2 * this.back) this.places.delete(k);
      for (const k of this.asked) if (k > frame.k || k < frame.k - 2 * this.back) this.asked.delete(k);
      this.draw();
      if (!this.filling) this.fill();
    }

    missing() {
      for (let k = this.frame.k - 1; k >= Math.max(this.frame.k - this.back, 0); k--)
        if (!this.places.has(k) && !this.asked.has(k)) return k;
      return -1;
    }

    // The frames that were passed over, one after another; a run under way keeps some of them only.
    async fill() {
      this.filling = true;
      for (let k = this.missing(), of = this.of; k >= 0 && of === this.of; k = this.missing()) {
        this.asked.add(k);
        const frame = await this.source.frame(k, []).catch(() => null);
        if (frame && of === this.of) this.note(frame);
      }
      this.filling = false;
      if (this.of === null) return;
      if (this.missing() >= 0) return this.fill();
      this.draw();
      this.redraw();
    }

    // Pairs of the places of a particle in two frames: [i, j] of their lists.
    static *pairs(a, b) {
      if (a.ids === b.ids) for (let i = 0; i < a.ids.length; i++) yield [i, i];
      else {
        const at = new Map(Array.from(a.ids, (id, i) => [id, i]));
        for (let j = 0; j < b.ids.length; j++) if (at.has(b.ids[j])) yield [at.get(b.ids[j]), j];
      }
    }

    draw() {
      const known = [...this.places.keys()].filter((k) => k <= this.frame.k && k >= this.frame.k - this.back).sort((a, b) => a - b);
      const pieces = [], page = paper();
      known.slice(1).forEach((k, n) => {
        const a = this.places.get(known[n]), b = this.places.get(k), colours = [known[n], k].map((at) => {
          const part = (this.frame.k - at) / (this.back + 1);
          return this.tint.map((v, c) => v + (page[c] - v) * part);
        });
        for (const [i, j] of Trails.pairs(a, b)) pieces.push([a.x, 3 * i, b.x, 3 * j, colours]);
      });
      const [begin, end, first, second] = this.segments.arrays(pieces.length);
      pieces.forEach(([a, i, b, j, [older, newer]], n) => {
        for (let c = 0, at = 3 * n; c < 3; c++, at++) {
          begin[at] = a[i + c];
          end[at] = b[j + c];
          first[at] = older[c];
          second[at] = newer[c];
        }
      });
    }
  }

  return { Trails };
})();
