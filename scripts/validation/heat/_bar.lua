-- Bodies whose heat goes one way, as particles in a row that bars join: slabs, cylinders and spheres by the section at
-- each place, and fins.
local bar = {}

-- n cells from `from` to `to`, m (0 to 1); `section(x)` is that at a place, m^2 (1), and has the mass with the density 1
-- between the middles of cells; `law` is that of the force conduction; `enthalpy(k)` the start of particle k = 0 to n;
-- `held` lists such k. Returns the scene, ids by k, and the masses.
function bar.scene(o)
  local from, to, n = o.from or 0, o.to or 1, o.n
  local section, dx = o.section or function() return 1 end, (to - from) / n
  local scene = hooke.scene { duration = o.duration, fps = 1 / o.duration, integrator = "rk4" }
  scene:channel("enthalpy", { initial = 0 })
  scene:channel("given", { initial = 0 })
  local ids, masses, edges, sections = {}, {}, {}, {}
  for k = 0, n do
    local a, b = from + math.max(0, k - 0.5) * dx, from + math.min(n, k + 0.5) * dx
    masses[k] = (b - a) / 6 * (section(a) + 4 * section((a + b) / 2) + section(b))
    ids[k] = scene:particle { position = { from + k * dx, 0, 0 }, mass = masses[k], enthalpy = o.enthalpy(k) }
    if k > 0 then edges[k], sections[k] = { ids[k - 1], ids[k] }, section(from + (k - 0.5) * dx) end
  end
  local held = {}
  for i, k in ipairs(o.held or {}) do held[i] = ids[k] end
  local params = { edges = edges, section = sections, held = #held > 0 and held or nil, channel = "enthalpy", account = "given" }
  for name, value in pairs(o.law) do params[name] = value end
  scene:force("conduction", params)
  return scene, ids, masses
end

-- The sum of the masses by how much of them is molten, kg.
function bar.molten(state, ids, masses, latent)
  local sum = 0
  for k = 0, #ids do sum = sum + masses[k] * math.max(0, math.min(1, state:channel("enthalpy", ids[k]) / latent)) end
  return sum
end

-- J: the enthalpy that nothing from outside gave.
function bar.kept(state, ids, masses)
  local sum = 0
  for k = 0, #ids do
    sum = sum + masses[k] * (state:channel("enthalpy", ids[k]) - state:channel("given", ids[k]))
  end
  return sum
end

-- By its series, for the small arguments that fronts have.
function bar.erf(x)
  local sum, term = 0, x
  for k = 0, 80 do
    sum, term = sum + term / (2 * k + 1), -term * x * x / (k + 1)
  end
  return 2 / math.sqrt(math.pi) * sum
end

return bar
