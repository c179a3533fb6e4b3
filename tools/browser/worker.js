// worker: the thread in which a page's runs are. It takes commands { do, ... } and gives { what: "message" | "state" | ... }.
// Between two pieces of work it hears what has come; a piece is some frames, up to PIECE of the clock, and not more than
// AHEAD pieces are under way to the page, which answers "got" to each: so that a slow page holds the run back.
"use strict";
const PIECE = 20, AHEAD = 3; // ms; pieces
const SLOW = 10, SHOWN = 30; // frames a second

const wire = new MessageChannel(); // a turn of the event loop without the 4 ms of setTimeout

class Session {
  constructor(wasm, files) {
    Object.assign(this, { wasm, files, doing: "ended", pace: 0, ahead: 0, turn: 0 });
    wire.port2.onmessage = () => this.work();
  }

  say(what, more, moved = []) { postMessage({ what, run: this.number, ...more }, moved); }
  state(more) { this.say("state", { doing: this.doing, ...more }); }

  heard(letter, body) {
    if (letter === "R") {
      const text = new TextDecoder().decode(body), told = (key) => Number(new RegExp(`^${key}\t(.*)$`, "m").exec(text)[1]);
      this.fps = told("fps");
      this.origin = ["x", "y", "z"].map((axis) => `${axis}=${told(axis)}`).join(",");
    }
    if (letter === "N") this.frames++;
    this.say("message", { letter, body: body.buffer }, [body.buffer]);
  }

  // number: of the run; name, text: of the script; values: of its parameters
  async start({ number, name, text, values }) {
    const engine = await this.open();
    Object.assign(this, { number, name, text, engine, frames: 0, ahead: 0, single: false });
    const wrong = engine.begin(name, text, values, this.options("output:page"));
    this.doing = wrong ? "ended" : "running";
    if (wrong) return this.state({ error: wrong });
    this.state({ parameters: engine.parameters() });
    this.clock();
    this.later();
  }

  open() { return Engine.open({ wasm: this.wasm, files: this.files, heard: (letter, body) => this.heard(letter, body) }); }
  options(output) { return [["no-output", ""], ["with", "force:pull:by_hand=true"], ["with", output]]; }

  // Other values from the next frame on: the run is kept, and another instance of the module goes on from there. Where it cannot,
  // the page is told why. values: all that are given; changed: those of them that are others.
  async change({ values, changed }) {
    if (!this.engine || this.doing === "ended") return;
    if (this.moving) {
      this.asked = { values, changed: { ...(this.asked || {}).changed, ...changed } };
      return;
    }
    this.moving = true; // no steps meanwhile
    try {
      const kept = this.engine.checkpoint(), engine = await this.open();
      this.state({ going: true });
      const wrong = engine.begin(this.name, this.text, values, [...this.options(`output:page:${this.origin}`), ...engine.resumed(kept, changed)]);
      if (wrong) throw new Error(wrong);
      if (this.doing === "ended") return; // it was stopped meanwhile
      this.engine = engine;
      this.state({ changed, parameters: engine.parameters() });
    } catch (error) {
      this.state({ changed, refused: String(error.message || error) });
    }
    const asked = this.asked;
    this.moving = this.asked = undefined;
    if (asked) this.change(asked);
    this.clock();
    this.later();
  }

  // The run's time counts against the clock from now on.
  clock() { this.began = { wall: performance.now(), t: this.engine ? this.engine.time : 0 }; }
  later(ms = 0) {
    clearTimeout(this.waiting);
    if (ms > 0) this.waiting = setTimeout(() => this.work(), ms);
    else wire.port1.postMessage(0);
  }

  // ms until the clock has come to the run's time. Where frames are few a second, as of planets, a second of the run is none
  // of the clock: such a scene has SHOWN frames a second.
  early() {
    const pace = this.pace * (this.fps < SLOW ? SHOWN / this.fps : 1);
    return pace > 0 ? 1000 * (this.engine.time - this.began.t) / pace - (performance.now() - this.began.wall) : 0;
  }

  work() {
    if (this.doing !== "running" || this.moving || this.ahead >= AHEAD) return; // "go", "got" and "change" come back here
    const begin = performance.now();
    do {
      const early = this.early();
      if (early > 0 && !this.single) return this.piece(early);
      const wrong = this.engine.time < this.engine.end ? this.engine.advance(Math.min(this.frames / this.fps, this.engine.end)) : "";
      if (wrong !== null) return this.finish();
      if (this.single) return this.pause();
    } while (performance.now() - begin < PIECE);
    this.piece(0);
  }

  piece(early) {
    this.ahead++;
    this.say("piece");
    this.later(early);
  }

  pause() {
    this.single = false;
    this.doing = "paused";
    this.state();
  }

  // What is left is the verdict, for which the scene may be run again.
  finish() {
    this.state({ judging: true });
    const summary = this.engine.finish();
    this.doing = "ended";
    this.state({ summary, error: summary ? undefined : this.engine.plain(this.engine.error()) });
  }

  go(single) {
    if (!this.engine || this.doing === "ended") return;
    this.single = single;
    this.doing = "running";
    this.clock();
    if (!single) this.state();
    this.later();
  }
}

let session = null;

const obey = {
  open: ({ wasm, files }) => { session = new Session(wasm, files); postMessage({ what: "ready" }); },
  start: (c) => session.start(c).catch((error) => session.say("failed", { error: String(error.message || error) })),
  change: (c) => session.change(c),
  pause: () => { if (session.doing === "running") session.pause(); },
  go: () => session.go(false),
  step: () => session.go(true),
  got: ({ run }) => { if (run === session.number && session.ahead-- === AHEAD) session.later(Math.max(session.early(), 0)); },
  pace: ({ pace }) => { session.pace = pace; session.clock(); session.later(); },
  hold: ({ id, place, strength }) => session.engine && session.engine.hold(id, place, strength),
  release: () => session.engine && session.engine.hold(0, [0, 0, 0], 1),
  stop: () => {
    if (session.doing === "ended") return;
    session.engine.stop();
    session.engine.advance(session.engine.end); // notices it
    session.finish();
  },
  table: ({ ask }) => postMessage({ what: "table", ask, text: session.engine ? session.engine.state() : "" }),
};

onmessage = ({ data }) => obey[data.do](data);
