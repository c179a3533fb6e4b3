// orbit: a camera that turns around a point, comes nearer and moves sideways, by mouse, touch and wheel. Up is z.
"use strict";
view.orbit = (() => {
  const LIMIT = Math.PI / 2 - 0.01, INNER = 0.84;

  class Orbit {
    constructor(element, changed) {
      Object.assign(this, { element, changed, pointers: new Map(), target: new THREE.Vector3(), distance: 3, size: 1 });
      this.face();
      this.camera = new THREE.PerspectiveCamera(34, 1, 0.01, 100);
      this.camera.up.set(0, 0, 1);
      element.addEventListener("pointerdown", (e) => this.down(e));
      element.addEventListener("pointermove", (e) => this.move(e));
      for (const end of ["pointerup", "pointercancel"]) element.addEventListener(end, (e) => this.pointers.delete(e.pointerId));
      element.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
      element.addEventListener("contextmenu", (e) => e.preventDefault());
    }

    face() {
      this.moved = false; // by the user
      this.azimuth = -0.9;
      this.height = 0.3;
    }

    // Turns around the point, and sees all corners of a box in the inner part of a picture of this aspect ratio.
    look(target, corners, aspect) {
      this.target.copy(target);
      this.size = Math.max(...corners.map((corner) => corner.distanceTo(target))) || 1;
      this.distance = 1;
      this.update();
      const m = this.camera.matrixWorld.elements, tall = INNER * Math.tan(this.camera.fov * Math.PI / 360), wide = tall * aspect;
      const along = (v, k) => v.x * m[k] + v.y * m[k + 1] + v.z * m[k + 2];
      const needed = corners.map((corner) => {
        const v = corner.clone().sub(target);
        return along(v, 8) + Math.max(Math.abs(along(v, 0)) / wide, Math.abs(along(v, 4)) / tall);
      });
      this.distance = Math.max(...needed) || 1;
      this.update();
    }

    update() {
      const { camera, target, azimuth, height, distance } = this, c = Math.cos(height);
      camera.position.set(Math.cos(azimuth) * c, Math.sin(azimuth) * c, Math.sin(height)).multiplyScalar(distance).add(target);
      camera.near = Math.max(distance - 12 * this.size, distance * 0.005);
      camera.far = distance + 30 * this.size;
      camera.lookAt(target);
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
      this.changed();
    }

    turn(dx, dy) {
      this.azimuth -= dx;
      this.height = Math.min(Math.max(this.height + dy, -LIMIT), LIMIT);
    }

    pan(dx, dy) {
      const unit = 2 * this.distance * Math.tan(this.camera.fov * Math.PI / 360) / this.element.clientHeight;
      const m = this.camera.matrixWorld.elements;
      for (const [k, axis] of ["x", "y", "z"].entries()) this.target[axis] += (-dx * m[k] + dy * m[4 + k]) * unit;
    }

    zoom(factor) {
      this.distance = Math.min(Math.max(this.distance * factor, this.size * 0.02), this.size * 40);
    }

    down(e) {
      if (e.defaultPrevented) return;
      this.element.setPointerCapture(e.pointerId);
      this.pointers.set(e.pointerId, e);
    }

    move(e) {
      const last = this.pointers.get(e.pointerId);
      if (!last) return;
      const dx = e.clientX - last.clientX, dy = e.clientY - last.clientY;
      if (this.pointers.size === 2) this.pinch(e, dx, dy);
      else if (e.buttons & 2 || e.buttons & 4 || e.shiftKey) this.pan(dx, dy);
      else this.turn(dx * 0.008, dy * 0.008);
      this.pointers.set(e.pointerId, e);
      this.moved = true;
      this.update();
    }

    pinch(e, dx, dy) {
      const other = [...this.pointers.values()].find((p) => p.pointerId !== e.pointerId);
      const last = this.pointers.get(e.pointerId);
      const gap = (p) => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY) || 1;
      this.zoom(gap(last) / gap(e));
      this.pan(dx / 2, dy / 2);
    }

    wheel(e) {
      e.preventDefault();
      this.moved = true;
      this.zoom(Math.exp(Math.sign(e.deltaY) * Math.min(Math.abs(e.deltaY), 100) * 0.0016));
      this.update();
    }
  }

  return { Orbit };
})();
