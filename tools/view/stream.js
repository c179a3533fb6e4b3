// stream: the frames of a run under way as a source of frames (recorded.js says what that is). The server keeps them; the
// page has the one that it shows, and the numbers of all. Another run from the start takes the place of the one before.
"use strict";
view.stream = (() => {
  const CHUNK = 512; // frames, as tools/common/watch/history.lua has them
  const FIXED = [["Energy", "J", "kinetic"], ["Energy", "J", "potential"], ["Energy", "J", "work"], ["Momentum", "kg m/s", "x"],
    ["Momentum", "kg m/s", "y"], ["Momentum", "kg m/s", "z"], ["Angular momentum", "kg m²/s", "x"],
    ["Angular momentum", "kg m²/s", "y"], ["Angular momentum", "kg m²/s", "z"], ["Largest strain", "", "strain"],
    ["Step length", "s", "step"]];

  // plugins/common/live/surroundings.h
  const solidsOf = (buffer) => {
    const [count] = new Uint32Array(buffer, 0, 1), head = new Uint32Array(buffer, 4, 4 * count), solids = [];
    for (let k = 0; k < count; k++) {
      const [kind, flags, vertices, faces] = head.subarray(4 * k, 4 * k + 4);
      solids.push({ kind: view.colours.solids[kind], hollow: (flags & 1) > 0, body: (flags & 2) > 0, group: flags >>> 2, vertices, faces });
    }
    let at = 4 + 16 * count;
    const list = (Kind, length) => { const a = new Kind(buffer, at, length); at += 4 * length; return a; };
    for (const s of solids) s.vertices = list(Float32Array, 3 * s.vertices);
    for (const s of solids) s.faces = list(Uint32Array, 3 * s.faces);
    return solids;
  };

  const empty = (list) => { list.length = 0; };

  class Stream {
    constructor() {
      Object.assign(this, { number: 0, solids: [], marks: [], groups: [], times: [], series: [], fields: [], title: "", summary: null, busy: false, next: null,
        bounds: { low: [0, 0, 0], high: [0, 0, 0] }, origin: [0, 0, 0], error: { positions: 0, extent: 0 }, topologies: new Map() });
    }

    get count() { return Math.max(this.times.length, 1); }
    time(k) { return this.times.length ? this.times[Math.min(k, this.times.length - 1)] : 0; }

    // True: what the run has to tell is other than before, so that the page is to be built again.
    async begin(number) {
      const run = await view.link.json(`run/${number}`), solids = solidsOf(await view.link.bytes(`solids/${number}`));
      const shape = JSON.stringify([run.fields, run.measures, run.units, run.marks, run.groups, solids.length > 0]);
      const other = this.shape !== undefined && this.shape !== shape;
      Object.assign(this, { number, run, shape, title: run.title, summary: null, origin: run.origin, solids, groups: run.groups || [] });
      this.marks = run.marks.map((m, j) => ({ ...m, key: `mark ${j}`, largest: 0 }));
      if (!this.fields.length) this.fields = run.fields.map((f) => ({ ...f, least: 0, most: 0 }));
      if (!this.series.length) this.series = this.charts(run.measures, run.units);
      this.topologies.clear();
      empty(this.times);
      for (const s of this.series) empty(s.values);
      this.known = { frames: 0, stride: 1, latest: 0 };
      return other;
    }

    // A series is the sum of numbers that the run tells: the total energy of two, all others of one.
    charts(measures, units) {
      const told = [...FIXED, ...measures.map((name, k) => [name, units[k] || "", name])];
      const list = told.map(([group, unit, name], k) => ({ group, unit, name, sum: [k], times: this.times, values: [] }));
      list.splice(2, 0, { group: "Energy", unit: "J", name: "total", sum: [0, 1], times: this.times, values: [] });
      this.told = told.length;
      return list;
    }

    // Numbers of the frames that are new, up to the whole ones there are.
    async learn(known) {
      this.known = known;
      const width = 1 + this.told;
      for (let c = Math.floor(this.times.length / CHUNK); c * CHUNK < known.frames; c++) {
        const all = new Float64Array(await view.link.bytes(`numbers/${this.number}/${c}`));
        for (let k = this.times.length - c * CHUNK; k < all.length / width; k++) {
          this.times.push(all[k * width]);
          for (const s of this.series) s.values.push(s.sum.reduce((sum, j) => sum + all[k * width + 1 + j], 0));
        }
      }
    }

    solidsAt() { return this.places || new Float32Array(0); }

    // The frame nearest to k of those that the server keeps.
    kept(k) {
      const { stride, latest } = this.known;
      if (k >= latest) return latest;
      return Math.min(Math.round(k / stride) * stride, latest);
    }

    topology(number) {
      const name = `topology/${this.number}/${number}`;
      if (!this.topologies.has(name)) this.topologies.set(name, view.link.bytes(name).then((buffer) => {
        const [, n, edges, triangles, pins, groups, radii] = new Uint32Array(buffer, 0, 7);
        let at = 28;
        const list = (length, Kind = Uint32Array) => { const a = new Kind(buffer, at, length); at += 4 * length; return a; };
        return { ids: list(n), edges: list(2 * edges), triangles: list(3 * triangles), pins: list(pins), groups: list(groups),
          radii: list(radii, Float32Array), topology: name };
      }));
      return this.topologies.get(name);
    }

    widen(list, numbers, components) {
      for (let i = 0; i < numbers.length; i += components)
        for (let c = 0; c < components; c++) {
          const v = numbers[i + c];
          if (v < list.low[c]) list.low[c] = v;
          if (v > list.high[c]) list.high[c] = v;
        }
    }

    measureField(f, numbers) {
      if (f.components > 1) {
        for (let i = 0; i < numbers.length; i += f.components) {
          let square = 0;
          for (let c = 0; c < f.components; c++) square += numbers[i + c] ** 2;
          if (square > f.most ** 2) f.most = f.largest = Math.sqrt(square);
        }
        return;
      }
      for (const v of numbers) { if (v < f.least) f.least = v; if (v > f.most) f.most = v; }
    }

    async frame(k, wanted) {
      const buffer = await view.link.bytes(`frame/${this.number}/${this.kept(k)}`);
      const [index, topology, n] = new Uint32Array(buffer, 0, 4), t = new DataView(buffer).getFloat64(16, true);
      let at = 24;
      const list = (length) => { const a = new Float32Array(buffer, at, length); at += 4 * length; return a; };
      const frame = { k: index, t, n, x: list(3 * n), values: {}, marks: {}, ...await this.topology(topology) };
      for (const f of this.fields) {
        const numbers = list(f.components * n);
        if (!wanted.includes(f.name)) continue;
        this.measureField(f, numbers);
        frame.values[f.name] = numbers;
      }
      this.surround(frame, wanted, list, () => { const [v] = new Uint32Array(buffer, at, 1); at += 4; return v; });
      return frame;
    }

    // What comes behind the fields: list(n) and count() take the next numbers.
    surround(frame, wanted, list, count) {
      frame.solids = this.places = list(12 * this.solids.length);
      for (const m of this.marks) {
        const [n, total] = [count(), count()], places = list(3 * n), vectors = list(3 * n);
        for (let i = 0; i < n; i++) m.largest = Math.max(m.largest, Math.hypot(vectors[3 * i], vectors[3 * i + 1], vectors[3 * i + 2]));
        if (wanted.includes(m.key)) frame.marks[m.key] = { places, vectors, count: n, total };
      }
    }

    // One frame at a time is on its way; of those asked for meanwhile the last is next.
    get(k, wanted, show) {
      this.next = { k, wanted, show };
      if (!this.busy) this.fetch();
    }

    async fetch() {
      this.busy = true;
      while (this.next) {
        const { k, wanted, show } = this.next, number = this.number;
        this.next = null;
        try {
          const frame = await this.frame(k, wanted);
          if (number === this.number) show(frame);
        } catch (error) {
          if (number === this.number && !/404/.test(error.message)) console.warn(error.message); // it was thinned out meanwhile
        }
      }
      this.busy = false;
    }
  }

  return { Stream };
})();
