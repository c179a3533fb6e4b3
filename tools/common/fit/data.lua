-- Measured data: a table of comma-separated values whose first line names the columns: `t`, in s; names of measures of the
-- scene; and with "_sd" behind such a name the standard deviations of its numbers. A unit between brackets behind a name, as
-- in "sag [m]", has to be that of the scene. Empty cells are gaps, lines that begin with # are remarks, and a mark of the order
-- of bytes before the first is none of its text.
local units = require("common.run.units")

local data = {}

local function split(line)
  local cells = {}
  for cell in (line .. ","):gmatch("([^,]*),") do cells[#cells + 1] = cell:match("^%s*\"?(.-)\"?%s*$") end
  return cells
end

local function is_finite(x) return x ~= nil and x - x == 0 end

-- Takes units off the names of columns; nil and what is wrong: one is not the scene's.
local function without_units(cells, known, said)
  for k, cell in ipairs(cells) do
    local name, unit = units.of_heading(cell)
    local of = name:gsub("_sd$", "")
    local own = name == "t" and "s" or said[of]
    if unit and not own and known[of] then
      return nil, ("the column '%s' has a unit, and the scene says none of '%s': leave it out, or give the measure "
        .. "{ unit = \"%s\" }"):format(cell, of, unit)
    end
    if unit and own and unit ~= own then
      return nil, ("the column '%s' is in %s, and the scene has %s in %s: convert it"):format(cell, unit, name, own)
    end
    if own or name == "t" then cells[k] = name end
  end
  return true
end

-- The number in a cell; nil: it is empty. Or false and what is wrong.
function data.number(name, cell)
  local x = tonumber(cell)
  if cell == "" then return nil end
  if is_finite(x) then return x end
  return false, ("%s: '%s' is not a finite number: the cell of a gap stays empty"):format(name, cell)
end

-- Whether there are as many cells as columns; or nil and what is wrong.
function data.fills(cells, columns)
  if #cells == #columns then return true end
  return nil, ("%d numbers, and %d columns: the cell of a gap stays empty between its commas"):format(#cells, #columns)
end

-- What each column holds: { time = true }, { measure = name } or { sd = name }; or nil and what is wrong.
local function columns_of(cells, known)
  local columns, found, list = {}, {}, {}
  for name in pairs(known) do list[#list + 1] = name end
  table.sort(list)
  for k, cell in ipairs(cells) do
    local of = cell:match("^(.+)_sd$")
    if found[cell] then return nil, ("the column '%s' is there twice"):format(cell) end
    found[cell] = true
    if cell == "t" then columns[k] = { time = true }
    elseif known[cell] then columns[k] = { measure = cell }
    elseif of and known[of] then columns[k] = { sd = of }
    elseif #cells == 1 and cell:find("[;\t]") then
      return nil, ("the columns are apart by %s: put commas between them, and points into numbers"):format(
        cell:find(";", 1, true) and "semicolons" or "tabulators")
    else
      local near = hooke.nearest(cell, list)
      return nil, ("the column '%s' is no measure of the scene; %s"):format(cell, near and ("did you mean '%s'?"):format(near)
        or #list > 0 and "it has " .. table.concat(list, ", ") .. ", and a column t is the time, s"
        or "it has none: scene:measure(name, function)")
    end
  end
  if not found.t then return nil, "there is no column 't', the time in s" end
  for _, column in ipairs(columns) do
    if column.sd and not found[column.sd] then return nil, ("'%s_sd' is there, '%s' is not"):format(column.sd, column.sd) end
  end
  return columns
end

-- Adds the observations of one line; or nil and what is wrong.
local function read_line(cells, columns, names, duration, list, number)
  local value = {}
  local filled, few = data.fills(cells, columns)
  if not filled then return nil, few end
  for k, cell in ipairs(cells) do
    local x, wrong = data.number(names[k], cell)
    if x == false then return nil, wrong end
    if columns[k].time and not x then return nil, "the time is missing: give it, or leave the line out" end
    if columns[k].sd and x and x <= 0 then
      return nil, ("%s: '%s' is not positive: give a standard deviation, or leave the column out"):format(names[k], cell)
    end
    value[names[k]] = x
  end
  if value.t < 0 or value.t > duration then
    return nil, ("t = %g s is outside of the run, 0 to %g s: leave the line out, or give the scene another duration"):format(value.t,
      duration)
  end
  for k, column in ipairs(columns) do
    local y = column.measure and value[names[k]]
    if y then list[#list + 1] = { t = value.t, name = names[k], value = y, sd = value[names[k] .. "_sd"], line = number } end
  end
  return true
end

-- The lines of a table: begin(cells) is told the first, add(cells, number) the others, and each says true, or nil and what is wrong.
-- Returns true; or nil and a sentence that begins with the file and its line.
function data.lines(path, begin, add)
  local file, why = io.open(path)
  if not file then return nil, ("cannot read %s"):format(why) end
  if not file:read(0) and file:seek("end") ~= 0 then
    file:close()
    return nil, ("cannot read %s: it is no file of text, but perhaps a folder"):format(path)
  end
  file:seek("set")
  local begun, number, fine, wrong = false, 0, true, nil
  for line in file:lines() do
    number = number + 1
    if number == 1 then line = line:gsub("^\xEF\xBB\xBF", "") end
    line = line:gsub("\r$", "")
    if line ~= "" and line:sub(1, 1) ~= "#" then
      if begun then fine, wrong = add(split(line), number) else fine, wrong = begin(split(line)) end
      begun = true
      if not fine then break end
    end
  end
  file:close()
  if not fine then return nil, ("%s:%d: %s"):format(path, number, wrong) end
  return true
end

-- known: { name = true } of the scene's measures; duration: of its run, s. Returns the observations { t, name, value, sd,
-- line } by their times, or nil and a sentence that begins with the file and its line. said: units of measures, { name = unit }.
function data.read(path, known, duration, said)
  local names, columns, list = nil, nil, {}
  local fine, why = data.lines(path, function(cells)
    local same, wrong = without_units(cells, known, said or {})
    names = cells
    if same then columns, wrong = columns_of(cells, known) end
    return columns, wrong
  end, function(cells, number) return read_line(cells, columns, names, duration, list, number) end)
  if not fine then return nil, why end
  if #list == 0 then return nil, ("%s: there is no number of a measure in it"):format(path) end
  table.sort(list, function(a, b) return a.t < b.t or a.t == b.t and a.line < b.line end)
  return list
end

return data
