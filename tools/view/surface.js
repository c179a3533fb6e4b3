// surface: triangles, shaded on both sides: smoothly, but for surfaces that nothing bends, of bodies or pinned as a whole, whose
// sides that are turned from each other by 40 degrees or more meet in a crease, as in pictures (plugins/common/normals).
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

  const CREASE = Math.cos(40 * Math.PI / 180);

  // Normals at the corners of triangles, each the sum of those at its vertex that are not across a crease.
  class Creases {
    constructor(n, triangles) {
      const start = new Uint32Array(n + 1), user = new Uint32Array(triangles.length);
      for (const v of triangles) start[v + 1]++;
      for (let v = 0; v < n; v++) start[v + 1] += start[v];
      const next = start.slice();
      triangles.forEach((v, k) => { user[next[v]++] = Math.floor(k / 3); });
      Object.assign(this, { triangles, start, user, face: new Float64Array(triangles.length) });
    }

    // into: from `at` on three numbers a corner
    find(x, into, at) {
      const { triangles, start, user, face } = this;
      for (let t = 0; t < triangles.length; t += 3) {
        const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
        const ux = x[b] - x[a], uy = x[b + 1] - x[a + 1], uz = x[b + 2] - x[a + 2];
        const vx = x[c] - x[a], vy = x[c + 1] - x[a + 1], vz = x[c + 2] - x[a + 2];
        face.set([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], t);
      }
      const dot = (i, j) => face[i] * face[j] + face[i + 1] * face[j + 1] + face[i + 2] * face[j + 2];
      for (let k = 0; k < triangles.length; k++) {
        const own = k - k % 3, v = triangles[k], square = dot(own, own);
        let nx = 0, ny = 0, nz = 0;
        for (let u = start[v]; u < start[v + 1]; u++) {
          const f = 3 * user[u];
          if (f !== own && !(dot(own, f) > CREASE * Math.sqrt(square * dot(f, f)))) continue;
          nx += face[f]; ny += face[f + 1]; nz += face[f + 2];
        }
        const long = Math.hypot(nx, ny, nz) || 1;
        into[at + 3 * k] = nx / long; into[at + 3 * k + 1] = ny / long; into[at + 3 * k + 2] = nz / long;
      }
    }
  }

  // The triangles that others bend, and the corners of those of surfaces all of whose particles are held or ride on bodies.
  const split = ({ n, triangles, pins }) => {
    const held = new Uint8Array(n), soft = [], hard = [];
    for (const i of pins) held[i] = 1;
    for (let changed = true; changed;) {
      changed = false;
      for (let t = 0; t < triangles.length; t += 3) {
        const some = held[triangles[t]] + held[triangles[t + 1]] + held[triangles[t + 2]];
        if (some === 0 || some === 3) continue;
        for (let c = 0; c < 3; c++) held[triangles[t + c]] = 0;
        changed = true;
      }
    }
    for (let t = 0; t < triangles.length; t += 3)
      (held[triangles[t]] ? hard : soft).push(triangles[t], triangles[t + 1], triangles[t + 2]);
    return { soft: Uint32Array.from(soft), hard: Uint32Array.from(hard) };
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
      if (this.triangles !== frame.triangles) this.join(frame);
      this.put("position", frame.x);
      if (this.painted !== colours) this.put("colour", colours);
      this.painted = colours;
      const into = array(this.geometry, "normal", 3, frame.n + this.hard.length);
      normals(frame.x, this.soft, frame.n, into);
      this.creases.find(frame.x, into, 3 * frame.n);
      this.own.backs.value = plain ? 1 : 0;
    }

    // Corners at creases follow the particles, each with a place of its own.
    join(frame) {
      Object.assign(this, split(frame), { triangles: frame.triangles, n: frame.n, painted: null });
      this.creases = new Creases(frame.n, this.hard);
      const index = new Uint32Array(frame.triangles.length);
      index.set(this.soft);
      for (let k = 0; k < this.hard.length; k++) index[this.soft.length + k] = frame.n + k;
      this.geometry.setIndex(new THREE.BufferAttribute(index, 1));
    }

    put(name, numbers) {
      const { n, hard } = this, into = array(this.geometry, name, 3, n + hard.length);
      into.set(numbers.subarray(0, 3 * n));
      for (let k = 0; k < hard.length; k++)
        for (let c = 0; c < 3; c++) into[3 * (n + k) + c] = numbers[3 * hard[k] + c];
    }

    fade(opacity) {
      this.own.opacity.value = opacity;
      this.mesh.material.transparent = opacity < 1;
    }
  }

  return { Surface, Creases };
})();
