-- Provot's sheet: 17 x 17 particles, 0.1 kg in all, all springs of 1 N/m, hung by two corners, after 0.3 s. With corrections
-- none is above the limit, a tenth; without, the most strained springs are those at the pinned corners.
local validation = require("validation")

local limit = 0.1
local steps = { { 1, 0 }, { 0, 1 }, { 1, 1 }, { -1, 1 }, { 2, 0 }, { 0, 2 } }

local function hang(N, h, limited)
  local scene = hooke.scene { duration = 0.3, fps = 10, dt = h, integrator = "symplectic_euler" }
  local sheet = scene:grid { nx = N, ny = N, width = 1, height = 1, mass = 0.1, u = { 1, 0, 0 }, v = { 0, -0.6, 0.8 } }
  local edges = sheet:structural() .. sheet:shear() .. sheet:flexion()
  scene:pin { sheet:at(1, N), sheet:at(N, N) }
  scene:force("gravity", {})
  scene:force("drag", { rate = 2 })
  scene:force("springs", { edges = edges, k = 1, damping = 2e-3 })
  if limited then
    scene:corrector("strain_limit", { edges = edges, limit = limit, tolerance = 1e-6, sweeps = 10000 })
  end
  local s, most, elsewhere = scene:run():state(), -1, -1
  for _, step in ipairs(steps) do
    local rest = math.sqrt(step[1] ^ 2 + step[2] ^ 2) / (N - 1)
    for j = 1, N - step[2] do
      for i = math.max(1, 1 - step[1]), math.min(N, N - step[1]) do
        local p, q = s:position(sheet:at(i, j)), s:position(sheet:at(i + step[1], j + step[2]))
        local l = math.sqrt((q[1] - p[1]) ^ 2 + (q[2] - p[2]) ^ 2 + (q[3] - p[3]) ^ 2)
        local at_corner = j + step[2] == N and (i == 1 or i == N or i + step[1] == 1 or i + step[1] == N)
        most = math.max(most, l / rest - 1)
        if not at_corner then elsewhere = math.max(elsewhere, l / rest - 1) end
      end
    end
  end
  return most, elsewhere
end

return validation.problem {
  title = "Provot's sheet: strains with and without corrections",
  quantities = {
    { name = "largest strain, corrected", reference = limit, source = "Provot 1995: the critical strain" },
    { name = "the most strained springs are at the corners (1: yes)", reference = 1,
      source = "Provot 1995: the super-elastic effect" },
  },
  time = { 0.003, 0.0015, 0.00075 },
  noise = 2e-5,
  tolerance = 1.5e-5,
  why = "the tolerance of the corrections, 1e-6 of 1.1 L, as a part of a tenth",
  quick = { time = { 0.006, 0.004, 0.003 }, tolerance = 1.5e-5 }, -- 9 x 9
  solve = function(at)
    local N = at.quick and 9 or 17
    local most, elsewhere = hang(N, at.h, false)
    return { (hang(N, at.h, true)), most > 1.2 * elsewhere and 1 or 0 }
  end,
}
