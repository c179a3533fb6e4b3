-- The report of a check: one line for each property that was tried, and below one that does not hold where that was
-- seen and what to do. A property is tried in a process of its own (isolate.lua); one that ends the process, prints, or
-- finds nothing to look at does not hold either.
local isolate = require("common.check.isolate")

local report = {}
report.__index = report

local MOST_ENDS = 3 -- properties that end the process, after which the others are not tried

-- seconds: of each scene of a property at most; only: a part of the names of those that are tried, nil: all are.
function report.new(seconds, only)
  return setmetatable({ lines = 0, failed = 0, ends = 0, tried = 0, seconds = seconds, only = only }, report)
end

local function text_of(x) return type(x) == "number" and ("%.2g"):format(x) or x end

-- Prints a line { fine, property, figure, bound, where, remedy }: figure and bound are numbers, texts or nil, `where`
-- the scene and the particle, `remedy` what to do when it is wrong.
function report:print(line)
  self.lines = self.lines + 1
  if not line.fine then self.failed = self.failed + 1 end
  print(("  %-5s %-60s %s%s"):format(line.fine and "ok" or "WRONG", line.property, text_of(line.figure) or "",
    line.bound and (" (at most %s)"):format(text_of(line.bound)) or ""))
  if line.fine then return end
  if line.where then print("        seen in: " .. line.where) end
  if line.remedy then print("        remedy:  " .. line.remedy) end
end

function report.note(_, text) print("  -     " .. text) end

-- What a property's body gets: at(place), and lines for the report.
local lines = {}
lines.__index = lines

function lines:at(place, ...)
  self.place = select("#", ...) > 0 and place:format(...) or place
  self.teller.at(self.place)
end

-- Adds one property. `where` left out: the present place; false: none.
function lines:add(fine, property, figure, bound, remedy, where)
  self.count = self.count + 1
  if where == nil then where = self.place end
  self.teller.tell { fine = fine and true or false, property = property, figure = figure, bound = bound,
    remedy = remedy, where = where or nil }
end

-- Adds a property that is a number, which must not be above its bound.
function lines:most(property, figure, bound, remedy, where)
  self:add(figure <= bound, property, figure, bound, remedy, where) -- false for NaN
end

function lines:wrong(property, remedy, where) self:add(false, property, nil, nil, remedy, where) end

-- Plain data for whoever tries the property, who gets a list of them.
function lines:value(value) self.teller.tell { value = value } end

function lines:note(text) self.teller.tell { note = text } end

-- The first of what is tried of every plugin; the others need it.
local always = { ["it is loaded"] = true, ["it starts"] = true }

-- Tries body(lines) in a process of its own. `name` is the property, which is added as fine when the body came to its
-- end and added nothing; nil: nothing is added then. Returns false when the process did not come to its end, and the list
-- of values that the body handed out. report.before(lines), where it is set, is called in front of each body.
function report:try(name, body, seconds)
  local added, values = name and 0 or 1, {}
  local left_out = self.only and name and not always[name] and not name:find(self.only, 1, true)
  if self.stopped or left_out then return false, values end
  if not always[name] then self.tried = self.tried + 1 end
  name = name or "a second try"
  local ended, place, printed, complaint, late = isolate.run(seconds or self.seconds, function(teller, fd)
    local own = setmetatable({ teller = teller, count = 0, fd = fd }, lines)
    if self.before then self.before(own) end
    body(own)
  end, function(found)
    if found.note then return self:note(found.note) end
    if found.value ~= nil then values[#values + 1] = found.value return end
    added = added + 1
    if not found.failed then return self:print(found) end
    -- Where the traceback of a refusal is in, it is that of the check itself.
    self:print { property = name .. ": could not be tried", where = found.failed:gsub("\n+stack traceback.*", ""),
      remedy = "if the plugin refused its parameters, give others by name=value or a scene by --scene FILE" }
  end)
  if ended then
    self:print { property = ("%s: %s"):format(name, ended), where = place, remedy = complaint and
      ("it said: " .. complaint) or "run the scene that is named in a debugger (gdb --args hooke run ...)" }
    self.ends = self.ends + 1
  elseif complaint then
    self:print { property = name .. ": it prints on standard error: " .. complaint, where = place,
      remedy = "use host->warn, or host->fail with the status that is returned" }
  elseif added == 0 then
    self:print { fine = true, property = name }
  end
  if printed then
    self:print { property = name .. ": it prints on standard output: " .. printed, where = place,
      remedy = "print nothing: use host->warn, or host->fail with the status that is returned" }
  end
  if late or self.ends >= MOST_ENDS then
    self.stopped = true
    self:note("the other properties are not tried: they would end alike")
  end
  return not ended, values
end

return report
