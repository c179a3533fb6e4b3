-- Damaged checkpoints, most of them under a checksum that is right again, as somebody who means harm would write them; see
-- tests/support/fuzz/run.lua.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
local run = require("fuzz.run")
local bytes = require("fuzz.bytes")

-- FNV-1a on eight lanes of words, and of what is left on bytes.
local basis, prime = 1469598103934665603, 1099511628211

local function checksum(text)
  local lane, sum, whole = {}, basis, #text - #text % 64
  for l = 0, 7 do lane[l] = basis + l end
  for k = 1, whole, 8 do
    local l = (k - 1) // 8 % 8
    lane[l] = (lane[l] ~ string.unpack("<i8", text, k)) * prime
  end
  for l = 0, 7 do sum = (sum ~ lane[l]) * prime end
  for k = whole + 1, #text do sum = (sum ~ text:byte(k)) * prime end
  return sum
end

local scenes = {
  leapfrog = [[s:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = 10 })]],
  bdf2 = [[s:pin { 1 } s:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = 1e4, damping = 1 })]],
  stoermer = [[s:channel("heat", { initial = 1, rate = -2 }) s:measure("z", function(state) return state.t end)]],
  rk4 = [[s:source("spout", {}) s:corrector("floor", {})]],
  cvode = [[s:force("drag", { rate = 1 }) s:constraint("bar", { edges = { { 1, 2 } } })]],
  midpoint = [[local g = s:grid { nx = 3, ny = 3 } s:force("springs", { edges = g:edges(), k = 100, damping = 1 })
s:force("hinges", { triangles = g:triangles(), rigidity = 1e-3 }) s:corrector("obstacle", { radius = 0.05 })]],
  dopri5 = [[s:force("soft_spheres", { radius = 0.6, stiffness = 100, friction = 0.5 })]],
  symplectic_euler = [[s:source("emitter", { rate = 100, speed = 1, lifetime = 0.02 })]],
  trapezoid = [[local g = s:grid { nx = 3, ny = 3, origin = { 0, 0, 1.5 } }
s:force("springs", { edges = g:edges(), k = 100, damping = 1 }) s:force("barrier", { d_hat = 0.1, friction = 0.5, radius = 0.05 })]],
  imex = [[s:force("rods", { edges = { { 1, 2 }, { 2, 3 } }, EI = 1e-2, GJ = 1e-2 })]],
}

local scene = [[
local s = hooke.scene { duration = 0.1, fps = 50, integrator = "%s" }
s:strand { n = 3, from = { 0, 0, 0 }, to = { 2, 0, 1 } }
s:force("gravity", {})
%s
%s
]]

local methods, whole = {}, {}

-- Writes a checkpoint of each scene.
local function save(place)
  for method, what in pairs(scenes) do
    local file = assert(io.open(place .. "/save.lua", "w"))
    file:write(scene:format(method, what, 's:run { to = 0.06 }:save("checkpoint")'))
    file:close()
    assert(os.execute(("cd %s && { %s %s run save.lua --trust --quiet --no-output; } 2>/dev/null"):format(place, run.before,
      run.hooke)))
    local saved = assert(io.open(place .. "/checkpoint", "rb"))
    methods[#methods + 1], whole[method] = method, saved:read("a")
    saved:close()
  end
  table.sort(methods)
end

local function damaged(text)
  local head = text:match("^%C+ %d+\n")
  if math.random(8) == 1 then return bytes.binary(text) end
  local body = bytes.binary(text:sub(#head + 1, -9))
  return head .. body .. string.pack("<i8", checksum(body))
end

run.fuzz {
  name = "checkpoints",
  cases = 40,
  prepare = save,
  make = function()
    local method = methods[math.random(#methods)]
    return { files = { checkpoint = damaged(whole[method]),
      ["scene.lua"] = scene:format(method, scenes[method], 's:start { file = "checkpoint" }\nreturn s') },
        words = "run scene.lua" }
  end,
}
