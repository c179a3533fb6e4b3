// node tools/browser/node.js BUILD SCENE.lua [name=value ...] [--state FILE] [--option value ...]: a scene by hooke in WebAssembly without a page, and
// its summary as JSON: what a test compares with the program, and a bench of their speeds.
"use strict";
const fs = require("fs"), path = require("path");
const [build, scene, ...more] = process.argv.slice(2), browser = path.join(build, "browser");
global.hooke_module = require(path.resolve(browser, "hooke.js"));
const { Engine } = require("./engine.js");

const files = {}, put = (name, from) => { files[name] = fs.readFileSync(from, "utf8"); };
const root = path.join(__dirname, "../..");
for (const name of fs.readdirSync(path.join(root, "scripts/lib"))) put(`scripts/lib/${name}`, path.join(root, "scripts/lib", name));
for (const kind of fs.readdirSync(path.join(root, "plugins"))) {
  const list = path.join(root, "plugins", kind, "default");
  if (fs.existsSync(list)) put(`build/plugins/${kind}/default`, list);
}
put("build/plugins/synonyms", path.join(root, "plugins/synonyms"));

(async () => {
  const engine = await Engine.open({ wasm: fs.readFileSync(path.join(browser, "hooke.wasm")), files });
  const values = {}, options = [["no-output", ""], ["no-check", ""]];
  let state;
  for (let k = 0; k < more.length; k++) {
    if (more[k] === "--state") state = more[++k];
    else if (more[k].startsWith("--")) options.push([more[k].slice(2), more[++k]]);
    else values[more[k].split("=")[0]] = more[k].split("=").slice(1).join("=");
  }
  const wrong = engine.begin(path.basename(scene), fs.readFileSync(scene, "utf8"), values, options);
  if (wrong) throw new Error(wrong);
  const summary = engine.finish();
  if (state) fs.writeFileSync(state, engine.state());
  console.log(JSON.stringify(summary));
})().catch((error) => {
  console.error(`hooke: ${error.message}`);
  process.exit(1);
});
