-- What is said of one plugin, from its own table of parameters: for `hooke plugins`, `hooke help` and the handbook.
local plugin_entry = {}

local lists = { particles = true, edges = true, triangles = true, tetrahedra = true, numbers = true }

local function choice(p)
  local k = 0
  for word in p.text:gmatch("[^|]+") do
    if k == p.initial[1] then return word end
    k = k + 1
  end
end

-- The default of a parameter, as a text.
function plugin_entry.default(p)
  if p.required then return "required" end
  if p.optional or p.type == "function" then return "-" end
  if p.type == "vector" then return ("{%g, %g, %g}"):format(p.initial[1], p.initial[2], p.initial[3]) end
  if p.type == "string" then return p.text ~= "" and p.text or "-" end
  if p.type == "boolean" then return tostring(p.initial[1] ~= 0) end
  if p.type == "choice" then return choice(p) or "-" end
  if lists[p.type] then return "{}" end
  return ("%g"):format(p.initial[1])
end

-- Its range, or what a choice or a function is written like; and whether it may be a function of t.
function plugin_entry.range(p)
  local text = (p.type == "choice" or p.type == "function") and p.text or ""
  if p.min then
    local open = p.max <= p.min or p.max == math.huge
    text = open and (">= %g"):format(p.min) or ("%g to %g"):format(p.min, p.max)
  end
  return text .. (p.timed and (text ~= "" and "; " or "") .. "may be a function of t" or "")
end

-- What a method is, in one line; nil: it is none.
local function order(plugin)
  if not plugin.order then return end
  return ("%d, %d evaluations of f a step%s%s%s"):format(plugin.order, plugin.stages, plugin.symplectic and ", symplectic" or "",
    plugin.adaptive and ", adaptive" or "", plugin.implicit and ", implicit" or "")
end

-- What is known beside its parameters, a list of {word, text}.
function plugin_entry.facts(plugin)
  local facts = {}
  local function add(word, text) facts[#facts + 1] = text and text ~= "" and { word, text } or nil end
  add("source", plugin.reference)
  add("order", order(plugin))
  add("facets", plugin.facets)
  add("box", plugin.periodic and "right in a periodic box, scene:periodic")
  return facts
end

-- The entry as lines of text.
function plugin_entry.lines(plugin)
  local lines = { ("%s '%s': %s"):format(plugin.kind, plugin.name, plugin.summary) }
  local function add(format, ...) lines[#lines + 1] = format:format(...) end
  for _, fact in ipairs(plugin_entry.facts(plugin)) do add("  %-11s %s", fact[1], fact[2]) end
  add("  file        %s", plugin.path)
  for _, p in ipairs(plugin.params) do
    add("  %-11s %-12s %-9s default %-14s %s", p.name, p.unit, p.type, plugin_entry.default(p), p.help)
    local range = plugin_entry.range(p)
    if range ~= "" then add("  %-11s %s", "", range) end
  end
  if plugin.kind == "force" then add("  every force also takes label, only (ids) or group, from and to (s)") end
  return lines
end

return plugin_entry
