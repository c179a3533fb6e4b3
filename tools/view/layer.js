// layer: one run in the 3D view: its surface, edges, particles, pins, arrows, obstacles, and the particle that is picked.
"use strict";
view.layer = (() => {
  const { thing } = view.colours;

  const MOST_WINDS = 72, MOST_ARROWS = 1500; // as many as are still told apart
  // Radii in a motion of this size, half the diagonal of its box, with n particles and so many lines, as pictures choose
  // them (plugins/common/frame_data/radii.h).
  const radiiOf = (size, n, lines) => {
    const r = view.colours.radii, many = r.most.findIndex((most) => lines <= most);
    const tube = size * r.tube[many < 0 ? r.most.length : many];
    const ball = lines ? r.on_tubes * tube : size * Math.min(Math.max(r.loose / Math.sqrt(n + 1), r.least), r.largest);
    return { tube, ball, pin: lines ? r.pin_on_tubes * ball : r.pin * size };
  };

  class Layer {
    // tint: the colour of what stands for no number
    // redraw(): called when what is shown has changed by itself
    constructor(source, tint, redraw) {
      Object.assign(this, { source, tint, every: 1, notes: [], shown: { points: null, edges: false, trails: false, shadows: true, solids: true } });
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
      this.trails = new view.trails.Trails(source, this.uniforms, redraw);
      this.contacts = new view.points.Points(this.uniforms, 2);
      // They are between what they hold apart, and are drawn last: after the floor, which is transparent.
      Object.assign(this.contacts.mesh.material, { depthTest: false, transparent: true });
      this.contacts.mesh.renderOrder = 1;
      const parts = [this.solids, this.wind, this.contacts, this.surface, this.edges, this.arrows, this.points, this.pins, this.picked,
        this.trails];
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
      const lines = view.topology.of(this.source, frame).edges.length / 2;
      this.radius = radiiOf(Math.hypot(...low.map((v, c) => high[c] - v)) / 2 || 0.5, frame.n, lines);
    }

    sizes() {
      const { tube, ball, pin } = this.radius || { tube: 0, ball: 0, pin: 0 }; // of no particles
      this.points.own.radius.value = ball;
      this.pins.own.radius.value = 2 * pin; // they are to be found
      this.picked.own.radius.value = 1.2 * Math.max(ball, 2 * pin);
      this.edges.own.radius.value = tube * (this.surface.mesh.visible ? 0.5 : 1);
      this.arrows.own.radius.value = 0.5 * tube;
      this.wind.own.radius.value = 0.006 * this.size;
      this.contacts.own.radius.value = 0;
    }

    // How far what is drawn reaches around the places of particles.
    thickness() {
      const { points, pins, edges } = this;
      return Math.max(0, ...[points, pins, edges].filter((part) => part.mesh.visible).map((part) => part.own.radius.value));
    }

    plain(n) {
      if (!this.same || this.same.length !== 3 * n) {
        this.same = new Float32Array(3 * n);
        for (let i = 0; i < 3 * n; i++) this.same[i] = this.tint[i % 3];
      }
      return this.same;
    }

    // colours: of each particle, or null; arrows: numbers (3n) and the length of one of size 1, or null
    // byGroup: whether they are those of groups, which rigid bodies have as well
    show(frame, colours, arrows, pickedId, byGroup = false) {
      if (this.radius === undefined && frame.n) this.defaults(frame);
      this.frame = frame;
      const paint = colours || this.plain(frame.n), s = this.shown;
      this.coloured = !!colours && !byGroup;
      this.surface.show(frame, paint, !colours);
      const { edges, alone, pins } = view.topology.of(this.source, frame);
      this.edges.show(frame, s.edges ? frame.edges : edges, paint);
      this.balls = s.points || alone.length === frame.n ? frame.n : alone.length;
      this.showBalls(frame, this.balls === frame.n ? null : alone, paint);
      this.pins.show(frame, pins, pins.length, thing("held"));
      this.solids.show(frame, s.solids);
      this.solids.colour(byGroup);
      this.showMarks(frame);
      this.showArrows(frame, arrows);
      const k = pickedId === null ? -1 : frame.ids.indexOf(pickedId);
      this.picked.show(frame, [k], k < 0 ? 0 : 1, thing("picked"));
      this.trails.show(frame, s.trails ? pickedId ?? "all" : null, this.tint);
      for (const shadow of this.shadows) shadow.visible = shadow.visible && s.shadows;
      this.sizes();
    }

    // By the graphics, or by the page itself where there is none.
    showBalls(frame, list, paint) {
      const count = Math.ceil(this.balls / this.every), by = this.sparing && this.sparing.splats(this.balls);
      by ? this.points.hide() : this.splats.hide();
      (by ? this.splats : this.points).show(frame, list, count, paint, { every: this.every, radii: this.radiiOfBalls(frame) });
    }

    // A channel has those of grains; particles of strands are no thinner than these.
    radiiOfBalls({ values, radii }) {
      const { ball } = this.radius || { ball: 0 };
      if (values[view.points.RADIUS] || !radii || !radii.length) return values[view.points.RADIUS];
      if (this.thick !== radii || this.thickOver !== ball)
        Object.assign(this, { thick: radii, thickOver: ball, thickened: radii.map((r) => Math.max(r, ball)) });
      return this.thickened;
    }

    showMarks(frame) {
      const shown = this.source.marks.filter((m) => frame.marks[m.key]).map((m) => ({ ...m, ...frame.marks[m.key] }));
      this.showWind(shown.filter((m) => m.kind === "wind" && m.count > 0));
      const contact = shown.find((m) => m.kind === "contact") || { places: new Float32Array(0), count: 0, total: 0 };
      this.contacts.show({ x: contact.places }, null, contact.count, thing("contact"));
      this.notes = contact.total > contact.count ? [`${contact.count} of ${contact.total} contacts are shown`] : [];
    }

    // Airs that act together are summed: they are known at the same places. Arrows stand so far apart that each is seen.
    showWind(winds) {
      const places = winds.length ? winds[0].places : new Float32Array(0), n = places.length / 3;
      const every = Math.ceil(n / MOST_WINDS) || 1, unit = 0.18 * this.size / winds.reduce((sum, m) => sum + m.largest, 1e-30);
      const [begin, end, first, second] = this.wind.arrays(Math.ceil(n / every)), wind = thing("wind");
      for (let i = 0, at = 0; i < n; i += every)
        for (let c = 0; c < 3; c++, at++) {
          const sum = winds.reduce((total, m) => total + m.vectors[3 * i + c], 0);
          begin[at] = places[3 * i + c];
          end[at] = places[3 * i + c] + sum * unit;
          first[at] = second[at] = wind[c];
        }
    }

    showArrows(frame, arrows) {
      const every = arrows ? Math.ceil(frame.n / MOST_ARROWS) : 1, count = arrows ? Math.ceil(frame.n / every) : 0;
      if (every > 1) this.notes.push(`arrows at ${count} of ${frame.n} particles`);
      const [begin, end, first, second] = this.arrows.arrays(count);
      for (let k = 0, at = 0; k < count; k++)
        for (let c = 0; c < 3; c++, at++) {
          const i = 3 * k * every + c;
          begin[at] = frame.x[i];
          end[at] = frame.x[i] + arrows.numbers[i] * arrows.length;
          first[at] = second[at] = arrows.colour[c];
        }
    }

    // Whether something is seen whose colour stands for a number; pins, obstacles and rigid bodies have colours of their own, and what is
    // within a body, found once for each topology, is not seen.
    get painted() {
      const { surface, frame, solids, source } = this, { edges, alone } = view.topology.of(source, frame);
      if (!this.coloured || surface.mesh.visible) return this.coloured;
      const key = [frame.topology, frame.n, solids.mesh.visible].join();
      if (this.withinOf !== key) Object.assign(this, { withinOf: key, inside: solids.within(frame) });
      const seen = (i) => !this.inside[i];
      return edges.some(seen) || (this.balls === frame.n ? this.inside.includes(0) : alone.some(seen));
    }

    // Particles of the motion, for the camera: those of surfaces that nothing bends only where there are no others.
    sample(camera) {
      const { x, n } = this.frame, held = new Uint8Array(n), places = [];
      for (const i of this.surface.mesh.visible ? this.surface.hard : []) held[i] = 1;
      const some = held.includes(0), every = Math.ceil(n / view.sight.POINTS);
      for (let i = 0; i < n; i += every)
        if (Number.isFinite(x[3 * i]) && !(some && held[i])) places.push(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
      return view.sight.clip(view.sight.matrixOf(camera, this.group), places, places.length / 3);
    }

    // What hides particles behind it from a press: surfaces and obstacles through which nothing is seen.
    blockers() {
      const { surface, frame, group } = this, seen = surface.mesh.visible && !surface.mesh.material.transparent;
      return [...seen ? [{ x: frame.x, count: frame.n, index: frame.triangles, object: group, side: view.sight.BOTH }] : [],
        ...this.solids.blockers()];
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
      if (this.frame) this.solids.fade(camera, () => this.sample(camera));
      this.splats.draw(camera, this.group, width, pixels);
    }
  }

  return { Layer };
})();
