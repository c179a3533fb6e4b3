// surface: triangles, shaded smoothly on both sides.
"use strict";
view.surface = (() => {
  const { array, material, object } = view.buffers;

  const vertex = `
    attribute vec3 colour;
    varying vec3 vColour, vNormal, vEye;
    void main() {
      vec4 p = modelViewMatrix * vec4(position, 1.0);
      vColour = colour;
      vNormal = normalMatrix * normal;
      vEye = -p.xyz;
      gl_Position = projectionMatrix * p;
    }`;
  const fragment = `
    varying vec3 vColour, vNormal, vEye;
    uniform float backs;
    uniform float opacity;
    ${view.light.glsl}
    void main() {
      vec3 normal = normalize(vNormal), colour = vColour;
      if (!gl_FrontFacing) {
        normal = -normal;
        colour = mix(colour, vec3(0.93, 0.89, 0.82), backs);
      }
      gl_FragColor = vec4(lit(colour, normal, normalize(vEye)), opacity);
    }`;
  const shadowVertex = `
    ${view.light.cast}
    void main() { gl_Position = projectionMatrix * viewMatrix * onFloor(modelMatrix * vec4(position, 1.0)); }`;
  const shadowFragment = "uniform vec3 shade; void main() { gl_FragColor = vec4(shade, 1.0); }";

  // The sum of the triangles' normals at each corner, weighted by area.
  const normals = (x, triangles, n, into) => {
    into.fill(0, 0, 3 * n);
    for (let t = 0; t < triangles.length; t += 3) {
      const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
      const ux = x[b] - x[a], uy = x[b + 1] - x[a + 1], uz = x[b + 2] - x[a + 2];
      const vx = x[c] - x[a], vy = x[c + 1] - x[a + 1], vz = x[c + 2] - x[a + 2];
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      into[a] += nx; into[a + 1] += ny; into[a + 2] += nz;
      into[b] += nx; into[b + 1] += ny; into[b + 2] += nz;
      into[c] += nx; into[c + 1] += ny; into[c + 2] += nz;
    }
  };

  class Surface {
    constructor(uniforms) {
      this.geometry = new THREE.BufferGeometry();
      this.own = Object.assign({ backs: { value: 1 }, opacity: { value: 1 } }, uniforms);
      this.mesh = object(THREE.Mesh, this.geometry, material(vertex, fragment, this.own, { side: THREE.DoubleSide }));
      this.shadow = object(THREE.Mesh, this.geometry, material(shadowVertex, shadowFragment, uniforms,
        { side: THREE.DoubleSide, ...view.light.LAID }));
    }

    // colours: red, green, blue of each particle; plain: they are no numbers, and the backs may have a colour of their own
    show(frame, colours, plain) {
      const some = frame.triangles.length > 0;
      this.mesh.visible = this.shadow.visible = some;
      if (!some) return;
      array(this.geometry, "position", 3, frame.n).set(frame.x);
      if (this.painted !== colours) array(this.geometry, "colour", 3, frame.n).set(colours);
      this.painted = colours;
      normals(frame.x, frame.triangles, frame.n, array(this.geometry, "normal", 3, frame.n));
      if (this.triangles !== frame.triangles) {
        this.geometry.setIndex(new THREE.BufferAttribute(frame.triangles, 1));
        this.triangles = frame.triangles;
      }
      this.own.backs.value = plain ? 1 : 0;
    }

    fade(opacity) {
      this.own.opacity.value = opacity;
      this.mesh.material.transparent = opacity < 1;
    }
  }

  return { Surface };
})();
