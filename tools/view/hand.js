// hand: the user's hand in the 3D view. With Shift, or once the hand is chosen, a press on a particle takes it, and it is
// drawn to the pointer in the plane through it that faces the eye.
"use strict";
view.hand = (() => {
  const EVERY = 25; // ms, the least time between two commands to the run

  class Hand {
    // pulls(): whether the run can be pulled at
    constructor(app, strength, pulls) {
      Object.assign(this, { app, strength, pulls, held: null, chosen: false, sentAt: 0 });
      const stage = document.getElementById("stage"), { svg } = view.dom;
      this.line = svg("line", {});
      this.dot = svg("circle", { r: 5 });
      this.overlay = svg("svg", { class: "hand", visibility: "hidden" }, this.line, this.dot);
      stage.append(this.overlay);
      stage.addEventListener("pointerdown", (e) => this.down(e), true); // before the camera
      stage.addEventListener("pointermove", (e) => this.move(e), true);
      for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, () => this.letGo(), true);
      addEventListener("blur", () => this.letGo());
    }

    down(e) {
      const { stage } = this.app;
      if (e.target !== stage.canvas || e.button !== 0 || !(e.shiftKey || this.chosen)) return;
      const found = stage.pick(e.offsetX, e.offsetY);
      if (!found) return;
      e.preventDefault();
      if (!this.pulls()) return;
      stage.canvas.setPointerCapture(e.pointerId);
      this.held = { id: found.id, layer: found.layer };
      this.at = [e.offsetX, e.offsetY];
      this.held.depth = this.seen().depth;
      this.overlay.setAttribute("visibility", "visible");
      this.send();
      this.draw();
    }

    move(e) {
      if (!this.held) return;
      e.stopPropagation();
      this.at = [e.offsetX, e.offsetY];
      this.moved = true;
      this.tellSoon();
    }

    // Where the pointer came to rest is sent as well: by a picture after the last move.
    tellSoon() {
      if (this.moved && performance.now() - this.sentAt > EVERY) this.send();
    }

    letGo() {
      if (!this.held) return;
      this.held = null;
      this.overlay.setAttribute("visibility", "hidden");
      view.link.ask("release");
    }

    // Where the particle is seen, in pixels, and its depth for the camera; null: it is no longer there.
    seen() {
      const { layer, id } = this.held, { frame } = layer, i = frame.ids.indexOf(id);
      if (i < 0) return null;
      const { camera } = this.app.stage.orbit, { clientWidth: w, clientHeight: h } = this.app.stage.canvas;
      const p = new THREE.Vector3(...frame.x.subarray(3 * i, 3 * i + 3)).applyMatrix4(layer.group.matrixWorld).project(camera);
      return { x: (p.x + 1) / 2 * w, y: (1 - p.y) / 2 * h, depth: p.z };
    }

    // The pointer's place at the particle's depth, in the scene.
    place() {
      const { camera } = this.app.stage.orbit, { clientWidth: w, clientHeight: h } = this.app.stage.canvas, { layer } = this.held;
      const p = new THREE.Vector3(2 * this.at[0] / w - 1, 1 - 2 * this.at[1] / h, this.held.depth).unproject(camera);
      return layer.group.worldToLocal(p).toArray().map((v, c) => v + layer.source.origin[c]);
    }

    send() {
      this.sentAt = performance.now();
      this.moved = false;
      view.link.ask("hold", { id: this.held.id, place: this.place(), strength: this.strength() });
    }

    // With every picture while it holds: the particle follows.
    draw() {
      const from = this.held && this.seen();
      if (!from) return;
      requestAnimationFrame(() => this.draw());
      this.tellSoon();
      for (const [key, value] of [["x1", from.x], ["y1", from.y], ["x2", this.at[0]], ["y2", this.at[1]]]) this.line.setAttribute(key, value);
      this.dot.setAttribute("cx", this.at[0]);
      this.dot.setAttribute("cy", this.at[1]);
    }
  }

  return { Hand };
})();
