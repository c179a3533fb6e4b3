-- Gresho's vortex in a full box: a ring of whirling liquid that its pressure holds together, without friction. After a
-- turn about itself, 0.4 pi s, what is missing is what the transfers between particles and grid have taken.
local tank = require("_tank")
local validation = require("validation")

local T = 0.4 * math.pi

local function speed(r) return r < 0.2 and 5 * r or r < 0.4 and 2 - 5 * r or 0 end

local function velocity(x, z)
  local r = math.sqrt((x - 0.5) ^ 2 + (z - 0.5) ^ 2)
  local w = r > 0 and speed(r) / r or 0
  return { -w * (z - 0.5), 0, w * (x - 0.5) }
end

return validation.problem {
  title = "Gresho's vortex after a turn",
  quantities = {
    { name = "kinetic energy kept", reference = 1, source = "Gresho and Chan 1990: a steady flow" },
  },
  space = { 20, 30, 40 },
  noise = 0.01,
  tolerance = 0.06,
  why = "its kinks at r = 0.2 and 0.4 m leave order 1, so that the levels here do not resolve more",
  quick = { space = { 16, 20, 24 }, tolerance = 0.3 },
  solve = function(at)
    local steps = math.ceil(2 * at.n * T)
    local scene, count = tank.scene { n = at.n, h = T / steps, top = 1, duration = T, velocity = velocity }
    local function energy(state)
      local sum = 0
      for id = 1, count do
        local v = state:velocity(id)
        sum = sum + v[1] ^ 2 + v[3] ^ 2
      end
      return sum
    end
    local first = energy(scene:run { to = 0 }:state())
    return energy(scene:run():state()) / first
  end,
}
