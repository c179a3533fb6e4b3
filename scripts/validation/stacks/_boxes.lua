-- Rigid boxes of side `a` on a floor, for the problems of stacks.
local boxes = { a = 0.2, thickness = 2e-3 }

-- places: { x, z } of each; gravity: a vector. Returns the scene and its boxes.
function boxes.scene(h, duration, mu, places, gravity)
  local scene = hooke.scene { duration = duration, fps = 50, dt = h, integrator = "leapfrog" }
  local list = {}
  for k, at in ipairs(places) do
    list[k] = scene:rigid { shape = "box", size = boxes.a, density = 500, position = { at[1], 0, at[2] } }
    list[k]:surface()
  end
  scene:body { shape = "box", size = { 8, 2, 0.2 }, position = { 0, 0, -0.1 } }
  scene:force("gravity", { g = gravity or { 0, 0, -9.81 } })
  scene:corrector("contact", { thickness = boxes.thickness, friction = mu })
  return scene, list
end

-- The height of the middle of the k-th layer, all of them in touch.
function boxes.height(k) return (boxes.a + boxes.thickness) * (k - 0.5) end

-- m and m/s: the largest way from the places, and the largest component of a velocity.
function boxes.motion(state, list, places)
  local drift, speed = 0, 0
  for k, b in ipairs(list) do
    local x, v, from = b:position(state), b:velocity(state), { places[k][1], 0, places[k][2] }
    for c = 1, 3 do drift, speed = math.max(drift, math.abs(x[c] - from[c])), math.max(speed, math.abs(v[c])) end
  end
  return drift, speed
end

return boxes
