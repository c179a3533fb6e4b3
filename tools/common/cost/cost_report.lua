-- The report of a study of costs (common/cost/cost.lua) as sentences, tables and plain data.
local cost = require("common.cost.cost")

local report = {}

-- ---- as text ----

local function percent(fraction)
  local size = math.abs(fraction)
  return (size >= 0.0995 and size < 10 and "%.0f %%" or "%.2g %%"):format(100 * fraction)
end

local function faster(figure)
  if not figure or not figure.saved then return "takes a time that was not measured" end
  if math.abs(figure.saved) <= 2 * figure.spread then
    return ("takes the same time (to %s)"):format(percent(2 * figure.spread))
  end
  return ("takes %s %s time"):format(percent(math.abs(figure.saved)), figure.saved > 0 and "less" or "more")
end

local function how_long(part)
  if part.own_failed then
    return ("%s at the same step, fails at its own (%s)"):format(faster(part.same), part.own_failed)
  end
  if part.own == part.same then return faster(part.own) end
  return ("%s at the same step and %s at its own"):format(faster(part.same), faster(part.own))
end

local function elsewhere(study, part)
  if not part.x then return "ends with other particles, " .. tostring(part.why) end
  if part.x == 0 then return "ends where it did" end
  return ("ends %.2g m elsewhere%s"):format(part.x,
    part.x_relative and (" (%s of the extent)"):format(percent(part.x_relative)) or "")
    .. (part.by_chance and part.x > 0 and (", as a disturbance of %g may%s"):format(cost.disturbance,
      study.chaotic and "" or (" (%.2g m)"):format(study.chance.x)) or "")
end

local function against_accuracy(study, part)
  if not study.accuracy or not part.x or part.by_chance and part.x > study.accuracy then return "" end
  return (": %s the accuracy asked (%g m)"):format(part.x > study.accuracy and "above" or "within", study.accuracy)
end

-- One sentence about a part.
local function sentence(study, part)
  if part.failed then return ("without '%s' the scene does not run: %s"):format(part.label, part.failed) end
  if part.same_failed then
    return ("without '%s' the run fails at the same step (%s); at its own it %s"):format(part.label, part.same_failed,
      faster(part.own))
  end
  local verdict = part.same.verdict ~= "ok" and (" (verdict: %s: %s)"):format(part.same.verdict, part.same.reason) or ""
  return ("without '%s' the run %s and %s%s%s"):format(part.label, how_long(part), elsewhere(study, part),
    against_accuracy(study, part), verdict)
end

-- ---- tables ----

-- Labels and names may hold line breaks.
local function line(text) return hooke.plain(text, true) end

local function saved(figure)
  return figure and figure.saved and ("%s +- %s"):format(percent(figure.saved), percent(figure.spread)) or "-"
end

local function print_heading(study)
  local w = study.whole
  print(("%s: %d particles, %s, %.9g s; %s"):format(w.scene, w.particles, w.integrator, w.t,
    study.accuracy and ("accuracy asked: %g m"):format(study.accuracy) or "no accuracy is asked for"))
  print(("the whole: %.3g s of time loop in %d steps of %.3g s, %d evaluations (one thread, median)"):format(
    study.seconds, w.steps, w.t / w.steps, w.force_evaluations))
  print(study.chance
    and ("a start disturbed by %g of the extent ends %.2g m elsewhere%s"):format(cost.disturbance, study.chance.x,
      study.chaotic and ": chaotic, differences below the extent say nothing; see --until" or "")
    or ("what a disturbed start changes is not known: %s"):format(study.chance_why))
end

-- An adaptive method takes other steps without the part, so the table has no column for equal steps.
local function print_table(study)
  local row = "  %-16s %-11s %18s %18s %9s %12s %12s"
  print("\n" .. row:format("without", "kind", "saves, same step", "saves, own step", "steps", "evaluations",
    "ends off, m"))
  for _, part in ipairs(study.parts) do
    local same, own = part.same, part.own
    if same and same.steps ~= study.whole.steps then same = nil end
    print(row:format(line(part.label), part.kind, saved(same), saved(own), own and ("%d"):format(own.steps) or "-",
      own and ("%d"):format(own.force_evaluations) or "-", part.x and ("%.3g"):format(part.x) or "-"))
  end
end

local function sorted_names(t)
  local names = {}
  for name in pairs(t) do names[#names + 1] = name end
  table.sort(names)
  return names
end

local function print_measures(study)
  local row = "  %-16s %-16s %14s %14s %12s %10s%s"
  if next(study.whole.measures) == nil then return end
  print("\n" .. row:format("without", "measure", "with it", "without", "change", "relative", ""))
  for _, part in ipairs(study.parts) do
    for _, name in ipairs(sorted_names(part.measures or {})) do
      local m = part.measures[name]
      print(row:format(line(part.label), line(name), ("%.6g"):format(m.with), ("%.6g"):format(m.without),
        ("%.3g"):format(m.change), m.relative and percent(m.relative) or "-",
        m.by_chance and m.change ~= 0 and "  (by chance, too)" or ""))
    end
  end
end

local function print_sentences(study)
  print("")
  for _, part in ipairs(study.parts) do print(line(sentence(study, part))) end
end

-- The data printed as JSON: the study without states and cases.
function report.plain(study)
  local out = { scene = study.whole.scene, integrator = study.whole.integrator, accuracy = study.accuracy,
    extent = study.extent, seconds = study.seconds, repeats = study.repeats, chance = study.chance,
    chance_why = study.chance_why, chaotic = study.chaotic, parts = {} }
  study.whole.states = nil
  out.whole = study.whole
  for k, part in ipairs(study.parts) do
    part.same_case, part.own_case = nil, nil
    for _, key in ipairs { "same", "own" } do
      if part[key] then part[key].result = nil end
    end
    part.says = sentence(study, part)
    out.parts[k] = part
  end
  return out
end

function report.print(study)
  print_heading(study)
  print_table(study)
  print_measures(study)
  print_sentences(study)
end

return report
