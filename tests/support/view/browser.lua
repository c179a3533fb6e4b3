-- A real headless Chromium, driven through chromedriver by W3C WebDriver (https://www.w3.org/TR/webdriver2): JSON over
-- HTTP, which curl carries. The driver is a process of its own and ends with the session's `close`, or with the test.
local cjson = require("cjson").new()

local browser = {}
browser.__index = browser

local function shell(command)
  local pipe = assert(io.popen(command))
  local text = pipe:read("a")
  pipe:close()
  return text
end

local function exists(program)
  return shell("command -v " .. program) ~= ""
end

-- What is missing here; nil: nothing is.
function browser.missing()
  for _, program in ipairs { "chromedriver", "curl" } do
    if not exists(program) then return program end
  end
  return not (exists("chromium") or exists("chromium-browser") or exists("google-chrome")) and "chromium" or nil
end

local function call(self, method, path, body)
  local data = os.tmpname()
  local file = assert(io.open(data, "w"))
  file:write(cjson.encode(body or {}))
  file:close()
  local answer = shell(("curl -s --max-time 60 -X %s -H 'Content-Type: application/json' %s http://127.0.0.1:%d%s"):format(
    method, method == "GET" and "" or "--data-binary @" .. data, self.port, path))
  os.remove(data)
  local fine, decoded = pcall(cjson.decode, answer)
  if not fine then error(("no answer from chromedriver to %s: %s"):format(path, answer), 3) end
  local value = decoded.value
  if type(value) == "table" and value.error then error(("%s: %s"):format(value.error, value.message), 3) end
  return value
end

local function start_driver()
  local log = os.tmpname()
  local pid = tonumber(shell(("chromedriver --port=0 >%s 2>&1 & echo $!"):format(log)))
  local port
  for _ = 1, 600 do
    local text = assert(io.open(log)):read("a")
    port = text:match("started successfully on port (%d+)")
    if port then break end
    os.execute("sleep 0.1")
  end
  os.remove(log)
  assert(port, "chromedriver does not start")
  return pid, tonumber(port)
end

-- width, height: of the page, in pixels; dark: what the page is told of the user's wish
function browser.open(width, height, dark)
  local pid, port = start_driver()
  local self = setmetatable({ pid = pid, port = port }, browser)
  local args = { "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--hide-scrollbars", "--force-device-scale-factor=1", ("--window-size=%d,%d"):format(width, height + 143) }
  if dark then args[#args + 1] = "--force-dark-mode" end
  local fine, made = pcall(call, self, "POST", "/session", { capabilities = { alwaysMatch = {
    browserName = "chrome", ["goog:chromeOptions"] = { args = args }, ["goog:loggingPrefs"] = { browser = "ALL" } } } })
  if not fine then
    self:close()
    error(made, 2)
  end
  self.session = made.sessionId
  return self
end

function browser:post(path, body) return call(self, "POST", "/session/" .. self.session .. path, body) end
function browser:get(path) return call(self, "GET", "/session/" .. self.session .. path) end

function browser:go(url) self:post("/url", { url = url }) end

-- The value of a JavaScript expression in the page; a promise is waited for.
function browser:value(expression)
  return self:post("/execute/async", { args = { 0 }, script =
    "const done = arguments[arguments.length - 1]; Promise.resolve().then(() => (" .. expression
    .. ")).then((v) => done({ v }), (e) => done({ e: String(e) }));" })
end

function browser:eval(expression)
  local answer = self:value(expression)
  if answer.e then error(answer.e, 2) end
  return answer.v
end

-- Waits until the expression is true, a minute at most where nothing else is said: a busy machine is slow.
function browser:wait(expression, seconds)
  local last
  for _ = 1, (seconds or 60) * 50 do
    last = self:value(expression)
    if last.v and last.v ~= cjson.null then return end
    os.execute("sleep 0.02")
  end
  error(("%s did not become true%s"):format(expression, last.e and ": " .. last.e or ""), 2)
end

-- A press of the mouse at a place of the page; with `to`, it is drawn there first.
function browser:press(x, y, to)
  local actions = { { type = "pointerMove", duration = 0, x = x, y = y }, { type = "pointerDown", button = 0 } }
  if to then actions[#actions + 1] = { type = "pointerMove", duration = 50, x = to[1], y = to[2] } end
  actions[#actions + 1] = { type = "pointerUp", button = 0 }
  self:post("/actions", { actions = { { type = "pointer", id = "mouse", parameters = { pointerType = "mouse" },
    actions = actions } } })
end

function browser:key(key)
  self:post("/actions", { actions = { { type = "key", id = "keyboard", actions = {
    { type = "keyDown", value = key }, { type = "keyUp", value = key } } } } })
end

function browser:size(width, height) self:post("/window/rect", { width = width, height = height }) end

-- Errors and warnings of the console since the last call.
function browser:complaints()
  local list = {}
  for _, entry in ipairs(self:post("/se/log", { type = "browser" })) do
    if entry.level == "SEVERE" or entry.level == "WARNING" then list[#list + 1] = entry.message end
  end
  return list
end

local alphabet = {}
for k, c in ("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"):gmatch("()(.)") do alphabet[c] = k - 1 end

function browser.bytes(base64)
  return (base64:gsub("[^%w+/]", ""):gsub("..?.?.?", function(four)
    local bits, count = 0, #four
    for k = 1, 4 do bits = bits * 64 + (alphabet[four:sub(k, k)] or 0) end
    return string.pack(">I3", bits):sub(1, count - 1)
  end))
end

-- A picture of the page as PNG.
function browser:screenshot(path)
  local file = assert(io.open(path, "wb"))
  file:write(browser.bytes(self:get("/screenshot")))
  file:close()
end

function browser:close()
  if self.session then pcall(call, self, "DELETE", "/session/" .. self.session) end
  os.execute(("kill %d 2>/dev/null"):format(self.pid))
end

return browser
