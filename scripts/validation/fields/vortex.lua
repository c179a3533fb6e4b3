-- A grain in the core of Rankine's vortex, where the air turns like a rigid body: z'' = rate (i W z - z'), so that it
-- spirals outwards as exp(lambda t), lambda^2 + rate lambda - i rate W = 0. And the air's circulation, from the drag on
-- grains around it.
local validation = require("validation")

local strength, core, rate, T = 2 * math.pi * 0.25, 0.5, 8, 2
local W = strength / (2 * math.pi * core ^ 2)

local function root(re, im)
  local size = math.sqrt(re * re + im * im)
  return math.sqrt((size + re) / 2), (im < 0 and -1 or 1) * math.sqrt((size - re) / 2)
end

-- (-rate + sqrt(rate^2 + 4 i rate W))/2
local re, im = root(rate * rate, 4 * rate * W)
local growth, turn = (re - rate) / 2, im / 2
local r0 = 0.1

return validation.problem {
  title = "A grain in Rankine's vortex",
  quantities = {
    { name = "distance from the axis after 2 s", unit = "m", reference = r0 * math.exp(growth * T),
      source = "closed form, lambda^2 + rate lambda = i rate W" },
    { name = "angle after 2 s", unit = "rad", reference = turn * T, source = "closed form, Im lambda" },
    { name = "circulation outside of the core", unit = "m^2/s", reference = strength,
      source = "Rankine 1858: u = circulation/(2 pi r)", order = {} },
  },
  time = { 0.04, 0.02, 0.01 },
  order = { time = 4 },
  tolerance = 1e-7,
  why = "order 4, (rate h)^4/120 = 3e-7 at the finest step",
  forces = { vortex = { "strength", "core", "profile", "rate" } },
  quick = { time = { 0.1, 0.05, 0.025 }, tolerance = 1e-4 },
  solve = function(at)
    local scene = hooke.scene { duration = T, fps = 1, dt = at.h, integrator = "rk4" }
    local p = scene:particle { position = { r0, 0, 0 }, velocity = { growth * r0, turn * r0, 0 }, mass = 1 }
    local far, sum = {}, 0
    for k = 1, 8 do
      local angle = 2 * math.pi * k / 8
      far[k] = scene:particle { position = { 0.8 * math.cos(angle), 0.8 * math.sin(angle), 0 }, mass = 1 }
    end
    scene:pin(far)
    scene:force("vortex", { strength = strength, core = core, profile = "rankine", rate = rate })
    local s = scene:run():state()
    for k = 1, 8 do
      local f, x = s:force("vortex", far[k]), s:position(far[k])
      sum = sum + (f[2] * x[1] - f[1] * x[2]) / 0.8 / rate * 2 * math.pi * 0.8 / 8 -- u . dl
    end
    local x = s:position(p)
    local angle = math.atan(x[2], x[1])
    return { math.sqrt(x[1] ^ 2 + x[2] ^ 2), angle + 2 * math.pi * math.floor((turn * T - angle) / (2 * math.pi) + 0.5), sum }
  end,
}
