-- The beam of the collections of stiff equations: 40 links, clamped and at rest, pulled at the tip by 1.5 sin^2 t (-1, 1)
-- until t = pi. The collection's equations are those of this chain: half a mass at the tip, 2 EI/l at the clamp. So its
-- digits are the chain's, at n = 40, with angle springs. (Rods, which bend by the tangents of half angles, are 0.9 % off: that
-- is what 40 links are worth at t = 5.)
local cantilever = require("_cantilever")

local n, t_end = 40, 5
local angles = { [1] = -0.5792366591285007e-2, [10] = -0.09119134654647947, [20] = -0.1483595472463012,
  [40] = -0.1767201761075488 }

local list = {}
for _, k in ipairs { 1, 10, 20, 40 } do list[#list + 1] = { ("angle of link %d"):format(k), angles[k], unit = "rad" } end

return cantilever.problem({
  title = "Beam of 40 links with a force at its tip",
  time = { 2e-4, 1e-4, 5e-5 },
  order = { time = 2 },
  together = true,
  tolerance = 1e-7,
  why = "errors of order 2 at h = 5e-5, 1e-8, and their irregular part: links swing with up to 6,400 rad/s",
  quick = { time = { 2.5e-4, 2e-4, 1.6e-4 }, tolerance = 1e-2 },
  with = { "angle_springs" },
  timeout = 600,
}, list, "Hairer and Wanner 1996, IV.10 (BEAM); reference solution of Test Set for IVP Solvers", function(_, force, at)
  local scene, s = cantilever.rod(n, force, { dt = at.h, duration = t_end, fps = 1, integrator = "leapfrog" })
  local tip = cantilever.at(s, n, n)
  local function pull(t) -- N; the tip's mass is 1/(2 n)
    local f = 1.5 * math.sin(t) ^ 2 * 2 * n
    return -f, f, 0
  end
  scene:force("gravity", { g = pull, only = { tip }, to = math.pi, label = "pull" })
  local state, found = scene:run { to = t_end }:state(), {}
  for _, k in ipairs { 1, 10, 20, 40 } do
    local a, b = state:position(cantilever.at(s, n, k - 1)), state:position(cantilever.at(s, n, k))
    found[#found + 1] = math.atan(b[2] - a[2], b[1] - a[1])
  end
  return table.unpack(found)
end)
