-- Maxwell's ring: N equal bodies around a heavy one turn as a whole. The angle after a time, for rings of 3, 8 and 36.
local validation = require("validation")

local M, m, R, t_end = 1, 0.001, 1, 4
local counts = { 3, 8, 36 }

local function rate(N)
  local sum = 0
  for k = 1, N - 1 do sum = sum + 1 / math.sin(math.pi * k / N) end
  return math.sqrt((M + m * sum / 4) / R ^ 3)
end

local quantities = {}
for i, N in ipairs(counts) do
  quantities[i] = { name = ("angle of %d bodies after 4 s"):format(N), unit = "rad", reference = rate(N) * t_end,
    source = "Maxwell 1859, On the stability of the motion of Saturn's rings: w^2 = (M + m/4 sum 1/sin(pi k/N)) G/R^3" }
end

return validation.problem {
  title = "Maxwell's ring",
  quantities = quantities,
  time = { 1 / 20, 1 / 40, 1 / 80 },
  order = { time = 4 },
  tolerance = 1e-10,
  why = "order 4, 1e-9 at the finest step",
  forces = { nbody = { "G" } },
  quick = { time = { 1 / 20, 1 / 40, 1 / 80 }, tolerance = 1e-9 },
  solve = function(at)
    local found = {}
    for i, N in ipairs(counts) do
      local scene = hooke.scene { duration = t_end, fps = 5, dt = at.h, integrator = "blanes_moan" }
      scene:particle { position = { 0, 0, 0 }, mass = M }
      for k = 0, N - 1 do
        local c, s = math.cos(2 * math.pi * k / N), math.sin(2 * math.pi * k / N)
        scene:particle { position = { R * c, R * s, 0 }, velocity = { -R * rate(N) * s, R * rate(N) * c, 0 }, mass = m }
      end
      scene:force("nbody", { G = 1 })
      local state = scene:run():state()
      local x = state:position(2)
      local angle = math.atan(x[2], x[1])
      found[i] = angle + 2 * math.pi * math.floor((rate(N) * t_end - angle) / (2 * math.pi) + 0.5)
    end
    return found
  end,
}
