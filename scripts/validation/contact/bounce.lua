-- A particle and a sheet fall flat onto a floor and bounce: heights by the closed form of the impacts so far, whose times
-- are found inside the steps. Two sheets of different masses meet head on in free flight: all of their
-- corners part with e times the speed, and the momentum stays.
local validation = require("validation")
local sheets = require("_sheets")

local g, H, e, thickness = 9.81, 0.3, 0.8, 1e-3
local up = { 0, 0, 1 }
local impulses = { restitution = e, thickness = thickness, radius = thickness / 2 }

-- Above the place where it rests, of what falls from H: a parabola after each impact, e of the speed before it.
local function height(t)
  local fall, v = math.sqrt(2 * H / g), math.sqrt(2 * g * H)
  if t < fall then return H - g * t * t / 2 end
  t, v = t - fall, e * v
  while t >= 2 * v / g do t, v = t - 2 * v / g, e * v end
  return v * t - g * t * t / 2
end

local function fallen(h, times, add)
  local scene, found = hooke.scene { duration = times[#times], fps = 4, dt = h, integrator = "leapfrog" }, {}
  scene:body { shape = "box", size = { 4, 4, 0.1 }, position = { 0, 0, -0.05 } }
  local ids = add(scene)
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:corrector("contact", impulses)
  for k, t in ipairs(times) do found[k] = sheets.mean(scene:run { to = t }:state(), ids, up) - thickness / 2 end
  return found
end

-- Speed of separation over that before, the spread of the speeds of the upper sheet, and the momentum over m v. The
-- upper one gets its speed in the first tenth of a second.
local function head_on(h)
  local scene, speed = hooke.scene { duration = 0.3, fps = 10, dt = h, integrator = "leapfrog" }, 2
  local below = sheets.add(scene, { nx = 5, size = 0.2, density = 0.3, origin = { 0, 0, 0 } })
  local above = sheets.add(scene, { nx = 5, size = 0.2, density = 0.2, origin = { 0, 0, 0.15 } })
  sheets.push(scene, above, { 0, 0, -speed / 0.1 }, 0.1)
  scene:corrector("contact", impulses)
  local s, least, most, momentum = scene:run():state(), math.huge, -math.huge, 0
  local _, v = sheets.mean(s, above, up)
  local _, w = sheets.mean(s, below, up)
  for _, id in ipairs(above) do
    least, most = math.min(least, s:velocity(id)[3]), math.max(most, s:velocity(id)[3])
  end
  for id = 1, s.n do momentum = momentum + s:mass(id) * s:velocity(id)[3] end
  return (v - w) / speed, (most - least) / speed, momentum / (0.2 * 0.04 * speed) + 1
end

local newton = "closed form, Newton's law of impact"
return validation.problem {
  title = "Particles and sheets that bounce",
  quantities = {
    { name = "height of a particle after 0.5 s", unit = "m", reference = height(0.5), source = newton .. ", one impact" },
    { name = "height of a particle after 1.75 s", unit = "m", reference = height(1.75), source = newton },
    { name = "height of a sheet after 0.5 s", unit = "m", reference = height(0.5), source = newton .. ", one impact" },
    { name = "height of a sheet after 1.75 s", unit = "m", reference = height(1.75), source = newton },
    { name = "restitution of two sheets", reference = e, source = newton },
    { name = "spread of speeds of the upper one", reference = 0, scale = 1, source = "closed form: it stays flat" },
    { name = "their momentum", reference = 0, scale = 1, source = "conserved" },
  },
  time = { 1 / 200, 1 / 400, 1 / 800 },
  noise = 1e-11,
  tolerance = 1e-11,
  why = "parabolas are exact in every step, and impacts are found to rounding",
  quick = { time = { 1 / 200, 1 / 300, 1 / 400 } },
  solve = function(at)
    local point = fallen(at.h, { 0.5, 1.75 }, function(scene)
      return { scene:particle { position = { 0.3, 0.2, H + thickness / 2 }, mass = 2 } }
    end)
    local flat = fallen(at.h, { 0.5, 1.75 }, function(scene)
      return sheets.add(scene, { nx = 5, size = 0.2, density = 0.2, origin = { 0.1, 0.15, H + thickness / 2 } })
    end)
    return { point[1], point[2], flat[1], flat[2], head_on(at.h) }
  end,
}
