// stage: the 3D view: one camera for all layers, beside each other or in one picture, and which particle is under the
// pointer. It draws when something has changed, and not otherwise.
"use strict";
view.stage = (() => {
  const corners = ({ min, max }) => [min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) =>
    [min.z, max.z].map((z) => new THREE.Vector3(x, y, z))));

  const REACH = 12; // pixels from the pointer within which a particle is meant

  class Stage {
    constructor(canvas, antialias, picked) {
      Object.assign(this, { canvas, layers: [], side: false, dirty: true, yUp: false, drawn: 0 });
      // It fills its part of the page itself: to blend it with what is behind takes a quarter of a picture by software.
      this.renderer = new THREE.WebGLRenderer({ canvas, antialias, alpha: false });
      this.renderer.autoClear = false;
      // Colours are those of the page's style; newer versions of three.js would take them for others.
      if (THREE.ColorManagement) THREE.ColorManagement.enabled = false;
      this.orbit = new view.orbit.Orbit(canvas, () => this.draw());
      new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
      matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.themed());
      let down = null;
      canvas.addEventListener("pointerdown", (e) => { down = [e.clientX, e.clientY]; });
      canvas.addEventListener("pointerup", (e) => {
        if (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) < 4) picked(this.pick(e.offsetX, e.offsetY));
      });
      this.themed();
      this.resize();
    }

    themed() {
      const style = getComputedStyle(document.documentElement);
      const colour = (name) => new THREE.Color(style.getPropertyValue(name).trim()).toArray();
      this.renderer.setClearColor(new THREE.Color(style.getPropertyValue("--paper").trim()), 1);
      this.theme = { floor: colour("--floor"), line: colour("--floor-line"), shade: colour("--floor-shade") };
      this.draw();
    }

    add(layer) {
      this.layers.push(layer);
      this.place();
    }

    // Sees the bounds of all layers, and puts the floor below them.
    place() {
      const box = new THREE.Box3();
      for (const layer of this.layers) {
        layer.group.rotation.x = this.yUp ? Math.PI / 2 : 0;
        layer.group.position.copy(layer.offset || new THREE.Vector3());
        layer.group.updateMatrixWorld(true);
        const { low, high } = layer.source.bounds;
        const own = new THREE.Box3(new THREE.Vector3(...low), new THREE.Vector3(...high));
        box.union(view.solids.around(own, layer.source).applyMatrix4(layer.group.matrixWorld));
      }
      const middle = box.getCenter(new THREE.Vector3()), radius = box.getSize(new THREE.Vector3()).length() / 2 || 1;
      Object.assign(this, { middle, reach: 4.2 * radius, below: box.min.z - 0.012 * radius });
      const [first] = this.views();
      this.orbit.look(middle, corners(box), first.w / first.h || 1);
    }

    // The camera as at the start.
    home() {
      this.orbit.face();
      this.place();
    }

    resize() {
      const { clientWidth: w, clientHeight: h } = this.canvas.parentElement;
      if (!w || !h) return;
      this.renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
      this.renderer.setSize(w, h, false);
      if (this.layers.length && !this.orbit.moved) this.place();
      this.draw();
    }

    draw() {
      if (this.dirty === "asked") return;
      this.dirty = "asked";
      requestAnimationFrame(() => this.render());
    }

    // How many pixels a length (m) has on the page at the middle of the motion, across the line of sight.
    pixels(length) {
      const { camera } = this.orbit, [first] = this.views();
      const depth = -this.middle.clone().applyMatrix4(camera.matrixWorldInverse).z;
      return depth > 0 ? length * camera.projectionMatrix.elements[5] * first.h / 2 / depth : 0;
    }

    views() {
      const { clientWidth: w, clientHeight: h } = this.canvas.parentElement;
      const seen = this.layers.filter((layer) => !layer.hidden);
      return this.side
        ? seen.map((layer, k) => ({ x: k * w / seen.length, w: w / seen.length, h, layers: [layer] }))
        : [{ x: 0, w, h, layers: seen }];
    }

    // The floor is below the motion, or a level plane that is an obstacle.
    layFloor() {
      const levels = this.layers.map((layer) => layer.solids.level(layer.group.matrixWorld, this.floorless));
      this.floorHeight = levels.find((height) => height !== undefined);
      if (this.floorHeight === undefined) this.floorHeight = this.below - Math.max(0, ...this.layers.map((layer) => layer.thickness()));
      for (const { floor, solids } of this.layers) {
        floor.mesh.position.set(this.middle.x, this.middle.y, this.floorHeight);
        floor.place(this.middle.x, this.middle.y, this.reach);
        solids.paint(this.reach, this.theme);
      }
    }

    render() {
      this.dirty = false;
      const { renderer, orbit } = this, { camera } = orbit;
      if (!this.layers.length) return;
      this.layFloor();
      const above = !this.floorless && camera.position.z > this.floorHeight;
      renderer.setScissorTest(false);
      renderer.clear();
      renderer.setScissorTest(true);
      for (const v of this.views()) {
        camera.aspect = v.w / v.h;
        camera.updateProjectionMatrix();
        renderer.setViewport(v.x, 0, v.w, v.h);
        renderer.setScissor(v.x, 0, v.w, v.h);
        v.layers.forEach((layer, k) => {
          layer.floor.mesh.visible = above && k === 0;
          layer.light(camera, v.w * renderer.getPixelRatio(), v.h * renderer.getPixelRatio(), this.floorHeight, above, this.theme);
          renderer.render(layer.scene, camera);
        });
      }
      this.drawn++;
      if (this.rendered) this.rendered();
    }

    // The picture as a file: what WebGL has drawn is there until the browser shows it.
    save(name) {
      this.render();
      this.canvas.toBlob((blob) => view.dom.save(name, blob));
    }

    // The particle nearest to the eye within some pixels of the point that no surface or obstacle hides, { layer, index, id },
    // or null.
    pick(px, py) {
      const v = this.views().find((one) => px >= one.x && px < one.x + one.w);
      if (!v) return null;
      const { camera } = this.orbit, found = [], x = 2 * (px - v.x) / v.w - 1, y = 1 - 2 * py / v.h;
      camera.aspect = v.w / v.h;
      camera.updateProjectionMatrix();
      const layers = v.layers.filter((layer) => layer.frame), reach = [2 * REACH / v.w, 2 * REACH / v.h];
      for (const layer of layers) found.push(...this.near(layer, x, y, reach));
      found.sort((a, b) => a.rank - b.rank);
      if (!found.length) return null;
      const blockers = new view.sight.Blockers(x, y, reach);
      for (const thing of layers.flatMap((layer) => layer.blockers())) blockers.add(camera, thing);
      return found.find(({ layer, index, place }) => !blockers.hide(place, layer.frame.x, index)) || null;
    }

    // Particles of a layer that are seen within reach of a place in its view, which goes from -1 to 1.
    near(layer, x, y, reach) {
      const { frame } = layer, { orbit } = this, found = [];
      const places = view.sight.clip(view.sight.matrixOf(orbit.camera, layer.group), frame.x, frame.n);
      for (let index = 0; index < frame.n; index++) {
        const at = 3 * index, w = places[at + 2];
        const off = Math.hypot((places[at] / w - x) / reach[0], (places[at + 1] / w - y) / reach[1]);
        if (w > 0 && off <= 1) found.push({ layer, index, id: frame.ids[index], place: places.subarray(at, at + 3),
          rank: off + 4 * w / orbit.distance }); // near the pointer, and in front
      }
      return found;
    }
  }

  return { Stage };
})();
