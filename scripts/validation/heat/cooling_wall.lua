-- A melt at its melting point freezes from a side that gives heat away by convection: the thickness of the solid after a
-- time. In units of k/h for lengths and of rho latent k/(h^2 dT) for times, and with the Stefan number e = c dT/latent,
--     t = X + X^2/2 + e/3 (X + X^2/2 - X/(1 + X)) + O(e^2),
-- from T(x, X) = (1 + x)/(1 + X) and its first correction by T_xx = e X' T_X with T_x = T at the surface. For large X it is
-- the series of Neumann's front, X^2/2 (1 + e/3 - 2 e^2/45), whose last term, 4e-4 with e = 0.1, is left out.
local bar, validation = require("_bar"), require("validation")

local number, by, X = 0.1, 2, 0.7 -- e; W/(m^2 K), of the convection; m, of a bar of 1 m with c = k = rho = 1

return validation.problem {
  title = "A solidifying slab with convection at its surface",
  quantities = {
    { name = "thickness of the solid", unit = "m", reference = X, source = "the series above, to first order in the Stefan number",
      noise = 4e-3 },
    { name = "enthalpy kept", unit = "of what there was", reference = 1, source = "conservation", tolerance = 1e-12,
      why = "rounding", noise = 1e-12 },
  },
  space = { 8, 16, 32, 64 },
  tolerance = 1e-3,
  why = "a part of the distance of particles, 1/64, and 2e-4 of the series",
  forces = { conduction = { "edges", "section", "channel", "account", "capacity", "conductivity", "solidus", "latent" },
    heating = { "particles", "area", "convection", "surroundings", "channel", "account", "capacity", "solidus", "latent" } },
  quick = { space = { 8, 12, 16 }, tolerance = 1e-2 },
  solve = function(at)
    local latent, x = 1 / number, by * X
    local time = x + x * x / 2
    time = time + number / 3 * (time - x / (1 + x))
    local law = { capacity = 1, conductivity = 1, solidus = 100, latent = latent }
    local scene, ids, masses = bar.scene { n = at.n, duration = time * latent / by ^ 2, law = law,
      enthalpy = function() return latent end }
    scene:force("heating", { particles = { ids[0] }, area = 1, convection = by, surroundings = 99, channel = "enthalpy",
      account = "given", capacity = 1, solidus = 100, latent = latent })
    local state = scene:run():state()
    return { 1 - bar.molten(state, ids, masses, latent), bar.kept(state, ids, masses) / latent }
  end,
}
