-- An infinite chain of atoms at equal distances a, by a box that repeats along it: the force on one that is moved by a little
-- along the chain, over the way, is 2 sum V''(k a), a sum of zeta functions. 1/n is the size: the force ends after n
-- neighbours on each side, and what it leaves out falls with n^-7.
local validation = require("validation")

local a, moved = 1.12, 1e-5 -- of sigma; epsilon = sigma = 1
local zeta8, zeta14 = math.pi ^ 8 / 9450, 2 * math.pi ^ 14 / 18243225

return validation.problem {
  title = "Stiffness of an atom in an infinite chain",
  quantities = {
    { name = "stiffness", unit = "N/m", reference = 2 * 4 * (156 * zeta14 / a ^ 14 - 42 * zeta8 / a ^ 8),
      source = "closed form, 2 sum V''(k a), V of Lennard-Jones 1924" },
  },
  space = { 4, 8, 16 },
  order = { space = 7, within = 0.8 },
  space_label = "1/n, neighbours",
  tolerance = 1e-8,
  why = "what is left out is of order 7 in 1/(n + 1/2); differences over 1e-5 of the distance",
  noise = 1e-9,
  forces = { lennard_jones = { "epsilon", "sigma", "cutoff" } },
  quick = { space = { 2, 4, 8 }, tolerance = 1e-5 },
  solve = function(at)
    local atoms, n = {}, 2 * at.n + 2
    local function force(by)
      local scene = hooke.scene { duration = 1, fps = 1, dt = 1, integrator = "leapfrog" }
      for k = 1, n do
        atoms[k] = scene:particle { position = { (k - 0.5) * a + (k == at.n and by or 0), 0, 0 }, mass = 1e30 }
      end
      scene:periodic { low = { 0, 0, 0 }, high = { n * a, 1, 1 }, axes = "x" }
      scene:force("lennard_jones", { epsilon = 1, sigma = 1, cutoff = (at.n + 0.5) * a })
      return scene:run { to = 0 }:state():force("lennard_jones", atoms[at.n])[1]
    end
    return (force(-moved) - force(moved)) / (2 * moved)
  end,
}
