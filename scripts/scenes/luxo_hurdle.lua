-- luxo_hurdle.lua: a desk lamp jumps over a hurdle of 0.12 m: it crouches, leaves the floor at 0.8 s, draws up its base, stretches to
-- land at 1.2 s 0.5 m further, gives way and stands again (Witkin and Kass, Spacetime constraints, 1988). The hurdle is a range of the
-- path: both feet are above it at each knot from 0.9 to 1.1 s, in which they pass it. Of its arm nothing is asked: as it gives way this
-- dips between the hurdle's posts, lower than they are high. hooke optimise luxo_hurdle.lua --way transcription ends with the least
-- squares of the muscles' forces; it begins near it, with what was found so by way of shorter jumps over lower hurdles, rounded to 0.01 N.
local start = {
  back = { -5.33, -0.25, 4.63, 7.77, 8.9, 9.76, 11.58, 13.72, 14.21, 10.23, 1.21, -7, -10.23, -9.34, -6.91, -7.33, -18.96, -24.5, -18.56,
    -4.95, 13.3, 32.93, 11.95, -42.19, 21.24, -9.28, -7.18, 0.34, 5.97, 15.1, -7.93, -28.16, 64.96, -53.61, 107.95, 27.6, 138.32, -95.6,
    2.05, -11.07, -8.03, -4.32, 0.5, 5.5, 11.8, 18.87, 23.59, 25.43, 25.58, 24.21, 21.86, 15.4, 4.47, -6.37, -17.4, -27.57, -25.4, -48.02,
    -24.33, -11.65, -1.77 },
  front = { 3.74, 0.83, -2.18, -5.01, -7.53, -9.2, -10.02, -10.11, -8.63, -5.64, -2.06, 2.07, 5.16, 6.79, 7.58, 12.12, 13.94, 12.94,
    13.83, 3.8, -6.5, 5.61, -21.74, -17.51, 2.92, -0.05, 10.12, 7.71, -6.62, -9.91, 2.81, 25.57, -26.97, 4.01, 88.08, -91.3, 14.28,
    -13.48, -7.9, -5.98, -3.99, -1.36, 0.2, 1.69, 1.79, -1.93, -9.24, -16.24, -21.68, -25.1, -24.05, -16.71, -3.52, 6.84, 19.77, 24.84,
    26.86, 30.25, 23.54, 23.48, 0.88 },
  leg = { 0.85, 2.86, 3.49, -0.09, -6.53, -10.44, -8.17, -1.15, 5.32, 4, -5.32, -11.86, -6.79, 6.53, 22.29, 23.05, -1.36, -24.56, -14.67,
    2.21, 43.99, 48.21, -21.56, -77.68, -18.8, 12.54, 21.86, 20.24, -6.25, -10.15, 9.58, 32.44, 49.98, -6.1, -68.45, -41.92, 89.56,
    -22.97, -8.47, -5.87, -4.09, 0.03, 5.44, 11.86, 12.59, 6.68, -2.14, -9.03, -14.08, -16.61, -13.56, -5.65, 1.89, 6.56, 12.09, 12.58,
    20.56, 7.15, 19.34, 3.72, 0.58 },
  neck = { -0.86, 2.02, 3.6, 2.06, -1.81, -4.56, -2.56, 3.32, 7.31, 5.04, -2.68, -10.26, -8.62, 3.35, 14.08, 11.28, -3.43, -23.74, -25.27,
    10.42, 34.36, 23.4, 14.17, -89.4, 18.58, 5.03, 5.9, 8.48, 3.18, 0.45, 5.37, 10.37, 49.86, -22.32, -59.59, 133.8, -104.78, 65.29, -8.8,
    1.94, -3.22, 1.21, 4.34, 6.21, 6.9, 7.18, 4.4, -0.42, -3.41, -3.32, -1.39, 1.55, 2.61, 3.34, 0.35, 6.25, -4.56, 11.9, -15.87, -4.82,
    -1.23 },
}
local knots, leaves, lands = 61, 0.8, 1.2 -- s
local far = param("far", 0.5, "m, how far it jumps", { min = 0.2 })
local height = 0.35 * far - 0.055 -- m, of the hurdle
local rest = param("rest", false, "muscles that do nothing, to begin with")
local scene = hooke.scene { duration = 2, fps = 30, integrator = "rk4", dt = 1 / 480 }
local lamp = require("lamp").new(scene, {})
for k, foot in ipairs { lamp.heel, lamp.toe } do
  local x, name = 0.24 * k - 0.36, k == 1 and "heel_height" or "toe_height"
  scene:force("central", { only = { foot }, per = "particle", strength = lamp.hold(leaves, lands), center = function(t)
    return t > (leaves + lands) / 2 and x + far or x, 0, 0
  end })
  scene:measure(name, function(s) return s:position(foot)[3] end, { unit = "m" })
  for knot = 28, 34 do scene:goal { measure = name, min = height, at = (knot - 1) / 30 } end
  scene:goal { particle = foot, position = { x + far, 0, 0 }, velocity = { 0, 0, 0 }, at = lands }
end
lamp:muscles(scene, knots, not rest and start or nil)
scene:goal { particle = lamp.knee, position = { far - 0.2, 0, 0.4 }, velocity = { 0, 0, 0 } }
scene:goal { particle = lamp.elbow, position = { far + 0.1, 0, 0.65 }, velocity = { 0, 0, 0 } }
scene:goal { particle = lamp.head, position = { far + 0.25, 0, 0.55 }, velocity = { 0, 0, 0 } }
local posts = {}
for _, y in ipairs { -0.15, 0.15 } do
  for _, number in ipairs { far / 2, y, height / 2 - 0.02, 0.03, 0.03, height + 0.03 } do posts[#posts + 1] = number end
end
scene:output("frames", { color = "group", legend = false, tubes = "base 0.022, arm 0.013, head 0.013", radius = 0.035, springs = "on",
  boxes = posts, from = { 0.7, -2.6, 0.8 }, look_at = { 0.3, 0, 0.42 }, fov = 28, ground_height = -0.035 })
return scene
