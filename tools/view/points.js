// points: particles as round balls, at least as large as `least` pixels. Grains, which have a channel `radius`, have theirs.
"use strict";
view.points = (() => {
  const { array, material, object } = view.buffers;

  const size = `
    attribute float size;
    uniform float radius, least, scale, sized;
    float pixels(vec4 p) { return 2.0 * max(mix(radius, size, sized) * scale / -p.z, least); }`;
  const vertex = `
    ${size}
    attribute vec3 colour;
    varying vec3 vColour;
    void main() {
      vec4 p = modelViewMatrix * vec4(position, 1.0);
      vColour = colour;
      gl_Position = projectionMatrix * p;
      gl_PointSize = pixels(p);
    }`;
  const fragment = `
    varying vec3 vColour;
    ${view.light.glsl}
    void main() {
      vec2 at = vec2(2.0 * gl_PointCoord.x - 1.0, 1.0 - 2.0 * gl_PointCoord.y);
      float square = dot(at, at);
      if (square > 1.0) discard;
      gl_FragColor = vec4(lit(vColour, vec3(at, sqrt(1.0 - square)), vec3(0.0, 0.0, 1.0)), 1.0);
    }`;
  const shadowVertex = `
    ${size}
    ${view.light.cast}
    void main() {
      vec4 p = viewMatrix * onFloor(modelMatrix * vec4(position, 1.0));
      gl_Position = projectionMatrix * p;
      gl_PointSize = pixels(p);
    }`;
  // A circle on the floor is as flat as the eye is low.
  const shadowFragment = `
    uniform vec3 shade, up;
    void main() {
      vec2 at = (2.0 * gl_PointCoord - 1.0) / vec2(1.0, max(abs(up.z), 0.1));
      if (dot(at, at) > 1.0) discard;
      gl_FragColor = vec4(shade, 1.0);
    }`;

  const RADIUS = "channel radius"; // the field

  class Points {
    constructor(uniforms, least) {
      this.geometry = new THREE.BufferGeometry();
      this.own = Object.assign({ radius: { value: 0 }, least: { value: least }, sized: { value: 0 } }, uniforms);
      this.mesh = object(THREE.Points, this.geometry, material(vertex, fragment, this.own));
      this.shadow = object(THREE.Points, this.geometry, material(shadowVertex, shadowFragment, this.own,
        view.light.LAID));
    }

    hide() { this.mesh.visible = this.shadow.visible = false; }

    place(x, list, count, every) {
      const to = array(this.geometry, "position", 3, count);
      if (!list && every === 1) return void to.set(x);
      for (let k = 0, at = 0; k < count; k++)
        for (let i = 3 * (list ? list[k * every] : k * every), end = i + 3; i < end; i++) to[at++] = x[i];
    }

    // Colours that stay are not given to the graphics card again.
    paint(colours, list, count, every) {
      Object.assign(this, { painted: colours, choice: list, count, every });
      const to = array(this.geometry, "colour", 3, count), one = colours.length === 3;
      for (let k = 0, at = 0; k < count; k++)
        for (let i = one ? 0 : 3 * (list ? list[k * every] : k * every), end = i + 3; i < end; i++) to[at++] = colours[i];
    }

    // Particle list[k * every] for k below `count`, or particle k * every where list is null.
    show(frame, list, count, colours, { every = 1, radii } = {}) {
      this.mesh.visible = this.shadow.visible = count > 0;
      if (count === 0) return;
      this.place(frame.x, list, count, every);
      if (this.painted !== colours || this.choice !== list || this.count !== count || this.every !== every) this.paint(colours, list, count, every);
      this.own.sized.value = radii ? 1 : 0;
      const size = radii && array(this.geometry, "size", 1, count);
      for (let k = 0; radii && k < count; k++) size[k] = radii[list ? list[k * every] : k * every];
      this.geometry.setDrawRange(0, count);
    }
  }

  return { Points, RADIUS };
})();
