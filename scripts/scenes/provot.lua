-- provot.lua: a sheet hung by two corners, twice: on the left as its springs hold it, on the right with springs that are
-- shortened after every step where they are drawn out by more than a tenth (Provot 1995). On the left those at the corners
-- become more than twice as long while most are hardly stretched. Stiffer springs would be the other remedy, in steps
-- that are shorter by 1/sqrt(k). The measures are the table of strains: the largest of each kind of springs on each side.
local N = param("N", 17, "particles along one side", { min = 3, max = 512 })
local k = param("k", 1, "stiffness of all springs, N/m", { min = 0 })
local limit = param("limit", 0.1, "largest strain on the right", { min = 0 })
local sweeps = param("sweeps", 2000, "sweeps of the correction in a step, at most", { min = 1 })
local order = param("order", "given", "of the sweeps: given, outwards, sorted")
local velocity = param("velocity", "corrected", "on the right: corrected, kept")

local scene = hooke.scene { duration = 3, fps = 60, integrator = "leapfrog" }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("drag", { rate = 2 })

local kinds = { structural = { { 1, 0 }, { 0, 1 } }, shear = { { 1, 1 }, { -1, 1 } }, flexion = { { 2, 0 }, { 0, 2 } } }

local function stretch(cloth, steps) -- the largest of the edges from (i, j) to (i + step[1], j + step[2])
  return function(s)
    local most = -1
    for _, step in ipairs(steps) do
      local rest = math.sqrt(step[1] ^ 2 + step[2] ^ 2) / (N - 1)
      for j = 1, N - step[2] do
        for i = math.max(1, 1 - step[1]), math.min(N, N - step[1]) do
          local a, b = s:position(cloth:at(i, j)), s:position(cloth:at(i + step[1], j + step[2]))
          local l = math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2 + (b[3] - a[3]) ^ 2)
          most = math.max(most, l / rest - 1)
        end
      end
    end
    return most
  end
end

local function sheet(side, x)
  local cloth = scene:grid { nx = N, ny = N, width = 1, height = 1, mass = 0.1, origin = { x, 0, 0 },
    u = { 1, 0, 0 }, v = { 0, -0.6, 0.8 } }
  scene:pin { cloth:at(1, N), cloth:at(N, N) }
  for _, kind in ipairs { "structural", "shear", "flexion" } do
    scene:force("springs", { edges = cloth[kind](cloth), k = k, damping = 2e-3, label = kind .. " " .. side })
    scene:measure(kind .. " " .. side, stretch(cloth, kinds[kind]))
  end
  return cloth
end

sheet("left", 0)
local right = sheet("right", 1.25)
scene:corrector("strain_limit", { edges = right:structural() .. right:shear() .. right:flexion(), limit = limit,
  sweeps = sweeps, tolerance = 5e-6, order = order, velocity = velocity })

scene:output("frames", { width = 1280, height = 720, range = { -0.5, 0.5 }, ground = false, from = { 0.7, -3.5, 0.2 },
  look_at = { 1.12, -0.4, 0.13 } })
return scene
