// page: the desk beside the view: scenes, the script, and the thread in which it is run. The view is a page of its own in a
// frame, as `hooke watch` serves it; it asks here for what it would have from a server (port.js).
"use strict";
hooke.page = (() => {
  const $ = (id) => document.getElementById(id);
  const PATIENCE = 1500; // ms, that a run may take to end in order; then it is ended at once

  // What one view of a run is told; `version` rises with what there is to tell.
  class Link {
    constructor(page) { Object.assign(this, { page, version: 1, closed: false }); }

    async json(name) { return this.page.history.get(name); }
    async bytes(name) { return this.page.history.get(name); }
    async ask(what, more = {}) { this.page.obey(what, more); }

    tell() {
      this.version++;
      if (this.wake) this.wake();
    }

    async follow(heard) {
      for (let seen = 0; !this.closed; seen = this.telling) {
        while (this.version === seen) await new Promise((go) => { this.wake = go; });
        this.telling = this.version;
        if (this.closed) return;
        await heard(this.page.state());
      }
    }
  }

  // Numbers without limits have a slider, too: of about three powers of ten, which makes it logarithmic, or of some more.
  const ranged = (p) => {
    const initial = Number(p.initial), has = (limit) => typeof limit === "number";
    if (p.type !== "number" && p.type !== "integer" || !(initial > 0) || has(p.min) && has(p.max) && p.max < 100 * initial) return p;
    const [low, high] = p.type === "integer" ? [1, 4 * initial] : [initial / 32, 32 * initial];
    return { ...p, min: has(p.min) ? Math.max(p.min, low) : low, max: has(p.max) ? Math.min(p.max, high) : high };
  };

  class Page {
    constructor() {
      Object.assign(this, { number: 0, values: {}, doing: "ended", pace: 1, parameters: [], tables: new Map() });
      this.editor = new hooke.editor.Editor($("script"), $("inked"));
    }

    async open() {
      const [wasm, thread, view, data] = await Promise.all([hooke.unpack("engine"), hooke.text("thread"), hooke.text("view"), hooke.text("data")]);
      Object.assign(this, { thread: URL.createObjectURL(new Blob([thread], { type: "text/javascript" })), view, ...JSON.parse(data) });
      this.wasm = await WebAssembly.compile(wasm);
      $("scenes").append(...this.scenes.map((s) => new Option(s.title, s.name)));
      $("scenes").addEventListener("change", () => this.choose($("scenes").value));
      $("run").addEventListener("click", () => this.begin());
      $("script").addEventListener("keydown", (e) => {
        if (e.key !== "Enter" || !(e.ctrlKey || e.metaKey)) return;
        e.preventDefault();
        this.begin();
      });
      $("save").addEventListener("click", () => this.save(`${this.scene.name}.lua`, this.editor.text));
      $("table").addEventListener("click", async () => this.save(`${this.scene.name}.csv`, await this.table()));
      const asked = decodeURIComponent(location.hash.slice(1));
      this.choose(this.scenes.some((s) => s.name === asked) ? asked : this.scenes[0].name);
    }

    choose(name) {
      this.scene = this.scenes.find((s) => s.name === name);
      this.title = this.scene.title;
      $("scenes").value = name;
      $("told").textContent = this.scene.told;
      this.editor.text = this.scene.text;
      this.begin();
    }

    // The script as it stands, with its own values of the parameters, but for those that the page's list of scenes has and the
    // script still declares.
    begin() {
      const declared = Object.entries(this.scene.values).filter(([name]) => this.editor.text.includes(`param("${name}"`));
      this.values = Object.fromEntries(declared.map(([name, value]) => [name, String(value)]));
      this.start();
    }

    // ---- the thread ----

    worker() {
      if (this.thread_) this.thread_.terminate();
      this.thread_ = new Worker(this.thread);
      this.thread_.onmessage = ({ data }) => this.hear(data);
      this.thread_.onerror = (e) => this.hear({ what: "failed", run: this.number, error: e.message });
      this.thread_.postMessage({ do: "open", wasm: this.wasm, files: this.files });
    }

    send(what, more = {}) { this.thread_.postMessage({ do: what, ...more }); }

    start() {
      clearTimeout(this.deadline);
      this.worker(); // the run before ends with its thread
      this.number++;
      Object.assign(this, { doing: "running", error: undefined, summary: undefined, notice: undefined, text: this.editor.text, opened: false });
      this.complain("");
      this.next = new hooke.history.History(this.number, this.title, this.kinds);
      this.send("pace", { pace: this.pace });
      this.send("start", { number: this.number, name: `${this.scene.name}.lua`, text: this.text, values: this.values });
    }

    hear(m) {
      if (m.what === "table") return this.tables.get(m.ask)(m.text);
      if (m.run !== this.number) return;
      if (m.what === "message") {
        if (!this.next.hear(m.letter, m.body)) this.again("it has other things to tell with this value");
        return;
      }
      if (m.what === "piece") this.send("got", { run: m.run });
      if (m.what === "failed") this.ended(`the engine failed: ${m.error}: please report it with the script`);
      if (m.what === "state") this.learn(m);
      if (this.link) this.link.tell();
    }

    learn(m) {
      if (m.going) this.next.goOn();
      if (m.refused) return this.again(m.refused);
      if (m.changed) this.parameters = m.parameters.map(ranged);
      else if (m.parameters) this.show(m.parameters);
      this.doing = m.doing;
      this.judging = m.judging;
      if (m.doing === "ended") clearTimeout(this.deadline);
      if (m.summary) this.summary = m.summary;
      if (m.error) this.complain(this.error = m.error);
    }

    // From the start, with the values as they now are: the run itself cannot go on with them.
    again(why) {
      const because = why.replace(/^.* cannot be gone on from: /, "").replace(/^\S+\.checkpoint /, "its checkpoint ");
      this.start();
      this.notice = `another run has begun from its start, as this one cannot go on: ${because}`;
    }

    ended(error) {
      this.thread_.terminate();
      this.doing = "ended";
      this.complain(this.error = error);
      if (this.link) this.link.tell();
    }

    // The run has begun. Another script is shown in another frame, whose parameters are its own.
    show(parameters) {
      this.history = this.next;
      this.opened = true;
      this.parameters = parameters.map(ranged);
      if (this.link && this.shown === this.text) return;
      this.shown = this.text;
      if (this.link) this.link.closed = true;
      this.link = null;
      const frame = document.createElement("iframe");
      frame.title = this.title;
      frame.srcdoc = this.view;
      $("frame").replaceChildren(frame);
    }

    // By the view, when it is read; also when it reads itself again.
    linked() {
      if (this.link) this.link.closed = true;
      this.link = new Link(this);
      return this.link;
    }

    // Whether there is a run that may go on with another value.
    get under_way() { return this.opened && this.doing !== "ended" && !this.judging && this.history === this.next && this.history.frames > 1; }

    // ---- what the view asks for ----

    state() {
      const known = this.history.known();
      return { run: this.history.number, doing: this.doing, notice: this.notice, ...known, pace: this.pace, error: this.error, values: this.values,
        summary: this.summary, parameters: this.parameters };
    }

    obey(what, more) {
      if (what === "start" || what === "change") {
        const changed = Object.fromEntries(Object.entries(more.values || {}).map(([k, v]) => [k, String(v)]));
        Object.assign(this.values, changed);
        if (what === "start" || !this.under_way) return this.start();
        this.notice = undefined;
        this.send("change", { values: this.values, changed });
      } else if (what === "stop") this.stop();
      else {
        if (what === "pace") this.pace = more.pace;
        this.send(what, more);
      }
    }

    stop() {
      this.send("stop");
      this.deadline = setTimeout(() => this.ended(this.judging ? "the run was ended while it was judged: there is no verdict"
        : "the run was ended within a step: there is no verdict"), this.judging ? 0 : PATIENCE);
    }

    table() {
      const ask = this.tables.size + 1;
      return new Promise((done) => {
        this.tables.set(ask, done);
        this.send("table", { ask });
      });
    }

    // ---- the desk ----

    complain(sentence) {
      $("wrong").hidden = !sentence;
      $("wrong").textContent = sentence;
      const place = new RegExp(`^${this.scene.name}\\.lua:(\\d+):`).exec(sentence);
      if (place || this.editor.fault) this.editor.mark(place ? Number(place[1]) : 0);
    }

    save(name, text) {
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([text]));
      link.download = name;
      link.click();
      URL.revokeObjectURL(link.href);
    }
  }

  const page = new Page();
  page.open().catch((error) => {
    console.error(error);
    $("wrong").hidden = false;
    $("wrong").textContent = `The page failed: ${error.message}`;
  });
  return page;
})();
