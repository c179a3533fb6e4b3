// recorded: the frames of a run that the page holds, as a source of frames. What shows frames knows of a source only
//
//   source.count           frames there are (a live source has one that grows)
//   source.time(k)         s
//   source.get(k, fields, show)   calls show(frame) when the frame is there, at once where it is already; a later call
//                          of get makes an earlier one that still waits void
//   source.fields          [{ name, label, unit, components, map }], numbers of particles beside their positions
//   source.origin          [x, y, z], m: positions are relative to it, so that single precision will do
//   source.bounds          { low, high } of all positions, relative to the origin; source.low: the least height
//   source.solids          [{ kind, hollow, body, group (1 + its place in groups, or 0), vertices, faces }], what particles bounce off, and surfaces of rigid bodies (solids.js)
//   source.marks           [{ key, name, kind: "wind" or "contact", largest }]: key may stand among the fields of get
//   source.groups          names of the groups; none where there is one only
//   source.most            particles at once; left out where that is unknown
//   source.title, source.summary, source.series, source.error
//
// and of a frame { k, t, n, ids, x (3n), edges, triangles, pins (indices), groups (n, places in source.groups, or none), radii
// (n, m, of strands, 0 of what is of none; or none), topology (a number that changes when the last five do), values: { name: numbers }, solids: of each solid its centre and three axes (12 numbers),
// marks: { key: { places, vectors (3 each), count, total } } }.
"use strict";
view.recorded = (() => {
  const text = (id) => document.getElementById(id).textContent;
  const MOST_BLOCKS = 12; // unpacked blocks that are kept, of all streams together: some 10 MB each at most

  // The last entry that begins at frame k or before.
  const at = (list, k) => {
    let low = 0, high = list.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (list[middle].first <= k) low = middle; else high = middle - 1;
    }
    return low;
  };

  class Recorded {
    constructor(run) {
      this.run = run;
      this.count = run.times.length;
      this.most = Math.max(...run.populations.map((p) => p.n));
      this.fields = run.streams.filter((s) => s.name !== "position");
      for (const key of ["title", "summary", "series", "fps"]) this[key] = run[key];
      this.groups = run.groups || [];
      const p = run.streams.find((s) => s.name === "position");
      this.origin = p.low.map((low, c) => (low + p.high[c]) / 2);
      this.bounds = { low: p.low.map((v, c) => v - this.origin[c]), high: p.high.map((v, c) => v - this.origin[c]) };
      this.error = { positions: p.error, extent: Math.max(...p.high.map((v, c) => v - p.low[c])) };
      this.marks = (run.marks || []).map((m, j) => ({ ...m, key: `mark ${j}`,
        largest: Math.hypot(...m.vectors.low.map((v, c) => Math.max(Math.abs(v), Math.abs(m.vectors.high[c])))) }));
      this.blocks = new Map(); // "stream/block" -> a promise of a Block, the most recently used last
      this.topologies = new Map();
      this.asked = 0;
      this.ready = Promise.all([this.unpackIds(), this.unpackSolids()]);
    }

    time(k) { return this.run.times[k]; }

    async unpackIds() {
      const all = view.codec.indices(await view.codec.unpack(text(this.run.ids)));
      let begin = 0;
      for (const p of this.run.populations) {
        p.ids = all.subarray(begin, begin + p.n);
        begin += p.n;
      }
      return this;
    }

    async unpackSolids() {
      const list = async (id) => id ? view.codec.indices(await view.codec.unpack(text(id))) : new Uint32Array(0);
      const { solids } = this.run;
      this.solids = await Promise.all((solids ? solids.list : []).map(async (s) => ({ kind: s.kind, hollow: s.hollow, body: s.body, group: s.group,
        vertices: new Float32Array((await list(s.vertices)).buffer), faces: await list(s.faces) })));
      this.places = solids ? new Float32Array((await list(solids.places)).buffer) : new Float32Array(0);
    }

    // Of frame k: those of the only one where nothing moves.
    solidsAt(k) {
      const size = 12 * this.solids.length, at = this.places.length > size ? k * size : 0;
      return this.places.subarray(at, at + size);
    }

    ids(k) { return this.run.populations[at(this.run.populations, k)].ids; }

    block(stream, number) {
      const key = `${stream.name}/${number}`;
      const found = this.blocks.get(key) || this.unpackBlock(stream, number);
      this.blocks.delete(key);
      this.blocks.set(key, found);
      const most = MOST_BLOCKS + this.fields.length + 2 * this.marks.length;
      for (const old of this.blocks.keys()) if (this.blocks.size > most && old !== key) this.blocks.delete(old);
      return found;
    }

    async unpackBlock(stream, number) {
      const first = this.run.blocks[number].first;
      const bytes = await view.codec.unpack(text(stream.texts[number]));
      return new view.codec.Block(bytes, stream.components, (k) => stream.counts ? stream.counts[first + k] : this.ids(first + k));
    }

    async topology(k) {
      const number = at(this.run.topologies, k);
      if (!this.topologies.has(number)) {
        const entry = this.run.topologies[number];
        const list = async (id) => id ? view.codec.indices(await view.codec.unpack(text(id))) : new Uint32Array(0);
        this.topologies.set(number, Promise.all(["edges", "triangles", "pins", "groups", "radii"].map((name) => list(entry[name]))));
      }
      const [edges, triangles, pins, groups, radii] = await this.topologies.get(number);
      return { edges, triangles, pins, groups, radii: new Float32Array(radii.buffer, radii.byteOffset, radii.length), topology: number };
    }

    async marksAt(k, number, inside, mark) {
      const halves = await Promise.all([mark.places, mark.vectors].map(async (stream) => {
        const block = await this.block(Object.assign(stream, { counts: mark.counts }), number);
        return view.codec.values(block.frame(inside), 3, stream.low, stream.step, stream === mark.places ? this.origin : null);
      }));
      return { places: halves[0], vectors: halves[1], count: mark.counts[k], total: mark.totals[k] };
    }

    async frame(k, fields) {
      await this.ready;
      const number = at(this.run.blocks, k), inside = k - this.run.blocks[number].first;
      const streams = this.run.streams.filter((s) => s.name === "position" || fields.includes(s.name));
      const blocks = await Promise.all(streams.map((s) => this.block(s, number)));
      if (number + 1 < this.run.blocks.length) for (const s of streams) this.block(s, number + 1); // while it plays on
      const frame = { k, t: this.time(k), ids: this.ids(k), values: {}, solids: this.solidsAt(k), ...await this.topology(k) };
      frame.n = frame.ids.length;
      frame.marks = {};
      for (const m of this.marks) if (fields.includes(m.key)) frame.marks[m.key] = await this.marksAt(k, number, inside, m);
      streams.forEach((s, j) => {
        const origin = s.name === "position" ? this.origin : null;
        const values = view.codec.values(blocks[j].frame(inside), s.components, s.low, s.step, origin);
        if (origin) frame.x = values; else frame.values[s.name] = values;
      });
      return frame;
    }

    get(k, fields, show) {
      const mine = ++this.asked;
      this.frame(k, fields).then((frame) => { if (mine === this.asked) show(frame); }, view.fail);
    }
  }

  return { Recorded };
})();
