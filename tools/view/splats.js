// splats: many particles as round balls, drawn by the processor, for browsers without a graphics card: there a point costs
// a microsecond, whatever its size, and here some tens of nanoseconds. A ball is a stencil of pixels; in each pixel the
// nearest stays. The picture goes to the graphics as one texture with depths, so that it hides and is hidden like all else.
// A pixel is 32 bits, so that one comparison is the depth test: 14 of depth, 3 of brightness, 15 of colour.
"use strict";
view.splats = (() => {
  const { material, object, shape } = view.buffers;
  const NONE = 0xffffffff, DEPTHS = 16383, SHADES = 7;
  const LARGEST = 48; // pixels: a radius above is drawn as this one

  const vertex = `
    varying vec2 vAt;
    uniform vec4 box;
    void main() {
      vAt = mix(box.xy, box.zw, uv);
      gl_Position = vec4(2.0 * vAt - 1.0, 0.0, 1.0);
    }`;
  const fragment = `
    varying vec2 vAt;
    uniform sampler2D picture;
    uniform vec2 depths, brightness;
    uniform vec4 projection;
    void main() {
      vec4 p = floor(texture2D(picture, vAt) * 255.0 + 0.5);
      if (p.a == 255.0 && p.b == 255.0) discard;
      float low = p.g * 256.0 + p.r, colour = mod(low, 32768.0), shade = mod(p.b, 4.0) * 2.0 + floor(low / 32768.0);
      vec3 c = vec3(mod(colour, 32.0), mod(floor(colour / 32.0), 32.0), floor(colour / 1024.0)) / 31.0;
      float light = mix(brightness.x, brightness.y, shade / ${SHADES}.0);
      gl_FragColor = vec4(sqrt(c * c * light), 1.0);
      float z = -mix(depths.x, depths.y, (p.a * 64.0 + floor(p.b / 4.0)) / ${DEPTHS}.0);
      gl_FragDepthEXT = 0.5 + 0.5 * (projection.x * z + projection.y) / (projection.z * z + projection.w);
    }`;

  // Of a ball of so many half pixels: the rows and columns of its pixels, and the brightness of each, as light.js has it.
  const stencil = (half, up, sun, low, high) => {
    const radius = half / 2, size = Math.floor(radius), rows = [], columns = [], shades = [];
    for (let row = -size; row <= size; row++)
      for (let column = -size; column <= size; column++) {
        const x = column / radius, y = row / radius, square = x * x + y * y;
        if (square > 1) continue;
        const z = Math.sqrt(1 - square), dot = (v) => x * v.x + y * v.y + z * v.z;
        const light = 0.26 + 0.36 * (0.5 + 0.5 * dot(up)) + 0.56 * Math.max(dot(sun), 0);
        rows.push(row);
        columns.push(column);
        shades.push(Math.round((light - low) / (high - low) * SHADES) << 15);
      }
    return { size, rows: Int32Array.from(rows), columns: Int32Array.from(columns), shades: Int32Array.from(shades) };
  };

  class Splats {
    // own: the uniforms `radius` and `least` of the particles, those of the light among them
    constructor(own) {
      this.own = own;
      this.uniforms = { picture: { value: null }, depths: { value: new THREE.Vector2() }, projection: { value: new THREE.Vector4() },
        box: { value: new THREE.Vector4() }, // the part of the view that has particles
        brightness: { value: new THREE.Vector2(0.26, 1.18) } }; // the least and the most that a stencil has
      this.mesh = object(THREE.Mesh, new (shape("Plane"))(2, 2), material(vertex, fragment, this.uniforms,
        { extensions: { fragDepth: true } }));
      this.mesh.visible = false;
      this.many = null;
    }

    // As Points.show has them; colours are packed once.
    show(frame, list, count, colours, { every = 1, radii } = {}) {
      this.mesh.visible = count > 0;
      this.many = { x: frame.x, list, count, every, radii };
      if (this.painted === colours) return;
      this.painted = colours;
      this.packed = new Uint16Array(colours.length / 3);
      for (let i = 0, k = 0; i < this.packed.length; i++, k += 3)
        this.packed[i] = Math.round(31 * colours[k]) | Math.round(31 * colours[k + 1]) << 5 | Math.round(31 * colours[k + 2]) << 10;
    }

    hide() { this.mesh.visible = false; }

    resize(width, height) {
      if (this.width === width && this.height === height) return;
      Object.assign(this, { width, height, pixels: new Uint32Array(width * height) });
      if (this.uniforms.picture.value) this.uniforms.picture.value.dispose();
      this.uniforms.picture.value = new THREE.DataTexture(new Uint8Array(this.pixels.buffer), width, height, THREE.RGBAFormat);
      this.stencils = [];
    }

    // The distances from the camera between which all particles are.
    range(row) {
      let near = Infinity, far = 0;
      const { x, count, list, every } = this.many;
      for (let k = 0; k < count; k++) {
        const i = 3 * (list ? list[k * every] : k * every);
        const w = row[0] * x[i] + row[1] * x[i + 1] + row[2] * x[i + 2] + row[3];
        if (w > 0) { near = Math.min(near, w); far = Math.max(far, w); }
      }
      return near < Infinity ? [near, far > near ? far : near * 1.001] : [1, 2];
    }

    // Of a camera, for a view of so many pixels.
    draw(camera, group, width, height) {
      if (!this.mesh.visible) return;
      const begin = performance.now();
      this.resize(Math.round(width), Math.round(height));
      this.stencils = []; // the light is another
      this.pixels.fill(NONE);
      const p = camera.projectionMatrix.elements;
      const m = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).multiply(group.matrixWorld).elements;
      const [near, far] = this.range([m[3], m[7], m[11], m[15]]);
      this.uniforms.depths.value.set(near, far);
      this.uniforms.projection.value.set(p[10], p[14], p[11], p[15]);
      this.fill(m, near, (DEPTHS - 1) / (far - near));
      this.uniforms.picture.value.needsUpdate = true;
      this.took = Math.min(performance.now() - begin, 1.1 * (this.took || Infinity)); // ms, without what else ran meanwhile
    }

    // The pixels of all particles: m takes places to the screen. The loop is one piece because of its speed.
    fill(m, near, unit) {
      const { x, list, count, every, radii } = this.many, { packed, width, height } = this, one = packed.length === 1;
      const half = [width / 2, height / 2], box = [width, height, 0, 0], radius = this.own.radius.value, scale = this.own.scale.value, least = this.own.least.value;
      for (let k = 0; k < count; k++) {
        const id = list ? list[k * every] : k * every, i = 3 * id, a = x[i], b = x[i + 1], c = x[i + 2];
        const w = m[3] * a + m[7] * b + m[11] * c + m[15];
        if (!(w > 0)) continue; // behind the eye, or nowhere
        const column = ((m[0] * a + m[4] * b + m[8] * c + m[12]) / w + 1) * half[0] | 0;
        const row = ((m[1] * a + m[5] * b + m[9] * c + m[13]) / w + 1) * half[1] | 0;
        const s = this.stencil(Math.max((radii ? radii[id] : radius) * scale / w, least));
        const value = ((w - near) * unit << 18 | packed[one ? 0 : id]) >>> 0;
        if (column < -s.size || row < -s.size || column >= width + s.size || row >= height + s.size) continue;
        this.stamp(s, column, row, value);
        if (column - s.size < box[0]) box[0] = column - s.size;
        if (row - s.size < box[1]) box[1] = row - s.size;
        if (column + s.size >= box[2]) box[2] = column + s.size + 1;
        if (row + s.size >= box[3]) box[3] = row + s.size + 1;
      }
      const share = (v, size) => Math.min(Math.max(v / size, 0), 1);
      this.uniforms.box.value.set(share(box[0], width), share(box[1], height), share(box[2], width), share(box[3], height));
    }

    stencil(radius) {
      const half = Math.round(2 * Math.min(radius, LARGEST)), { up, sun } = this.own, [low, high] = this.uniforms.brightness.value.toArray();
      return this.stencils[half] || (this.stencils[half] = stencil(half, up.value, sun.value, low, high));
    }

    stamp({ size, rows, columns, shades }, column, row, value) {
      const { pixels, width, height } = this;
      const inside = column >= size && row >= size && column < width - size && row < height - size;
      for (let q = 0; q < rows.length; q++) {
        const h = column + columns[q], v = row + rows[q];
        if (!inside && (h < 0 || v < 0 || h >= width || v >= height)) continue;
        const at = v * width + h, pixel = (value | shades[q]) >>> 0;
        if (pixel < pixels[at]) pixels[at] = pixel;
      }
    }
  }

  return { Splats };
})();
