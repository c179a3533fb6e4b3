-- Two masses on springs without rest length, which swing in two modes for ever: undamped, undamped_long.
return function(options)
  local scene = hooke.scene(options)
  scene:particles { positions = { { 0, 0, 0 }, { 0, 0, 0 }, { 1, 0, 0 } },
    velocities = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 1 } }, mass = 1 }
  scene:pin { 1 }
  scene:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = 1, rest = 0 })

  -- Modes (1, r) of [2, -1; -1, 1]: w = 0.618 and r = 1.618 (the golden ratio), w = 1.618 and r = -0.618.
  local slow, fast = (math.sqrt(5) - 1) / 2, (math.sqrt(5) + 1) / 2
  scene:exact(function(t)
    local a = 1 / math.sqrt(5) -- (0, 1) is a times their difference
    local x = { a * math.cos(slow * t), -a * math.cos(fast * t) }
    local z = { a * math.sin(slow * t) / slow, -a * math.sin(fast * t) / fast }
    return 0, 0, 0, x[1] + x[2], 0, z[1] + z[2], fast * x[1] - slow * x[2], 0, fast * z[1] - slow * z[2]
  end)
  return scene
end
