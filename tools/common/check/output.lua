-- The tests of an output (hooke check): it watches and changes nothing, says when a file cannot be written, copes with
-- particles that come and go, and closes what it opens.
local inspect = require("inspect")
local watching = require("watching")
local actor = require("common.check.actor")
local whole_runs = require("common.check.whole_runs")

local function folder_of(body)
  local folder = os.tmpname()
  os.remove(folder)
  os.execute(("mkdir -p '%s'"):format(folder))
  local fine, why = pcall(body, folder)
  os.execute(("rm -rf '%s'"):format(folder))
  if not fine then error(why, 0) end
end

-- As actor.each, with an instance that no run has opened yet.
local function each(plugin, lines, body)
  actor.each(plugin, lines, body, { quiet = true })
end

-- ---- properties ----

local function changes_nothing(plugin, lines)
  local options = { gravity = true, springs = true, duration = 0.3 }
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s", setting.name)
    local own = actor.scene(plugin, setting.values, options):run()
    local bare = { gravity = true, springs = true, duration = 0.3, without = true }
    if own:packed() ~= actor.scene(plugin, setting.values, bare):run():packed() then
      lines:wrong("the motion is another one with it", "an output reads the view and writes files, nothing else")
    end
  end
end

-- Begins, gives frames with so many particles each, and finishes; calls `heard` after every call.
local function show(a, counts, verdict, heard)
  local fine, said = watching.begin(a, counts[1])
  heard("open", fine, said)
  if not fine then return end
  for k, n in ipairs(counts) do
    fine, said = watching.frame(a, n, k - 1)
    heard("frame", fine, said)
    if not fine then break end
  end
  fine, said = watching.finish(a, verdict)
  heard("close", fine, said)
end

local function copes_with_births_and_deaths(plugin, lines)
  folder_of(function(folder)
    each(plugin, lines, function(a)
      watching.into(a, folder)
      lines:at("4, 7, 2, 0, 5 particles at five frames")
      show(a, { 4, 7, 2, 0, 5 }, "ok", function(what, fine, said)
        if not fine then
          lines:wrong(("%s fails where particles come and go: %s"):format(what, said),
            "the number of particles is view->n of each call")
        end
      end)
    end)
  end)
end

local function ends_in_every_way(plugin, lines)
  folder_of(function(folder)
    for _, verdict in ipairs { "ok", "diverged", "stopped" } do
      each(plugin, lines, function(a)
        watching.into(a, folder)
        lines:at("a run that ends %s, before its first frame", verdict)
        local fine, said = watching.begin(a, 3)
        if fine then fine, said = watching.finish(a, verdict) end
        if not fine then lines:wrong("it cannot be closed without a frame: " .. said) end
      end)
    end
  end)
end

local function try_a_full_disk(plugin, lines, link)
  local told = false
  each(plugin, lines, function(a)
    os.execute(("ln -sfn /dev/full '%s'"):format(link))
    watching.into(a, link, true)
    lines:at("a disk that is full")
    local said_so, mute = false, nil
    show(a, { 3, 3, 3 }, "ok", function(what, fine, said)
      if not fine then said_so = true end
      if not fine and said == "" then mute = what end
    end)
    if mute and not told then
      told = true
      lines:wrong(("%s fails without saying why"):format(mute), "use host->fail with the path and strerror(errno)")
    elseif not said_so and not told and watching.asked() > 0 then
      told = true
      lines:wrong("it does not see that its file cannot be written", "look at the results of fprintf, fflush and fclose")
    end
  end)
end

-- On Linux /dev/full takes no byte. It is reached by a link, since outputs remove or replace files that failed.
local function says_that_the_disk_is_full(plugin, lines)
  if not os.execute("test -c /dev/full") then return lines:note("a disk that is full: this system has no /dev/full") end
  folder_of(function(folder) try_a_full_disk(plugin, lines, folder .. "/full") end)
end

local function says_that_there_is_no_folder(plugin, lines)
  each(plugin, lines, function(a)
    watching.into(a, "/nowhere/at/all")
    lines:at("a folder that is not there")
    local failed = false
    show(a, { 3, 3 }, "ok", function(what, fine, said)
      failed = failed or not fine
      if not fine and said == "" then
        lines:wrong(("%s fails without saying why"):format(what), "use host->fail with the path and strerror(errno)")
      end
    end)
    if watching.asked() == 0 then return end
    if not failed then lines:wrong("it does not see that its file cannot be made", "look at the result of fopen") end
    watching.into(a)
    lines:at("a run without a folder")
    local fine = watching.begin(a, 3)
    if fine then fine = watching.frame(a, 3, 0) end
    if fine then lines:wrong("it does not see that host->path fails", "return its status") end
  end)
end

local function closes_its_files(plugin, lines)
  folder_of(function(folder)
    actor.settings(plugin) -- has a run of its own
    local before = watching.files()
    actor.frees(lines, function()
      each(plugin, lines, function(a)
        watching.into(a, folder)
        show(a, { 3, 3 }, "ok", function() end)
      end)
    end)
    local left = watching.files() - before
    if left > 0 then lines:wrong(("%d files are open after the runs"):format(left), "close them in `close` and `destroy`") end
  end)
end

-- A run that fails before `close`: destroy alone is called.
local function closes_after_a_failure(plugin, lines)
  folder_of(function(folder)
    actor.settings(plugin) -- has a run of its own
    local before = watching.files()
    each(plugin, lines, function(a)
      watching.into(a, folder)
      watching.begin(a, 3)
    end)
    collectgarbage()
    collectgarbage()
    local left = watching.files() - before
    if left > 0 then
      lines:wrong(("%d files are open after a run that failed before its end"):format(left), "close them in `destroy`")
    end
  end)
end

-- ---- files ----

local COUNTS = { 3, 5, 2, 5 } -- particles of the frames

-- What is in the folder, in one word; two folders with the same files have the same.
local function contents(folder)
  local pipe = assert(io.popen(("cd '%s' && find . -type f | LC_ALL=C sort | xargs -d '\\n' -r cksum"):format(folder)))
  local text = pipe:read("a")
  pipe:close()
  return text
end

-- The first line that differs, for a message.
local function first_difference(a, b)
  local next_line = b:gmatch("[^\n]+")
  for line in a:gmatch("[^\n]+") do
    if line ~= next_line() then return line:match("%./(.*)$") end
  end
  return "a file more, or less"
end

local function in_turn(own, other, folder, beside)
  local function with(a, place, call, ...)
    watching.into(a, place)
    return call(a, ...)
  end
  local fine = with(own, folder, watching.begin, COUNTS[1]) and with(other, beside, watching.begin, 9)
  for k, n in ipairs(COUNTS) do
    fine = fine and with(own, folder, watching.frame, n, k - 1) and with(other, beside, watching.frame, 9 + k, k - 1)
  end
  return fine and with(own, folder, watching.finish, "ok") and with(other, beside, watching.finish, "ok")
end

-- Its files are the same ones whatever the heap holds, whatever the clock says, and beside another instance.
local function the_same_files(plugin, lines)
  folder_of(function(top)
    local settings = actor.settings(plugin)
    local function folder(name)
      os.execute(("mkdir -p '%s/%s'"):format(top, name))
      return ("%s/%s"):format(top, name)
    end
    local function opened()
      local scene, run
      local fine = pcall(function()
        scene = actor.scene(plugin, settings[1].values)
        watching.quiet(scene, true)
        run = scene:run { to = 0 }
      end)
      if scene then watching.quiet(scene, false) end
      return fine and watching.open(run, plugin.kind) or nil, { scene, run }
    end
    local kept = {}
    lines:at("%s", settings[1].name)
    inspect.fill(0)
    local a
    a, kept[1] = opened()
    if not a then return end
    watching.into(a, folder("alone"))
    local fine = true
    show(a, COUNTS, "ok", function(_, held) fine = fine and held end)
    if not fine or watching.asked() == 0 then return end
    inspect.fill(0xc1)
    inspect.clock(1e5)
    local own, other
    own, kept[2] = opened()
    other, kept[3] = opened()
    fine = in_turn(own, other, folder("again"), folder("beside"))
    inspect.clock(0)
    if not fine then return lines:wrong("it fails beside another instance", "keep all data in the instance, no static variables") end
    local alone, again = contents(top .. "/alone"), contents(top .. "/again")
    if alone ~= again then
      lines:wrong(("beside another instance, later and with another heap its files are others: %s"):format(
        first_difference(alone, again)), "keep all data in the instance, initialise what is written, write no dates")
    end
    assert(kept)
  end)
end

local function keeps_few_files_open(plugin, lines)
  local FRAMES <const> = 12
  folder_of(function(folder)
    local told = false
    each(plugin, lines, function(a)
      watching.into(a, folder)
      local open
      if not watching.begin(a, 3) then return end
      for k = 0, FRAMES do
        if not watching.frame(a, 3, k) then break end
        if k == 2 then open = watching.files() end
      end
      local more = watching.files() - (open or math.huge)
      watching.finish(a, "ok")
      if more >= FRAMES - 2 and not told then
        told = true
        lines:wrong(("%d files more are open after %d more frames"):format(more, FRAMES - 2), "close a frame's file in `frame`")
      end
    end)
  end)
end

-- A long run of many particles, then few: what was large enough at the start is not later.
local function copes_with_a_crowd(plugin, lines)
  folder_of(function(folder)
    local told = false
    each(plugin, lines, function(a)
      if told then return end
      told = true -- the first setting alone
      watching.into(a, folder)
      lines:at("6, 3000 and 2 particles at three frames")
      show(a, { 6, 3000, 2 }, "ok", function(what, fine, said)
        if not fine then lines:wrong(("%s fails where particles come and go: %s"):format(what, said)) end
      end)
    end)
  end)
end

return function(plugin, report)
  local try = actor.watched(plugin, report, watching)
  if not actor.starts(plugin, try) then return end
  try("it changes nothing", function(l) changes_nothing(plugin, l) end)
  try("it copes with births and deaths", function(l) copes_with_births_and_deaths(plugin, l) end)
  try("it can be closed without a frame, whatever the verdict", function(l) ends_in_every_way(plugin, l) end)
  try("a disk that is full is an error", function(l) says_that_the_disk_is_full(plugin, l) end)
  try("a folder that is not there is an error", function(l) says_that_there_is_no_folder(plugin, l) end)
  try("it closes its files and frees its memory", function(l) closes_its_files(plugin, l) end)
  try("it closes its files after a run that failed", function(l) closes_after_a_failure(plugin, l) end)
  try("it keeps few files open", function(l) keeps_few_files_open(plugin, l) end)
  try("it copes with a crowd", function(l) copes_with_a_crowd(plugin, l) end)
  try("its files are the same again", function(l) the_same_files(plugin, l) end)
  whole_runs.habits(plugin, try, { duration = 0.2, keeps_nothing = true, quiet = true })
end
