// segments: straight pieces between two points, drawn as round bars, at least as wide as `least` pixels: edges, and
// arrows, which are needles that end in a point.
"use strict";
view.segments = (() => {
  const { array, material, object } = view.buffers;

  const place = `
    attribute vec3 begin, end;
    attribute float own; // of strands, 0: it has none
    uniform float radius, least, scale, taper;
    float width(vec3 p, float along) { return max(own > 0.0 ? own : radius, least * -p.z / scale) * mix(1.0, 0.06, along * taper); }`;
  const vertex = `
    ${place}
    attribute vec3 colourBegin, colourEnd;
    varying vec3 vColour, vSide, vFront;
    varying float vAcross;
    void main() {
      vec3 a = (modelViewMatrix * vec4(begin, 1.0)).xyz, b = (modelViewMatrix * vec4(end, 1.0)).xyz;
      vec3 p = mix(a, b, position.x), along = b - a;
      vec3 side = cross(along, p);
      float size = length(side);
      side = size > 0.0 ? side / size : vec3(1.0, 0.0, 0.0);
      vSide = side;
      vFront = normalize(cross(side, along));
      if (dot(vFront, p) > 0.0) vFront = -vFront;
      vAcross = position.y;
      vColour = mix(colourBegin, colourEnd, position.x);
      gl_Position = projectionMatrix * vec4(p + side * position.y * width(p, position.x), 1.0);
    }`;
  const fragment = `
    varying vec3 vColour, vSide, vFront;
    varying float vAcross;
    ${view.light.glsl}
    void main() {
      vec3 normal = normalize(vSide * vAcross + vFront * sqrt(max(1.0 - vAcross * vAcross, 0.0)));
      gl_FragColor = vec4(lit(vColour, normal, normalize(vFront)), 1.0);
    }`;
  const shadowVertex = `
    ${place}
    ${view.light.cast}
    void main() {
      vec3 a = (viewMatrix * onFloor(modelMatrix * vec4(begin, 1.0))).xyz;
      vec3 b = (viewMatrix * onFloor(modelMatrix * vec4(end, 1.0))).xyz;
      vec3 p = mix(a, b, position.x), side = cross(b - a, p);
      float size = length(side);
      side = size > 0.0 ? side / size : vec3(1.0, 0.0, 0.0);
      gl_Position = projectionMatrix * vec4(p + side * position.y * width(p, position.x), 1.0);
    }`;
  const shadowFragment = "uniform vec3 shade; void main() { gl_FragColor = vec4(shade, 1.0); }";

  class Segments {
    constructor(uniforms, taper) {
      this.geometry = new THREE.InstancedBufferGeometry();
      const corners = new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]);
      this.geometry.setAttribute("position", new THREE.BufferAttribute(corners, 3));
      this.geometry.setIndex([0, 1, 2, 0, 2, 3]);
      this.own = Object.assign({ radius: { value: 0 }, least: { value: 0.7 }, taper: { value: taper ? 1 : 0 } }, uniforms);
      this.mesh = object(THREE.Mesh, this.geometry, material(vertex, fragment, this.own, { side: THREE.DoubleSide }));
      this.shadow = object(THREE.Mesh, this.geometry, material(shadowVertex, shadowFragment, this.own,
        { side: THREE.DoubleSide, ...view.light.LAID }));
    }

    count(count) {
      this.geometry.maxInstancedCount = this.geometry.instanceCount = count; // its name in older and in newer versions
      this.mesh.visible = this.shadow.visible = count > 0;
    }

    // Arrays to fill, for so many pieces, none of which has a radius of its own.
    arrays(count) {
      this.count(count);
      array(this.geometry, "own", 1, count, true).fill(0);
      return ["begin", "end", "colourBegin", "colourEnd"].map((name) => array(this.geometry, name, 3, count, true));
    }

    // The mean of both ends, of those that have a radius, as in pictures (plugins/common/picture/geometry.c).
    static radius(radii, i, j) {
      const a = radii[i], b = radii[j];
      return a > 0 && b > 0 ? (a + b) / 2 : a + b;
    }

    // Pairs of indices of particles.
    show(frame, pairs, colours) {
      const count = pairs.length / 2;
      this.count(count);
      if (count === 0) return;
      const [begin, end, first, second] = this.arrays(count), own = frame.radii && frame.radii.length && array(this.geometry, "own", 1, count, true);
      for (let e = 0; own && e < count; e++) own[e] = Segments.radius(frame.radii, pairs[2 * e], pairs[2 * e + 1]);
      for (let e = 0, at = 0; e < count; e++) {
        const i = 3 * pairs[2 * e], j = 3 * pairs[2 * e + 1];
        for (let c = 0; c < 3; c++, at++) {
          begin[at] = frame.x[i + c];
          end[at] = frame.x[j + c];
          first[at] = colours[i + c];
          second[at] = colours[j + c];
        }
      }
    }
  }

  return { Segments };
})();
