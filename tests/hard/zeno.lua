--[[
what: bounces follow each other ever faster and end at a known time, after infinitely many; the block then slides, stops, and
  lies still
right: closed form in pieces: parabolas; then mu g t^2/2; then rest
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2,
  tr_bdf2, esdirk4, imex
also: symplectic_euler; backward_euler; xpbd
]]
-- The bound: in the step in which the bounces end, friction acts as if the weight lay on the floor for the whole of it: up
-- to mu times the speed of the last bounce, g h/2, off, 5e-3 m/s times h.
local g, H, e, mu, u = 9.81, 0.5, 0.5, 0.2, 3
local scene = hooke.scene { duration = 2.5, fps = 250, tol = 1e-8, accuracy = 1e-4 }

scene:particle { position = { 0, 0, H }, velocity = { u, 0, 0 }, mass = 1 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("obstacle", { restitution = e, friction = mu })

scene:exact(function(t)
  local v, along = math.sqrt(2 * g * H), u
  local fall, over = v / g, v / g * (1 + e) / (1 - e)
  if t < fall then return u * t, 0, H - g * t * t / 2 end
  local x = u * fall
  for _ = 1, 60 do -- bounces, down to 2^-60 of the first
    along = math.max(0, along - mu * (1 + e) * v)
    v, fall = e * v, fall + 2 * e * v / g
    if t < fall then
      local s = t - (fall - 2 * v / g)
      return x + along * s, 0, v * s - g * s * s / 2
    end
    x = x + along * 2 * v / g
  end
  local s = math.min(math.max(t - over, 0), along / (mu * g))
  return x + along * s - mu * g * s * s / 2, 0, 0
end)
return scene
