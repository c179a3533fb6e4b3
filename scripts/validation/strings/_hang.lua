-- Strings and chains that hang between two pegs at one height, 1 m apart: 1.2 m and 1 N/m of them, in n segments of equal
-- length; the pegs bear half a segment each. They come to rest by drag from a V.
local validation = require("validation")

local hang = { span = 1, length = 1.2, w = 1, g = 9.81 }

-- Where it rests: the run, and the ids from one peg to the other. join(scene, edges, l) adds what holds it together.
function hang.rest(n, dt, join)
  local l, depth = hang.length / n, math.sqrt(hang.length ^ 2 - hang.span ^ 2) / 2
  local scene = hooke.scene { duration = 40, fps = 1, dt = dt, integrator = "leapfrog" }
  local ids, edges = {}, {}
  for k = 0, n do
    local s = 2 * k / n
    ids[k] = scene:particle { position = { hang.span * s / 2, 0, -depth * math.min(s, 2 - s) }, mass = hang.w * l / hang.g }
    if k > 0 then edges[k] = { ids[k - 1], ids[k] } end
  end
  scene:pin { ids[0], ids[n] }
  scene:force("gravity", { g = { 0, 0, -hang.g } })
  scene:force("drag", { rate = 8 }) -- the slowest swing has 8/s or so
  join(scene, edges, l)
  return validation.rest(scene, 1, 1e-12, 40), ids
end

return hang
