-- hooke watch SCENE.lua [name=value ...]: the run in a browser while it goes on, as hooke run SCENE.lua --watch.
--
-- This process serves the page (tools/native/server.c) and never runs the scene. The run is `hooke run` itself, in a
-- process of its own with all of its options and limits, so that verdict, files and exit code are the usual ones. It
-- tells what happens through a pipe that is always emptied here (plugins/outputs/live.c), and never waits for a page;
-- pages ask for what they want to show. For a value that a page changes the run is kept in a checkpoint at its next frame
-- and ends there, and another process goes on from it with that value (hooke run --resume FILE --change NAME=VALUE).
local fine, server = pcall(require, "server")
local process = require("process")
local cjson = require("cjson.safe")
local json_text = require("common.view.json_text")
local shared = require("common.view.shared")
local template = require("common.view.template")
local child = require("common.watch.child")
local history = require("common.watch.history")
local commands = require("common.watch.commands")
local messages = require("common.watch.messages")
local command_line = require("common.watch.command_line")

local PUBLISH_EVERY = 0.03 -- s, the least time between two versions of the state: 30 a second
local LONGEST = 5 -- s, that a run may take to end in order; then it is ended at once

local function complain(text)
  io.stderr:write("hooke: ", hooke.plain(text), "\n")
  return 1
end

-- The parameters that the scene declares, or nil and the exit code: what is wrong has been said.
local function parameters_of(own)
  local list = { "/proc/self/exe", "run" }
  table.move(own, 1, #own, 3, list)
  table.move({ "--help", "--json" }, 1, 2, #list + 1, list)
  local from, to = process.pipe()
  local pid, text = process.spawn(list, { [1] = to }), {}
  process.close(to)
  repeat
    text[#text + 1] = process.read(from)
  until text[#text] == ""
  process.close(from)
  local how, code = process.wait(pid)
  local got = cjson.decode(table.concat(text))
  if how == "exit" and code == 0 and type(got) == "table" then return got.parameters end
  if how == "exit" and code ~= 0 then return nil, code end -- it has said why
  return nil, complain("--watch: there is no scene to run: name its script, as in hooke run SCENE.lua --watch")
end

-- ---- the session: one run after the other, and what pages see of them ----

local session = {}
session.__index = session

-- state: what all pages show, as the document "state".
function session:publish(always)
  local now = process.clock()
  if not always and now - self.published < PUBLISH_EVERY then return end
  self.published = now
  if not (always or self.dirty) then return end
  self.dirty = false
  self.history:publish()
  local known = self.history:known()
  self.server:put("state", "application/json", json_text.encode({ run = self.number, doing = self.doing, waiting = self.waiting,
    frames = known.frames,
    stride = known.stride, latest = known.latest,
    pace = self.pace, error = self.error, values = self.values,
    notice = self.notice, summary = self.summary and json_text.raw(self.summary), parameters = self.declared_list }))
end

function session:begin()
  if self.before then self.before:drop() end
  self.before = self.history -- pages may still be asking for it
  self.number = self.number + 1
  self.history = history.new(self.server, self.number, self.title)
  self.child = child.start(command_line.with(self.arguments, self.values), self.forces)
  self.child:command(("pace %.9g"):format(self.pace))
  if self.waiting then self.child:command("pause") end -- at the first frame
  self.doing, self.error, self.summary, self.wanted, self.deadline = "running", nil, nil, nil, nil
  self.changed, self.kept_at, self.going_on = nil, nil, nil
  self:publish(true)
end

-- The values that were asked for hold from the checkpoint on.
function session:go_on()
  local changed, path, paused = self.changed, self.kept_at, self.doing == "paused"
  for name, value in pairs(changed) do self.values[name] = value end
  self.history:go_on()
  local arguments = command_line.going_on(self.arguments, self.values, changed, path)
  io.stderr:write("hooke: the same again: hooke run ", hooke.plain(command_line.text(arguments)), " --with output:live\n")
  self.child = child.start(arguments, self.forces, self.history:origin())
  self.child:command(("pace %.9g"):format(self.pace))
  if paused then self.child:command("pause") end
  self.doing, self.deadline, self.changed, self.kept_at, self.going_on = "running", nil, nil, nil, true
  self.notice = nil
  self:publish(true)
end

-- What a run that goes on tells first is what the page has; where it is not (other measures, other obstacles), the page
-- shows what comes as another run.
function session:hear(letter, body)
  if letter == "K" then
    if self.changed then
      self.kept_at = body
      self:stop()
    end
    return
  end
  if self.going_on and (letter == "R" or letter == "S") then
    if self.history:has(letter, body) then return end
    local run = self.history.told.R
    self.before, self.number = self.history, self.number + 1
    self.history = history.new(self.server, self.number, self.title)
    self.going_on = nil
    if letter == "S" then self.history:hear("R", run) end
  elseif letter == "F" or letter == "N" then
    self.going_on = nil
  end
  self.history:hear(letter, body)
  if letter == "D" then self.doing = messages.stopped(body) and "paused" or "running" end
  self.dirty = true
end

function session:finish()
  self.code = self.child:finish()
  if self.kept_at then return self:go_on() end
  local refused = self.code == 1 or self.code == 2 or self.code == 4
  if self.going_on and refused and not self.leaving then -- its first frame has not come
    local why = self.child:complaint() or "it ended without a word"
    self.notice = "another run has begun from its start, as this one cannot go on: "
      .. why:gsub("^.- cannot be gone on from: ", ""):gsub("^%S+%.checkpoint ", "its checkpoint ")
    self.child = nil
    return self:begin()
  end
  local unheeded = self.changed
  local summary = cjson.decode(self.child.summary) and self.child.summary
  self.summary, self.error = summary, not summary and (self.child:complaint() or "the run ended without a word") or nil
  if self.code ~= 0 and self.code ~= 5 and self.code ~= 130 then self.error = self.child:complaint() or self.error end
  self.child, self.doing = nil, "ended"
  self:publish(true)
  for name, value in pairs(unheeded or {}) do self.values[name] = value end
  if self.wanted or unheeded then self:begin() end -- it had come to its end before it could be kept
end

function session:change(values)
  if not next(values) then return end
  local asked, under_way = self.changed, self.child and not self.waiting and not self.deadline
  if not asked and not (under_way and self.history.frames > 1) then return self:obey_start(values) end
  self.changed, self.notice = asked or {}, nil
  for name, value in pairs(values) do self.changed[name] = value end
  if not asked then self.child:command("keep") end
end

function session:obey_start(values)
  for name, value in pairs(values) do self.values[name] = value end
  if not next(values) then self.waiting = false end -- a value alone lets it wait, with that value
  self.wanted, self.notice, self.changed, self.kept_at = true, nil, nil, nil
  if self.child then self:stop() else self:begin() end
end

-- Asks the run for its end, and sees to it.
function session:stop()
  if not self.child or self.deadline then return end
  self.child:interrupt()
  self.deadline = process.clock() + LONGEST
end

function session:obey(text)
  local asked = commands.read(text, self.declared)
  if not asked then return end
  if asked.name == "start" then
    self:obey_start(asked.values)
  elseif asked.name == "change" then
    self:change(asked.values)
  elseif asked.name == "stop" then
    self.changed, self.kept_at = nil, nil
    self:stop()
  else
    if asked.name == "go" or asked.name == "step" then self.waiting = false end
    if asked.pace then self.pace = asked.pace end
    if self.child then self.child:command(asked.line) end
    self:publish(true)
  end
end

function session:wait()
  local list = { self.server:descriptor(), self.signals }
  if self.child then table.move(self.child:descriptors(), 1, 8, #list + 1, list) end
  return process.ready(list, self.dirty and PUBLISH_EVERY or 0.5)
end

-- One turn of the loop; false: the user has ended it all.
function session:turn()
  local ready = self:wait()
  if self.child then
    self.child:read(ready, function(letter, body) self:hear(letter, body) end)
    if self.child:ended() then self:finish() end
  end
  if ready[self.signals] then
    process.read(self.signals)
    self.leaving, self.wanted, self.changed, self.kept_at = true, nil, nil, nil
    self:stop()
  end
  for text in function() return self.server:take() end do
    if not self.leaving then self:obey(text) end
  end
  if self.child and self.deadline and process.clock() > self.deadline then process.kill(self.child.pid) end
  self.server:tick()
  self:publish()
  return not (self.leaving and not self.child)
end

-- ---- the command ----

-- The page of a run under way: it has no data but what all pages share.
local function page_of(title)
  local before, after = template.parts({ title = title, subtitle = "live", policy = "; connect-src 'self'",
    modules = { "link", "stream", "hand", "drive", "live" } })
  if not before then return nil, after end
  local parts = { before }
  local out = { add = function(_, packed)
    parts[#parts + 1] = ('<script type="text/plain" id="d%d">%s</script>\n'):format(#parts, packed)
    return ("d%d"):format(#parts - 1)
  end }
  local page_data = json_text.encode({ shared = shared.page_data(out) })
  return table.concat(parts) .. '<script type="application/json" id="page-data">' .. page_data .. "</script>\n" .. after
end

local usage = [[
Usage: hooke watch SCENE.lua [name=value ...] [--port N] [options]

Runs the scene, and serves a page of it on this computer alone while it goes on: hooke run SCENE.lua --watch.

Options:
   --port N              of the page's address (default: a free one)
   --forces              each force by itself, as colours and arrows
   --at-once             the run begins by itself; otherwise it waits at its first frame for "start" on the page

All others are those of hooke run.
]]

local function wants_help()
  for _, word in ipairs(arg) do
    if word == "--help" or word == "-h" then return true end
  end
  return false
end

local function run()
  if wants_help() then
    io.write(usage)
    return 0
  end
  if not fine then
    return complain("--watch needs hooke's server of live pages, which was not built without libmicrohttpd: "
      .. "tools/install-deps run gets it, then make")
  end
  local own, port, forces, at_once = command_line.split(table.move(arg, 1, #arg, 1, {}))
  if not own then return complain(port) end
  local declared, code = parameters_of(own)
  if not declared then return code end
  local made, s = pcall(server.open, port, "frame-ancestors 'none'")
  if not made then return complain((s:gsub("^.-: ", "", 1))) end
  local title = "hooke"
  for _, word in ipairs(own) do title = word:match("([^/]+)%.lua$") or title end
  local page, why = page_of(title)
  if not page then return complain(why) end
  s:put("", "text/html; charset=utf-8", page)
  local by_name = {}
  for _, p in ipairs(declared) do by_name[p.name] = p end
  for _, p in ipairs(declared) do
    if p.min == cjson.null then p.min = nil end
    if p.max == cjson.null then p.max = nil end
  end
  local self = setmetatable({ server = s, arguments = own, forces = forces, title = title, declared = by_name,
    values = {}, waiting = not at_once,
    pace = 0, number = 0, declared_list = json_text.list(declared), signals = process.signals(), published = 0, code = 0 }, session)
  io.stderr:write("hooke: watch it at ", s:url(), " (Ctrl-C ends)", at_once and "" or "; it waits there for \"start\"", "\n")
  self:begin()
  while self:turn() do end
  s:close()
  return self.code
end

return run()
