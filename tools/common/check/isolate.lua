-- A body of Lua in a child process with limits. What a plugin does there, crash, hang, exit, abort or print, ends or
-- soils the child alone, and comes back as a sentence. The child tells its parent by lines on a pipe:
--   @TEXT   where it is      =TABLE  something it found (a table as Lua text)      !TEXT  last message of a dying process
--   .       it came to its end
local process = require("process")

local isolate = {}

local BYTES = 4 << 30 -- address space; a check takes some tens of megabytes, the threads' stacks some hundreds

local PATIENCE = 10 -- times its seconds that a child may take which computes

local signals = { [2] = "SIGINT", [4] = "SIGILL", [6] = "SIGABRT", [7] = "SIGBUS", [8] = "SIGFPE", [9] = "SIGKILL",
  [11] = "SIGSEGV", [15] = "SIGTERM", [24] = "SIGXCPU", [25] = "SIGXFSZ" }

-- A value as one line of Lua, with all bits of numbers.
local function dump(value)
  if type(value) ~= "table" then return (("%q"):format(value):gsub("\\?\n", "\\n")) end
  local parts = {}
  for key, item in pairs(value) do parts[#parts + 1] = ("[%s]=%s"):format(dump(key), dump(item)) end
  return "{" .. table.concat(parts, ",") .. "}"
end

local function undump(text) return assert(load("return " .. text, "=line", "t", {}))() end

-- Lua's errors carry the file and line of the checker or the script; the rest is the cause.
local function plain(message) return (tostring(message):gsub("^[%w_/%.%-]+%.lua:%d+: ", "")) end

local function child(fd, out, err, seconds, body)
  process.confine(seconds, BYTES, out, err, fd)
  local teller = {
    at = function(place)
      process.allow(seconds)
      process.write(fd, "@" .. place:gsub("\n", " ") .. "\n")
    end,
    tell = function(found) process.write(fd, "=" .. dump(found) .. "\n") end,
  }
  local fine, message = xpcall(body, function(m)
    -- An error with a place in a file is one of the checker or of the scene.
    return type(m) == "string" and m:find("%.lua:%d") and m .. "\n" .. debug.traceback("", 2) or tostring(m)
  end, teller, fd)
  if fine then process.write(fd, ".\n")
  else process.write(fd, "=" .. dump { failed = plain(message) } .. "\n.\n") end
  process.exit(0)
end

-- What the child printed, in a few words; nil: nothing.
local function shown(text)
  text = text:gsub("^%s+", ""):gsub("%s+$", "")
  if text == "" then return nil end
  local line = text:match("ERROR: (AddressSanitizer:[^\n]*)") or text:match("runtime error: [^\n]*") or text
  return line:sub(1, 200):gsub("%s+", " ")
end

local function read_lines(state, text, on_found)
  state.parts[#state.parts + 1] = text
  if not text:find("\n", 1, true) then return end
  local all, from = table.concat(state.parts), 1
  local function next_line()
    local to = all:find("\n", from, true)
    if not to then return nil end
    local line = all:sub(from, to - 1)
    from = to + 1
    return line
  end
  for line in next_line do
    local mark, said = line:sub(1, 1), line:sub(2)
    if mark == "@" then state.place = said
    elseif mark == "=" then on_found(undump(said))
    elseif mark == "!" then state.last_words = said
    elseif mark == "." then state.done = true end
  end
  state.parts = { all:sub(from) }
end

-- Clock ticks of a processor that the process has had; "" where that cannot be read.
local function computed(pid)
  local file = io.open(("/proc/%d/stat"):format(pid))
  local text = file and file:read("a") or ""
  if file then file:close() end
  return text:match("^.*%) " .. ("%S+ "):rep(11) .. "(%S+ %S+)") or ""
end

-- On a busy machine a child that computes is slow; the limit of its own processor time ends it where it does so forever.
local function follow(pid, fd, seconds, on_found)
  local state, said, ticks = { parts = {} }, process.clock(), ""
  local moved = said
  while true do
    local text = process.ready({ fd }, 0.1)[fd] and process.read(fd)
    if text == "" then break end
    local now, had = process.clock(), computed(pid)
    if text then
      read_lines(state, text, on_found)
      said, moved = now, now
    elseif had ~= ticks then
      moved = now
    end
    ticks = had
    if now > moved + seconds or now > said + PATIENCE * seconds then
      process.kill(pid)
      state.late = true
      break
    end
  end
  process.close(fd)
  state.how, state.code = process.wait(pid)
  return state
end

-- Runs body(teller, fd) in a child that is ended when it says nothing for `seconds` of a processor, or of the clock without
-- computing: teller.at(text) says where it is,
-- teller.tell(table) what it found, which comes to on_found(table) here at once. Returns nil or, where the child did not
-- come to its end, what ended it in a sentence; the place where it was then; what it printed on standard output, and on
-- standard error.
function isolate.run(seconds, body, on_found)
  local out, err = process.capture(), process.capture()
  local pid, fd = process.fork()
  if pid == 0 then child(fd, out, err, seconds, body) end
  local state = follow(pid, fd, seconds, on_found)
  local printed, complaint = shown(process.captured(out)), shown(process.captured(err))
  local ended
  if state.late then ended = ("it does not end: the process was ended after %g s there"):format(seconds)
  elseif state.last_words then ended = state.last_words
  elseif not state.done then
    ended = state.how == "signal" and ("the process was ended by signal %d (%s)"):format(state.code,
      signals[state.code] or "?") or ("it ends the process with exit code %d"):format(state.code)
  end
  local late = state.late or ended and ended:find("does not end", 1, true) ~= nil -- also by its processor time
  return ended, state.place, printed, complaint, late
end

return isolate
