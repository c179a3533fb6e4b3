-- The tests of a service (hooke check): its interface has a name and a version, its table is there and stays where it is,
-- a plugin that asks for it gets it; what neighbours/1, octree/1 and bvh/1 answer is what a plain search finds, and what
-- grip/1 and obstacles/1 answer is what they were told.
local actors = require("actors")
local inspect = require("inspect")
local keeping = require("keeping")
local members = require("members")
local sharing = require("sharing")
local actor = require("common.check.actor")
local whole_runs = require("common.check.whole_runs")

local function has_a_version(plugin, lines, interface)
  local name, version = interface:match("^([%a_][%w_]*)/(%d+)$")
  if not name then
    return lines:wrong(("its interface '%s' is not like \"neighbours/1\""):format(interface), "name and version")
  end
  if name ~= plugin.name then
    lines:wrong(("its interface is %s and its name %s: `query` finds a service by its file"):format(interface, plugin.name),
      "give both the same name")
  end
  if tonumber(version) < 1 then lines:wrong("its version is below 1") end
end

local function serve(plugin, lines)
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s", setting.name)
    local run = actor.scene(plugin, setting.values, { dt = 0.01 }):run { to = 0 }
    local interface = plugin.interface
    local fine, said = actors.serve(run, interface)
    if not fine then
      return lines:wrong("a plugin that asks for it gets nothing: " .. said,
        "`table` returns the address of the functions, after `create`")
    end
    local a = actors.open(run, "service")
    local one, two = actors.table(a), actors.table(a)
    if not one or one ~= two then
      lines:wrong("its table is not there, or elsewhere when it is asked again", "keep it in the instance")
    end
  end
end

-- ---- answers ----

local NOT_FINITE = 5 -- hk_status
local MANY, SHAPES = 1000, 2 -- of more than so many particles these places alone are tried, which take long

-- A run of so many particles, with the service as others ask for it.
local function crowded(plugin, n, threads)
  local positions = {}
  for i = 1, n do positions[i] = { 0.37 * i % 5, 0.61 * i % 5, 0.83 * i % 5 } end
  local values = actor.settings(plugin)[1].values
  local scene = actor.scene(plugin, values, { positions = positions, threads = threads, gravity = true })
  local run = scene:run { to = 0 }
  local fine, said = actors.serve(run, plugin.interface)
  if not fine then error("a plugin that asks for it gets nothing: " .. said, 0) end
  return run, scene
end

-- What is asked of each interface: ask(actor, shape, seed) -> what is wrong, after what.
local questions = {
  ["neighbours/1"] = function(a, shape, seed, n)
    return sharing.neighbours(a, shape, seed, n > 4000 and 0.05 or shape == "a lattice" and 0.11 or 0.14)
  end,
  ["octree/1"] = sharing.octree,
  ["bvh/1"] = sharing.bvh,
}

-- Whether all places were answered rightly in that run; says so otherwise.
local function answers_in(plugin, lines, run, n, what)
  local ask = questions[plugin.interface]
  local a = sharing.open(run, "service")
  for k, shape in ipairs(sharing.shapes()) do
    if n > MANY and k > SHAPES then break end
    lines:at("%d particles in %s, %s", n, shape, what)
    local wrong, after = ask(a, shape, 3 + k, n)
    if wrong then
      lines:wrong(wrong, "compare with a search over all; forget in `topology` what was found before", ("%s, %s"):format(
        lines.place, after))
      return false
    end
  end
  return true
end

-- Several numbers of particles, the most of which take several chunks of a parallel_for; the fewest are none.
local function answers_rightly(plugin, lines)
  for _, threads in ipairs { 1, 2, 3 } do
    for _, n in ipairs(threads == 1 and { 1, 2, 9, 700, 4200 } or threads == 2 and { 700 } or { 700, 4200 }) do
      local run, scene = crowded(plugin, n, threads)
      if not answers_in(plugin, lines, run, n, ("%d threads"):format(threads)) then return end
      assert(scene)
    end
  end
end

local function follows_births_and_deaths(plugin, lines)
  local run, scene = crowded(plugin, 300, 2)
  if not answers_in(plugin, lines, run, 300, "before births and deaths") then return end
  local function change(from, to, births)
    local dead, born = {}, {}
    for k = from, to do dead[#dead + 1] = k end
    for k = 1, births do born[k] = { 0.1 * k, 0.2, 0.3 } end
    members.change(run, dead, born)
    local n = run:state().n
    return answers_in(plugin, lines, run, n, ("after %d deaths and %d births"):format(#dead, births))
  end
  local fine = change(10, 39, 0) and change(0, -1, 400) and change(5, 6, 2) and change(0, 669, 0)
  if fine then change(0, -1, 30) end
  assert(scene)
end

-- Places that are no numbers are an error with a message, not a crash or rows of nonsense.
local function names_the_lost(plugin, lines)
  local run, scene = crowded(plugin, 50, 1)
  lines:at("a particle at a place that is no number")
  local status, said = sharing.lost(sharing.open(run, "service"))
  if status ~= NOT_FINITE then
    lines:wrong(("with a place that is no number its status is %d, not HK_NOT_FINITE"):format(status),
      "look at the places before they are searched")
  elseif said == "" then lines:wrong("with a place that is no number it fails and does not say why", "name the particle") end
  assert(scene)
end

-- Services that keep what they are told.
local kept = { ["grip/1"] = keeping.grip, ["obstacles/1"] = keeping.obstacles }

local function keeps_what_it_is_told(plugin, lines)
  local run, scene = crowded(plugin, 9, 1)
  lines:at("9 particles")
  local wrong, after = kept[plugin.interface](keeping.open(run, "service", "behind", true))
  if wrong then lines:wrong(wrong, "see the header of its interface", after) end
  assert(scene)
end

return function(plugin, report)
  local try = actor.watched(plugin, report)
  plugin.interface = actors.interface(plugin.path)
  try("its interface has its name, and a version", function(l) has_a_version(plugin, l, plugin.interface) end)
  try("its table is there for those who ask", function(l) serve(plugin, l) end)
  if questions[plugin.interface] then
    local function known(name, body)
      try(name, function(l)
        sharing.watch(l.fd)
        inspect.quiet()
        body(plugin, l)
      end)
    end
    known("its answers are those of a plain search", answers_rightly)
    known("its answers after births and deaths", follows_births_and_deaths)
    if plugin.interface ~= "bvh/1" then known("places that are no numbers", names_the_lost) end
  elseif kept[plugin.interface] then
    try("its answers are what it was told", function(l)
      keeping.watch(l.fd)
      keeps_what_it_is_told(plugin, l)
    end)
  else report:note(("what %s answers is not compared: hooke knows no plain search for it"):format(plugin.interface)) end
  whole_runs.habits(plugin, try)
end
