// layer: one run in the 3D view: its surface, edges, particles, pins, arrows, obstacles, and the particle that is picked.
"use strict";
view.layer = (() => {
  const PIN = [0.90, 0.45, 0.13], PICKED = [0.98, 0.78, 0.18], WIND = [0.10, 0.62, 0.60], CONTACT = [0.85, 0.15, 0.45];

  const MOST_WINDS = 72; // arrows
  const SAMPLE = 64; // particles whose neighbours are looked for

  const distance = (x, i, j) => Math.hypot(x[3 * i] - x[3 * j], x[3 * i + 1] - x[3 * j + 1], x[3 * i + 2] - x[3 * j + 2]);

  const median = (list) => {
    const known = list.filter((l) => l > 0).sort((a, b) => a - b);
    return known[known.length >> 1];
  };

  const ofEdges = ({ x, edges }) => {
    const lengths = [], every = Math.max(1, Math.floor(edges.length / 2 / 2000));
    for (let e = 0; 2 * e < edges.length; e += every) lengths.push(distance(x, edges[2 * e], edges[2 * e + 1]));
    return median(lengths);
  };

  // From some particles to the nearest other one.
  const ofNeighbours = ({ x, n }) => {
    const lengths = [], every = Math.max(1, Math.floor(n / SAMPLE));
    for (let i = 0; i < n; i += every) {
      let least = Infinity;
      for (let j = 0; j < n; j++) if (j !== i) least = Math.min(least, distance(x, i, j));
      lengths.push(least);
    }
    return median(lengths);
  };

  // Of a ball, in the picture of a motion of this size: smaller than what is between neighbours.
  const radiusOf = (frame, size) => {
    const edge = frame.edges.length ? ofEdges(frame) : undefined, gap = edge ? undefined : ofNeighbours(frame);
    if (edge) return 0.16 * edge;
    return Math.min(gap > 0 && Number.isFinite(gap) ? 0.35 * gap : Infinity, 0.02 * size);
  };

  class Layer {
    // tint: the colour of what stands for no number
    constructor(source, tint) {
      Object.assign(this, { source, tint, every: 1, told: [], shown: { points: null, edges: false, shadows: true, solids: true } });
      this.uniforms = view.light.uniforms();
      this.scene = new THREE.Scene();
      this.group = new THREE.Group();
      this.floor = new view.floor.Floor();
      this.surface = new view.surface.Surface(this.uniforms);
      this.edges = new view.segments.Segments(this.uniforms, false);
      this.arrows = new view.segments.Segments(this.uniforms, true);
      this.points = new view.points.Points(this.uniforms, 1);
      this.splats = new view.splats.Splats(this.points.own);
      this.pins = new view.points.Points(this.uniforms, 2.5);
      this.picked = new view.points.Points(this.uniforms, 5);
      this.solids = new view.solids.Solids(source, this.uniforms);
      this.wind = new view.segments.Segments(this.uniforms, true);
      this.contacts = new view.points.Points(this.uniforms, 2);
      // They are between what they hold apart, and are drawn last: after the floor, which is transparent.
      Object.assign(this.contacts.mesh.material, { depthTest: false, transparent: true });
      this.contacts.mesh.renderOrder = 1;
      const parts = [this.solids, this.wind, this.contacts, this.surface, this.edges, this.arrows, this.points, this.pins, this.picked];
      for (const part of parts) this.group.add(part.mesh);
      this.shadows = [this.surface, this.edges, this.points, this.solids].map((part) => part.shadow);
      this.group.add(...this.shadows);
      this.scene.add(this.group, this.floor.mesh, this.splats.mesh);
      for (const shadow of this.shadows) shadow.renderOrder = -0.5; // between the floor and all else
    }

    // Edges of a surface and particles at edges are drawn where somebody chooses that, or where they are few.
    defaults(frame) {
      const s = this.shown;
      if (s.points === null) s.points = frame.triangles.length === 0 && frame.n <= 400;
      const { low, high } = this.source.bounds;
      this.size = Math.max(...low.map((v, c) => high[c] - v)) || 1;
      this.radius = radiusOf(frame, this.size);
    }

    sizes() {
      this.points.own.radius.value = this.radius;
      this.pins.own.radius.value = 1.5 * this.radius;
      this.picked.own.radius.value = 1.7 * this.radius;
      this.edges.own.radius.value = 0.38 * this.radius * (this.surface.mesh.visible ? 0.5 : 1);
      this.arrows.own.radius.value = 0.3 * this.radius;
      this.wind.own.radius.value = 0.006 * this.size;
      this.contacts.own.radius.value = 0;
    }

    plain(n) {
      if (!this.same || this.same.length !== 3 * n) {
        this.same = new Float32Array(3 * n);
        for (let i = 0; i < 3 * n; i++) this.same[i] = this.tint[i % 3];
      }
      return this.same;
    }

    // colours: of each particle, or null; arrows: numbers (3n) and the length of one of size 1, or null
    show(frame, colours, arrows, pickedId) {
      if (this.radius === undefined && frame.n) this.defaults(frame);
      this.frame = frame;
      const paint = colours || this.plain(frame.n), s = this.shown;
      this.surface.show(frame, paint, !colours);
      const { edges, alone, pins } = view.topology.of(this.source, frame);
      this.edges.show(frame, s.edges ? frame.edges : edges, paint);
      this.balls = s.points || alone.length === frame.n ? frame.n : alone.length;
      this.showBalls(frame, this.balls === frame.n ? null : alone, paint);
      this.pins.show(frame, pins, pins.length, PIN);
      this.showArrows(frame, arrows);
      this.solids.show(frame, s.solids);
      this.showMarks(frame);
      const k = pickedId === null ? -1 : frame.ids.indexOf(pickedId);
      this.picked.show(frame, [k], k < 0 ? 0 : 1, PICKED);
      for (const shadow of this.shadows) shadow.visible = shadow.visible && s.shadows;
      this.sizes();
    }

    // By the graphics, or by the page itself where there is none.
    showBalls(frame, list, paint) {
      const count = Math.ceil(this.balls / this.every), by = this.sparing && this.sparing.splats(this.balls);
      by ? this.points.hide() : this.splats.hide();
      (by ? this.splats : this.points).show(frame, list, count, paint, { every: this.every, radii: frame.values[view.points.RADIUS] });
    }

    showMarks(frame) {
      const shown = this.source.marks.filter((m) => frame.marks[m.key]).map((m) => ({ ...m, ...frame.marks[m.key] }));
      this.showWind(shown.filter((m) => m.kind === "wind" && m.count > 0));
      const contact = shown.find((m) => m.kind === "contact") || { places: new Float32Array(0), count: 0, total: 0 };
      this.contacts.show({ x: contact.places }, null, contact.count, CONTACT);
      this.told = contact.total > contact.count ? [`${contact.count} of ${contact.total} contacts are shown`] : [];
    }

    // Airs that act together are summed: they are known at the same places. Arrows stand so far apart that each is seen.
    showWind(winds) {
      const places = winds.length ? winds[0].places : new Float32Array(0), n = places.length / 3;
      const every = Math.ceil(n / MOST_WINDS) || 1, unit = 0.18 * this.size / winds.reduce((sum, m) => sum + m.largest, 1e-30);
      const [begin, end, first, second] = this.wind.arrays(Math.ceil(n / every));
      for (let i = 0, at = 0; i < n; i += every)
        for (let c = 0; c < 3; c++, at++) {
          const sum = winds.reduce((total, m) => total + m.vectors[3 * i + c], 0);
          begin[at] = places[3 * i + c];
          end[at] = places[3 * i + c] + sum * unit;
          first[at] = second[at] = WIND[c];
        }
    }

    showArrows(frame, arrows) {
      const every = arrows ? Math.ceil(frame.n / 6000) : 1, count = arrows ? Math.ceil(frame.n / every) : 0;
      const [begin, end, first, second] = this.arrows.arrays(count);
      for (let k = 0, at = 0; k < count; k++)
        for (let c = 0; c < 3; c++, at++) {
          const i = 3 * k * every + c;
          begin[at] = frame.x[i];
          end[at] = frame.x[i] + arrows.numbers[i] * arrows.length;
          first[at] = second[at] = arrows.colour[c];
        }
    }

    // The light, and colours of the page, for a camera and a width and height of the view in pixels; above: the camera is above
    // the floor, whose height is `floor`.
    light(camera, width, pixels, floor, above, theme) {
      for (const shadow of this.shadows) shadow.traverse((one) => { if (one.material) one.material.visible = above; });
      const u = this.uniforms;
      u.up.value.set(0, 0, 1).transformDirection(camera.matrixWorldInverse);
      u.scale.value = pixels / 2 * camera.projectionMatrix.elements[5];
      u.floor.value = floor;
      u.shade.value.fromArray(theme.shade);
      u.sun.value.copy(view.light.SUN).transformDirection(camera.matrixWorldInverse);
      this.floor.paint(theme);
      this.splats.draw(camera, this.group, width, pixels);
    }
  }

  return { Layer };
})();
