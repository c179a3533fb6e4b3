-- A plane box of liquid, 1 m wide, of at.n cells, for the problems of this folder. Particles are two a cell along each axis,
-- a little at random, so that values differ by chance from level to level: each problem says by how much, as its noise.
local filling = require("filling")
local validation = require("validation")

local tank = {}

-- inside(x, y, z): where the liquid is, of [0, 1] x [0, top]; or level(x): how high; velocity(x, z) at the start; `with`: parameters of the
-- corrector; before(scene): adds obstacles; scatter: 0, and particles are on a lattice. Returns the scene, the number of
-- particles and their masses.
function tank.scene(t)
  local cell = 1 / t.n
  local scene = hooke.scene { duration = t.duration, fps = validation.fps(t.h), dt = t.h, integrator = "symplectic_euler" }
  local water = filling.box { low = { 0, 0, 0 }, high = { 1, 0, t.top }, cell = cell, density = 1000,
    inside = t.inside, level = t.level, scatter = t.scatter }
  for k, p in ipairs(water.positions) do
    scene:particle { position = p, mass = water.masses[k], velocity = t.velocity and t.velocity(p[1], p[3]) }
  end
  if t.g then scene:force("gravity", { g = { 0, 0, -t.g } }) end
  if t.before then t.before(scene) end
  local with = t.with or {}
  with.low, with.high, with.cell, with.density = { 0, 0, 0 }, { 1, 0, t.room or t.top }, cell, 1000
  scene:corrector("liquid", with)
  return scene, #water.positions, water.masses
end

return tank
