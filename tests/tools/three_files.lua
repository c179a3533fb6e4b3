-- three.js as a plain script, from each form in which it is published, as node runs it; and what is said of others.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT")
package.path = ("%s/tools/?.lua;%s"):format(root, package.path)
local fine, three = pcall(require, "common.view.three")
if not fine or not os.execute("command -v node >/dev/null") then
  print("skipped: node or lua-filesystem is not installed (tools/install-deps test)")
  os.exit(77)
end

local folder = os.tmpname()
os.remove(folder)
assert(os.execute(("mkdir '%s'"):format(folder)))

-- A folder with these files and no others; its script, or nil and why.
local function script(files)
  os.execute(("rm -rf '%s/three' && mkdir '%s/three'"):format(folder, folder))
  for name, text in pairs(files) do
    local file = assert(io.open(("%s/three/%s"):format(folder, name), "w"))
    file:write(text)
    file:close()
  end
  return three.script { folder .. "/nothing/", folder .. "/three/" }
end

-- What THREE has when the script has run: "name=value" in the order of the names.
local function exports(text)
  local file = assert(io.open(folder .. "/script.js", "w"))
  file:write("globalThis.window = globalThis;\n", assert(text),
    "\nconsole.log(Object.keys(THREE).sort().map((k) => `${k}=${THREE[k]}`).join(' '));")
  file:close()
  local pipe = assert(io.popen(("node '%s/script.js' 2>&1"):format(folder)))
  local said = pipe:read("l")
  pipe:close()
  return said
end

local function equal(got, wanted) assert(got == wanted, ("%s, expected %s"):format(got, wanted)) end

equal(exports(script { ["three.js"] = "window.THREE = { a: 1 };" }), "a=1")
equal(exports(script { ["three.cjs"] = "exports.a = 2;" }), "a=2")
equal(exports(script { ["three.module.js"] = "const x = 3, b = 4;\nexport { x as a, b };\n" }), "a=3 b=4")
local two = { ["three.module.js"] = "import { a, b as c } from './three.core.js';\nexport { a, b as last } from './three.core.js';\n"
  .. "const sum = a + c, $d = 7;\nexport { sum, $d };\n", ["three.core.js"] = "const a = 5, b = 6;\nexport { a, b };\n" }
equal(exports(script(two)), "$d=7 a=5 last=6 sum=11")
two["three.module.js"] = 'export*from"./three.core.js";import{a as t}from"./three.core.js";const u=t;export{u as v};'
equal(exports(script(two)), "a=5 b=6 v=5")

-- CommonJS that only wraps the modules, and a build that says that it is not kept, leave the modules.
two["three.cjs"] = "module.exports = require('./three.module.js');"
two["three.min.js"] = "console.warn('these are deprecated with r150+'); window.THREE = { old: 1 };"
equal(exports(script(two)), "a=5 b=6 v=5")

-- What is not of these forms is refused, not broken.
for _, odd in ipairs { "export const a = 1;", "import x from './three.core.js';", "import { a } from './other.js';\nexport { a };" } do
  local text, why = script { ["three.module.js"] = odd, ["three.core.js"] = "export { a };" }
  assert(not text and why:find("three.module.js in a form that is not known", 1, true), why)
end
local text, why = script {}
assert(not text and why:find("is not found", 1, true), why)
local used = script { ["three.js"] = "window.THREE = '</script>';" }
assert(not used, "text that would end the page's script")
os.execute(("rm -rf '%s'"):format(folder))
