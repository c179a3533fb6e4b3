-- Damages a file: bits, bytes, words, numbers, lines.
local bytes = {}

local function pick(list) return list[math.random(#list)] end

local numbers = { "nan", "-nan", "inf", "-inf", "1e308", "1e309", "-1e999", "5e-324", "0", "-0", "-1", "1", "2", "4294967295",
  "4294967296",
  "18446744073709551616", "9223372036854775807", "-9223372036854775808", "0x10", "1e", "1.5", ".", "+", "", " ", "1 2", "1,2",
    "\0",
  "0.25", "3", "1e-7", "-2.5", ("9"):rep(400), ("1"):rep(5000) }

-- As 8 bytes of a binary file.
local words = { 0, 1, 2, 3, 7, -1, 0x7fffffff, 0x80000000, 0xffffffff, 0x100000000, math.maxinteger, math.mininteger, 1 << 40,
  1 << 60 }
local doubles = { 0 / 0, 1 / 0, -1 / 0, 0.0, -0.0, -1.0, 1e308, -1e308, 5e-324, 1e-9, 0.5, 1.0, 1e18 }

-- Replaces the bytes from `from` to `to`.
local function cut(text, from, to, by) return text:sub(1, from - 1) .. by .. text:sub(to + 1) end

local function place_in(text) return math.random(1, math.max(1, #text)) end

local damage = {}

function damage.bit(text)
  local at = place_in(text)
  return cut(text, at, at, string.char((text:byte(at) or 0) ~ (1 << math.random(0, 7))))
end

function damage.byte(text)
  local at = place_in(text)
  return cut(text, at, at, string.char(math.random(0, 255)))
end

function damage.insert(text)
  local at = place_in(text)
  return cut(text, at, at - 1, pick { "\0", "\n", "\r", ",", " ", "-", "\xff", "#", ("x"):rep(math.random(1, 9000)) })
end

function damage.truncate(text) return text:sub(1, math.random(0, #text)) end

function damage.remove(text)
  local at = place_in(text)
  return cut(text, at, at + math.random(0, 40), "")
end

function damage.twice(text)
  local at = place_in(text)
  local piece = text:sub(at, at + math.random(0, 60))
  return cut(text, at, at - 1, piece:rep(math.random(1, 4)))
end

-- Replaces one of the numbers in a text.
function damage.number(text)
  local spans = {}
  for from, to in text:gmatch("()[-+.%w]+()") do
    spans[#spans + 1] = { from, to - 1 }
  end
  local span = #spans > 0 and pick(spans)
  return span and cut(text, span[1], span[2], pick(numbers)) or text
end

function damage.lines(text)
  local list = {}
  for line in text:gmatch("[^\n]*\n?") do list[#list + 1] = line end
  local k, j = math.random(#list), math.random(#list)
  local how = math.random(3)
  if how == 1 then list[k], list[j] = list[j], list[k]
  elseif how == 2 then list[k] = list[k]:rep(math.random(2, 5))
  else list[k] = list[j] end
  return table.concat(list)
end

-- Replaces one aligned word of a binary file.
function damage.word(text)
  local count = #text // 8
  local at = 8 * math.random(0, math.max(0, count - 1)) + 1
  local by = math.random(2) == 1 and string.pack("<i8", pick(words)) or string.pack("<d", pick(doubles))
  return cut(text, at, at + 7, by)
end

function damage.half(text)
  local at = 4 * math.random(0, math.max(0, #text // 4 - 1)) + 1
  return cut(text, at, at + 3, string.pack("<I4", pick(words) & 0xffffffff))
end

local of_text = { "bit", "byte", "insert", "truncate", "remove", "twice", "number", "number", "number", "lines", "lines" }
local of_binary = { "bit", "byte", "word", "word", "word", "word", "half", "half", "truncate", "remove", "twice" }

local function damaged(text, ways)
  for _ = 1, pick { 1, 1, 1, 2, 3 } do text = damage[pick(ways)](text) end
  return text
end

function bytes.text(text) return damaged(text, of_text) end
function bytes.binary(text) return damaged(text, of_binary) end

return bytes
