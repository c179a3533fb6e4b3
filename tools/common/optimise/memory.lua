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

local function texts_of(lists)
  local texts = {}
  for k, list in ipairs(lists or {}) do texts[k] = text_of(list) end
  return texts
end

local function lists_of(texts)
  local lists = {}
  for k, text in ipairs(texts) do lists[k] = numbers_of(text) end
  return lists
end

local function packed(found)
  return { failed = found.failed, integrator = found.integrator, misses = text_of(found.misses),
    numbers = text_of { found.dt or 0, found.cost or 0 }, cost_slopes = found.cost_slopes and text_of(found.cost_slopes),
    slopes = found.slopes and texts_of(found.slopes) }
end

local function unpacked(row)
  local numbers = numbers_of(row.numbers)
  return { failed = row.failed, integrator = row.integrator, misses = numbers_of(row.misses), dt = numbers[1],
    cost = numbers[2], cost_slopes = row.cost_slopes and numbers_of(row.cost_slopes),
    slopes = row.slopes and lists_of(row.slopes) }
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

-- ---- the state of a search, under words and the values u from which it began: the last one that was saved ----

-- state: iteration, dt, and lists of numbers, u, penalty, price and multipliers (or nil), and lists of these, nodes and
-- weights (or nil).
function memory:save(words, u, state)
  self.kept:put(journal.hash(words .. " " .. text_of(u)), { iteration = state.iteration, dt = text_of { state.dt or 0 },
    u = text_of(state.u), penalty = text_of(state.penalty), price = text_of(state.price), nodes = texts_of(state.nodes),
    weights = state.weights and texts_of(state.weights), multipliers = state.multipliers and text_of(state.multipliers) })
end

function memory:saved(words, u)
  local row = self.kept:get(journal.hash(words .. " " .. text_of(u)))
  if not row then return nil end
  return { iteration = row.iteration, dt = numbers_of(row.dt)[1], u = numbers_of(row.u), penalty = numbers_of(row.penalty),
    price = numbers_of(row.price), nodes = lists_of(row.nodes), weights = row.weights and lists_of(row.weights),
    multipliers = row.multipliers and numbers_of(row.multipliers) }
end

function memory:remove() self.kept:remove() end

return memory
