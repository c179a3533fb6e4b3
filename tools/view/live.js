// live: opens the page of a run under way: it follows the latest frame until somebody looks at an earlier one.
"use strict";
(async () => {
  const { el } = view.dom;
  const $ = (id) => document.getElementById(id);
  const REDRAW = 200; // ms, the least time between two pictures of the charts

  class Page {
    constructor() {
      this.source = new view.stream.Stream();
      const node = el("section", { id: "drive" });
      $("verdicts").before(node);
      this.drive = new view.drive.Drive(node, (on) => { if (this.hand) this.hand.chosen = on; });
      this.drawn = 0;
    }

    // Follows unless the clock was put elsewhere.
    get follows() { return !this.app.clock.playing && this.app.clock.k >= this.last; }

    open() {
      this.app = new view.app.App([this.source]);
      this.hand = this.app.stage && new view.hand.Hand(this.app, () => this.drive.strength(), () => this.drive.pulls());
      view.page = this.app;
      view.live = this;
    }

    async heard(state) {
      const fresh = state.run !== this.source.number && state.latest >= 0;
      if (fresh && await this.source.begin(state.run)) return location.reload();
      this.drive.show(state);
      if (state.run !== this.source.number) return;
      await this.source.learn(state);
      this.source.summary = state.summary || null;
      await this.bound();
      const opened = !this.app;
      if (opened) this.open();
      this.show(state, fresh || opened);
      if (opened && state.doing === "ended") this.app.clock.play(true);
    }

    // What the camera and the sizes are chosen by: the first frame, and the present one.
    async bound() {
      if (this.bounded === this.source.number) return;
      this.bounded = this.source.number;
      const { source } = this, low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      const frames = await Promise.all([0, source.count - 1].map((k) => source.frame(k, [])));
      for (const frame of frames) source.widen({ low, high }, frame.x, 3);
      if (!(low[0] <= high[0])) return;
      Object.assign(source.bounds.low, low);
      Object.assign(source.bounds.high, high);
      if (this.app) for (const layer of this.app.layers || []) layer.radius = undefined;
    }

    show(state, fresh) {
      const { app, source } = this, end = source.count - 1, follows = fresh || this.follows;
      this.last = end;
      if (follows) {
        app.clock.k = -1; // the frame itself may be another one, under the same number
        app.clock.seek(end);
      } else app.timeline.update();
      const now = performance.now();
      if (now - this.drawn > REDRAW || state.doing !== "running") {
        this.drawn = now;
        app.plots.draw();
      }
      this.report(state, fresh);
    }

    report(state, fresh) {
      const key = `${state.run} ${state.doing === "ended"}`;
      if (!fresh && this.reported === key) return;
      this.reported = key;
      const ended = state.doing === "ended", { summary } = this.source;
      const put = (id, content) => $(id).replaceChildren(el("div", { class: "run" }, content));
      put("verdicts", ended ? view.report.verdict(summary) : el("div", { class: "verdict unknown" },
        el("strong", {}, "running"), el("p", {}, "The verdict comes at the end.")));
      put("reports", ended ? view.report.details(summary) : null);
    }

    lost(is) {
      if (is) this.drive.showMessage("the run's program has ended; the page keeps what it shows", true);
    }
  }

  await view.colours.load(JSON.parse($("page-data").textContent).shared);
  const page = new Page();
  await view.link.follow((state) => page.heard(state), (is) => page.lost(is));
})().catch(view.fail);
