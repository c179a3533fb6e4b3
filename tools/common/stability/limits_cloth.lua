-- A simple square cloth with the properties that limit a step: stiffness, damping, unequal masses and fine meshes. It
-- is in equilibrium without weight, so that any growth is an instability of the method: `hooke stability` measures the
-- estimates of stable steps on it.
local N = param("N", 8, "particles along one side", { min = 3 })
local k = param("k", 1000, "structural stiffness, N/m", { min = 0 })
local damping = param("damping", 0.02, "structural damping, N s/m", { min = 0 })
local ratio = param("ratio", 1, "mass of every fifth particle over that of the others", { min = 1e-9 })

local scene = hooke.scene { duration = 1, fps = 60 }
local x, mass = {}, {}
for j = 0, N - 1 do
  for i = 0, N - 1 do
    x[#x + 1] = { i / (N - 1), j / (N - 1), 0 }
    mass[#mass + 1] = 0.15 / (N * N) * ((i + 2 * j) % 5 == 0 and ratio or 1)
  end
end
scene:particles { positions = x, masses = mass }
scene:pin { N * (N - 1) + 1, N * N }

local function edges(steps)
  local list = {}
  for j = 0, N - 1 do
    for i = 0, N - 1 do
      for _, d in ipairs(steps) do
        local a, b = i + d[1], j + d[2]
        if a >= 0 and a < N and b < N then list[#list + 1] = { 1 + i + N * j, 1 + a + N * b } end
      end
    end
  end
  return list
end

scene:force("springs", { edges = edges { { 1, 0 }, { 0, 1 } }, k = k, damping = damping, label = "structural" })
scene:force("springs", { edges = edges { { 1, 1 }, { -1, 1 } }, k = 0.3 * k, damping = 0.5 * damping, label = "shear" })
scene:force("springs", { edges = edges { { 2, 0 }, { 0, 2 } }, k = 0.05 * k, damping = 0.25 * damping, label = "flexion" })
return scene
