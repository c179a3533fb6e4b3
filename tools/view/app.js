// app: puts the page together: sources of frames, their layers on the stage, the clock, plots and reports.
"use strict";
view.app = (() => {
  const { el } = view.dom;
  const $ = (id) => document.getElementById(id);
  const GROUPS = "by group"; // as a choice of colours; a field is called otherwise, by its kind or "KIND NAME"

  class App {
    // sources: one or two; more: { difference: { times, rms, most, largest }, bench, title, note }
    constructor(sources, more = {}) {
      Object.assign(this, { sources, more, paint: "", arrowsOf: "", pickedId: null, mode: "side",
        marked: { wind: true, contact: false } });
      this.economy = new view.economy.Economy(sources);
      this.clock = new view.clock.Clock(sources[0], (k) => this.seek(k), () => this.playingChanged());
      this.timeline = view.timeline.make($("timeline"), this.clock);
      $("timeline").append(view.dom.el("button", { title: "save the view as a picture",
        onclick: () => this.stage.save(`${this.sources[0].title}.png`) }, "PNG"));
      view.timeline.keys(this.clock);
      this.makeStage();
      this.inspector = view.inspector.make($("inspector"), () => this.pick(null));
      this.makePlots();
      this.makeControls();
      this.makeReports();
      document.addEventListener("keydown", (e) => { if (e.key === "Escape") this.pick(null); });
      this.seek(0);
    }

    // ---- parts ----

    makeStage() {
      try {
        this.stage = new view.stage.Stage($("canvas"), this.economy.antialias, (found) => this.pick(found));
      } catch (error) {
        $("note").textContent = `There is no 3D picture: this browser gives no WebGL (${error.message}).`;
        return;
      }
      this.stage.rendered = () => this.showArrowScale();
      this.layers = this.sources.map((source, k) => new view.layer.Layer(source, view.colours.thing(k ? "second" : "plain"),
        () => this.stage.draw()));
      const first = this.sources[0].origin;
      this.layers.forEach((layer, k) => {
        layer.offset = new THREE.Vector3(...this.sources[k].origin.map((v, c) => v - first[c]));
        this.stage.add(layer);
      });
      this.stage.side = this.sources.length > 1;
      this.stage.place();
    }

    groups() {
      const groups = new Map();
      this.sources.forEach((source, run) => {
        for (const s of source.series) {
          const key = `${s.group}\n${s.unit}`;
          if (!groups.has(key)) groups.set(key, { title: s.group, unit: s.unit, lines: [] });
          groups.get(key).lines.push({ name: s.name, run, times: s.times || source.run.times, values: s.values });
        }
      });
      const d = this.more.difference, list = [...groups.values()];
      if (d) list.unshift({ title: "Distance between the runs", unit: "m", lines: [
        { name: "RMS", run: 0, times: d.times, values: d.rms }, { name: "largest", run: 0, times: d.times, values: d.most }] });
      return list;
    }

    makePlots() {
      this.plots = view.plots.make($("plots"), this.groups(), (t) => {
        this.clock.play(false);
        this.clock.seek(view.compare.nearest(this.sources[0], t));
      });
    }

    makeControls() {
      const { select, check, button, choice } = view.controls, fields = this.sources[0].fields, first = this.layers && this.layers[0];
      const vectors = fields.filter((f) => f.components === 3);
      const nodes = [], marked = (kind) => this.sources.some((s) => s.marks.some((m) => m.kind === kind));
      const mark = (kind, label, title) => marked(kind) ? check(label, title, this.marked[kind], (on) => {
        this.marked[kind] = on;
        this.refresh();
      }) : null;
      if (this.sources.length > 1) nodes.push(choice("two runs", [["side", "side by side"], ["over", "in one picture"],
        ["difference", "difference"]], "side", (mode) => this.arrange(mode)));
      nodes.push(select("Colour", "what the colours stand for", [["", "none"], ...fields.map((f) => [f.name, f.painted || f.label]),
        ...this.sources.some((s) => s.groups.length) ? [[GROUPS, "group"]] : []], "", (name) => { this.paint = name; this.refresh(); }));
      if (vectors.length) nodes.push(select("Arrows", "vectors of each particle", [["", "none"], ...vectors.map((f) => [f.name, f.label])],
        "", (name) => { this.arrowsOf = name; this.refresh(); }));
      this.checks = { points: check("particles", "also those of surfaces and edges", false, (on) => this.choose("points", on)),
        edges: check("edges", "also those of surfaces", false, (on) => this.choose("edges", on)) };
      nodes.push(...Object.values(this.checks), check("trails", "where particles have been: the one that is picked, or all", false,
        (on) => this.choose("trails", on)), check("shadows", "", true, (on) => this.choose("shadows", on)),
        this.sources.some((s) => s.solids.length) ? check("obstacles", "what particles bounce off", true,
          (on) => this.choose("solids", on)) : null,
        mark("wind", "wind", "the air's velocity at some of the particles"),
        mark("contact", "contacts", "where surfaces, grains and obstacles touch"), check("floor", "", true, (on) => { this.stage.floorless = !on; this.stage.draw(); }),
        check("y up", "the scene's y points up", false, (on) => { this.stage.yUp = on; this.stage.place(); }),
        button("reset view", "the camera as at the start", () => this.stage.home()));
      $("controls").append(...(first ? nodes.filter(Boolean) : []));
    }

    makeReports() {
      const title = (source, k) => el("h2", { class: `run-title run-${k}` }, source.title,
        el("small", {}, k ? "dashed lines" : "solid lines"));
      const part = (id, content) => $(id).append(...this.sources.map((source, k) => el("div", { class: "run" },
        this.sources.length > 1 ? title(source, k) : null, content(source.summary))));
      part("verdicts", view.report.verdict);
      part("reports", view.report.details);
      const bench = this.more.bench && view.bench.make(this.more.bench);
      if (bench) $("bench").append(bench);
    }

    // ---- what is seen ----

    arrange(mode) {
      this.mode = mode;
      this.stage.side = mode === "side";
      this.layers[1].hidden = mode === "difference";
      this.layers.forEach((layer) => layer.surface.fade(1));
      if (mode === "over") this.layers[1].surface.fade(0.6);
      this.stage.place();
      this.refresh();
    }

    choose(what, on) {
      for (const layer of this.layers) layer.shown[what] = on;
      this.refresh();
    }

    pick(found) {
      this.pickedId = found ? found.id : null;
      this.pickedLayer = found ? found.layer : null;
      this.refresh();
    }

    // Numbers of the particle's fields are unpacked when they are seen only.
    wanted(source) {
      const marks = source.marks.filter((m) => this.marked[m.kind]).map((m) => m.key);
      const fields = source.fields.map((f) => f.name);
      if (this.pickedId !== null) return [...marks, ...fields];
      return [...marks, ...[this.paint, this.arrowsOf, view.points.RADIUS].filter((name) => fields.includes(name))];
    }

    refresh() { this.seek(this.clock.k); }

    // It plays, or no longer: then the charts' cursors are where the picture is.
    playingChanged() {
      if (!this.timeline) return;
      this.timeline.update();
      if (!this.clock.playing) this.plots.show(this.sources[0].time(this.clock.k), this.frames);
    }

    seek(k) {
      const t = this.sources[0].time(k);
      this.frames = this.sources.map((source, j) => j === 0 ? k : view.compare.nearest(source, t));
      if (this.economy.cursors(this.clock.playing)) {
        this.timeline.update();
        this.plots.show(t, this.frames);
      }
      if (!this.stage) return;
      const got = new Array(this.sources.length).fill(null);
      this.sources.forEach((source, j) => source.get(this.frames[j], this.wanted(source), (frame) => {
        got[j] = frame;
        if (got.every((f) => f)) this.show(got);
      }));
    }

    scaleOf(source) {
      if (this.mode === "difference" && this.sources.length > 1)
        return { title: "distance between the runs, m", scale: view.colours.scale(0, this.more.difference.largest, "viridis") };
      const f = source.fields.find((one) => one.name === this.paint);
      if (!f) return null;
      const both = this.sources.map((s) => s.fields.find((one) => one.name === f.name)).filter(Boolean);
      const scale = view.colours.scale(Math.min(...both.map((b) => b.least)), Math.max(...both.map((b) => b.most)), f.map,
        Math.min(...both.map((b) => b.lowest ?? b.least)), Math.max(...both.map((b) => b.highest ?? b.most)));
      return { field: f, title: `${f.painted || f.label}${f.unit ? `, ${f.unit}` : ""}`, scale };
    }

    numbers(frame, field) {
      const values = frame.values[field.name];
      if (!values || field.components === 1) return values;
      const sizes = new Float32Array(frame.n);
      for (let i = 0; i < frame.n; i++) {
        let square = 0;
        for (let c = 0; c < field.components; c++) square += values[i * field.components + c] ** 2;
        sizes[i] = Math.sqrt(square);
      }
      return sizes;
    }

    show(frames) {
      this.layers.forEach((layer, j) => {
        const frame = frames[j], s = this.scaleOf(layer.source);
        let numbers = null;
        if (s && !s.field) numbers = j === 0 ? view.compare.distances(frame, frames[1], this.sources[0].origin, this.sources[1].origin) : null;
        else if (s) numbers = this.numbers(frame, s.field);
        let colours = null;
        const byGroup = !s && this.paint === GROUPS;
        if (byGroup && frame.groups.length) view.colours.paintGroups(frame.groups, colours = new Float32Array(3 * frame.n));
        if (numbers) view.colours.paint(numbers, s.scale, colours = new Float32Array(3 * frame.n));
        layer.every = this.economy.every;
        layer.sparing = this.economy;
        const arrows = this.arrows(layer.source, frame);
        layer.show(frame, colours, arrows, this.pickedId, byGroup);
        if (j === 0) this.arrowScale = arrows;
        if (j === 0 && byGroup) this.groupLegend(frame);
        else if (j === 0) view.colours.legend($("legend"), layer.painted && s.title, s && s.scale);
      });
      this.showPicked(frames);
      this.synchronise();
      this.economy.pace(this.clock.playing, this.layers);
      this.showNotes();
      this.stage.draw();
    }

    groupLegend(frame) {
      const { groups, solids } = this.sources[0], used = new Set(frame.groups);
      solids.forEach((solid) => { if (solid.group > 1) used.add(solid.group - 1); });
      view.colours.groupLegend($("legend"), groups, [...used].sort((a, b) => a - b));
    }

    // With each picture, since the camera may have moved: a bar as long as an arrow of a round size is at the middle of the motion,
    // across the line of sight.
    showArrowScale() {
      const scale = this.arrowScale, node = $("arrow-scale");
      if (node.hidden === !!scale) node.hidden = !scale;
      if (!scale) return;
      const step = 10 ** Math.floor(Math.log10(scale.field.largest)), times = scale.field.largest / step;
      const round = step * (times >= 5 ? 5 : times >= 2 ? 2 : 1);
      const text = `${view.numbers.short(round, 3)}${scale.field.unit ? ` ${scale.field.unit}` : ""}`;
      const width = `${this.stage.pixels(round * scale.length).toFixed(1)}px`;
      if (node.textContent === text && node.firstChild.style.width === width) return;
      const bar = el("div", { class: "arrow-bar" });
      bar.style.width = width;
      node.replaceChildren(bar, el("span", {}, text));
    }

    arrows(source, frame) {
      const f = source.fields.find((one) => one.name === this.arrowsOf), numbers = f && frame.values[f.name];
      if (!numbers || !(f.largest > 0)) return null;
      const { low, high } = source.bounds, size = Math.max(...low.map((v, c) => high[c] - v));
      return { numbers, field: f, length: 0.25 * size / f.largest, colour: view.colours.thing("arrow") };
    }

    showPicked(frames) {
      const layer = this.pickedLayer, frame = layer && frames[this.layers.indexOf(layer)];
      const index = frame ? frame.ids.indexOf(this.pickedId) : -1;
      this.inspector.show(index >= 0 ? layer : null, index);
    }

    synchronise() {
      const { shown, frame } = this.layers[0];
      this.checks.points.hidden = !frame.edges.length && !frame.triangles.length; // all are drawn
      this.checks.edges.hidden = !frame.triangles.length;
      this.checks.points.querySelector("input").checked = shown.points;
      this.checks.edges.querySelector("input").checked = shown.edges;
    }

    // Below the picture: how near its numbers are, and what it leaves out.
    showNotes() {
      const off = this.sources.map((s) => s.error.positions / s.error.extent), most = Math.max(...off);
      const notes = [];
      if (this.sources[0].error.extent) notes.push(`positions within ${view.numbers.short(most, 3)} of the extent`);
      const speed = this.sources[0].fields.find((f) => f.name === "velocity");
      if (speed && speed.error) notes.push(`velocities within ${view.numbers.short(speed.error, 3)} m/s`);
      for (const note of this.layers.flatMap((layer) => layer.notes)) notes.push(note);
      notes.push(...this.economy.notes(this.layers));
      const note = notes.join(" · "), node = $("note");
      if (node.textContent !== note) node.textContent = note; // to write it again would be to draw it again
    }
  }

  return { App };
})();
