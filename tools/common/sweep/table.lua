-- Results of a sweep as rows: a printed table, and CSV (RFC 4180, numbers with 17 digits).
local csv = require("common.run.csv")
local files = require("common.run.file")
local store = require("common.sweep.store")
local units = require("common.run.units")

local rows = {}

-- The value of a case's setting or result `name`: a measure, a figure of the summary, or a setting; nil: not known.
function rows.value(case, name)
  local result = case.result or { measures = {} }
  local value = result.measures[name]
  if value == nil and name ~= "dt" and name ~= "tol" then value = result[name] end
  if value == nil or case.values[name] ~= nil and result.measures[name] == nil then value = case.values[name] end
  return value
end

local own_units = { dt = "s" }
for _, column in ipairs(store.reported) do own_units[column[1]] = column.unit end

-- The unit of a measure, a parameter or a figure of the summary; nil: it is not said, or not the same in all cases.
function rows.unit(the, name)
  local found
  for _, case in ipairs(the.cases) do
    local result = case.result
    local unit = result and result.units and result.units[name]
    if unit and found and unit ~= found or result and not unit and result.measures[name] ~= nil then return nil end
    found = found or unit
  end
  return found or own_units[name]
end

function rows.label(the, name) return units.label(name, rows.unit(the, name)) end

local function sorted(set)
  local list = {}
  for name in pairs(set) do list[#list + 1] = name end
  table.sort(list)
  return list
end

-- The scenes' measures: those asked for, or all in the results.
function rows.measures(the)
  if the.definition.measures then return the.definition.measures end
  local met = {}
  for _, case in ipairs(the.cases) do
    for name in pairs(case.result and case.result.measures or {}) do met[name] = true end
  end
  return sorted(met)
end

local function settings(the)
  local list, seen = {}, {}
  local function add(name)
    if not seen[name] then list[#list + 1] = name end
    seen[name] = true
  end
  for _, axis in ipairs(the.axes) do add(axis.name) end
  for _, case in ipairs(the.cases) do
    if case.dt then add("dt") end
    if case.tol then add("tol") end
  end
  return list, seen
end

-- { heading =, of = function(case) } in order.
local function columns_of(the)
  local list = { { heading = "case", of = function(case) return case.number end } }
  local names, seen = settings(the)
  local function add(heading, of)
    if seen[heading] and heading ~= "case" and of ~= nil then heading = "result " .. heading end
    list[#list + 1] = { heading = heading, of = of }
  end
  for _, name in ipairs(names) do
    list[#list + 1] = { heading = name, of = function(case) return case.values[name] or case[name] end }
  end
  local ran = {}
  for _, name in ipairs { "verdict", "reason" } do ran[#ran + 1] = name end
  if not seen.integrator then table.insert(ran, 1, "integrator") end
  for _, column in ipairs(store.reported) do ran[#ran + 1] = column[1] end
  for _, name in ipairs(ran) do add(name, function(case) return case.result[name] end) end
  for _, name in ipairs(ran) do seen[name] = true end
  for _, name in ipairs(rows.measures(the)) do
    if not seen[name] or the.definition.measures == nil then
      add(units.heading(name, rows.unit(the, name)), function(case) return case.result.measures[name] end)
    end
  end
  return list
end

local function cell(value) return value == value and csv.cell(value) or "" end

function rows.write_csv(the, path)
  local columns, lines, line = columns_of(the), {}, {}
  for k, column in ipairs(columns) do line[k] = cell(column.heading) end
  lines[1] = table.concat(line, ",")
  for _, case in ipairs(the.cases) do
    for k, column in ipairs(columns) do line[k] = case.result and cell(column.of(case)) or "" end
    if case.result then lines[#lines + 1] = table.concat(line, ",") end
  end
  store.make_folder(path)
  return files.write(path, table.concat(lines, "\n") .. "\n")
end

-- ---- printed table ----

local function short(value)
  if value == nil then return "-" end
  return math.type(value) == "float" and ("%.4g"):format(value) or hooke.plain(tostring(value), true)
end

local most = 40

function rows.show(the)
  local names = {}
  for _, name in ipairs(the.varying) do names[#names + 1] = name end
  names[#names + 1] = "verdict"
  for _, name in ipairs(the.definition.measures or { "steps", "step_wall_s", table.unpack(rows.measures(the)) }) do
    names[#names + 1] = name
  end
  local lines, width = { {} }, {}
  for k, name in ipairs(names) do lines[1][k] = hooke.plain(own_units[name] and name or units.heading(name, rows.unit(the, name)), true) end
  for _, case in ipairs(the.cases) do
    local line = {}
    for k, name in ipairs(names) do line[k] = case.result and short(rows.value(case, name)) or "" end
    if case.result and #lines <= most then lines[#lines + 1] = line end
  end
  for _, line in ipairs(lines) do
    for k = 1, #names do width[k] = math.max(width[k] or 0, utf8.len(line[k]) or #line[k]) end
  end
  for _, line in ipairs(lines) do
    for k = 1, #names do line[k] = line[k] .. (" "):rep(width[k] - (utf8.len(line[k]) or #line[k])) end
    print(("  " .. table.concat(line, "  ")):match("^(.-)%s*$"))
  end
  if #the.cases > most then print(("  ... %d cases; --csv FILE writes them all"):format(#the.cases)) end
end

-- "34 ok, 2 diverged, 1 crashed", and a line for the first case of each other verdict than ok.
function rows.count(the)
  local counts, first = {}, {}
  for _, case in ipairs(the.cases) do
    local verdict = case.result and case.result.verdict or "not done"
    counts[verdict] = (counts[verdict] or 0) + 1
    first[verdict] = first[verdict] or case
  end
  local parts, notes = {}, {}
  for _, verdict in ipairs(sorted(counts)) do
    parts[#parts + 1] = ("%d %s"):format(counts[verdict], verdict)
    local reason = verdict ~= "ok" and first[verdict].result and first[verdict].result.reason
    if reason then notes[#notes + 1] = ("%s, case %d: %s"):format(verdict, first[verdict].number, reason) end
  end
  return table.concat(parts, ", "), notes
end

return rows
