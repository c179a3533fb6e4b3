// clock: which frame is shown. The one timeline of the page: play, pause, speed, and every move to another frame.
"use strict";
view.clock = (() => {
  class Clock {
    // source: count and time(k); changed(k): another frame is to be shown; playingChanged(): playing or speed have changed
    constructor(source, changed, playingChanged) {
      Object.assign(this, { source, changed, playingChanged, k: 0, playing: false, speed: 1, at: 0, last: 0 });
    }

    get end() { return this.source.count - 1; }

    seek(k, keep) {
      const next = Math.min(Math.max(Math.round(k), 0), this.end);
      if (!keep) this.at = this.source.time(next);
      if (next === this.k) return;
      this.k = next;
      this.changed(next);
    }

    // The last frame at time t or before.
    frameAt(t) {
      let low = 0, high = this.end;
      while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (this.source.time(middle) <= t + 1e-9) low = middle; else high = middle - 1;
      }
      return low;
    }

    play(on = !this.playing) {
      if (on === this.playing) return;
      this.playing = on && this.end > 0;
      if (this.playing) {
        if (this.k >= this.end) this.seek(0);
        this.at = this.source.time(this.k);
        this.last = performance.now();
        requestAnimationFrame((now) => this.tick(now));
      }
      this.playingChanged();
    }

    tick(now) {
      if (!this.playing) return;
      this.at += Math.min((now - this.last) / 1000, 0.25) * this.speed;
      this.last = now;
      if (this.at >= this.source.time(this.end)) {
        if (!this.loop) {
          this.seek(this.end);
          this.play(false);
          return;
        }
        this.at = this.source.time(0);
      }
      this.seek(this.frameAt(this.at), true);
      requestAnimationFrame((later) => this.tick(later));
    }
  }

  return { Clock };
})();
