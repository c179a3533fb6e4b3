-- hooke run --watch without a browser: who gets what from its server, what drives the run, and that nothing a page does
-- harms it. The page itself is watched in tests/tools/watch_page.lua.
local root, build = os.getenv("HK_ROOT") or ".", os.getenv("HK_BUILD") or "build"
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
if not io.open(build .. "/tools/server.so") then
  print("skipped: built without libmicrohttpd")
  os.exit(77)
end
local watched = require("watch.watched")
local child = require("watch.child")

-- A chain that swings; at most `pace` seconds a second, so that there is something to watch.
local scene = [[
local n = param("n", 12, "particles", { min = 2, max = 40 })
local g = param("g", 9.81, "m/s^2", { min = 0, max = 50 })
param("name", "chain", "of it")
if n == 13 then error("thirteen <is> unlucky") end
local scene = hooke.scene { duration = 2 }
local chain = scene:strand { from = { 0, 0, 0 }, to = { 1, 0, 0 }, n = n, mass = 1 }
scene:pin { 1 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("springs", { edges = chain:structural(), k = 2000, damping = 0.2 })
scene:measure("end", function(s) return s:position(n)[3] end)
return scene
]]

local function with(words, body, waits)
  local folder = watched.folder()
  local file = assert(io.open(folder .. "/chain.lua", "w"))
  file:write(scene)
  file:close()
  local w = watched.start(folder, "chain.lua " .. words, waits)
  local fine, why = xpcall(body, debug.traceback, w)
  w:close()
  if not fine then error(why, 0) end
end

local function equal(got, wanted, what)
  if got ~= wanted then error(("%s: %s instead of %s"):format(what, got, wanted), 2) end
end

local function ended(w) return w:wait(function(s) return s.doing == "ended" end, "the end") end

local tests = {}

function tests.only_who_has_the_token_and_the_right_host_gets_in()
  with("--no-output", function(w)
    local token = w.url:match("/(%x+)/$")
    equal(#token, 32, "hexadecimal digits of the token")
    local status, page, head = w:curl("", "")
    equal(status, 200, "the page")
    assert(page:find("<canvas", 1, true))
    for _, name in ipairs { "Content-Security-Policy", "X-Content-Type-Options: nosniff", "Referrer-Policy: no-referrer",
      "Cache-Control: no-store", "X-Frame-Options: DENY" } do
      assert(head:find(name, 1, true), name .. " is missing")
    end
    assert(not head:find("Access-Control", 1, true), "other sites may read it")
    local base = "http://" .. w.host
    for _, path in ipairs { "/", "/state", "/" .. token, "/" .. ("0"):rep(32) .. "/", "/" .. token:upper() .. "x/",
      "/" .. token:sub(1, 31) .. (token:sub(-1) == "0" and "1" or "0") .. "/state", "/" .. token .. "/../../etc/passwd",
      "/" .. token .. "/etc/passwd", "/" .. token .. "/page.css", "/" .. token .. "/frame/1/99999", "//" .. token .. "/" } do
      equal(w:curl("--path-as-is", base .. path), 404, path)
    end
    for _, host in ipairs { "evil.example", w.host .. ".evil.example", "127.0.0.1", "127.0.0.1:1", "[::1]:80" } do
      equal(w:curl(("-H 'Host: %s'"):format(host), ""), 403, "Host: " .. host)
    end
    equal(w:curl(("-H 'Host: localhost:%s'"):format(w.host:match("%d+$")), ""), 200, "localhost")
    for _, method in ipairs { "PUT", "DELETE", "OPTIONS", "TRACE", "POST" } do equal(w:curl("-X " .. method, "state"), 405, method) end
    assert(w:curl("", ("http://[::1]:%s/"):format(w.host:match("%d+$"))) == 0, "it listens on ::1")
  end)
end

function tests.commands_need_an_origin_a_type_and_a_length_within_bounds()
  with("--no-output", function(w)
    local json, body = "-H 'Content-Type: application/json'", "--data-binary '{\"do\":\"pause\"}'"
    local ours = ("-H 'Origin: http://%s'"):format(w.host)
    equal(w:curl(json .. " " .. body, "command"), 403, "no origin")
    for _, origin in ipairs { "http://evil.example", "null", "https://" .. w.host, "http://127.0.0.1:1" } do
      equal(w:curl(("-H 'Origin: %s' %s %s"):format(origin, json, body), "command"), 403, origin)
    end
    equal(w:curl(ours .. " " .. body, "command"), 415, "a form's type")
    equal(w:curl(ours .. " -H 'Content-Type: text/plain' " .. body, "command"), 415, "plain text")
    equal(w:curl(("%s %s -H 'Transfer-Encoding: chunked' %s"):format(ours, json, body), "command"), 411, "no length")
    equal(w:curl(("%s %s --data-binary '%s'"):format(ours, json, ("x"):rep(4097)), "command"), 413, "too long")
    equal(w:curl(("%s %s --data-binary '%s'"):format(ours, json, (" "):rep(4096)), "command"), 204, "as long as may be")
    equal(w:curl("", "command"), 405, "GET")
    equal(w:curl(("%s %s %s"):format(ours, json, body), ("http://%s/%s/command"):format(w.host, ("a"):rep(32))), 404, "no token")
  end)
end

-- Words that mean nothing, or too much, change nothing: the run ends as it would.
function tests.nonsense_and_half_requests_do_no_harm()
  with("--no-output", function(w)
    for _, command in ipairs { "", "{", "[]", "null", "17", '{"do":17}', '{"do":"nope"}', '{"do":"hold","id":-1,"place":[0,0,0]}',
      '{"do":"hold","id":1e300,"place":[0,0,0]}', '{"do":"hold","id":2,"place":[0,0]}', '{"do":"hold","id":2,"place":"x"}',
      '{"do":"pace","pace":-1}', '{"do":"pace","pace":"x"}', '{"do":"hold","id":99999,"place":[0,0,0]}' } do
      equal(w:ask(command), 204, command)
    end
    local port = w.host:match("%d+$")
    local garbage = { "GET", "\\0\\1\\2\\377", "GET /" .. ("a"):rep(60000) .. " HTTP/1.1\\r\\n\\r\\n",
      "POST " .. w.url:match("(/%x+/)") .. "command HTTP/1.1\\r\\nHost: " .. w.host .. "\\r\\nOrigin: http://" .. w.host
        .. "\\r\\nContent-Type: application/json\\r\\nContent-Length: 100\\r\\n\\r\\n{",
      "GET / HTTP/9.9\\r\\nHost:\\r\\n\\r\\n", "HTTP/1.1 200 OK\\r\\n\\r\\n" }
    for _, bytes in ipairs(garbage) do
      os.execute(("bash -c \"exec 3<>/dev/tcp/127.0.0.1/%s; printf '%s' >&3; exec 3>&-\" 2>/dev/null"):format(port, bytes))
    end
    local state = ended(w)
    equal(state.summary.verdict, "ok", "verdict")
    equal(state.summary.hand_work, require("cjson").null, "the hand's work")
    equal(w:interrupt(), 0, "exit code")
  end)
end

-- Two hundred connections that begin a request and go on with a letter a second, so that none is idle: a page does not
-- wait for them.
function tests.half_open_connections_keep_no_page_out()
  with("--no-output", function(w)
    local file = assert(io.open(w.folder .. "/hold.sh", "w"))
    file:write(([[trap "" PIPE
echo $$ >holder
for k in $(seq 200); do
  exec {fd}<>/dev/tcp/127.0.0.1/%s && fds="$fds $fd" && printf 'GET / HTTP/1.1\r\nA: ' >&$fd
done
>ready
while sleep 1; do for fd in $fds; do printf x >&$fd; done; done
]]):format(w.host:match("%d+$")))
    file:close()
    os.execute(("cd '%s' && bash hold.sh </dev/null >/dev/null 2>&1 & while ! [ -e '%s/ready' ]; do sleep 0.1; done")
      :format(w.folder, w.folder))
    for _ = 1, 3 do equal(w:curl("", ""), 200, "the page") end
    os.execute(("kill $(cat '%s/holder')"):format(w.folder))
    ended(w)
  end)
end

function tests.the_run_is_the_same_as_without_a_page()
  with("--state watched.csv --json", function(w)
    ended(w)
    equal(w:interrupt(), 0, "exit code")
    assert(os.execute(("cd '%s' && '%s/hooke' run chain.lua --state alone.csv --quiet --out alone && cmp watched.csv alone.csv")
      :format(w.folder, build)), "the state is another one")
    local summary = require("cjson").decode(w:printed())
    equal(summary.verdict, "ok", "the verdict printed")
  end)
end

-- A line of JSON for every run, and nothing else.
function tests.with_json_every_run_is_a_line()
  with("--json --no-output n=6", function(w)
    ended(w)
    for run, n in ipairs { 7, 8 } do
      w:ask { ["do"] = "start", values = { n = n } }
      w:wait(function(s) return s.run == run + 1 and s.doing == "ended" end)
    end
    equal(w:interrupt(), 0, "exit code")
    local particles = {}
    for line in w:printed():gmatch("[^\n]+") do
      table.insert(particles, assert(require("cjson.safe").decode(line), line).particles)
    end
    equal(#particles, 3, "lines")
    for k = 1, 3 do equal(particles[k], 5 + k, "particles of run " .. k) end
  end)
end

-- Of methods that ask for elements, and of forces whose elements are no edges, as of any: frames, strain and the bits.
function tests.methods_with_elements_and_surfaces_are_watched()
  for _, case in ipairs {
    { 'scene:force("springs", { edges = sheet:edges(), k = 400 })', "xpbd" },
    { 'scene:force("springs", { edges = sheet:edges(), k = 400 })', "local_global" },
    { 'scene:force("membrane", { triangles = sheet:triangles(), stiffness = 50 })', "leapfrog" },
    { 'scene:force("membrane", { triangles = sheet:triangles(), stiffness = 50 })', "xpbd" },
  } do
    local folder = watched.folder()
    local file = assert(io.open(folder .. "/sheet.lua", "w"))
    file:write(([[
local scene = hooke.scene { duration = 0.5, integrator = "%s" }
local sheet = scene:grid { nx = 6, ny = 6, width = 1, height = 1, mass = 0.2 }
scene:pin { 1, 6 }
scene:force("gravity")
%s
return scene
]]):format(case[2], case[1]))
    file:close()
    local w = watched.start(folder, "sheet.lua --no-output --forces --state watched.csv --quiet")
    local fine, why = xpcall(function()
      local state = ended(w)
      equal(state.summary.verdict, "ok", state.summary.reason)
      local run, labels = require("cjson").decode(w:get("run/1")), {}
      for k, f in ipairs(run.fields) do labels[k] = f.name end
      local force = case[1]:match('force%("(%a+)"')
      local within = force == "springs" and "tension N" or "sheet_stress N/m"
      equal(table.concat(labels, ", "), ("velocity, strain, force gravity, force %s, force pull, channel %s")
        :format(force, within), "fields")
      -- behind 24 bytes of head: x and v, 36 x 3 each, the strain, and gravity, of which z is -9.81 m; last what is within
      local frame = w:get("frame/1/" .. math.tointeger(state.latest))
      equal(#frame, 24 + 4 * 36 * (3 + 3 + 1 + 3 * 3 + 1), "bytes of a frame")
      local most = 0
      for i = 0, 35 do most = math.max(most, math.abs((string.unpack("<f", frame, 24 + 4 * 36 * 6 + 4 * i + 1)))) end
      assert(most > 1e-3 and most < 1, "strain " .. most)
      local weight = string.unpack("<f", frame, 24 + 4 * 36 * 7 + 4 * 2 + 1)
      assert(math.abs(weight + 9.81 * 0.2 / 36) < 1e-6, "weight " .. weight)
      equal(w:interrupt(), 0, "exit code")
      assert(os.execute(("cd '%s' && '%s/hooke' run sheet.lua --state alone.csv --quiet --no-output && cmp watched.csv alone.csv")
        :format(folder, build)), "the state is another one")
    end, debug.traceback)
    w:close()
    if not fine then error(case[1] .. ", " .. case[2] .. ": " .. why, 0) end
  end
end

function tests.pause_step_go_stop()
  with("--no-output --until 1000 --quiet", function(w)
    equal(w:ask { ["do"] = "pause" }, 204, "pause")
    local first = w:wait(function(s) return s.doing == "paused" end).frames -- the run has said so: no frame is on its way
    child.sleep(0.2)
    equal(w:state().frames, first, "frames while it is paused")
    w:ask { ["do"] = "step" }
    w:wait(function(s) return s.frames == first + 1 end, "a step")
    w:ask { ["do"] = "go" }
    w:wait(function(s) return s.frames > first + 10 and s.doing == "running" end, "going on")
    w:ask { ["do"] = "stop" }
    local state = ended(w)
    equal(state.summary.verdict, "interrupted", "verdict")
    equal(w:printed(), "", "what --quiet prints")
    equal(w:interrupt(), 130, "exit code")
  end)
end

function tests.a_changed_value_begins_another_run_and_an_error_is_told()
  with("--no-output n=6", function(w)
    equal(ended(w).summary.particles, 6, "particles at first")
    w:ask { ["do"] = "start", values = { n = 20, nope = 1, name = "a 'b' <c>" } }
    local state = w:wait(function(s) return s.run == 2 and s.doing == "ended" end)
    equal(state.summary.particles, 20, "particles then")
    equal(state.values.n, "20", "the value")
    equal(state.values.nope, nil, "what the scene does not declare")
    w:ask { ["do"] = "start", values = { n = 13 } }
    state = w:wait(function(s) return s.run == 3 and s.doing == "ended" end)
    assert(state.error:find("thirteen <is> unlucky", 1, true), state.error)
    w:ask { ["do"] = "start", values = { n = 41 } }
    state = w:wait(function(s) return s.run == 4 and s.doing == "ended" end)
    assert(state.error:find("above the maximum 40", 1, true), state.error)
    w:ask { ["do"] = "start", values = { n = 7 } }
    equal(w:wait(function(s) return s.run == 5 and s.doing == "ended" end).summary.particles, 7, "particles at last")
  end)
end

-- Numbers of a table that `hooke convert` wrote, of the rows at the last time.
local function last_rows(path)
  local rows, last = {}, nil
  for line in io.lines(path) do
    local row = {}
    for number in line:gmatch("[^,]+") do row[#row + 1] = tonumber(number) end
    if row[1] ~= last then rows, last = {}, row[1] end
    if #row > 0 then rows[#rows + 1] = row end
  end
  return rows
end

-- A run whose frames take long is "paused" when it stands still, not when somebody has asked for it.
function tests.it_is_paused_when_it_stands_still()
  with("--no-output --until 1000 --dt 1e-7 --quiet", function(w)
    for _ = 1, 2 do
      w:ask { ["do"] = "pause" }
      local state = w:wait(function(s) return s.doing == "paused" end)
      equal(state.latest, state.frames - 1, "the frame at which it stands still")
      child.sleep(0.6)
      equal(w:state().frames, state.frames, "frames while it is paused")
      w:ask { ["do"] = "go" }
      w:wait(function(s) return s.doing == "running" and s.frames > state.frames end)
    end
    equal(w:interrupt(), 130, "exit code")
  end)
end

-- What a page of a watched run is sent is what the recording of that run holds: fields, edges, and every number as a float.
function tests.a_watched_frame_is_that_of_the_recording()
  if not io.open(build .. "/tools/recording.so") then return print("hooke is built without HDF5: there is no recording") end
  with("--out kept --with output:trajectory", function(w)
    local k = math.tointeger(ended(w).latest)
    local run, frame = require("cjson").decode(w:get("run/1")), w:get("frame/1/" .. k)
    for _, format in ipairs { "csv", "obj" } do
      assert(os.execute(("cd '%s' && '%s/hooke' convert kept --to %s >said 2>&1"):format(w.folder, build, format)))
    end
    local names = {}
    for j, f in ipairs(run.fields) do names[j] = ("%s %d"):format(f.name, f.components) end
    equal(table.concat(names, ", "), "velocity 3, strain 1", "fields")
    local rows, n, at = last_rows(w.folder .. "/kept/converted.csv"), string.unpack("<I4", frame, 9), 25
    equal(n, #rows, "particles") -- t, id, place, velocity, mass, strain
    local function same(i, number, what)
      local got
      got, at = string.unpack("<f", frame, at)
      equal(got, (string.unpack("<f", string.pack("<f", number))), ("%s of particle %d"):format(what, i))
    end
    for i, row in ipairs(rows) do for c = 1, 3 do same(i, row[2 + c] - run.origin[c], "place") end end
    for i, row in ipairs(rows) do for c = 1, 3 do same(i, row[5 + c], "velocity") end end
    for i, row in ipairs(rows) do same(i, row[10], "strain") end
    local topology, edges = w:get(("topology/1/%d"):format(string.unpack("<I4", frame, 5))), {}
    local count = string.unpack("<I4", topology, 9)
    for e = 1, count do edges[e] = ("l %d %d"):format(string.unpack("<I4I4", topology, 29 + 4 * n + 8 * (e - 1))) end
    local lines = {}
    for line in io.lines(("%s/kept/obj/%06d.obj"):format(w.folder, k)) do
      local a, b = line:match("^l (%d+) (%d+)")
      if a then lines[#lines + 1] = ("l %d %d"):format(a - 1, b - 1) end
    end
    equal(#lines, 11, "edges of the recording")
    equal(table.concat(edges, "; "), table.concat(lines, "; "), "edges")
    equal(w:interrupt(), 0, "exit code")
  end)
end

-- A run at work is ended for the next one.
function tests.a_running_run_gives_way_to_the_next()
  with("--no-output", function(w)
    w:ask { ["do"] = "pace", pace = 0.5 }
    w:ask { ["do"] = "start", values = {} }
    w:wait(function(s) return s.run >= 2 and s.frames > 3 end)
    w:ask { ["do"] = "start", values = { n = 5 } }
    w:wait(function(s) return s.run >= 3 and s.values.n == "5" and s.frames > 3 end)
  end)
end

-- By a method that controls its error the energy is balanced with the hand's work in it: to 1e-3, a hundred times what it
-- is found to be (1e-5).
function tests.the_hand_draws_a_particle_and_its_work_is_told()
  with("--no-output --integrator dopri5", function(w)
    w:ask { ["do"] = "pace", pace = 1 }
    w:ask { ["do"] = "start", values = {} }
    w:wait(function(s) return s.run == 2 and s.frames > 5 end)
    w:ask { ["do"] = "hold", id = 12, place = { 0.2, 0.8, 0.3 }, strength = 10 }
    child.sleep(0.7)
    local k = math.tointeger(w:state().latest)
    local frame = w:get("frame/2/" .. k)
    local run = require("cjson").decode(w:get("run/2"))
    local x = { string.unpack("<fff", frame, 24 + 12 * 11 + 1) }
    for c = 1, 3 do x[c] = x[c] + run.origin[c] end
    local off = math.sqrt((x[1] - 0.2) ^ 2 + (x[2] - 0.8) ^ 2 + (x[3] - 0.3) ^ 2)
    assert(off < 0.15, ("the particle is %g m from the hand"):format(off))
    w:ask { ["do"] = "release" }
    local state = ended(w)
    -- the chain's end is lifted by about 1.3 m at least, against the weight of most of it: more than a joule
    assert(state.summary.hand_work > 1, "work " .. tostring(state.summary.hand_work))
    equal(state.summary.verdict, "ok", state.summary.reason)
    assert(math.abs(state.summary.energy.drift) < 1e-3, "drift " .. state.summary.energy.drift)
    assert(state.summary.checked:find("moved by hand", 1, true), state.summary.checked)
    equal(w:interrupt(), 0, "exit code")
    assert(w:printed():find("by hand +work"), "the summary's text")
  end)
end

-- Another run, some frames of which are there: the first has come to its end at once. It is slow, so that what follows comes soon
-- after these frames on a busy machine as well.
local function under_way(w)
  w:ask { ["do"] = "pace", pace = 0.2 }
  w:ask { ["do"] = "start", values = {} }
  w:wait(function(s) return s.run == 2 and s.frames > 10 end)
end

-- The chain weighs nothing from some frame on: the run goes on from there, under its own number and with all its frames.
function tests.a_value_changes_while_the_run_goes_on()
  with("--no-output", function(w)
    under_way(w)
    w:ask { ["do"] = "change", values = { g = 0 } }
    local state = w:wait(function(s) return s.values.g end, "the value")
    equal(state.run, 2, "run")
    w:ask { ["do"] = "pace", pace = 0 }
    state = ended(w)
    equal(state.run, 2, "run")
    equal(state.frames, 121, "frames of 2 s at 60 a second") -- none is missing, none is told twice
    equal(state.latest, 120, "the last frame")
    local s = state.summary
    equal(s.verdict, "ok", s.reason)
    assert(s.checked:find("its parameters were changed while it ran", 1, true), s.checked)
    local warned = table.concat(s.warnings, "\n")
    assert(warned:find("the parameter g was 9.81 and is 0: positions, velocities and masses stay as they are", 1, true), warned)
    -- What the change gives is work. What leapfrog's energy is off by differs with the frame of the change:
    -- 6e-5 to 3e-3 at ten frames up to the 60th, but 1e-2 where the chain is jerked.
    assert(math.abs(s.energy.drift) < 2e-2, "drift " .. s.energy.drift)
    local numbers, before = w:get("numbers/2/0"), -1
    for k = 0, 120 do
      local t = string.unpack("<d", numbers, k * (#numbers // 121) + 1)
      assert(math.abs(t - k / 60) < 1e-12 and t > before, ("frame %d is of t = %g s"):format(k, t))
      before = t
    end
    equal(w:interrupt(), 0, "exit code")
  end)
end

-- The same run by two commands, from the checkpoint that the page's change has left.
function tests.a_change_can_be_repeated()
  with("--out out --state first.csv", function(w)
    under_way(w)
    w:ask { ["do"] = "pause" }
    w:wait(function(s) return s.doing == "paused" end)
    w:ask { ["do"] = "change", values = { g = 20 } }
    w:wait(function(s) return s.values.g and s.doing == "paused" end, "the value")
    w:ask { ["do"] = "pace", pace = 0 }
    w:ask { ["do"] = "go" }
    equal(ended(w).summary.verdict, "ok", "verdict")
    assert(w:said():find("the same again: hooke run chain.lua .*changed.checkpoint %-%-change g=20 %-%-with output:live"), w:said())
    assert(os.execute(("cd '%s' && '%s/hooke' run chain.lua --resume out/changed.checkpoint --change g=20 --out again --quiet "
      .. "--with output:live --state second.csv 2>said.txt && cmp first.csv second.csv"):format(w.folder, build)))
  end)
end

function tests.what_only_a_start_can_have_begins_another_run()
  with("--no-output", function(w)
    under_way(w)
    w:ask { ["do"] = "change", values = { n = 20 } }
    local state = w:wait(function(s) return s.notice end, "a notice")
    assert(state.notice:find("there are 20 particles in place of 12", 1, true), state.notice)
    equal(state.run, 3, "run")
    equal(state.values.n, "20", "n")
    w:ask { ["do"] = "pace", pace = 0 }
    equal(ended(w).summary.verdict, "ok", "verdict")
  end)
end

function tests.an_accuracy_cannot_be_claimed_after_the_hand()
  with("--no-output --accuracy 1e-3", function(w)
    w:ask { ["do"] = "pace", pace = 1 }
    w:ask { ["do"] = "start", values = {} }
    w:wait(function(s) return s.run == 2 and s.frames > 5 end)
    w:ask { ["do"] = "hold", id = 12, place = { 0.5, 0.5, 0 } }
    child.sleep(0.3)
    w:ask { ["do"] = "release" }
    local state = ended(w)
    equal(state.summary.verdict, "inaccurate", "verdict")
    assert(state.summary.reason:find("the user's hand did work of", 1, true), state.summary.reason)
  end)
end

-- Frames asked for by many at once, each gone before its answer.
function tests.many_readers_that_leave_do_no_harm()
  with("--no-output --until 2", function(w)
    local list = {}
    for k = 1, 40 do
      list[k] = ("curl -s -m 0.%d -o /dev/null '%sstate?after=%d' & curl -s -m 1 -o /dev/null '%sframe/1/%d' &"):format(k % 9 + 1, w.url,
        k, w.url, k)
    end
    os.execute("(" .. table.concat(list, " ") .. " wait) >/dev/null 2>&1")
    equal(ended(w).summary.verdict, "ok", "verdict")
  end)
end

-- At its first frame, also with a value that a page sets, and until a page says to go, which others are told.
function tests.it_waits_for_a_page_to_start_it()
  with("--no-output", function(w)
    assert(w:said():find('it waits there for "start"', 1, true), w:said())
    local function at_first(s) return s.doing == "paused" and s.latest == 0 and s.waiting end
    local run = w:wait(at_first, "waiting").run
    child.sleep(0.2)
    equal(w:state().latest, 0, "the frame at which it waits")
    w:ask { ["do"] = "start", values = { n = 5 } }
    local state = w:wait(function(s) return s.run == run + 1 and at_first(s) end, "waiting with a value")
    equal(state.values.n, "5", "the value")
    w:ask { ["do"] = "go" }
    w:wait(function(s) return s.latest > 2 and not s.waiting end, "started")
    w:ask { ["do"] = "start", values = { n = 6 } }
    w:wait(function(s) return s.run == run + 2 and s.latest > 2 end, "another run, which begins at once")
  end, true)
end

function tests.what_is_wrong_is_said_before_the_page_is_served()
  local folder = watched.folder()
  local function refused(words, code, text)
    local pipe = io.popen(("cd '%s' && timeout 120 '%s/hooke' run %s --watch 2>&1; echo \"code $?\""):format(folder, build, words))
    local said = pipe:read("a")
    pipe:close()
    if not (said:find(text, 1, true) and said:find("code " .. code, 1, true)) then error(words .. ": " .. said) end
    assert(not said:find("http://", 1, true), said)
  end
  local file = assert(io.open(folder .. "/chain.lua", "w"))
  file:write(scene)
  file:close()
  refused("none.lua", 4, "cannot read the scene none.lua")
  refused("chain.lua n=1", 1, "below the minimum 2")
  refused("chain.lua --nope", 1, "unknown option '--nope'")
  refused("chain.lua --port x", 1, "--port")
  refused("chain.lua --port 70000", 1, "--port")
  local alone = io.popen(("cd '%s' && '%s/hooke' run chain.lua --forces 2>&1"):format(folder, build)):read("a")
  assert(alone:find("--forces is of the page of --watch", 1, true), alone)
  os.execute(("rm -rf '%s'"):format(folder))
end

local names, failed = {}, 0
for name in pairs(tests) do names[#names + 1] = name end
table.sort(names)
for _, name in ipairs(names) do
  local begin = child.clock()
  local fine, why = xpcall(tests[name], debug.traceback)
  print(("%s %s (%.1f s)"):format(fine and "ok    " or "FAILED", name, child.clock() - begin))
  if not fine then
    failed = failed + 1
    print(why)
  end
end
os.exit(failed == 0)
