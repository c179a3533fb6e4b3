-- Births and deaths: a force whose particles were born and died, and its tuples with them, must say what a force says
-- that was made for the particles that are left.
local inspect = require("inspect")
local members = require("members")
local answers = require("common.check.force.answers")
local cases = require("common.check.force.cases")

local population = {}

local ROUNDING = 1e-11 -- of sums over all elements of a scene, in another order

local DEAD = { [2] = true, [5] = true } -- one inside, and one further on, so that indices move by one and by two

-- The positions of the newborn.
local function born_beside(shape)
  local l = shape.length
  return { { 0.31 * l, 1.7 * l, 0.4 * l } }
end

local function without_the_dead(shape)
  local map, next_index = {}, 0
  local left = { name = shape.name .. " after births and deaths", length = shape.length, positions = {}, masses = {},
    particles = {} }
  for i = 1, #shape.positions do
    if not DEAD[i] then
      next_index = next_index + 1
      map[i] = next_index
      left.positions[next_index] = shape.positions[i]
      left.masses[next_index] = 0.7 + 0.1 * (i % 5)
      if i % 2 == 1 then left.particles[#left.particles + 1] = next_index end
    end
  end
  for _, list in ipairs { "edges", "triangles", "tetrahedra" } do
    left[list] = {}
    for _, tuple in ipairs(shape[list]) do
      local mapped = {}
      for m, i in ipairs(tuple) do mapped[m] = map[i] end
      if #mapped == #tuple then left[list][#left[list] + 1] = mapped end
    end
  end
  for _, x in ipairs(born_beside(shape)) do
    left.positions[#left.positions + 1] = x
    left.masses[#left.masses + 1] = 1
  end
  return left
end

local function indices()
  local list = {}
  for i in pairs(DEAD) do list[#list + 1] = i - 1 end
  table.sort(list)
  return list
end

local function all_of(run, plugin, case, start)
  local subject = inspect.open(run, plugin.name)
  case = { name = case.name, length = case.length, start = start, limits = case.limits }
  cases.random_state(subject, case, 1)
  return answers.all(subject)
end

local function follows(plugin, lines)
  local told
  local tried = cases.each(plugin, lines, function(case) return case.few and case.base and not case.shape.grid end,
    function(subject, case, run)
      if told then return end
      cases.random_state(subject, case, 1)
      answers.all(subject) -- what it keeps of the state is now that of the old particles
      lines:at("%s, where particles 2 and 5 die and one is born", case.name)
      members.change(run, indices(), born_beside(case.shape))
      local reference = cases.open(plugin, cases.variant(case, without_the_dead(case.shape)))
      if not reference then return end
      local now = inspect.open(run, plugin.name)
      local start = inspect.state(now)
      local text = answers.difference(all_of(reference, plugin, case, start), all_of(run, plugin, case, start), ROUNDING)
      if text then
        told = true
        lines:wrong("after births and deaths it differs from a force made for those who are left: " .. text,
          "rebuild in `topology` what is derived from indices, numbers of particles and lists")
      end
    end)
  if tried == 0 then lines:note("births and deaths: it takes none of the scenes in which they are compared") end
end

local function survives_the_last(plugin, lines)
  cases.each(plugin, lines, function(case) return case.few and case.base end, function(subject, case, run)
    local all = {}
    for i = 1, inspect.state(subject).n do all[i] = i - 1 end
    lines:at("%s, where all particles die", case.name)
    members.change(run, all, {})
    answers.all(inspect.open(run, plugin.name))
  end)
end

function population.try(plugin, report)
  report:try("births and deaths", function(lines) follows(plugin, lines) end)
  report:try("no particles are left", function(lines) survives_the_last(plugin, lines) end)
end

return population
