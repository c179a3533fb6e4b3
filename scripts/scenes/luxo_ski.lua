-- luxo_ski.lua: a desk lamp on skis slides down a slope of 20 degrees, crouches, springs off its end at 0.8 s, turns in the air,
-- lands at 1.2 s on a slope of 40 degrees below, gives way and slides on as it stood (Witkin and Kass, Spacetime constraints, 1988).
-- Slopes hold its feet at given times and have no friction; where it lands is given, how fast it slides there is not. From muscles that
-- do nothing the least squares of their forces are found by
--   hooke optimise luxo_ski.lua rest=true --way transcription
local start = {
  back = { -1.1, -1.5, -1.5, -1.1, -0.4, 0.1, 0.1, 0.1, 0.8, 2, 2.6, 1.7, -0.2, -1.4, -0.9, 0.6, 0.8, -2.2, -5.5, -4.7, 0.4, 8.5, 2.8,
    3.7, -9.9, 1.2, -2.2, 0.5, 2.3, 3.2, -3.4, -7.6, 5.2, 4.8, -0.4, -13.3, 46.8, -8.3, 6, 1.5, 1, -1.9, -3.9, -4.2, -4.4, -4.6, -4.8,
    -4, -1.4, 3.5, 6.9, 8.4, 4.7, -1.1, -0.4 },
  front = { 0.8, 1, 1.1, 0.9, 0.6, 0.2, -0.1, -0.5, -1, -1.5, -1.6, -1.2, -0.4, 0.3, 0.5, 0.4, 0.8, 1.7, 2.5, 2.3, -0.8, -0.4, -5.7, 8.3,
    -6.6, 2.9, 1.4, 0.1, -3.1, -3, 2, 8.4, -1.3, -9.7, 4.4, -12.3, 5.5, -6.1, -2, -2.2, -0.5, 1.3, 2.7, 3.9, 4.3, 4.3, 3.9, 2.6, 0.4,
    -1.9, -4.6, -4.9, -5.2, -3.6, -6.1 },
  leg = { 0.4, 0.2, 0.2, 0.7, 1.1, 0.7, -0.5, -1.6, -1.3, 0.2, 1.1, -0.1, -2.3, -2.8, 0.1, 4.1, 5.1, 0.1, -5.5, -6, 4.6, 10, 12.2, -20.3,
    -1.6, 5.5, 7.5, -1.6, -12.6, -7.7, 9.5, 23.3, 5.3, -34.2, -20.6, -1, 34.4, -12.1, 0.5, -0.9, 0.3, -0.8, -0.1, 2.7, 4.7, 3.9, 1.3,
    -1.3, -1.7, 0.6, 1.4, 0.5, -10.2, -2.7, -1.4 },
  neck = { 0, -0.3, -0.3, 0.2, 0.6, 0.5, -0.3, -1, -0.6, 0.8, 1.5, 0.4, -1.7, -2.4, -0.2, 3.2, 3.5, -0.1, -5.9, -5.1, 2.4, 10.7, 8.7,
    -19, 2.9, 3.5, 6, -1, -9.7, -5.7, 8.1, 15.3, 6.5, -21.6, -43.6, 45, 3.9, -1.4, -0.2, 1, 0.1, -1.3, -1.1, 0.5, 2.1, 1.4, -0.5, -2,
    -1.3, 0.8, 4.1, 0.4, -2.6, -1, 1.1 },
}
local knots, leaves, lands = 55, 0.8, 1.2 -- s
local rest = param("rest", false, "muscles that do nothing, to begin with")
local far = param("far", 1.35, "m, along the lower slope from below the end of the upper one, where it lands")
local scene = hooke.scene { duration = 1.8, fps = 30, integrator = "rk4", dt = 1 / 240 }
local function slope(angle, x, z) -- that goes down from (x, z)
  return { angle = angle, x = x, z = z, along = { math.cos(angle), 0, -math.sin(angle) }, up = { math.sin(angle), 0, math.cos(angle) } }
end
local upper = slope(math.rad(20), 0, 0)
local run = 9.81 / 2 * math.sin(upper.angle) * leaves ^ 2 -- m
local lower = slope(math.rad(40), run * upper.along[1], run * upper.along[3] - 0.06)
local lamp = require("lamp").new(scene, upper)
local hold = lamp.hold(leaves, lands)
local feet = { lamp.heel, lamp.toe }
for _, part in ipairs { { upper, 1 }, { lower, -1 } } do
  local at, side = table.unpack(part)
  scene:force("central", { only = feet, per = "particle", center = { at.x, 0, at.z }, axis = at.along,
    strength = function(t) return (t - 1) * side < 0 and hold(t) or 0 end })
end
-- Where a particle is on the lower slope, from `of` on, and how fast.
local function goal(name, get, direction, particle, of, value, at)
  local d, o = lower[direction], { lower.x, 0, lower.z }
  scene:measure(name, function(s)
    local x, from = s[get](s, particle), of and s[get](s, of) or get == "position" and o or { 0, 0, 0 }
    return (x[1] - from[1]) * d[1] + (x[3] - from[3]) * d[3]
  end, { unit = "m" })
  scene:goal { measure = name, value = value, at = at }
end
for k, foot in ipairs(feet) do
  local name = k == 1 and "heel" or "toe"
  goal(name .. "_above", "position", "up", foot, nil, 0, lands)
  goal(name .. "_along", "position", "along", foot, nil, far + 0.24 * k - 0.36, lands)
  goal(name .. "_falls", "velocity", "up", foot, nil, 0, lands)
end
for _, joint in ipairs { { "knee", -0.2, 0.4 }, { "elbow", 0.1, 0.65 }, { "head", 0.25, 0.55 } } do
  local name, ahead, above = table.unpack(joint)
  goal(name .. "_ahead", "position", "along", lamp[name], lamp.ankle, ahead)
  goal(name .. "_above", "position", "up", lamp[name], nil, above)
  goal(name .. "_speed", "velocity", "along", lamp[name], lamp.ankle, 0)
  goal(name .. "_falls", "velocity", "up", lamp[name], nil, 0)
end
lamp:muscles(scene, knots, not rest and start or nil)
local ground = {} -- columns under both slopes
for _, part in ipairs { { upper, -0.3, run + 0.14 }, { lower, 0.15, 6.6 } } do
  local at, first, last = table.unpack(part)
  for s = first, last, 0.05 do
    for _, number in ipairs { at.x + s * at.along[1], 0, at.z + s * at.along[3] - 0.545, 0.05, 0.6, 1 } do
      ground[#ground + 1] = number
    end
  end
end
scene:output("frames", { color = "group", legend = false, tubes = "base 0.022, arm 0.013, head 0.013", radius = 0.035, springs = "on",
  boxes = ground, follow = true, ground = false, from = { 2, -7, 0 }, look_at = { 2, 0, -1.4 }, fov = 20 })
return scene
