-- hooke rest: the catenary of bars and the elastic one, the elastica of a cantilever, a column that buckles off its saddle, a
-- chain that hangs upside down, the state as a start, and what has no equilibrium.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "rest")
local scenes = os.getenv("HK_ROOT") .. "/scripts/scenes/"

local function value(text, name)
  return tonumber(text:match("\n  " .. name:gsub("%p", "%%%0") .. " +(%S+)")) or error(text)
end

local function at_rest(words)
  local code, text = runs.run(words)
  assert(code == 0 and text:find("verdict +ok: no force above .* is left.* comes back"), text)
  return text
end

-- With n segments the closed forms (the scenes' heads) are missed by c/n^2 + O(1/n^4), which two n extrapolate away; what is
-- left of the next term at n = 10 is below 1e-5.
local function extrapolate(scene, known)
  local coarse, fine = at_rest(scenes .. scene .. " n=10"), at_rest(scenes .. scene .. " n=20")
  for name, wanted in pairs(known) do
    local limit = (4 * value(fine, name) - value(coarse, name)) / 3
    assert(math.abs(limit - wanted) < 1e-5, ("%s: %.9g, known %.9g"):format(name, limit, wanted))
  end
end
extrapolate("catenary.lua", { ["sag of the chain"] = 0.292343798, ["pull of the chain"] = 0.469541523,
  ["sag of the string"] = 0.341111699, ["pull of the string"] = 0.395527043 })
extrapolate("cantilever.lua", { ["w L^3/EI = 1: drop"] = 0.1234714, ["w L^3/EI = 5: drop"] = 0.4959050 })

-- A pendulum on its head balances, and is pushed off it.
runs.write("head.lua", [[
local scene = hooke.scene { duration = 1 }
local a = scene:particle { position = { 0, 0, 0 } }
local b = scene:particle { position = { 0, 0, 1 }, mass = 2 }
scene:pin(a)
scene:force("springs", { edges = { { a, b } }, k = 1000 })
scene:force("gravity", { g = { 0, 0, -10 } })
scene:measure("height", function(s) return s:position(b)[3] end)
scene:start { file = "rest.csv" }
return scene
]])
runs.write("rest.csv", "")
local text = runs.read("head.lua"):gsub("scene:start[^\n]+\n", "")
runs.write("up.lua", text)
text = at_rest("up.lua --state rest.csv")
assert(math.abs(value(text, "height") + 1.02) < 1e-9, text) -- 20 N on 1000 N/m

-- Where it is at rest it stays, to rounding.
text = at_rest("head.lua")
assert(text:find("stages +[0-9] of") and math.abs(value(text, "height") + 1.02) < 1e-9, text)

runs.write("falls.lua", "local scene = hooke.scene {}\nscene:particle {}\nscene:force('gravity')\nreturn scene\n")
local code
code, text = runs.run("falls.lua")
assert(code == 5 and text:find("not at rest: .*no equilibrium"), text)
code, text = runs.run(scenes .. "cloth_on_sphere.lua N=4")
assert(code == 3 and text:find("the scene has the corrector 'contact'", 1, true), text)

runs.close()
