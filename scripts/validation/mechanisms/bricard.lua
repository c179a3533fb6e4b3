-- Bricard's linkage: six rods of 1 m on hinges across each other, one of them held, move though a count of freedoms has none left:
-- one equation follows from the others (the benchmark of Gonzalez, Dopico, Lugris and Cuadrado, Multibody System Dynamics 16
-- (2006) 337, with rods of a square section). Under gravity it keeps its energy, that of the start, and every hinge.
local validation = require("validation")

local corner = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, -1, 0 }, { 1, -1, 1 }, { 0, -1, 1 }, { 0, 0, 1 } }
local axis = { { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 0 } }

return validation.problem {
  title = "Bricard's linkage",
  quantities = {
    { name = "energy", unit = "J", reference = 0, scale = 10, source = "that of the start",
      noise = 1e-12, tolerance = 1e-8 },
    { name = "largest gap of a hinge", unit = "m", reference = 0, scale = 1, source = "closed loop",
      noise = 1e-12, order = {}, tolerance = 1e-12, why = "positions are brought onto the equations to rounding" },
  },
  time = { 0.01, 0.005, 0.0025 },
  order = { time = 2, within = 0.5 },
  tolerance = 1e-5,
  why = "errors of order 2 leave those of order 4",
  quick = { time = { 0.02, 0.01, 0.005 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = 2, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local body, points = {}, {}
    for k = 1, 5 do
      local p, q, size = corner[k], corner[k + 1], {}
      for i = 1, 3 do size[i] = p[i] == q[i] and 0.1 or 1 end
      body[k] = scene:rigid { shape = "box", size = size, mass = 1,
        position = { (p[1] + q[1]) / 2, (p[2] + q[2]) / 2, (p[3] + q[3]) / 2 } }
    end
    local function point(k, p)
      local c = body[k].center
      local at_start = {}
      for i = 1, 3 do at_start[i] = p[i] - (corner[k][i] + corner[k + 1][i]) / 2 + c[i] end
      return body[k]:point(at_start)
    end
    for k = 1, 6 do
      local b = k > 1 and body[k - 1] or nil
      if k == 6 then
        scene:joint { kind = "hinge", a = body[5], at = corner[6], axis = axis[6] }
      else
        scene:joint { kind = "hinge", a = body[k], b = b, at = corner[k], axis = axis[k] }
        if b then points[#points + 1] = { point(k, corner[k]), point(k - 1, corner[k]) } end
      end
    end
    scene:force("gravity", { g = { 0, -9.81, 0 } })
    local run = scene:run()
    local s, gap = run:state(), 0
    for _, pair in ipairs(points) do
      local p, q = s:position(pair[1]), s:position(pair[2])
      gap = math.max(gap, math.sqrt((p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2 + (p[3] - q[3]) ^ 2))
    end
    local E = 0
    for k = 1, 5 do
      E = E + body[k]:energy(s) + 9.81 * (body[k]:position(s)[2] - (corner[k][2] + corner[k + 1][2]) / 2)
    end
    return { E, gap }
  end,
}
