-- Progress of many small pieces of work, on standard error: on a terminal one line that is written over, in a pipe a
-- plain line every few seconds. The remaining time is estimated from the number of finished pieces, or from the
-- fraction done (0 to 1) where the caller gives it, such as when late pieces cost more than early ones.
--
--   local bar = progress.new { what = "bench", total = 40 }   -- total may be nil: not known
--   bar:add()            one more is done;  bar:add { failed = true, note = "rk4, dt 1e-3" }
--   bar:tick()           call it some times a second: draws when it is time to
--   bar:say("text")      a line of its own, above the progress line
--   bar:finish()         the last line goes away (a terminal) or is written (a pipe)
local process = require("process")

local progress = {}
local bar = {}
bar.__index = bar

local every = { terminal = 0.1, pipe = 5 } -- s between two updates

-- options: what, total, done (already, from an earlier run: not counted in the rate), quiet, out (standard error)
function progress.new(options)
  local self = setmetatable({ what = options.what, total = options.total, done = options.done or 0, failed = 0 }, bar)
  self.before = self.done
  self.out = options.out or io.stderr
  self.quiet = options.quiet
  self.terminal = not options.out and process.terminal(2)
  self.begun = process.clock()
  self.drawn_at = self.begun
  return self
end

-- 75 s -> "1:15", 3700 s -> "1:01:40"
function progress.duration(seconds)
  local s = math.floor(seconds + 0.5)
  if s < 3600 then return ("%d:%02d"):format(s // 60, s % 60) end
  return ("%d:%02d:%02d"):format(s // 3600, s // 60 % 60, s % 60)
end

local function rate_text(rate)
  return rate >= 1 and ("%.3g/s"):format(rate) or ("%.3g/min"):format(60 * rate)
end

function bar:text()
  local now = process.clock()
  local spent, fresh = now - self.begun, self.done - self.before
  local parts = { ("%s: %d%s done"):format(self.what, self.done, self.total and (" of %d"):format(self.total) or "") }
  if self.failed > 0 then parts[#parts + 1] = ("%d failed"):format(self.failed) end
  if fresh > 0 and spent > 0 then parts[#parts + 1] = rate_text(fresh / spent) end
  local part = self.part or self.total and fresh > 0 and fresh / math.max(self.total - self.before, fresh)
  if part and part > 0 then parts[#parts + 1] = progress.duration(spent * (1 - part) / part) .. " left" end
  if self.note then parts[#parts + 1] = self.note end
  return table.concat(parts, ", ")
end

local function width()
  return tonumber(os.getenv("COLUMNS")) or 100
end

function bar:draw()
  if self.quiet then return end
  self.drawn_at = process.clock()
  local text = hooke.plain(self:text(), true)
  if self.terminal then
    self.out:write("\r\27[K", text:sub(1, width() - 1))
    self.shown = true
  else
    self.out:write(text, "\n")
  end
  self.out:flush()
end

function bar:tick()
  if process.clock() - self.drawn_at >= (self.terminal and every.terminal or every.pipe) then self:draw() end
end

-- what: { failed, note, part (fraction of all the work that is done, 0 to 1), count (1) }
function bar:add(what)
  what = what or {}
  self.done = self.done + (what.count or 1)
  if what.failed then self.failed = self.failed + 1 end
  self.note = what.note or self.note
  self.part = what.part or self.part
  self:tick()
end

local function clear(self)
  if self.shown then self.out:write("\r\27[K") end
  self.shown = false
end

function bar:say(text)
  if self.quiet then return end
  clear(self)
  self.out:write(hooke.plain(text), "\n")
  self.out:flush()
  if self.terminal then self:draw() end
end

-- In a pipe the last state is written only when lines were written before.
function bar:finish()
  local written = not self.terminal and self.drawn_at > self.begun
  clear(self)
  if written then self:draw() end
  self.out:flush()
end

return progress
