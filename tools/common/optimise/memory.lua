-- The evaluations of an optimisation on file, so that one that was interrupted goes on where it was: a search takes the same way
-- again, and what it has asked for is there. Numbers are texts that give the same bits.
local journal = require("common.bench.journal")

local memory = {}
memory.__index = memory

-- At `path`, for all that the results depend on; or nil and why it cannot be written.
function memory.open(path, fingerprint)
  local kept, why = journal.open(path, journal.hash(fingerprint))
  return kept and setmetatable({ kept = kept, taken = 0 }, memory), why
end

local function text_of(list)
  local words = {}
  for k, x in ipairs(list or {}) do words[k] = ("%a"):format(x) end
  return table.concat(words, " ")
end

local function numbers_of(text)
  local list = {}
  for word in text:gmatch("%S+") do list[#list + 1] = tonumber(word) end
  return list
end

local function packed(found)
  local row = { failed = found.failed, integrator = found.integrator, misses = text_of(found.misses),
    numbers = text_of { found.dt or 0, found.cost or 0 }, cost_slopes = found.cost_slopes and text_of(found.cost_slopes) }
  if found.slopes then
    row.slopes = {}
    for g, list in ipairs(found.slopes) do row.slopes[g] = text_of(list) end
  end
  return row
end

local function unpacked(row)
  local numbers = numbers_of(row.numbers)
  local found = { failed = row.failed, integrator = row.integrator, misses = numbers_of(row.misses), dt = numbers[1],
    cost = numbers[2], cost_slopes = row.cost_slopes and numbers_of(row.cost_slopes) }
  if row.slopes then
    found.slopes = {}
    for g, text in ipairs(row.slopes) do found.slopes[g] = numbers_of(text) end
  end
  return found
end

-- What is on file for the values u under these words, or what take() gives, which is kept.
function memory:recall(words, u, take)
  local key = journal.hash(words .. " " .. text_of(u))
  local row = self.kept:get(key)
  if row then return unpacked(row) end
  local found = take()
  self.taken = self.taken + 1
  self.kept:put(key, packed(found))
  return found
end

function memory:remove() self.kept:remove() end

return memory
