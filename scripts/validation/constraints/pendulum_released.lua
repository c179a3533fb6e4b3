-- A rigid pendulum of L = g = 1 is let go level with its pivot; its place at t = 1, 5 and 10.
local validation = require("validation")

local source = "elliptic functions of modulus 1/sqrt2"
local places = {
  { 0.879548132411889, -0.475809922942721 }, { -0.685344871278749, -0.728218653573167 },
  { -0.811586446191304, -0.584232351345396 },
}

local quantities = {}
for k, t in ipairs { 1, 5, 10 } do
  quantities[2 * k - 1] = { name = ("x at t = %d s"):format(t), unit = "m", reference = places[k][1], source = source }
  quantities[2 * k] = { name = ("y at t = %d s"):format(t), unit = "m", reference = places[k][2], source = source }
end

return validation.problem {
  title = "A rigid pendulum let go from the horizontal",
  quantities = quantities,
  time = { 1 / 100, 1 / 200, 1 / 400, 1 / 800 },
  together = true,
  order = { time = 2 },
  tolerance = 1e-8,
  why = "order 2, 1e-5 at the finest step; extrapolation leaves order 4, 1e-9",
  quick = { time = { 1 / 50, 1 / 100, 1 / 200 }, tolerance = 1e-4 },
  solve = function(at)
    local scene = hooke.scene { duration = 10, fps = 1, dt = at.h, integrator = "leapfrog" }
    local anchor = scene:particle { position = { 0, 0, 0 }, mass = 1 }
    local p = scene:particle { position = { 1, 0, 0 }, mass = 1 }
    scene:pin { anchor }
    scene:force("gravity", { g = { 0, -1, 0 } })
    scene:constraint("bars", { edges = { { anchor, p } } })
    local got = {}
    for _, t in ipairs { 1, 5, 10 } do
      local x = scene:run { to = t }:state():position(p)
      got[#got + 1], got[#got + 2] = x[1], x[2]
    end
    return got
  end,
}
