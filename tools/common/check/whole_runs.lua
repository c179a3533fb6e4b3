-- The properties of constraints, correctors, sources, solvers, outputs and services that a whole run shows: the same bits
-- again and on any threads, from a checkpoint, in a crowd, and what steps take of files and memory.
local inspect = require("inspect")
local actors = require("actors")
local actor = require("common.check.actor")

local whole_runs = {}

local function ended(plugin, setting, options)
  local scene = actor.scene(plugin, setting.values, options)
  local run = scene:run()
  return run:packed(), run:summary()
end

local function runs_and_repeats(plugin, lines, options)
  local settings = actor.settings(plugin)
  for k, setting in ipairs(settings) do
    if k > 1 and options and options.quiet then return end -- an output: that it changes nothing is tried in each of them
    lines:at("%s", setting.name)
    if pcall(function() return actor.scene(plugin, setting.values, options):run { to = 0 } end) then
      local one = ended(plugin, setting, options)
      inspect.clock(1e5) -- s, that the plugin's clocks are ahead in the second run
      local again = ended(plugin, setting, options)
      inspect.clock(0)
      if one ~= again then
        lines:wrong("two runs differ", "keep nothing outside the instance, initialise what you read, ask no clock, and take"
          .. " random numbers from host->random")
      end
      local more = {}
      for key, value in pairs(options or {}) do more[key] = value end
      more.threads = 2
      if one ~= ended(plugin, setting, more) then
        lines:wrong("the bits differ with 2 threads", "cut loops by count and grain, sum chunks in their order")
      end
    end
  end
end

local function goes_on_from_a_checkpoint(plugin, lines, options)
  local file = os.tmpname()
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s", setting.name)
    local fine, first = pcall(function() return actor.scene(plugin, setting.values, options):run { to = 0.5 } end)
    if fine then
      first:save(file)
      local whole = ended(plugin, setting, options)
      local again = actor.scene(plugin, setting.values, options)
      again:start { file = file }
      if whole ~= again:run():packed() then
        lines:wrong("a run that goes on from a checkpoint ends elsewhere",
          "put what evolves into the field table (hk_field), which checkpoints save")
      end
    end
  end
  os.remove(file)
end

local FEW <const> = 3 -- allocations in half a second's steps, of what has to grow once

-- Files and the heap, in the steps of a run.
local function steps_take_nothing(plugin, lines, options)
  local told = false
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s", setting.name)
    local scene
    local fine = pcall(function()
      scene = actor.scene(plugin, setting.values, options)
      scene:run { to = 0.5 }
    end)
    if fine and not told then
      local files, heap = inspect.files(), inspect.heap()
      pcall(scene.run, scene, { to = 1 })
      local opened, taken = inspect.files() - files, inspect.heap() - heap
      told = opened > 0 or taken > FEW
      if opened > 0 then
        lines:wrong(("it opens files in a step: %d times in 0.5 s"):format(opened), "open files in `create`")
      elseif taken > FEW then
        lines:wrong(("it allocates in a step: %d times in 0.5 s"):format(taken), "allocate in `create` and `topology`, and"
          .. " more than is needed, so that it is seldom")
      end
    end
  end
end

local function the_same_in_a_crowd(plugin, lines, options)
  local more, first = {}, nil
  for key, value in pairs(options or {}) do more[key] = value end
  more.positions, more.duration = actor.crowd(), 0.05
  for _, threads in ipairs { 1, 2, 3 } do
    more.threads = threads
    lines:at("%d particles, %d threads", actor.CROWD, threads)
    local fine, packed = pcall(ended, plugin, actor.settings(plugin)[1], more)
    if not fine then return end -- a scene of particles strewn about is not what every plugin can begin with
    if first and packed ~= first then
      return lines:wrong(("the bits differ with %d threads"):format(threads), "cut loops by count and grain, and sum chunks in"
        .. " their order")
    end
    first = packed
  end
end

-- What every kind owes the host: memory, errors, messages. options: those of the scene; keeps_nothing: it is
-- of a kind that has nothing to keep in a checkpoint.
function whole_runs.habits(plugin, try, options)
  try("two runs, and runs with 1 and 2 threads, have the same bits", function(lines)
    runs_and_repeats(plugin, lines, options)
  end)
  if not plugin.scene and not (options and options.keeps_nothing) then
    try("a run goes on from a checkpoint as if it had not stopped", function(lines)
      goes_on_from_a_checkpoint(plugin, lines, options)
    end)
  end
  -- An output takes files; a solver may need the third power of a crowd in time.
  if not (options and options.quiet) and not plugin.scene and plugin.kind ~= "solver" then
    try("it opens no files and takes no memory in steps", function(lines) steps_take_nothing(plugin, lines, options) end)
    try("the same bits in a crowd, with 1 to 3 threads", function(lines) the_same_in_a_crowd(plugin, lines, options) end)
  end
  try("it frees what it takes from the heap", function(lines)
    actor.each(plugin, lines, function(_, _, run)
      actor.frees(lines, function() actors.open(run, plugin.kind, "behind", true) end)
    end, options)
  end)
  try("it refuses to start, with a message, where there is no memory", function(lines)
    for allocations = 1, 6 do
      local fine, why = pcall(function()
        return actor.scene(plugin, actor.settings(plugin)[1].values, { allocations = allocations }):run { to = 0 }
      end)
      if not fine and tostring(why):find("without saying why", 1, true) then
        lines:wrong(actor.plain(why), "return host->fail(host, HK_NO_MEMORY, ...) where host->allocate gives NULL")
        break
      end
    end
  end)
end

return whole_runs
