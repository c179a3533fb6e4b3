-- The page of `hooke validate`: validate.md with a table and a figure for each topic, validate.csv with all digits, and
-- validate.pdf (pdf.lua) with the same for a paper.
local files = require("common.run.file")
local lines = require("common.validate.lines")
local panels = require("common.validate.panels")
local pdf = require("common.validate.pdf")
local plot = require("common.run.plot")

local page = {}

-- ---- topics ----

local function topics_of(list)
  local topics = {}
  for _, problem in ipairs(list) do
    local last = topics[#topics]
    if not last or last.name ~= problem.topic then
      last = { name = problem.topic, problems = {} }
      topics[#topics + 1] = last
    end
    table.insert(last.problems, problem)
  end
  for _, topic in ipairs(topics) do topic.panels = panels.of(topic.problems) end
  return topics
end

-- ---- Markdown ----

local function cell(text) return (tostring(text):gsub("|", "\\|"):gsub("[%*_<]", "\\%0"):gsub("%s+", " ")) end

local function row(found)
  local q = found.quantity
  return ("| %s%s | %.12g | %s | %.1f | %s | %s | %s |"):format(cell(q.name), q.unit and ", " .. cell(q.unit) or "", q.reference,
    lines.value_text(found, 12), found.digits, lines.order_cell(found, "space"), lines.order_cell(found, "time"),
    #found.faults == 0 and "" or "**" .. cell(table.concat(found.faults, "; ")) .. "**")
end

local head = "| quantity | reference | hooke | digits | order in space | in time | |\n|---|---|---|---|---|---|---|"

-- The sources of a problem's references, each once.
function page.sources(problem)
  local list, seen = {}, {}
  for _, q in ipairs(problem.description.quantities) do
    if not seen[q.source] then list[#list + 1], seen[q.source] = q.source, true end
  end
  return table.concat(list, "; ")
end

local function introduction(o)
  return ("Each value is extrapolated from %s resolutions or steps with the order that they show among themselves "
    .. "(Richardson), without the reference; the expected order is in brackets. Digits: to how many decimal digits it agrees "
    .. "with the reference. Exact: all levels agree to rounding."):format(o.quick and "three coarse" or "three or more")
end

local function markdown(topics, o)
  local text = { "# Validation of hooke", "", introduction(o) }
  for _, topic in ipairs(topics) do
    text[#text + 1] = ("\n## %s\n\n%s"):format(topic.name, head)
    for _, problem in ipairs(topic.problems) do
      text[#text + 1] = ("| **%s** (%s; %s evaluations, %.2g s) | | | | | | %s |"):format(cell(problem.title),
        cell(page.sources(problem)), lines.count(problem.cost.evaluations), problem.cost.seconds,
        problem.failed and "**failed** " .. cell(problem.failed) or "")
      for _, found in ipairs(problem.found) do text[#text + 1] = row(found) end
    end
    if #topic.panels > 0 then text[#text + 1] = ("\n![convergence](%s.png)"):format(topic.name) end
  end
  return table.concat(text, "\n") .. "\n"
end

-- ---- CSV: `error` and `uncertainty` (see study.lua) are relative ----

local columns = { "topic", "problem", "quantity", "unit", "reference", "value", "error", "uncertainty", "tolerance", "order_space",
  "order_time", "evaluations", "seconds", "verdict", "source" }

local function field(value)
  if type(value) == "number" then return ("%.17g"):format(value) end
  return '"' .. (value or ""):gsub('"', '""') .. '"'
end

local function csv(list)
  local rows = { table.concat(columns, ",") }
  for _, problem in ipairs(list) do
    for _, found in ipairs(problem.found) do
      local q = found.quantity
      local fields = { problem.topic, problem.name, q.name, q.unit or "", q.reference, found.value, found.error, found.uncertainty or "",
        found.tolerance, lines.order_text(found.space) or "", lines.order_text(found.time) or "",
        problem.cost.evaluations, problem.cost.seconds, #found.faults == 0 and "ok" or "wrong", q.source }
      for k, value in ipairs(fields) do fields[k] = field(value) end
      rows[#rows + 1] = table.concat(fields, ",")
    end
  end
  return table.concat(rows, "\n") .. "\n"
end

-- ---- figures ----

local function draw(topic, out)
  if #topic.panels == 0 then return true end
  local rows = panels.rows(#topic.panels)
  local path = ("%s/%s"):format(out, topic.name)
  local fine, why = files.write(path .. ".dat", panels.data(topic.panels))
  if fine then
    fine, why = files.write(path .. ".gp", ("load '%s.dat'\n"):format(topic.name)
      .. panels.script(topic.panels, 1, #topic.panels, rows, topic.name))
  end
  if not fine then return nil, why end
  local script = {}
  for _, kind in ipairs { "pngcairo", "svg" } do
    script[#script + 1] = ("set terminal %s size 1400,%d font 'Sans,9' background rgb 'white'\nset output '%s.%s'\nload '%s.gp'")
      :format(kind, 40 + 380 * rows, topic.name, kind == "svg" and "svg" or "png", topic.name)
  end
  why = plot.gnuplot(out, table.concat(script, "\n"))
  return why == nil, why
end

-- Writes all into the folder o.out; nil and the reason: it cannot.
function page.write(list, o)
  local made, refused = files.make_folder(o.out)
  if not made then return nil, refused end
  local topics = topics_of(list)
  local fine, why = files.write(o.out .. "/validate.md", markdown(topics, o))
  if fine then fine, why = files.write(o.out .. "/validate.csv", csv(list)) end
  for _, topic in ipairs(topics) do
    if fine then fine, why = draw(topic, o.out) end
  end
  if fine then fine, why = pdf.write(topics, o, page.sources, introduction(o)) end
  return fine, why
end

return page
