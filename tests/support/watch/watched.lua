-- hooke run --watch as a process of the test, and requests to its server by curl.
local cjson = require("cjson")
local child = require("watch.child")

local watched = {}
watched.__index = watched

local root, build = os.getenv("HK_ROOT") or ".", os.getenv("HK_BUILD") or "build"
local patience = 120 -- s: of a machine however busy

local function read(path)
  local file = io.open(path, "rb")
  local text = file and file:read("a") or ""
  if file then file:close() end
  return text
end

-- A fresh folder, in which the run has its files.
function watched.folder()
  local name = os.tmpname()
  os.remove(name)
  assert(os.execute(("mkdir '%s'"):format(name)))
  return name
end

-- Starts it with the words in the folder and waits for its address; it begins at once, unless it is to wait for a page.
function watched.start(folder, words, waits)
  if not waits then words = words .. " --at-once" end
  child.start(folder, ("%s/hooke run %s --watch >printed.txt 2>said.txt </dev/null"):format(build, words))
  local self = setmetatable({ folder = folder }, watched)
  local ends = child.clock() + patience
  repeat
    self.url = self:said():match("http://%S+")
    child.sleep(0.01)
  until self.url or child.clock() > ends
  if not self.url then
    child.signal(folder, "KILL")
    error("it did not say its address: " .. self:said(), 2)
  end
  self.host = self.url:match("http://([^/]+)")
  return self
end

function watched:said() return read(self.folder .. "/said.txt") end
function watched:printed() return read(self.folder .. "/printed.txt") end

-- Headers and body of an answer, and its status: curl with the options, a list of words for the shell.
function watched:curl(options, name)
  local file = self.folder .. "/answer"
  local pipe = io.popen(("curl -s -m 20 -D '%s.head' -o '%s' -w '%%{http_code}' %s '%s'"):format(file, file, options,
    name:find("^http") and name or self.url .. name))
  local status = tonumber(pipe:read("a"))
  pipe:close()
  return status, read(file), read(file .. ".head")
end

function watched:get(name)
  local status, body = self:curl("", name)
  assert(status == 200, ("%s: %s"):format(name, status))
  return body
end

function watched:state() return cjson.decode(self:get("state")) end

-- Posts a command as a page does; its status.
function watched:ask(command)
  return (self:curl(("-H 'Origin: http://%s' -H 'Content-Type: application/json' --data-binary '%s'"):format(self.host,
    type(command) == "table" and cjson.encode(command) or command), "command"))
end

-- Waits until the state is as `wanted` says; the state.
function watched:wait(wanted, what)
  local ends, state = child.clock() + patience
  repeat
    state = self:state()
    if wanted(state) then return state end
    child.sleep(0.02)
  until child.clock() > ends
  error(("%s: it did not come to that: %s"):format(what or "waiting", cjson.encode(state)), 2)
end

-- Ends it as Ctrl-C does; the exit code.
function watched:interrupt()
  child.signal(self.folder, "INT")
  self.ended = true
  return child.wait(self.folder)
end

function watched:close()
  if not self.ended then
    child.signal(self.folder, "KILL")
    child.wait(self.folder)
  end
  os.execute(("rm -rf '%s'"):format(self.folder))
end

watched.root, watched.build = root, build
return watched
