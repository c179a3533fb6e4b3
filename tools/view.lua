-- hooke view SCENE.lua [name=value ...] | RUN [RUN]: a page to play, turn and share: the motion in 3D, plots, verdict.
-- A scene is run with the output `trajectory`, as `hooke run` does; what follows -- are options for that. RUN is the folder
-- of a run that is over; two are shown beside each other. The page is one HTML file that needs no network: tools/view has
-- its modules, tools/common/view what puts it together.
local argparse = require("argparse")
local lfs = require("lfs")
local command_line = require("common.run.command_line")
local progress = require("common.run.progress")

local function complain(format, ...) return command_line.complain("view", format:format(...)) end

local function refuse_file(why)
  complain("%s", why)
  return 4
end

local function parser()
  local p = argparse("hooke view", "A page of a run: the motion in 3D, plots, the verdict. One HTML file, without a network.")
  p:argument("what", "a scene's script, then name=value ... and, after --, options of hooke run; or the folder of a run, "
    .. "or of two"):args("+")
  p:option("--page", "the file to write (page.html in the run's folder)")
  p:option("--out", "folder of the scene's run (out/SCENE)")
  p:flag("--forces", "with the forces on each particle by name (larger files)")
  p:flag("--trust", "the scene may use plugins beside it")
  p:flag("--quiet", "no progress")
  return p
end

local function quoted(word) return "'" .. word:gsub("'", "'\\''") .. "'" end

-- ---- a scene ----

-- Runs it as `hooke run` does, with that command's confinement; its exit code.
local function run(o, folder)
  local arguments = { quoted(lfs.symlinkattributes("/proc/self/exe", "target")), "run" }
  for _, word in ipairs(o.what) do arguments[#arguments + 1] = quoted(word) end
  arguments[#arguments + 1] = "--no-output" -- what the page shows is enough, and the scene's own pictures would take their time
  arguments[#arguments + 1] = "--with output:" .. (o.forces and "trajectory:forces=true" or "trajectory")
  arguments[#arguments + 1] = "--out " .. quoted(folder)
  if o.trust then arguments[#arguments + 1] = "--trust" end
  if o.quiet then arguments[#arguments + 1] = "--quiet" end
  local _, how, code = os.execute(table.concat(arguments, " "))
  return how == "signal" and 128 + code or code
end

-- ---- a folder ----

local function trajectory_in(folder)
  if lfs.attributes(folder, "mode") == "file" then return folder, folder:match("^(.*)/[^/]*$") or "." end
  if lfs.attributes(folder, "mode") ~= "directory" then return nil, ("there is no folder or script %s"):format(folder) end
  if lfs.attributes(folder .. "/trajectory.h5", "mode") == "file" then return folder .. "/trajectory.h5", folder end
  for name in lfs.dir(folder) do
    if name:find("%.h5$") then return folder .. "/" .. name, folder end
  end
  return nil, ("%s has no trajectory.h5: add scene:output('trajectory') to the scene, or view the scene itself, or run it "
    .. "with --with output:trajectory"):format(folder)
end

-- Text of a file in the folder that is JSON; what is not, nor a plain file, is as if it was not there.
local function json_in(folder, name)
  local text = hooke.read(folder .. "/" .. name, folder)
  return text and pcall(require("cjson").decode, text) and text or nil
end

-- A run is called by its scene, two runs of one scene by their folders: "out/a/b" and "out/a/c" are told apart as b and c.
local function titles(folders, recordings)
  local scenes, names = {}, {}
  for k, folder in ipairs(folders) do
    names[k] = folder:gsub("/+$", ""):match("[^/]+$") or folder
    scenes[k] = recordings[k].attributes.scene:gsub("%.lua$", ""):match("[^/]+$") or names[k]
  end
  if scenes[1] ~= scenes[2] then return scenes end
  return names[1] == names[2] and folders or names
end

local function modules()
  local fine, recording = pcall(require, "recording")
  if not fine then
    return nil, "trajectories cannot be read: hooke was built without HDF5; tools/install-deps run gets it, then run make"
  end
  if not pcall(require, "page") then
    return nil, "pages cannot be made: hooke was built without zlib; tools/install-deps run gets it, then run make"
  end
  return recording
end

-- The files of the recordings and their folders.
local function find(folders)
  local found = {}
  for k, folder in ipairs(folders) do
    local path, place = trajectory_in(folder)
    if not path then return nil, place end
    found[k] = { path = path, place = place }
  end
  return found
end

-- In a process that can do no more than read them and write the page: recordings may be a stranger's.
local function open_runs(recording, folders, found)
  local runs, recordings = {}, {}
  for k, one in ipairs(found) do
    local r, why = recording.open(one.path)
    if not r then return nil, why end
    recordings[k] = r
    runs[k] = { recording = r, file = one.path, summary = json_in(one.place, "summary.json"),
      bench = json_in(one.place, "bench.json") }
  end
  for k, title in ipairs(titles(folders, recordings)) do runs[k].title = title end
  return runs
end

-- ---- the page ----

local function size_text(bytes)
  return bytes < 1e6 and ("%.0f kB"):format(bytes / 1e3) or ("%.1f MB"):format(bytes / 1e6)
end

local function subtitle_of(runs)
  local r = runs[1].recording
  local text = ("%d particles, %.4g s, %d frames"):format(r:n(r.frames), r.times[#r.times] - r.times[1], r.frames)
  return #runs == 1 and text or text .. " · two runs"
end

local function is_same(one, other)
  local a, b = lfs.attributes(one), lfs.attributes(other)
  return a and b and a.dev == b.dev and a.ino == b.ino
end

local function folder_of(path) return path:match("^(.*)/[^/]*$") or "." end

-- Whether the page can be written; before a scene is run for it.
local function has_place(path)
  local folder = folder_of(path)
  if lfs.attributes(folder == "" and "/" or folder, "mode") ~= "directory" then
    return nil, ("--page: there is no folder %s for %s: create it first"):format(folder, path)
  end
  local mode = lfs.attributes(path, "mode")
  if mode == "directory" then return nil, ("--page: %s is a folder: name a file in it, such as %s/page.html"):format(path, path) end
  if mode and mode ~= "file" then return true end -- a device or a pipe
  local file, why = io.open(path, "a") -- which changes nothing that is there
  if not file then return nil, ("--page: cannot write %s; name another file"):format(why) end
  file:close()
  if not mode then os.remove(path) end
  return true
end

local function make_page(o, folders)
  local recording, found, why, runs
  recording, why = modules()
  if not recording then return refuse_file(why) end
  found, why = find(folders)
  if not found then return refuse_file(why) end
  local path = o.page or (folders[1]:gsub("%.h5$", "") .. (folders[1]:find("%.h5$") and ".html" or "/page.html"))
  local mode = lfs.attributes(path, "mode")
  if not o.page and mode and mode ~= "file" then
    return refuse_file(("%s is no plain file: remove it, or name a file with --page"):format(path))
  end
  local pages = require("common.view.make")
  local open = hooke.confine(found[1].path, found[2] and found[2].place, folder_of(path))
  if open then io.stderr:write("hooke view: ", open, "\n") end
  runs, why = open_runs(recording, folders, found)
  if not runs then return refuse_file(why) end
  for _, one in ipairs(runs) do
    for _, read in ipairs { one.file, folder_of(one.file) .. "/summary.json", folder_of(one.file) .. "/bench.json" } do
      if is_same(path, read) then return complain("--page: %s is what is to be shown; name another file", path) end
    end
  end
  local frames = 0
  for _, one in ipairs(runs) do frames = frames + one.recording.frames end
  local bar = progress.new { what = "view", total = frames, quiet = o.quiet }
  local made
  made, why = pages.page(path, runs, { title = #runs == 2 and runs[1].title .. " and " .. runs[2].title
    or runs[1].title, subtitle = subtitle_of(runs), bench = runs[1].bench, tick = function() bar:add() end })
  bar:finish()
  if not made then return refuse_file(why) end
  print(("wrote %s (%s)"):format(hooke.plain(path), size_text(made.size)))
  for _, run_ in ipairs(made.runs) do
    local p = run_.streams[1]
    local extent = 0
    for c = 1, 3 do extent = math.max(extent, p.high[c] - p.low[c]) end
    print(("  %s: positions within %.2g m%s"):format(hooke.plain(run_.title), p.error,
      extent > 0 and (", %.2g of the extent"):format(p.error / extent) or ""))
  end
  return 0
end

local function main()
  local o = command_line.parse("view", parser())
  if not o then return 1 end
  local scene = o.what[1]:find("%.lua$")
  if not scene and #o.what > 2 then return complain("'%s': one or two folders of runs, or a scene", o.what[3]) end
  if o.page then
    local fine, why = has_place(o.page)
    if not fine then return refuse_file(why) end
  end
  if not scene then return make_page(o, o.what) end
  local folder = o.out or "out/" .. (o.what[1]:match("([^/]+)%.lua$"))
  local code = run(o, folder)
  -- A run that diverged, was interrupted or is inaccurate is worth a look, too.
  if code ~= 0 and code ~= 3 and code ~= 5 and code ~= 130 then return code end
  local made = make_page(o, { folder })
  return made == 0 and code or made
end

return main()
