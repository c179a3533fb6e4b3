-- Messages of a run that is watched (plugins/common/live/messages.h), from a pipe: whole ones, however it cuts them.
local messages = {}
messages.__index = messages

local MOST = 1 << 30 -- bytes of one: a frame of 20 million particles; what is longer is no message of ours

function messages.new()
  return setmetatable({ parts = {}, size = 0, wanted = 8 }, messages)
end

-- What has come, in one piece, when it is enough for what is wanted; else nil.
local function whole(self)
  if self.size < self.wanted then return nil end
  local text = table.concat(self.parts)
  self.parts = { text }
  return text
end

-- Adds bytes; calls heard(letter, body) for each message that is whole now. nil and the reason when they are none.
function messages:add(bytes, heard)
  self.parts[#self.parts + 1] = bytes
  self.size = self.size + #bytes
  local text, at = whole(self), 1
  while text and #text - at + 1 >= 8 do
    local letter, length = string.unpack("<I4I4", text, at)
    if letter > 127 or length > MOST then return nil, "the run says what is no message" end
    self.wanted = 8 + length
    if #text - at + 1 < self.wanted then break end
    heard(string.char(letter), text:sub(at + 8, at + 7 + length))
    at, self.wanted = at + self.wanted, 8
  end
  if text and at > 1 then self.parts, self.size = { text:sub(at) }, #text - at + 1 end
  return true
end

-- R as a table: fps, origin, fields { name, kind, components }, measures, their units ("": not said), marks { name, kind },
-- groups (names).
function messages.run(body)
  local run = { origin = { 0, 0, 0 }, fields = {}, measures = {}, units = {}, marks = {}, groups = {} }
  for line in body:gmatch("[^\n]+") do
    local key, value, more, kind = line:match("^([^\t]*)\t([^\t]*)\t?([^\t]*)\t?([^\t]*)")
    if key == "fps" then run.fps = tonumber(value)
    elseif key == "x" or key == "y" or key == "z" then run.origin[key:byte() - 119] = tonumber(value)
    elseif key == "field" then table.insert(run.fields, { name = value, components = tonumber(more), kind = kind })
    elseif key == "mark" then table.insert(run.marks, { name = value, kind = more })
    elseif key == "group" then table.insert(run.groups, value)
    elseif key == "measure" then
      table.insert(run.measures, value)
      table.insert(run.units, more)
    end
  end
  return run
end

-- Frame number, topology and number of particles of F.
function messages.frame(body)
  return string.unpack("<I4I4I4", body)
end

-- Whether the run stands still, from D. (K is a path.)
function messages.stopped(body)
  return string.unpack("<I4", body) == 1
end

return messages
