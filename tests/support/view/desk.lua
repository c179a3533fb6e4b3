-- The page of hooke in a browser (tools/browser), driven as a reader of the course would: a scene to its end and its verdict,
-- the state that it ends in, a script with a fault, a value by its slider. usage: lua5.4 desk.lua PAGE STATE PICTURE
local page, state, picture = table.unpack(arg)
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT")
package.path = ("%s/tests/?.lua;%s"):format(root, package.path)
local browser = require("support.view.browser")
local b = browser.open(1400, 800)

local function text(selector) return b:eval(("document.querySelector('%s').textContent"):format(selector)) end
local function view(expression) return b:eval("document.querySelector('iframe').contentWindow." .. expression) end

local function ended()
  b:wait("hooke.page.doing === 'ended' && (hooke.page.summary || hooke.page.error)", 60)
  local complaint = b:eval("hooke.page.error || ''")
  return b:eval("hooke.page.summary ? hooke.page.summary.verdict : ''"), complaint
end

local function choose(name)
  b:eval(("hooke.page.choose('%s')"):format(name))
  return ended()
end

local function shown(verdict)
  b:wait(("(document.querySelector('iframe').contentDocument.querySelector('.verdict strong') || {}).textContent === '%s'"):format(verdict))
end

local ran, why = pcall(function()
  b:go("file://" .. page)
  b:wait("hooke.page && hooke.page.scene", 60)

  -- A scene runs to its end, as fast as it can, and its verdict is read.
  b:eval("hooke.page.obey('pace', { pace: 0 })")
  local verdict, complaint = ended()
  assert(verdict == "ok", ("the first scene ends %s: %s"):format(verdict, complaint))
  shown("ok")
  assert(b:eval("hooke.page.scenes.length") >= 7)
  print("string: ok, " .. b:eval("hooke.page.summary.steps") .. " steps")

  -- Where it ends: what the program writes.
  local file = assert(io.open(state, "wb"))
  file:write(b:eval("hooke.page.table()"))
  file:close()

  -- A fault is a sentence with its line, and the line is marked.
  b:eval([[(() => { const { editor } = hooke.page; editor.text = editor.text.replace('stiffness of one spring', 'x')
    .replace('scene:force("drag", { rate', 'scene:force("drag", { rat'); hooke.page.begin(); })()]])
  verdict, complaint = ended()
  assert(verdict == "" and complaint:find("^string%.lua:%d+: "), complaint)
  assert(complaint:find("rate", 1, true), complaint)
  assert(text("#wrong") == complaint)
  local line = tonumber(complaint:match("^string%.lua:(%d+):"))
  assert(text(".fault"):find("rat = 0.05", 1, true), text(".fault"))
  print(("a fault in line %d: %s"):format(line, complaint))

  -- A value at the start's button begins another run.
  assert(choose("string") == "ok")
  local before = b:eval("hooke.page.number")
  view("view.link.ask('start', { values: { k: 500 } })")
  b:wait(("hooke.page.number > %d"):format(before))
  assert(ended() == "ok")
  b:wait("hooke.page.summary.origin && JSON.stringify(hooke.page.summary.origin).includes('500')")

  -- A value by its slider acts on the run as it goes on: the same run, its frames stay, and its summary says so.
  b:eval("hooke.page.obey('pace', { pace: 1 })")
  b:eval("hooke.page.choose('string')")
  b:wait("hooke.page.under_way && hooke.page.history.frames > 10", 30)
  b:eval("hooke.page.obey('pause', {})")
  b:wait("hooke.page.doing === 'paused'")
  local same, frames = b:eval("hooke.page.number"), b:eval("hooke.page.history.frames")
  b:eval("hooke.page.obey('change', { values: { k: 700 } })")
  b:eval("hooke.page.obey('change', { values: { k: 500 } })")
  b:wait("Number((hooke.page.parameters.find((p) => p.name === 'k') || {}).value) === 500", 30)
  assert(b:eval("hooke.page.number") == same and b:eval("hooke.page.history.frames") == frames, "another run began")
  b:eval("hooke.page.obey('pace', { pace: 0 })")
  b:eval("hooke.page.obey('go', {})")
  verdict, complaint = ended()
  assert(verdict ~= "" and not b:eval("!!hooke.page.notice"), complaint)
  assert(b:eval("hooke.page.number") == same, "another run began")
  assert(b:eval("hooke.page.history.frames === Math.round(hooke.page.summary.t * hooke.page.summary.fps) + 1"), "frames are missing")
  assert(b:eval("hooke.page.summary.checked || hooke.page.summary.reason"):find("its parameters were changed while it ran", 1, true),
    b:eval("hooke.page.summary.checked || hooke.page.summary.reason"))
  print(("changed at frame %d: %s"):format(frames - 1, verdict))

  -- What only a start can have begins another run, which says why.
  b:eval("hooke.page.obey('pace', { pace: 1 })")
  b:eval("hooke.page.choose('string')")
  b:wait("hooke.page.under_way && hooke.page.history.frames > 3", 30)
  same = b:eval("hooke.page.number")
  b:eval("hooke.page.obey('change', { values: { n: 12 } })")
  b:wait(("hooke.page.number > %d && !!hooke.page.notice"):format(same), 30)
  print("notice: " .. b:eval("hooke.page.notice"))
  b:eval("hooke.page.obey('pace', { pace: 0 })")
  assert(ended() == "ok")
  b:eval("hooke.page.obey('pace', { pace: 1 })")

  -- Pause holds it, go lets it go on, stop ends it with its verdict.
  b:eval("hooke.page.choose('cloth')")
  b:wait("hooke.page.history && hooke.page.history.number === hooke.page.number && hooke.page.history.frames > 3", 30)
  b:eval("hooke.page.obey('pause', {})")
  b:wait("hooke.page.doing === 'paused'")
  frames = b:eval("hooke.page.history.frames")
  os.execute("sleep 0.3")
  assert(b:eval("hooke.page.history.frames") == frames, "it went on while it was paused")
  b:eval("hooke.page.obey('go', {})")
  b:wait(("hooke.page.history.frames > %d"):format(frames + 3), 30)
  b:wait("!!(document.querySelector('iframe').contentWindow.view || {}).page", 30)
  b:eval("hooke.page.obey('pause', {})")
  b:wait("hooke.page.doing === 'paused'")
  b:eval("new Promise((done) => setTimeout(done, 500))")
  b:screenshot(picture)
  b:eval("hooke.page.obey('stop', {})")
  verdict, complaint = ended()
  assert(verdict == "interrupted", verdict .. complaint)
  local list = b:complaints()
  assert(#list == 0, "the console has: " .. table.concat(list, "\n"))
end)
b:close()
if not ran then
  print("failed: " .. why)
  os.exit(1)
end
