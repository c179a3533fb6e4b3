-- Processes by the shell, for tests in Lua that the plain interpreter runs: with sanitizers it cannot load the modules
-- that are built for hooke.
local child = {}

local function line_of(path)
  local file = io.open(path)
  local line = file and file:read("l")
  if file then file:close() end
  return line
end

function child.sleep(seconds) os.execute(("sleep %g"):format(seconds)) end

-- s, since some time
function child.clock()
  local pipe = assert(io.popen("date +%s.%N"))
  local now = tonumber(pipe:read("l"))
  pipe:close()
  return now
end

-- Starts the command in the folder, where the files pid and code are its own. With set -m an interruption reaches it.
function child.start(folder, command)
  local job = ("set -m; %s & echo $! > pid; wait $!; echo $? > code.new; mv code.new code"):format(command)
  assert(os.execute(("cd '%s' && rm -f pid code && sh -c '%s' 2>/dev/null &"):format(folder, job)))
  while not line_of(folder .. "/pid") do child.sleep(0.01) end
end

-- `signal`: INT, KILL
function child.signal(folder, signal) os.execute(("kill -%s %s 2>/dev/null"):format(signal, line_of(folder .. "/pid"))) end

-- Waits for its end; the exit code, or 128 and the number of a signal.
function child.wait(folder)
  while not line_of(folder .. "/code") do child.sleep(0.01) end
  return tonumber(line_of(folder .. "/code"))
end

return child
