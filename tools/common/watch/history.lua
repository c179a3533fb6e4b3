-- What a run has shown so far, as documents of the server. Of run r:
--
--     run/r            the run's data: title, fps, origin, fields, measures, units, marks, groups (JSON)
--     solids/r         S as it came: what particles bounce off
--     topology/r/k     T as it came, number k; frame/r/k: F as it came, frame k
--     numbers/r/c      the N of frames 512 c to 512 c + 511, one after the other (double)
--
-- Where frames take more than MEMORY every second one is dropped, and of those to come as many are left out, so that
-- what is kept is spread evenly; the latest is always there. Numbers are kept of all.
local messages = require("common.watch.messages")
local json_text = require("common.view.json_text")
local shared = require("common.view.shared")

local history = {}
history.__index = history

local MEMORY = 256 << 20 -- bytes
local CHUNK = 512
local BINARY, JSON = "application/octet-stream", "application/json"

function history.new(server, number, title)
  return setmetatable({ server = server, number = number, title = title, frames = 0, stride = 1, size = 0, kept = {},
    chunk = {}, latest = -1, topologies = 0, before = 0, told = {} }, history)
end

local function name_of(self, kind, k) return ("%s/%d/%d"):format(kind, self.number, k) end

local function begin(self, body)
  self.told.R = body
  local run = messages.run(body)
  local fields = json_text.list()
  for k, f in ipairs(run.fields) do fields[k] = shared.field(f) end
  self.server:put(("run/%d"):format(self.number), JSON, json_text.encode({ title = self.title, fps = run.fps,
    origin = json_text.list(run.origin), fields = fields, measures = json_text.list(run.measures), units = json_text.list(run.units),
    marks = json_text.list(run.marks), groups = json_text.list(run.groups) }))
end

local function forget(self, k)
  if not self.kept[k] then return end
  self.server:drop(name_of(self, "frame", k))
  self.size, self.kept[k] = self.size - self.kept[k], nil
end

local function thin(self)
  self.stride = 2 * self.stride
  for k in pairs(self.kept) do
    if k % self.stride ~= 0 then forget(self, k) end
  end
end

local function keep(self, body)
  local k = messages.frame(body)
  if self.latest % self.stride ~= 0 then forget(self, self.latest) end
  self.server:put(name_of(self, "frame", k), BINARY, body)
  self.kept[k], self.latest, self.size = #body, k, self.size + #body
  while self.size > MEMORY and next(self.kept, next(self.kept)) do thin(self) end
end

-- Numbers of a chunk that is not full are put when somebody may look: see `publish`.
local function note(self, body)
  self.chunk[#self.chunk + 1] = body
  self.frames, self.unpublished = self.frames + 1, true
  if #self.chunk == CHUNK then
    self:publish()
    self.chunk = {}
  end
end

function history:publish()
  if not self.unpublished then return end
  self.server:put(name_of(self, "numbers", (self.frames - 1) // CHUNK), BINARY, table.concat(self.chunk))
  self.unpublished = false
end

local heard = {
  R = begin,
  T = function(self, body)
    self.topologies = self.before + string.unpack("<I4", body)
    self.server:put(name_of(self, "topology", self.topologies), BINARY, string.pack("<I4", self.topologies) .. body:sub(5))
  end,
  S = function(self, body)
    self.told.S = body
    self.server:put(("solids/%d"):format(self.number), BINARY, body)
  end,
  N = note,
  F = function(self, body)
    if self.before > 0 then
      local k, topology = string.unpack("<I4I4", body)
      body = string.pack("<I4I4", k, self.before + topology) .. body:sub(9)
    end
    keep(self, body)
  end,
}

function history:hear(letter, body)
  local what = heard[letter]
  if what then what(self, body) end
end

-- Another process goes on with the run: it tells anew what there is, and counts its topologies anew.
function history:go_on() self.before = self.topologies end

-- The origin of its positions, m.
function history:origin() return messages.run(self.told.R).origin end

-- Whether R or S, as a process that goes on tells it, is what the page has.
function history:has(letter, body) return self.told[letter] == body end

-- The run is shown no more.
function history:drop()
  for k in pairs(self.kept) do forget(self, k) end
  for k = 1, self.topologies do self.server:drop(name_of(self, "topology", k)) end
  for c = 0, self.frames // CHUNK do self.server:drop(name_of(self, "numbers", c)) end
  self.server:drop(("solids/%d"):format(self.number))
  self.server:drop(("run/%d"):format(self.number))
end

-- The frames of which `frame` documents exist: multiples of stride, and the latest.
function history:known()
  return { frames = self.frames, stride = self.stride, latest = self.latest }
end

return history
