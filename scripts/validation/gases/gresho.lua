-- Gresho's vortex, a ring of whirling gas whose pressure balances it, turns once about itself (0.4 pi s) without friction:
-- what it loses is the method's doing.
local validation = require("validation")

local T = 0.4 * math.pi

local function speed(r) return r < 0.2 and 5 * r or r < 0.4 and 2 - 5 * r or 0 end

return validation.problem {
  title = "Gresho's vortex after one turn",
  quantities = {
    { name = "kinetic energy kept", reference = 1, source = "Gresho and Chan 1990: a steady flow" },
    { name = "peak kept", reference = 1, source = "Gresho and Chan 1990", tolerance = 0.06 },
  },
  space = { 20, 40, 80 },
  tolerance = 0.02,
  why = "its kinks at r = 0.2 and 0.4 m leave order 1 to 2, and limits cut the peak by a part of a cell",
  quick = { space = { 16, 20, 32 }, tolerance = 0.2 },
  solve = function(at)
    local steps = math.ceil(2 * at.n * T)
    local scene = hooke.scene { duration = T, fps = steps / T, dt = T / steps, integrator = "symplectic_euler" }
    local ids = {}
    for i = 1, 40 do
      for j = 1, 40 do ids[#ids + 1] = scene:particle { position = { (i - 0.5) / 40, 0, (j - 0.5) / 40 }, mass = 1 } end
    end
    scene:pin(ids)
    scene:corrector("gas", { low = { 0, 0, 0 }, high = { 1, 0, 1 }, cell = 1 / at.n,
      start_velocity = function(_, x, _, z)
        local r = math.sqrt((x - 0.5) ^ 2 + (z - 0.5) ^ 2)
        local w = r > 0 and speed(r) / r or 0
        return -w * (z - 0.5), 0, w * (x - 0.5)
      end })
    local function measure(s)
      local energy, peak = 0, 0
      for _, id in ipairs(ids) do
        local u = s:field("flow", id)
        energy, peak = energy + u[1] ^ 2 + u[3] ^ 2, math.max(peak, math.sqrt(u[1] ^ 2 + u[3] ^ 2))
      end
      return energy, peak
    end
    local e0 = measure(scene:run { to = 0 }:state())
    local e1, peak = measure(scene:run():state())
    return { e1 / e0, peak }
  end,
}
