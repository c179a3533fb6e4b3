-- Three bodies of masses 3, 4 and 5 fall from rest in the corners of a right triangle, pass each other closely several
-- times, and are looked at after 10 s. An adaptive method of order 5 with an error per step of `tol`.
local validation = require("validation")

local start = { { 1, 3, 0 }, { -2, -1, 0 }, { 1, -1, 0 } }
local there = { 0.77848041013809, 0.14139230029009, -2.02509247797820, 0.09721938414606, 1.15298573629971,
  -0.16261088749090 }

local quantities = {}
for k, value in ipairs(there) do
  quantities[k] = { name = ("%s%d at t = 10 s"):format(k % 2 == 1 and "x" or "y", (k + 1) // 2), unit = "m",
    reference = value, scale = 1,
    source = "Burrau 1913, Szebehely and Peters 1967; recomputed at two tolerances that agree to 1e-14" }
end

return validation.problem {
  title = "The Pythagorean problem of three bodies",
  quantities = quantities,
  together = true,
  time = { 1e-9, 1e-10, 1e-11, 1e-12 },
  time_label = "tolerance",
  tolerance = 1e-6,
  why = "errors grow by 1e5 or so in the encounters, from a tolerance of 1e-12 and many steps",
  forces = { nbody = { "G" } },
  quick = { time = { 1e-9, 1e-10, 1e-11 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = 10, fps = 2, tol = at.h, integrator = "dopri5" }
    for i, p in ipairs(start) do scene:particle { position = p, mass = i + 2 } end
    scene:force("nbody", { G = 1 })
    local s, found = scene:run():state(), {}
    for i = 1, 3 do
      local p = s:position(i)
      found[2 * i - 1], found[2 * i] = p[1], p[2]
    end
    return found
  end,
}
