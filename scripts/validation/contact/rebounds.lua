-- A particle and round rigid bodies fall from H and bounce: impact n+1 is at t_n = sqrt(2 H/g) (1 + 2 (e + ... + e^n)),
-- between impacts n and n+1 they rise to e^2n H, and after sqrt(2 H/g) (1 + e)/(1 - e) all bounces are over. Times and heights
-- are those of the parabolas on which they are found between impacts. The ball turns as it falls, which changes nothing.
local validation = require("validation")

local g, H, e, r = 9.81, 0.5, 0.7, 0.1
local fall = math.sqrt(2 * H / g)
local total = fall * (1 + e) / (1 - e)

local function impact(n) return fall * (1 + 2 * (e - e ^ (n + 1)) / (1 - e)) end -- n = 0: the first one

local ball = { shape = "sphere", radius = r, mass = 2, position = { 0.3, 0.2, H + r }, spin = { 1, 2, 3 } }

local falls = {
  { name = "particle, obstacle", add = function(scene)
    scene:corrector("obstacle", { restitution = e, radius = r })
    local p = scene:particle { position = ball.position, mass = 2 }
    return function(s) return s:position(p)[3], s:velocity(p)[3] end
  end },
  { name = "rigid ball, obstacle", add = function(scene)
    scene:corrector("obstacle", { restitution = e, radius = r })
    local b = scene:rigid(ball)
    b:surface { { 0, 0, 0 } }
    return function(s) return b:position(s)[3], b:velocity(s)[3] end
  end },
  { name = "rigid ball, contact", add = function(scene)
    scene:body { shape = "box", size = { 4, 4, 0.1 }, position = { 0, 0, -0.05 } }
    local b = scene:rigid(ball)
    b:surface({ { 0, 0, 0 } }, { radius = r })
    scene:corrector("contact", { restitution = e })
    return function(s) return b:position(s)[3], b:velocity(s)[3] end
  end },
}

-- Height after the second impact, time of the fourth and of the eleventh, and the energy per weight after all of them.
local function bounced(what, h)
  local scene = hooke.scene { duration = 1.01 * total, fps = 1 / (1.01 * total), dt = h, integrator = "leapfrog" }
  local look = what.add(scene)
  scene:force("gravity", { g = { 0, 0, -g } })
  local function at(t)
    local z, v = look(scene:run { to = t }:state())
    return z - r, v
  end
  local function lands(t)
    local z, v = at(t)
    return t + (v + math.sqrt(v * v + 2 * g * z)) / g
  end
  local z, v = at((impact(1) + impact(2)) / 2)
  local height = z + v * v / (2 * g)
  local fourth, eleventh = lands((impact(2) + impact(3)) / 2), lands((impact(9) + impact(10)) / 2)
  z, v = at(1.01 * total)
  return height, fourth, eleventh, z + v * v / (2 * g)
end

local quantities = {}
for _, what in ipairs(falls) do
  for _, q in ipairs {
    { "height after two impacts", "m", e ^ 4 * H, "e^2n H" },
    { "fourth impact", "s", impact(3), "sqrt(2 H/g) (1 + 2 (e + e^2 + e^3))" },
    { "eleventh impact", "s", impact(10), "sqrt(2 H/g) (1 + 2 (e + ... + e^10))" },
    { "height after all impacts", "m", 0, "sqrt(2 H/g) (1 + e)/(1 - e)" },
  } do
    quantities[#quantities + 1] = { name = ("%s: %s"):format(what.name, q[1]), unit = q[2], reference = q[3],
      scale = q[3] == 0 and H or nil, source = "closed form, " .. q[4] }
  end
end

return validation.problem {
  title = "Heights and times of bounces",
  quantities = quantities,
  time = { 1 / 100, 1 / 200, 1 / 400 },
  tolerance = 1e-9,
  noise = 1e-9,
  why = "parabolas are exact in every step, and landings are found to rounding; several of them in one step are not looked at",
  quick = { time = { 1 / 100, 1 / 150, 1 / 200 } },
  solve = function(at)
    local found = {}
    for _, what in ipairs(falls) do
      for _, value in ipairs { bounced(what, at.h) } do found[#found + 1] = value end
    end
    return found
  end,
}
