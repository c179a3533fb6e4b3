-- Newton's cradle without strings: a ball hits four others that hang a tenth of a millimetre apart. Equal balls exchange
-- their speeds, one pair after the other; with e = 0.9 the last one goes with ((1 + e)/2)^4 of it.
local validation = require("validation")

local r, v, count = 0.05, 1, 5

local function last(h, e)
  local scene = hooke.scene { duration = 0.2, fps = 5, dt = h, integrator = "leapfrog" }
  local ball = {}
  for k = 1, count do
    ball[k] = scene:rigid { shape = "sphere", radius = r, mass = 1, position = { (2 * r + 1e-4) * k - (k == 1 and 0.05 or 0), 0, 0 },
      velocity = { k == 1 and v or 0, 0, 0 } }
    ball[k]:surface { { 0, 0, 0 } }
  end
  scene:corrector("contact", { radius = r, restitution = e, friction = 0.2 })
  local s = scene:run():state()
  return ball[count]:velocity(s)[1], ball[1]:velocity(s)[1]
end

return validation.problem {
  title = "Newton's cradle",
  quantities = {
    { name = "last of five, e = 1", unit = "m/s", reference = v, source = "equal balls exchange their speeds" },
    { name = "first, e = 1", unit = "m/s", reference = 0, scale = v, source = "equal balls exchange their speeds" },
    { name = "last of five, e = 0.9", unit = "m/s", reference = 0.95 ^ 4 * v, source = "((1 + e)/2)^4" },
  },
  time = { 4e-4, 2e-4, 1e-4 },
  tolerance = 1e-13,
  noise = 1e-13,
  why = "speeds between impacts are constant, and the law of impact is exact",
  quick = { time = { 4e-4, 2e-4, 1e-4 } },
  solve = function(at)
    local one, first = last(at.h, 1)
    return { one, first, (last(at.h, 0.9)) }
  end,
}
