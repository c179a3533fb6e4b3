-- A sweep as a Slurm job array: each task runs a share of the cases into a database of its own (a write-ahead log does
-- not work on network file systems, and a single writer per file needs none), which the next `hooke sweep` merges.
local files = require("common.run.file")
local database = require("common.sweep.database")
local lfs = require("lfs")
local plan = require("common.sweep.plan")
local process = require("process")
local progress = require("common.run.progress")
local store = require("common.sweep.store")

local slurm = {}

local function parts_folder(results) return results.path .. ".parts" end

-- Whether tasks of Slurm have left databases beside the one at the path.
function slurm.has_parts(path) return lfs.attributes(path .. ".parts", "mode") == "directory" end

-- Merges the results that tasks have written so far; returns the number of new cases.
function slurm.collect(results)
  local folder, count = parts_folder(results), 0
  if lfs.attributes(folder, "mode") ~= "directory" then return 0 end
  for name in lfs.dir(folder) do
    if name:match("%.db$") then count = count + results:merge(folder .. "/" .. name) end
  end
  return count
end

-- Discards the results of earlier tasks.
function slurm.forget(results)
  local folder = parts_folder(results)
  if lfs.attributes(folder, "mode") ~= "directory" then return end
  for name in lfs.dir(folder) do
    if name:match("%.db$") or name:match("%.db%-journal$") then os.remove(folder .. "/" .. name) end
  end
end

local function quote(text) return "'" .. tostring(text):gsub("'", "'\\''") .. "'" end

local function write(path, text)
  local fine, why = files.write(path, text)
  if not fine then database.fail("sweep: %s", why) end
end

local function output_of(command)
  local pipe = io.popen(command .. " 2>&1")
  local text = pipe:read("a")
  return pipe:close(), text
end

-- Converts increasing numbers to a text such as "1-5,9".
local function list_text(numbers)
  local parts, first = {}, 1
  for k = 1, #numbers do
    if numbers[k + 1] ~= numbers[k] + 1 then
      parts[#parts + 1] = first == k and tostring(numbers[k]) or ("%d-%d"):format(numbers[first], numbers[k])
      first = k + 1
    end
  end
  return table.concat(parts, ",")
end

-- The lines of the file `shares`: the cases that are not done, distributed evenly over the tasks.
local function share_out(cases, tasks)
  local numbers, lines = {}, {}
  for _, case in ipairs(cases) do
    if not case.row then numbers[#numbers + 1] = case.number end
  end
  tasks = math.min(#numbers, tasks or 100)
  for k = 1, tasks do
    local from, to = (k - 1) * #numbers // tasks + 1, k * #numbers // tasks
    lines[k] = list_text(table.move(numbers, from, to, 1, {}))
  end
  return lines, #numbers
end

-- Options that are not passed to tasks, with the number of arguments that they take.
local not_for_tasks = { ["--slurm"] = 1, ["--wait"] = 1, ["--resume"] = 1, ["--again"] = 1, ["--retry"] = 1, ["--quiet"] = 1,
  ["--report"] = 1, ["--tasks"] = 2, ["--sbatch"] = 2, ["--db"] = 2, ["--csv"] = 2, ["--plot"] = 2, ["--case"] = 2,
  ["-j"] = 2 }

-- The arguments of this command that a task needs as well.
local function words_for_task()
  local arguments, k = {}, 1
  while k <= #arg do
    local skip = not_for_tasks[arg[k]] or arg[k]:match("^%-j%d+$") and 1
    if not skip then arguments[#arguments + 1] = quote(arg[k]) end
    k = k + (skip or 1)
  end
  return table.concat(arguments, " ")
end

local function job_script(the, folder, count)
  local engine = lfs.symlinkattributes("/proc/self/exe", "target")
  return table.concat({
    "#!/bin/sh",
    "#SBATCH --job-name=" .. the.definition.name:gsub("[^%w_.-]", "_"),
    ("#SBATCH --array=1-%d"):format(count),
    "# Each task runs the cases in its line of the file `shares`.",
    "folder=" .. quote(folder),
    'cases=$(sed -n "${SLURM_ARRAY_TASK_ID}p" "$folder/shares.$1")',
    ("exec %s sweep %s \\"):format(quote(engine), words_for_task()),
    '  --quiet -j "${SLURM_CPUS_PER_TASK:-1}" --case "$cases" \\',
    '  --part "$folder/$SLURM_ARRAY_JOB_ID.$SLURM_ARRAY_TASK_ID.db"',
  }, "\n") .. "\n"
end

local function absolute(path)
  return path:sub(1, 1) == "/" and path or lfs.currentdir() .. "/" .. path
end

-- Merges results while the tasks' databases grow, until no task is in the queue.
local function wait(the, results, cases, job)
  local bar = progress.new { what = the.definition.name, total = #cases, done = results:find(cases), quiet = the.quiet }
  local left = true
  while left do
    process.ready({}, 1)
    local fine, text = output_of("squeue -h -o %T -j " .. job)
    left = fine and text:match("%S") ~= nil -- some minutes after the end of a job squeue reports it as unknown
    local count = slurm.collect(results)
    if count > 0 then bar:add { count = count } end
    bar:tick()
  end
  bar:finish()
  return true
end

-- Submits the cases that are not done; with --wait returns true when the array has ended.
function slurm.submit(the, results, cases, asked)
  if not output_of("command -v sbatch") then
    plan.refuse("--slurm: sbatch is not installed here (Debian: slurm-wlm); --print-cases and --case fit any scheduler")
  end
  local folder = absolute(parts_folder(results))
  local lines, count = share_out(cases, asked.given["--tasks"])
  if count == 0 then return true end
  local stamp = ("%d.%d"):format(os.time(), math.floor(process.clock() * 1000) % 1000)
  store.make_folder(folder .. "/x")
  write(("%s/shares.%s"):format(folder, stamp), table.concat(lines, "\n") .. "\n")
  write(folder .. "/job.sh", job_script(the, folder, #lines))
  local fine, text = output_of(("sbatch --parsable --output=%s --chdir=%s %s %s %s"):format(quote(folder .. "/%a.log"),
    quote(lfs.currentdir()), asked.given["--sbatch"] or "", quote(folder .. "/job.sh"), stamp))
  local job = fine and text:match("^(%d+)")
  if not job then plan.refuse("sbatch: %s", (text:gsub("%s+$", ""))) end
  io.stderr:write(("%s: %d cases in %d tasks, Slurm job %s"):format(the.definition.name, count, #lines, job),
    asked.given["--wait"] and "\n" or "; --resume in place of --slurm takes over what is done\n")
  return asked.given["--wait"] and wait(the, results, cases, job) or false
end

return slurm
