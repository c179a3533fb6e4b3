-- Births and deaths in front of a constraint's or a corrector's particles: the indices of all that it is told of move, and it
-- must answer as one that was made for the particles that are left.
local actors = require("actors")
local members = require("members")
local actor = require("common.check.actor")

local population = {}

local DEAD <const> = 5 -- particles in front, after which masses repeat themselves
local ROUNDING <const> = 1e-9 -- of numbers of size 1, summed in another order
local BORN <const> = { 7, 7, -0.5 }

local is_list = { particles = true, edges = true, triangles = true, tetrahedra = true }

-- The values with all indices raised; nil: some list is the user's own, and there is none to compare with.
local function moved(plugin, values)
  local list = {}
  for name, value in pairs(values) do list[name] = value end
  for _, p in ipairs(plugin.params) do
    if is_list[p.type] and plugin.given[p.name] then return nil end
    if is_list[p.type] and list[p.name] then
      local raised = {}
      for k, item in ipairs(list[p.name]) do
        if type(item) == "number" then raised[k] = item + DEAD
        else
          raised[k] = {}
          for m, i in ipairs(item) do raised[k][m] = i + DEAD end
        end
      end
      list[p.name] = raised
    end
  end
  return list
end

local function positions_of(in_front)
  local list, masses = {}, {}
  for k = 1, in_front and DEAD or 0 do list[k] = { -9 - k, 20 + k, 30 } end
  for _, x in ipairs(actor.POSITIONS) do list[#list + 1] = x end
  if not in_front then
    for k = 1, #list do masses[k] = 0.7 + 0.1 * (k % 5) end
    list[#list + 1], masses[#list + 1] = BORN, 1
  end
  return list, masses
end

-- An actor among those that are left, and its run and scene, which have to live as long.
local function opened(plugin, values, in_front)
  local positions, masses = positions_of(in_front)
  local scene = actor.scene(plugin, values, { positions = positions, masses = not in_front and masses or nil, gravity = true })
  local run = scene:run { to = 0 }
  if in_front then
    local dead = {}
    for k = 1, DEAD do dead[k] = k - 1 end
    members.change(run, dead, { BORN })
  end
  return actors.open(run, plugin.kind), run, scene
end

local function differ(p, q)
  if #p ~= #q then return ("%d numbers, and %d of one that was made for them"):format(#p, #q) end
  for k = 1, #p do
    local same = p[k] == q[k] or (p[k] ~= p[k] and q[k] ~= q[k])
    if not same and not (math.abs(p[k] - q[k]) <= ROUNDING * math.max(1, math.abs(q[k]))) then -- luacheck: ignore 581
      return ("number %d is %.9g, and %.9g of one that was made for them"):format(k, p[k], q[k])
    end
  end
end

-- answers(actor, start) -> a list of numbers, at the state that the actor has.
function population.follows(plugin, lines, answers)
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s, where %d particles in front die and one is born", setting.name, DEAD)
    local values = moved(plugin, setting.values)
    if not values then return lines:note("births and deaths: lists are given, and cannot be compared") end
    local fine = pcall(opened, plugin, setting.values, false) and pcall(function()
      actor.scene(plugin, values, { positions = positions_of(true), gravity = true }):run { to = 0 }
    end)
    if fine then
      local a, run, scene = opened(plugin, values, true)
      local b, other_run, other_scene = opened(plugin, setting.values, false)
      local start = actors.state(b)
      for seed = 1, 3 do
        local random = actor.random(seed)
        local x, v = actor.moved(start.x, random, 0.2), actor.moved(start.v, random, 1)
        for _, one in ipairs { a, b } do actors.set(one, { t = 0.37, x = x, v = v }) end
        local text = differ(answers(a, start), answers(b, start))
        if text then
          return lines:wrong("after births and deaths it answers otherwise: " .. text,
            "rebuild in `topology` what is derived from indices and the number of particles")
        end
      end
      assert(run and scene and other_run and other_scene)
    end
  end
end

return population
