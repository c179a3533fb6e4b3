-- How many files of hooke one reads to follow a step: those whose code runs in every step of a curtain with leapfrog,
-- as callgrind counts it. Its counts are written out at every begin of a step (hk_step_begin), so each holds what ran
-- from one to the next, by the file in which a line stands: what a compiler has inlined counts where it is written. A
-- file counts if it is in all steps of the method; what is looked at every 32 or 64 steps does not, nor do the frames.
-- Needs valgrind. STEP_FILES=1 prints the files.

local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")

local most_files = 20
local mark = "plugins/kit/integrate/leap.h" -- only steps of leapfrog execute it

local function fits()
  local settings = assert(io.open(build .. "/settings")):read("a")
  return os.execute("command -v valgrind >/dev/null") and not settings:find("-fsanitize", 1, true)
end

-- The path in hooke's sources; "": it is not of them.
local function source(path)
  return ("/" .. path):match("^.*/(core/[%w_/]+%.[ch])$") or ("/" .. path):match("^.*/(plugins/[%w_/]+%.[ch])$") or ""
end

-- The files of core/ and plugins/ of which a line was executed, in the text of one of callgrind's files. A cost after
-- "calls=" is that of the function which was called.
local function executed(text)
  local name_of, files, file, of_call = {}, {}, nil, false
  for line in text:gmatch("[^\n]+") do
    local kind, number, name = line:match("^(c?f[lie])=(%(%d+%)) ?(.*)")
    if kind then
      if name ~= "" then name_of[number] = source(name) end
      if kind:sub(1, 1) ~= "c" then file = name_of[number] end
    elseif line:find("^calls=") then
      of_call = true
    elseif line:find("^[%d+*-]") then
      if file and file ~= "" and not of_call then files[file] = true end
      of_call = false
    end
  end
  return files
end

-- The files that are in all steps of the method, in order, and how many steps there were.
local function in_every_step(texts)
  local count, steps, list = {}, 0, {}
  for _, text in ipairs(texts) do
    local files = executed(text)
    if files[mark] then
      steps = steps + 1
      for file in pairs(files) do count[file] = (count[file] or 0) + 1 end
    end
  end
  for file, times in pairs(count) do
    if times == steps then list[#list + 1] = file end
  end
  table.sort(list)
  return list, steps
end

local function check_the_check()
  local step = "fl=(1) /a/core/engine/loop/x.c\nfn=(1) f\n+3 1\nfi=(2) /a/./core/engine/base/y.h\n-1 2\n"
    .. "cfi=(3) /a/core/engine/base/z.c\ncfn=(2) g\ncalls=1 7\n* 40\n"
    .. "fl=(4) /a/plugins/kit/integrate/leap.h\n12 5\nfl=(5) /lib/libm.c\n1 2\n"
  local other = step:gsub("fi=%(2%)[^\n]+", "fi=(2) /a/core/engine/base/w.h") .. "fl=(3)\n9 1\n"
  local list, steps = in_every_step { step, other, "fl=(1) /a/core/engine/loop/q.c\n1 1\n" }
  assert(steps == 2 and table.concat(list, " ") == "core/engine/loop/x.c " .. mark, table.concat(list, " "))
  assert(#in_every_step { step } == 3 and #in_every_step { other } == 4)
end

local function output_of(command)
  local pipe = assert(io.popen(command .. " 2>&1"))
  local text = pipe:read("a")
  assert(pipe:close(), command .. "\n" .. text)
  return text
end

local function texts_in(folder)
  local texts = {}
  for path in output_of(("ls %s/cg.*"):format(folder)):gmatch("[^\n]+") do
    local file = assert(io.open(path))
    texts[#texts + 1] = file:read("a")
    file:close()
  end
  return texts
end

local function measure(size, dt, till)
  local folder = output_of("mktemp -d"):match("%S+")
  output_of(("cd %s && valgrind --tool=callgrind --dump-before=hk_step_begin --callgrind-out-file=cg '%s/hooke' run"
    .. " '%s/scripts/scenes/curtain.lua' N=%d --threads 1 --no-output --no-check --until %g --dt %g --quiet"):format(folder, build,
    root, size, till, dt))
  local list, steps = in_every_step(texts_in(folder))
  output_of(("rm -r %s"):format(folder))
  print(("curtain of %d x %d particles: %d files in each of %d steps"):format(size, size, #list, steps))
  if os.getenv("STEP_FILES") then print("  " .. table.concat(list, "\n  ")) end
  return #list, steps
end

check_the_check()
if not fits() then
  print("skipped: there is no valgrind, or the build has sanitizers, which do not go together with it")
  os.exit(77)
end
-- Of one domain, and of two; a larger curtain has several steps in a tile, and its loop runs once a tile.
for _, case in ipairs { { 10, 5e-4, 0.02 }, { 45, 1e-4, 0.0012 } } do
  local files, steps = measure(table.unpack(case))
  assert(steps > 10, "no steps were seen")
  assert(files <= most_files,
    ("a step goes through %d files, %d are allowed (STEP_FILES=1 names them)"):format(files, most_files))
end
