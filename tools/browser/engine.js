// engine: one run of hooke in WebAssembly, for a worker of the page and for Node. `hooke_module` is what emcc made;
// calls go to libhooke (core/app/hooke/hooke.h) and to run.c. A run belongs to one instance of the module: what a run has
// left behind goes with it.
"use strict";
const PLACE = "/hooke/"; // where the files are that the engine looks for: a build of hooke
const KEPT = "/kept.checkpoint";
const OK = 0;

class Engine {
  // module: the instance
  constructor(module) {
    this.module = module;
    this.run = 0;
  }

  // wasm: its bytes, or a WebAssembly.Module; files: { path: text }, of an installation; heard(letter, body): gets the
  // messages of the run (plugins/common/live/messages.h)
  static async open({ wasm, files, heard = () => {} }) {
    const options = { print: (line) => console.log(line), printErr: (line) => console.warn(line), message: heard };
    if (wasm instanceof WebAssembly.Module)
      options.instantiateWasm = (imports, done) => {
        WebAssembly.instantiate(wasm, imports).then((instance) => done(instance, wasm));
        return {};
      };
    else options.wasmBinary = wasm;
    const engine = new Engine(await hooke_module(options));
    engine.furnish(files);
    return engine;
  }

  // Plugins are linked in; the files of their names are what the registry finds (linked.c).
  furnish(files) {
    const put = (path, text) => {
      this.module.FS.mkdirTree((PLACE + path).replace(/\/[^/]*$/, ""));
      this.module.FS.writeFile(PLACE + path, text);
    };
    this.module.FS.mkdirTree(`${PLACE}scripts/scenes`); // where the scene seems to be
    for (const [path, text] of Object.entries(files)) put(path, text);
    const held = "This plugin is linked into the program that looks for it here.\n";
    for (let k = 0, name; (name = this.text(this.module._page_plugin(k))); k++) put(`build/plugins/${name}.so`, held);
    put("build/libhooke.so", held);
  }

  text(address) { return address ? this.module.UTF8ToString(address) : null; }
  call(name, kinds, values) { return this.module.ccall(name, "number", ["number", ...kinds], [this.run, ...values]); }
  error() { return this.text(this.call("hooke_error", [], [])); }

  // Begins a run of a scene; null, or the sentence of why not. values: of its parameters; options: [name, value] as of
  // `hooke run`
  begin(name, script, values, options) {
    this.run = this.module._hooke_new();
    const put = (call, list) => list.every(([key, value]) => this.call(call, ["string", "string"], [key, String(value)]) === OK);
    const fine = put("hooke_option", options) && put("hooke_parameter", Object.entries(values))
      && this.call("hooke_open_text", ["string", "string"], [`${PLACE}scripts/scenes/${name}`, script]) === OK;
    return fine ? null : this.plain(this.error());
  }

  // The scene's own name without the folder, which is none of the user's.
  plain(sentence) { return sentence.split(`${PLACE}scripts/scenes/`).join(""); }

  parameters() { return JSON.parse(this.text(this.call("hooke_parameters", [], []))).parameters; }

  get time() { return this.module._hooke_time(this.run); }
  get end() { return this.module._hooke_end(this.run); }

  // Takes steps until t, s. Null, or the sentence of why the run has ended.
  advance(t) { return this.call("hooke_advance", ["number"], [t]) === OK ? null : this.plain(this.error()); }
  stop() { this.module._hooke_stop(this.run); }

  // Goes to the end and judges. The summary, null where there is none.
  finish() {
    this.module._hooke_finish(this.run);
    const text = this.text(this.module._hooke_summary(this.run));
    return text ? JSON.parse(this.plain(text)) : null;
  }

  hold(id, place, strength) { this.module._page_hold(id, ...place, strength); }

  // What a run needs to go on from here, as bytes; or an error with the sentence of why not.
  checkpoint() {
    if (this.call("hooke_checkpoint", ["string"], [KEPT]) !== OK) throw new Error(this.plain(this.error()));
    return this.module.FS.readFile(KEPT);
  }

  // Options of a run that goes on from it with other values of parameters, in another instance of the module.
  resumed(bytes, changed) {
    this.module.FS.writeFile(KEPT, bytes);
    return [["resume", KEPT], ...Object.entries(changed).map(([name, value]) => ["change", `${name}=${value}`])];
  }

  // The state as a table, as --state writes it.
  state() {
    const path = "/state.csv";
    if (this.call("hooke_write_state", ["string"], [path]) !== OK) throw new Error(this.error());
    return this.module.FS.readFile(path, { encoding: "utf8" });
  }
}
if (typeof module !== "undefined") module.exports = { Engine };
