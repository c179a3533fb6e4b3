// history: what the runs of the page have shown, as the documents that the view asks for (tools/common/watch/history.lua is
// the same on a server): run/r, solids/r, topology/r/k, frame/r/k, numbers/r/c. Where frames take more than MEMORY every
// second one is dropped, and of those to come as many are left out; the latest is always there, and numbers of all.
"use strict";
hooke.history = (() => {
  const MEMORY = 256 << 20; // bytes
  const CHUNK = 512;

  // R of plugins/common/live/messages.h, with what the page knows of fields (tools/common/view/shared.lua).
  const runOf = (text, title, kinds) => {
    const run = { title, origin: [0, 0, 0], fields: [], measures: [], units: [], marks: [], groups: [] };
    for (const line of text.split("\n")) {
      const [key, value, more, kind] = line.split("\t");
      if (key === "fps") run.fps = Number(value);
      else if (key === "x" || key === "y" || key === "z") run.origin["xyz".indexOf(key)] = Number(value);
      else if (key === "field") run.fields.push({ name: kind === value ? value : `${kind} ${value}`, label: kind === "force" ? `force: ${value}` : value,
        components: Number(more), ...kinds[kind] });
      else if (key === "mark") run.marks.push({ name: value, kind: more });
      else if (key === "group") run.groups.push(value);
      else if (key === "measure") {
        run.measures.push(value);
        run.units.push(more);
      }
    }
    return run;
  };

  class History {
    constructor(number, title, kinds) {
      Object.assign(this, { number, title, kinds, documents: new Map(), frames: 0, stride: 1, size: 0, kept: new Map(), numbers: [], latest: -1, topologies: 0,
        before: 0, told: {}, going: false });
    }

    // The run goes on in another instance, which tells anew what there is, and counts its topologies anew.
    goOn() { Object.assign(this, { before: this.topologies, going: true }); }

    // Whether what a run that goes on tells first is what the page has.
    has(letter, body) {
      const old = new Uint8Array(this.told[letter] || 0), now = new Uint8Array(body);
      return old.length === now.length && old.every((byte, k) => byte === now[k]);
    }

    // Topologies of an instance by the run's own count.
    counted(body, place) {
      const [number] = new Uint32Array(body, 4 * place, 1);
      new Uint32Array(body, 4 * place, 1)[0] = this.before + number;
      return this.before + number;
    }

    put(name, body) { this.documents.set(name, body); }

    // False: a run that goes on has other things to tell than the page knows.
    hear(letter, body) {
      const first = letter === "R" || letter === "S";
      if (first && this.going) return this.has(letter, body);
      if (first) this.told[letter] = body;
      if (letter === "N" || letter === "F") this.going = false;
      if (letter === "R") this.put(`run/${this.number}`, runOf(new TextDecoder().decode(body), this.title, this.kinds));
      else if (letter === "S") this.put(`solids/${this.number}`, body);
      else if (letter === "T") this.put(`topology/${this.number}/${(this.topologies = this.counted(body, 0))}`, body);
      else if (letter === "N") this.numbers[this.frames++] = new Uint8Array(body);
      else if (letter === "F") {
        this.counted(body, 1);
        this.keep(body);
      }
      return true;
    }

    forget(k) {
      if (!this.kept.has(k)) return;
      this.size -= this.kept.get(k);
      this.kept.delete(k);
      this.documents.delete(`frame/${this.number}/${k}`);
    }

    keep(body) {
      const [k] = new Uint32Array(body, 0, 1);
      if (this.latest % this.stride !== 0) this.forget(this.latest);
      this.put(`frame/${this.number}/${k}`, body);
      this.kept.set(k, body.byteLength);
      this.latest = k;
      this.size += body.byteLength;
      while (this.size > MEMORY && this.kept.size > 1) {
        this.stride *= 2;
        for (const old of [...this.kept.keys()]) if (old % this.stride !== 0 && old !== k) this.forget(old);
        if (this.stride > k) break;
      }
    }

    chunk(c) {
      const list = this.numbers.slice(c * CHUNK, (c + 1) * CHUNK), all = new Uint8Array(list.reduce((sum, a) => sum + a.length, 0));
      let at = 0;
      for (const a of list) {
        all.set(a, at);
        at += a.length;
      }
      return all.buffer;
    }

    get(name) {
      const numbers = /^numbers\/\d+\/(\d+)$/.exec(name);
      if (numbers) return this.chunk(Number(numbers[1]));
      if (!this.documents.has(name)) throw new Error(`${name}: 404`);
      return this.documents.get(name);
    }

    known() { return { frames: this.frames, stride: this.stride, latest: this.latest }; }
  }

  return { History };
})();
