-- large_steps.lua: cloth as Baraff and Witkin 1998 have it, in large steps: triangles with their conditions of stretch and
-- shear, one linearisation of backward Euler a step, and pins as a filter of conjugate gradients. A square cloth falls over
-- a round table. steps=1, one a frame, is how the method was meant: nothing rings, whatever the stiffness. What the
-- steps damp then is 1.4 times the largest kinetic energy, with 16 a frame 0.04 of it (`drift` in the summary).
local N = param("N", 17, "particles along one side", { min = 5, max = 200 })
local k = param("k", 200, "stiffness against stretching, N/m", { min = 0 })
local per_frame = param("steps", 4, "in a frame", { min = 1 })
local side, round = 1, 0.3

local scene = hooke.scene { duration = 1.5, fps = 60, dt = 1 / 60 / per_frame }
scene:integrator("baraff_witkin", { solve = "filtered" })

local cloth = scene:grid { nx = N, ny = N, width = side, height = side, mass = 0.2 * side * side, alternating = true,
  origin = { -side / 2, -side / 2, 0 } }
local table_top = {}
for j = 1, N do
  for i = 1, N do
    local x, y = side * ((i - 1) / (N - 1) - 0.5), side * ((j - 1) / (N - 1) - 0.5)
    if math.sqrt(x * x + y * y) < round then table_top[#table_top + 1] = cloth:at(i, j) end
  end
end
scene:pin(table_top)

scene:force("membrane", { triangles = cloth:triangles(), stiffness = k, shear = 0.3 * k, damping = 0.02 })
scene:force("hinges", { triangles = cloth:triangles(), rigidity = 1e-4, damping = 1e-5 })
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("drag", { rate = 4 })

scene:measure("lowest", function(s)
  local z = 0
  for _, id in ipairs(cloth:ids()) do z = math.min(z, s:position(id)[3]) end
  return z
end, { unit = "m" })
scene:output("frames", { width = 960, height = 720, color = "none", plain = { 0.62, 0.32, 0.36 }, from = { 1.1, -1.9, 0.9 },
  look_at = { 0, 0, -0.12 }, ground_height = -0.5 })
return scene
