-- hooke explain: which way of contact is cheaper for a scene with a barrier, by the step of leapfrog without it. The
-- step of a spring of stiffness k on two masses m is 2/w, w^2 = 2 k/m.
local json = require("cjson")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD")

local folder = os.tmpname()
os.remove(folder)
assert(os.execute("mkdir -p " .. folder))
local file = assert(io.open(folder .. "/pair.lua", "w"))
file:write([[
local k = param("k", 1, "N/m", { min = 0 })
local barrier = param("barrier", true, "contact")
local scene = hooke.scene { duration = 1, fps = 100, integrator = "bdf2", dt = 0.01 }
scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:particle { position = { 1, 0, 0 }, mass = 1 }
scene:force("springs", { edges = { { 1, 2 } }, k = k })
if barrier then scene:force("barrier", { label = "walls", d_hat = 1e-3 }) end
return scene
]])
file:close()

local function explain(arguments)
  local pipe = io.popen(("cd %s && %s/hooke explain pair.lua %s 2>&1"):format(folder, build, arguments))
  local text = pipe:read("a")
  return text, select(3, pipe:close())
end

for _, case in ipairs { { k = 1, take = "contact" }, { k = 1e10, take = "barrier" } } do
  local text, code = explain(("k=%g --json"):format(case.k))
  assert(code == 0, text)
  local found, limit = json.decode(text).contact, 2 / math.sqrt(2 * case.k)
  assert(math.abs(found.limit / limit - 1) < 0.05, ("k = %g: %g s, wanted %g s"):format(case.k, found.limit, limit))
  assert(math.abs(found.steps / math.max(1, 0.01 / found.limit) - 1) < 1e-9)
  assert(found.take == case.take, text)
end
local text = explain("k=1")
assert(text:find("the corrector with leapfrog is cheaper", 1, true), text)
text = explain("k=1e10")
assert(text:find("the barrier with an implicit method is cheaper", 1, true), text)
text = explain("barrier=false")
assert(not text:find("\ncontact\n", 1, true), text)

-- Who differentiates forces, and keys that are there where there is nothing of it.
text = explain("barrier=false --json")
local all = json.decode(text)
assert(text:find('"warnings":%['), text)
for _, key in ipairs { "cost", "contact", "solver_libraries" } do assert(all[key] ~= nil, key) end
file = assert(io.open(folder .. "/pair.lua", "w"))
file:write([[
local scene = hooke.scene { duration = 1 }
local p, q = scene:particle {}, scene:particle { position = { 1, 0, 0 } }
scene:force("springs", { edges = { { p, q } }, k = 1 })
scene:force("field", { f = function(_, x) return -x, 0, 0 end })
return scene
]])
file:close()
for _, p in ipairs(json.decode((explain("--json"))).plugins) do
  assert(p.kind ~= "force" or p.differentiated_by == (p.name == "field" and "blocks" or "itself"), p.name)
end
text = explain("")
assert(text:find("field  .*derivatives %(gradient, optimise%): by the host, from the blocks")
  and not text:find("derivatives.*derivatives"), text)

os.execute("rm -rf " .. folder)
