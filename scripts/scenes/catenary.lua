-- catenary.lua: a chain of rigid bars and an elastic string of the same length and weight are let go as V's between two
-- pegs and come to rest as catenaries, the string below the chain. For a span of 1 m, a length of 1.2 m and 1 N/m the
-- closed forms are known: sag and horizontal pull are 0.292343798 m and 0.469541523 N for the chain, z = a cosh(x/a), and
-- 0.341111699 m and 0.395527043 N for the elastic catenary with EA = 10 N (Irvine, Cable Structures, 1981). With n
-- segments they are off by a multiple of 1/n^2.
local n = param("n", 40, "bars, and springs", { min = 2 })
local EA = param("EA", 10, "the string's stiffness, N", { min = 1 })
local T = param("duration", 6, "s", { min = 0.1 })

local span, length, w, g = 1, 1.2, 1, 9.81 -- m, m, N/m
local scene = hooke.scene { duration = T, fps = 60, integrator = "leapfrog", dt = 1 / 4800 }

-- A V of segments that have their length; the pegs bear half a segment each.
local function hang(name)
  local l, ids, edges = length / n, {}, {}
  local depth = math.sqrt(length ^ 2 - span ^ 2) / 2
  for k = 0, n do
    local s = 2 * k / n
    ids[k] = scene:particle { position = { span * s / 2, 0, -depth * math.min(s, 2 - s) }, mass = w * l / g,
      group = name }
    if k > 0 then edges[k] = { ids[k - 1], ids[k] } end
  end
  scene:pin { ids[0], ids[n] }
  return ids, edges, l
end

local chain, bars = hang("chain")
local string, parts, l = hang("string")
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("drag", { rate = 3 })
scene:constraint("bars", { edges = bars })
scene:force("springs", { edges = parts, k = EA / l, rest = l })

local function middle(s, ids) return -(s:position(ids[n // 2])[3] + s:position(ids[(n + 1) // 2])[3]) / 2 end
scene:measure("sag of the chain", function(s) return middle(s, chain) end, { unit = "m" })
scene:measure("sag of the string", function(s) return middle(s, string) end, { unit = "m" })
scene:measure("pull of the chain", function(s) return s:force("bars", chain[0])[1] end, { unit = "N" })
scene:measure("pull of the string", function(s) return s:force("springs", string[0])[1] end, { unit = "N" })
scene:output("frames", { width = 960, height = 600, color = "group", radius = 0.011, from = { 0.5, -1.45, -0.2 },
  look_at = { 0.5, 0, -0.2 }, ground = false })
return scene
