// economy: what the page does with less work where it is too slow otherwise, and says so. Without a graphics card the
// browser draws by software: then the slider and the charts' cursors follow a motion some times a second, and many particles
// are drawn by the page itself (splats.js). Where pictures still come too slowly, every second, fourth ... particle is drawn.
"use strict";
view.economy = (() => {
  const MANY = 5000; // particles: by software, points with shadows take 10 ms then
  // ms between two moves of the slider and the charts' cursors, while it plays by software: to draw those again takes as
  // long as a picture of 100,000 particles
  const CURSORS = 250;
  const SHOW_EVERY = 2000; // ms between two notes on the rate: they are to be drawn, too
  const SLOW = 1000 / 27, PAUSE = 2000; // ms between two pictures: below 30 a second, and nothing that was played

  const software = () => {
    const canvas = document.createElement("canvas"), gl = canvas.getContext("webgl2") || canvas.getContext("webgl");
    if (!gl) return false;
    const known = gl.getExtension("WEBGL_debug_renderer_info");
    const name = String(gl.getParameter(known ? known.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
    const lose = gl.getExtension("WEBGL_lose_context");
    if (lose) lose.loseContext();
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  };

  class Economy {
    constructor(sources) {
      Object.assign(this, { software: software(), every: 1, slow: 0, lastShown: 0, lastCursors: 0 });
      this.many = sources.some((s) => s.most > MANY);
    }

    // Smooth edges cost four times the pixels.
    get antialias() { return !(this.software && this.many); }

    splats(balls) { return this.software && this.many && balls > MANY; }

    // Whether the slider and the charts may be drawn again.
    cursors(playing) {
      const now = performance.now();
      if (this.software && playing && now - this.lastCursors < CURSORS) return false;
      this.lastCursors = now;
      return true;
    }

    // After each picture.
    pace(playing, layers) {
      const now = performance.now(), took = now - (this.lastShown || now);
      this.lastShown = now;
      this.slow = playing && took > SLOW && took < PAUSE ? this.slow + 1 : Math.max(this.slow - 1, 0);
      if (took < PAUSE) this.took = 0.9 * (this.took || took) + 0.1 * took;
      if (this.slow <= 4) return;
      if (this.every < 16 && layers.some((layer) => layer.balls > 20000 && this.worthwhile(layer, took))) {
        this.every *= 2;
        this.slow = 0;
      } else if (!this.rate || now - this.rateShown > SHOW_EVERY) {
        this.rate = Math.round(1000 / this.took);
        this.rateShown = now;
      }
    }

    // Fewer particles do not help where something else takes the time.
    worthwhile(layer, took) { return !layer.splats.mesh.visible || layer.splats.took > took / 3; }

    notes(layers) {
      const notes = [];
      if (layers.some((layer) => layer.splats.mesh.visible)) notes.push("without a graphics card: particles cast no shadows");
      if (this.every > 1) notes.push(`this machine is too slow for all: one of ${this.every} particles is drawn, of ${layers[0].balls}`);
      if (this.rate) notes.push(`this machine shows some ${this.rate} pictures a second`);
      return notes;
    }
  }

  return { Economy };
})();
