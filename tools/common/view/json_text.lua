-- JSON that may stand in a page's script element: "<" is written as \u003c, so that no text ends the element. A list is
-- marked as one, so that an empty one is; a number that is not finite is null.
local json_text = {}

local lists, raws = {}, {}

function json_text.list(t) return setmetatable(t or {}, lists) end

-- A text that is JSON already.
function json_text.raw(text) return setmetatable({ text = text }, raws) end

local function escape(c) return ("\\u%04x"):format(c:byte()) end

local function harmless(text) return (text:gsub("[<>&]", escape):gsub("\u{2028}", "\\u2028"):gsub("\u{2029}", "\\u2029")) end

local function text_of(s)
  s = utf8.len(s) and s or s:gsub("[\128-\255]", "?")
  return '"' .. harmless((s:gsub('[%c"\\]', escape))) .. '"'
end

local function number_of(x)
  if x ~= x or x == math.huge or x == -math.huge then return "null" end
  return math.type(x) == "integer" and tostring(x) or ("%.10g"):format(x)
end

local put

local function put_list(t, out)
  out[#out + 1] = "["
  for k = 1, #t do
    if k > 1 then out[#out + 1] = "," end
    put(t[k], out)
  end
  out[#out + 1] = "]"
end

local function put_object(t, out)
  local keys = {}
  for key in pairs(t) do keys[#keys + 1] = key end
  table.sort(keys)
  out[#out + 1] = "{"
  for k, key in ipairs(keys) do
    out[#out + 1] = (k > 1 and "," or "") .. text_of(key) .. ":"
    put(t[key], out)
  end
  out[#out + 1] = "}"
end

function put(value, out)
  local kind, mark = type(value), getmetatable(value)
  if kind == "string" then out[#out + 1] = text_of(value)
  elseif kind == "number" then out[#out + 1] = number_of(value)
  elseif kind == "boolean" then out[#out + 1] = tostring(value)
  elseif mark == raws then out[#out + 1] = harmless(value.text)
  elseif mark == lists then put_list(value, out)
  elseif kind == "table" then put_object(value, out)
  else out[#out + 1] = "null" end
end

function json_text.encode(value)
  local out = {}
  put(value, out)
  return table.concat(out)
end

return json_text
