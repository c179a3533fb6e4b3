-- A chain of 6 links falls from 60 degrees: ropes that may be neither drawn out nor pressed are bars, so that corrections
-- alone, without any spring, have to give the motion of a chain that does not stretch.
local validation = require("validation")
local links = require("links")

local n, L, mass, g, T = 6, 1 / 6, 0.02, 9.81, 0.75
local angle = math.rad(60)

local function tip(c)
  return function()
    return links.pendulum { n = n, length = L, mass = mass, g = g, angle = angle, h = 2.5e-4 }(T)[n][c]
  end
end

local source = "Lagrange's equations of the chain in its angles, in steps of 1/4000 s of order 4 (scripts/lib/links.lua)"

return validation.problem {
  title = "A chain of links, held by corrections alone",
  quantities = {
    { name = "x of the tip", unit = "m", reference = tip(1), source = source },
    { name = "z of the tip", unit = "m", reference = tip(2), source = source },
  },
  time = { 1 / 800, 1 / 1600, 1 / 3200 },
  order = { time = 2 },
  noise = 1e-9,
  tolerance = 1e-7,
  why = "order 2, some 1e-5 at the finest step; a hundredth of it is left",
  quick = { time = { 1 / 200, 1 / 400, 1 / 800 }, tolerance = 1e-5 },
  solve = function(at)
    local scene = hooke.scene { duration = T, fps = 20, dt = at.h, integrator = "leapfrog" }
    local chain = scene:strand { n = n + 1, from = { 0, 0, 0 }, mass = mass * (n + 1),
      to = { n * L * math.sin(angle), 0, -n * L * math.cos(angle) } }
    scene:pin { chain:at(1) }
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:corrector("strain_limit", { edges = chain:structural(), limit = 0, compression = 0, tolerance = 1e-10,
      sweeps = 100000 })
    local x = scene:run():state():position(chain:at(n + 1))
    return { x[1], x[3] }
  end,
}
