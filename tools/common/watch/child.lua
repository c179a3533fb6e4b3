-- One run in a process of its own: `hooke run` with the arguments of the user, and the output and the force that a page
-- needs. What it says on standard error goes there, and the end of it is kept for the page.
local process = require("process")
local messages = require("common.watch.messages")

local child = {}
child.__index = child

local KEPT_ERRORS = 4000 -- characters

-- The arguments for the link, for descriptors 3, 4 and 5.
local function link_of(forces, origin)
  local live = "output:live:messages=3,commands=4,forces=" .. tostring(forces)
  if origin then live = ("%s,x=%.17g,y=%.17g,z=%.17g"):format(live, table.unpack(origin)) end
  return { "--with", "force:pull:by_hand=true", "--with", live, "--summary", "/dev/fd/5" }
end

-- forces: whether frames have each force by itself; origin: of positions in its messages (nil: its own choice)
function child.start(arguments, forces, origin)
  local link = link_of(forces, origin)
  local list = { "/proc/self/exe", "run" }
  table.move(arguments, 1, #arguments, 3, list)
  table.move(link, 1, #link, #list + 1, list)
  local messages_in, messages_out = process.pipe()
  local commands_in, commands_out = process.pipe()
  local summary_in, summary_out = process.pipe()
  local errors_in, errors_out = process.pipe()
  local pid = process.spawn(list, { [2] = errors_out, [3] = messages_out, [4] = commands_in, [5] = summary_out })
  for _, fd in ipairs({ messages_out, commands_in, summary_out, errors_out }) do process.close(fd) end
  return setmetatable({ pid = pid, commands = commands_out, decoder = messages.new(), summary = "", said = "",
    streams = { [messages_in] = "messages", [summary_in] = "summary", [errors_in] = "errors" } }, child)
end

-- The descriptors that are still open, for process.ready.
function child:descriptors()
  local list = {}
  for fd in pairs(self.streams) do list[#list + 1] = fd end
  return list
end

local take = {
  messages = function(self, bytes, heard) return self.decoder:add(bytes, heard) end,
  summary = function(self, bytes) self.summary = self.summary .. bytes end,
  errors = function(self, bytes)
    io.stderr:write(bytes)
    self.said = (self.said .. bytes):sub(-KEPT_ERRORS)
  end,
}

-- Reads what has come on the descriptors that are ready; heard(letter, body) gets the messages.
function child:read(ready, heard)
  for fd, what in pairs(self.streams) do
    if ready[fd] then
      local bytes = process.read(fd)
      if bytes ~= "" then take[what](self, bytes, heard) end
      if bytes == "" then
        process.close(fd)
        self.streams[fd] = nil
      end
    end
  end
end

-- Whether all has been heard: the process has ended, or is about to.
function child:ended() return next(self.streams) == nil end

-- Waits for the end; the exit code.
function child:finish()
  local how, number = process.wait(self.pid)
  process.close(self.commands)
  return how == "exit" and number or 128 + number
end

function child:command(line) process.write(self.commands, line .. "\n") end

-- Asks for an orderly end: the verdict is "interrupted", and what there is is kept.
function child:interrupt() process.interrupt(self.pid) end

-- The sentence with which it failed, if it did.
function child:complaint()
  local text
  for line in self.said:gmatch("hooke: ([^\n]+)") do text = line end
  return text
end

return child
