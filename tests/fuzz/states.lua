-- Damaged start states, and states that are written where they were; see tests/support/fuzz/run.lua.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
local run = require("fuzz.run")
local bytes = require("fuzz.bytes")

local head = "id,x,y,z,vx,vy,vz,mass"
local states = {
  { "", head .. "\n1,0,0,0,0,0,0,1\n2,1,0,0,0,0.5,0,1\n3,2,0,0,0,0,-1e-3,0.25\n" },
  { "s:channel('heat', { initial = 2, rate = -1 })\ns:channel('dye', { initial = { 1, 2 } })\n",
    head .. ",heat,dye[1],dye[2]\n1,0,0,0,0,0,0,1,5,1,2\n2,1,0,0,0,0.5,0,1,6,3,4\n3,2,0,0,0,0,-1e-3,0.25,7,5,6\n" },
  { "s:source('spout', {})\n", head .. "\r\n3,2,0,0,0,0,-1e-3,0.25\r\n1,0,0,0,0,0,0,1" },
}

local scene = [[
local s = hooke.scene { duration = 0.02, fps = 50, integrator = "%s" }
%ss:strand { n = 3, from = { 0, 0, 0 }, to = { 2, 0, 0 } }
s:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = 10 })
s:start { file = "state.csv" }
return s
]]

run.fuzz {
  name = "states",
  cases = 40,
  make = function()
    local state = states[math.random(#states)]
    local method = math.random(2) == 1 and "leapfrog" or "bdf2"
    return { files = { ["state.csv"] = bytes.text(state[2]), ["scene.lua"] = scene:format(method, state[1]) },
      words = "run scene.lua --state state.csv" }
  end,
}
