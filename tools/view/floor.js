// floor: a round plane with a fine grid, that fades into the background: below the motion, or an obstacle.
"use strict";
view.floor = (() => {
  const vertex = `
    uniform float radius;
    uniform vec2 centre;
    varying vec2 vAt;
    void main() {
      vAt = position.xy * radius + centre;
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    }`;
  const fragment = `
    varying vec2 vAt;
    uniform vec3 colour, line;
    uniform float cell, radius;
    uniform vec2 centre;
    float grid(float size) {
      vec2 at = vAt / size, d = abs(fract(at - 0.5) - 0.5) / fwidth(at);
      return 1.0 - min(min(d.x, d.y), 1.0);
    }
    void main() {
      float fade = 1.0 - smoothstep(0.45, 1.0, length(vAt - centre) / radius);
      vec3 c = mix(colour, line, max(0.35 * grid(cell), 0.8 * grid(5.0 * cell)));
      gl_FragColor = vec4(c, fade);
    }`;

  class Floor {
    constructor() {
      this.uniforms = { colour: { value: new THREE.Vector3() }, line: { value: new THREE.Vector3() }, cell: { value: 1 },
        radius: { value: 1 }, centre: { value: new THREE.Vector2() } };
      this.mesh = new THREE.Mesh(new (view.buffers.shape("Circle"))(1, 96), view.buffers.material(vertex, fragment,
        this.uniforms, { transparent: true, depthWrite: false, side: THREE.DoubleSide, extensions: { derivatives: true } }));
      this.mesh.renderOrder = -1;
    }

    // The grid goes through x = 0 and y = 0 in the plane, whose middle is there.
    place(x, y, radius) {
      this.mesh.scale.set(radius, radius, 1);
      this.uniforms.centre.value.set(x, y);
      this.uniforms.radius.value = radius;
      this.uniforms.cell.value = view.numbers.step(radius, 24);
    }

    // The colours of the page.
    paint(theme) {
      this.uniforms.colour.value.fromArray(theme.floor);
      this.uniforms.line.value.fromArray(theme.line);
    }
  }

  return { Floor };
})();
