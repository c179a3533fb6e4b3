-- luxo.lua: a desk lamp of three links on a base jumps 0.3 m to the side by its four muscles: it crouches first, leaves the floor at
-- 0.8 s, lands at 1.1 s and comes to rest as it stood. The base is held to the floor at given times (Witkin and Kass, Spacetime
-- constraints, 1988). hooke optimise luxo.lua --way transcription ends with the least squares of the muscles' forces; it begins near
-- it, with what IPOPT found on the same steps, rounded to 0.1 N. From a lamp that stands still, by way of a jump on the spot:
--   hooke optimise luxo.lua rest=true --way transcription --guess still --through far=0,0.02,0.1,0.2,0.3
local start = {
  back = { -3.5, 0.6, 4.4, 6.9, 7.7, 8, 9, 10.3, 10.5, 7.4, 0.4, -6.4, -9.3, -8.4, -6.1, -5.7, -13.5, -18.4, -15.5, -1.5, 8.3, 26.1,
    24.6, -44.5, 26.3, -6.8, -0.4, -9.2, 4.5, 40.7, -70.6, 104.5, -9.2, 122.5, -37.1, 5.7, -2.5, 5.2, 8.9, 13.3, 16.3, 17.9, 18.9, 19,
    17.4, 14.5, 9.6, 2.4, -6.1, -14.1, -21, -26, -28.3, -26.5, -19.7, -10.8, -4, 11.5, 8.7, 5.1, 0 },
  front = { 2.4, 0, -2.3, -4.5, -6.3, -7.4, -7.9, -7.8, -6.5, -4, -1, 2.3, 4.9, 6.2, 6.7, 9.7, 10.5, 9.8, 9.4, 2.7, -6.3, 0.8, -7, -25.5,
    10.1, -2.7, 3.6, 12.7, -4.4, -18.6, 8.5, 117.4, -142.4, 17, 5.2, -0.6, 0.6, 0.3, -0.1, -1, -2.2, -6, -11.7, -16, -17.5, -16, -11.2,
    -2.5, 7.8, 15.7, 20.9, 23.1, 22.2, 20.1, 14, 9.4, 3.2, -5.6, -6.8, -21.1, -11.4 },
  leg = { 0.2, 1.7, 2.3, -0.1, -4.9, -8.2, -6.8, -1.3, 4.1, 3.8, -3.2, -9, -5.9, 4.8, 17.6, 19.2, 0.8, -18.6, -15.6, 2.2, 30.1, 40,
    -19.1, -47.9, -16.8, 8.3, 12.3, 16.4, 2.1, -6.7, -4.7, 30.3, -35.1, 119, -49, 13.1, -5.1, 1.1, 1, 3.8, 4.3, 0, -6.4, -10.5, -11.3,
    -10.7, -7.1, 0.3, 8, 11.8, 11.3, 8.3, 5.4, 4.9, 6, 9, 2.4, 3.1, -18.4, -6.7, -2.7 },
  neck = { -0.8, 1.4, 2.8, 1.8, -1.1, -3.5, -2.3, 2.1, 5.6, 4.3, -1.7, -8, -7.4, 1.8, 11, 9.7, -1.4, -18.3, -19.1, 2.2, 30.8, 16.7, 10.7,
    -57.1, 1.6, 2.7, 5.3, 3.1, 7.5, 7.6, -3.5, -79.2, 209.7, -84.9, 18.9, -2.1, -1.7, -0.1, 3.5, 5.1, 4.9, 3.7, 0.8, -2.3, -3.7, -3.2,
    -1.7, 0.7, 3.2, 3.8, 1.6, -1.9, -3.9, -4, 0.2, 0.6, 7.1, -6.9, 5.7, 1.3, 2.6 },
}
local knots = param("knots", 61)
local leaves, lands = 0.8, 1.1 -- s
local far = param("far", 0.3, "m, how far it jumps")
local rest = param("rest", false, "muscles that do nothing, to begin with")
local scene = hooke.scene { duration = 2, fps = 30, integrator = "rk4", dt = 1 / 240 }
local lamp = require("lamp").new(scene, {})
for k, foot in ipairs { lamp.heel, lamp.toe } do
  local x = 0.24 * k - 0.36
  scene:force("central", { only = { foot }, per = "particle", strength = lamp.hold(leaves, lands), center = function(t)
    return t > (leaves + lands) / 2 and x + far or x, 0, 0
  end })
  scene:goal { particle = foot, position = { x + far, 0, 0 }, velocity = { 0, 0, 0 }, at = lands }
end
lamp:muscles(scene, knots, knots == 61 and not rest and start or nil)
scene:goal { particle = lamp.knee, position = { far - 0.2, 0, 0.4 }, velocity = { 0, 0, 0 } }
scene:goal { particle = lamp.elbow, position = { far + 0.1, 0, 0.65 }, velocity = { 0, 0, 0 } }
scene:goal { particle = lamp.head, position = { far + 0.25, 0, 0.55 }, velocity = { 0, 0, 0 } }
scene:output("frames", { color = "group", legend = false, tubes = "base 0.022, arm 0.013, head 0.013", radius = 0.035, springs = "on",
  from = { 0.6, -2.4, 0.75 }, look_at = { 0.2, 0, 0.36 }, fov = 24, ground_height = -0.035 })
return scene
