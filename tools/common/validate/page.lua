-- The page of `hooke validate`: Markdown, CSV, and a figure for every problem with all its lines of convergence.
local files = require("common.run.file")
local lines = require("common.validate.lines")
local plot = require("common.run.plot")

local page = {}

local function folder_made(path)
  return os.execute("mkdir -p '" .. path:gsub("'", "'\\''") .. "'")
end

-- Errors of the values against the reference, or against the extrapolated value where the other axis's error hides it.
local function curves_of(problem, axis)
  local curves = {}
  for _, found in ipairs(problem.found) do
    local c, points = found[axis], {}
    local limit = (found.space and found.time) and c.value or found.quantity.reference
    for k, h in ipairs(c and c.h or {}) do
      local off = math.abs(c.v[k] - limit) / found.quantity.scale
      if off > 0 then points[#points + 1] = { h, off } end
    end
    if #points > 0 then
      curves[#curves + 1] = { points = points, title = ("%s (order %s)"):format(found.quantity.name,
        lines.order_text(c)) }
    end
  end
  return curves
end

local function draw(problem, out)
  for _, axis in ipairs { "space", "time" } do
    local curves = problem.levels[axis] and curves_of(problem, axis) or {}
    if #curves > 0 then
      local fine, why = plot.draw(("%s/%s-%s-%s"):format(out, problem.topic, problem.name, axis), {
        title = problem.description.title, curves = curves, width = 900, height = 540,
        x = { label = axis == "space" and "1/n" or "step, s", log = true }, y = { label = "relative error", log = true } })
      if not fine then return nil, why end
      problem.figures = problem.figures or {}
      table.insert(problem.figures, ("%s-%s-%s.png"):format(problem.topic, problem.name, axis))
    end
  end
  return true
end

local function cell(text) return (tostring(text):gsub("|", "\\|"):gsub("%s+", " ")) end

local function row(problem, found)
  local q = found.quantity
  return ("| %s | %s | %.12g%s | %s | %.1f | %s | %s | %s | %s%s |"):format(cell(problem.name), cell(q.name), q.reference,
    q.unit and " " .. q.unit or "", lines.value_text(found), found.digits, lines.order_text(found.space) or "",
    lines.order_text(found.time) or "", lines.count(problem.cost.evaluations), cell(q.source),
    #found.faults > 0 and " **wrong**" or "")
end

local head = "| problem | quantity | reference | hooke | digits | order in space | in time | evaluations | source |\n"
  .. "|---|---|---|---|---|---|---|---|---|"

local function markdown(list)
  local text, topic = { "# Validation of hooke", "" }, nil
  for _, problem in ipairs(list) do
    if problem.topic ~= topic then
      topic = problem.topic
      text[#text + 1] = ("\n## %s\n\n%s"):format(topic, head)
    end
    for _, found in ipairs(problem.found) do text[#text + 1] = row(problem, found) end
    if problem.failed then text[#text + 1] = ("| %s | %s | | | | | | | **failed** |"):format(problem.name, cell(problem.failed)) end
  end
  return table.concat(text, "\n") .. "\n"
end

local columns = { "topic", "problem", "quantity", "unit", "reference", "value", "error", "tolerance", "order_space",
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
      local fields = { problem.topic, problem.name, q.name, q.unit or "", q.reference, found.value, found.error,
        found.tolerance, lines.order_text(found.space) or "", lines.order_text(found.time) or "",
        problem.cost.evaluations, problem.cost.seconds, #found.faults == 0 and "ok" or "wrong", q.source }
      for k, value in ipairs(fields) do fields[k] = field(value) end
      rows[#rows + 1] = table.concat(fields, ",")
    end
  end
  return table.concat(rows, "\n") .. "\n"
end

function page.write(list, o)
  if not folder_made(o.out) then return nil, ("the folder %s cannot be made"):format(o.out) end
  for _, problem in ipairs(list) do
    if not problem.failed then
      local fine, why = draw(problem, o.out)
      if not fine then return nil, why end
    end
  end
  local fine, why = files.write(o.out .. "/validate.md", markdown(list))
  if fine then fine, why = files.write(o.out .. "/validate.csv", csv(list)) end
  return fine, why
end

return page
