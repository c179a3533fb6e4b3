-- `hooke run --integrator auto` on scenes that it has not been tuned on (scenes.lua): whether the motion that it computes is
-- within the accuracy at every frame, against a run by a method of high order with a tolerance far below it.
local files = require("files")

local unseen = {}

local function script(scene)
  local out = { ("local scene = hooke.scene { duration = %g, fps = %g, accuracy = 1e-4 }"):format(scene.duration, scene.fps),
    scene[2] }
  for i = 1, scene.n do
    for c = 1, 3 do
      out[#out + 1] = ("scene:measure('x%d_%d', function(s) return s:position(%d)[%d] end)"):format(i, c, i, c)
    end
  end
  return table.concat(out, "\n") .. "\nreturn scene\n"
end

local function rows(text)
  local list = {}
  for line in text:gmatch("[^\n]+") do
    local row = {}
    for word in line:gmatch("[^,]+") do row[#row + 1] = tonumber(word) end
    list[#list + 1] = row
  end
  return list
end

local function distance(a, b, n)
  if #a ~= #b or #a < 3 then return math.huge end
  local worst = 0
  for k = 2, #a do
    local sum = 0
    for e = 2, 3 * n + 1 do sum = sum + ((a[k][e] or 0 / 0) - (b[k][e] or 0 / 0)) ^ 2 end
    worst = math.max(worst, sum == sum and math.sqrt(sum / n) or math.huge)
  end
  return worst
end

-- Of runs with several methods, the two that agree best: { motion, what they differ by }.
local exact_runs = { "--integrator dop853 --tol 1e-12", "--integrator dopri5 --tol 1e-12", "--integrator dopri5 --tol 1e-11" }

local function shell(folder, o, arguments)
  local command = ("cd %s && rm -rf out && %s run scene.lua %s --threads 1 --json --out out >json 2>err"):format(
    files.quoted(folder), files.quoted(o.hooke), arguments)
  os.execute(("XDG_CACHE_HOME=%s; export XDG_CACHE_HOME; "):format(files.quoted(folder .. "/cache")) .. command)
  return rows(files.read(folder .. "/out/measures.csv") or ""), files.read(folder .. "/json") or "", files.read(folder .. "/err") or ""
end

local function truth(folder, o, n)
  local motions, best = {}, { off = math.huge }
  for k, arguments in ipairs(exact_runs) do
    motions[k] = shell(folder, o, arguments .. " --no-check --accuracy-at end")
    for j = 1, k - 1 do
      local off = distance(motions[j], motions[k], n)
      if off < best.off then best = { off = off, motion = motions[k] } end
    end
    if best.off < 1e-7 then break end
  end
  return best
end

-- o: hooke, folder, only (a name or nil), slow (choices have a budget of time, in which all takes ten times as long: a run
-- that says that it did not reach the accuracy is fine), every (of so many scenes the first is tried). Returns the number of
-- scenes that are fine, and of those tried.
function unseen.measure(o)
  local good, count = 0, 0
  for k, scene in ipairs(require("unseen.scenes")) do
    if o.only == scene[1] or not o.only and (k - 1) % (o.every or 1) == 0 then
      files.write(o.folder .. "/scene.lua", script(scene))
      local exact = truth(o.folder, o, scene.n)
      local motion, json, words = shell(o.folder, o, "--integrator auto")
      local error = exact.motion and distance(motion, exact.motion, scene.n) or math.huge
      local verdict = json:match('"verdict":"(%a+)"') or "none"
      local fine = verdict == "ok" and error <= 1e-4 or o.slow and verdict == "inaccurate"
      good, count = good + (fine and 1 or 0), count + 1
      print(("%-4s %-18s error %.2g m (known to %.1g), %s; %s"):format(fine and "" or "OFF", scene[1], error, exact.off, verdict,
        words:match("hooke: auto: ([^\n]*)") or words))
      io.stdout:flush()
    end
  end
  print(("%d of %d scenes within the accuracy"):format(good, count))
  return good, count
end

return unseen
