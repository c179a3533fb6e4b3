-- The page of hooke run --watch in a real browser: it follows the run, drives it, tries values, and its user's hand
-- reaches the particles; and that the run does not mind what becomes of pages.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = ("%s/tests/?.lua;%s/tests/support/?.lua;%s"):format(root, root, package.path)
local fine = pcall(require, "cjson")
local browser = fine and require("support.view.browser")
local missing = not fine and "lua-cjson" or browser.missing()
  or (not io.open(build .. "/tools/server.so") and "libmicrohttpd, with which hooke is built,")
if missing then
  print(("skipped: %s is not installed (tools/install-deps test)"):format(missing))
  os.exit(77)
end
local watched = require("watch.watched")
local child = require("watch.child")

-- Of 13 x 13 particles at first; free to fall on nothing, it hangs by two corners.
local scene = [[
local N = param("N", 13, "particles along one side", { min = 3, max = 40 })
local k = param("k", 400, "structural stiffness, N/m", { min = 10, max = 1e5 })
local scene = hooke.scene { duration = 600 }
local sheet = scene:grid { nx = N, ny = N, width = 1, height = 1, mass = 0.2, group = "sheet" }
scene:pin { 1, N }
scene:force("gravity", {})
scene:force("springs", { edges = sheet:structural(), k = k, damping = 0.05, label = "structural" })
scene:force("springs", { edges = sheet:shear(), k = k / 2, damping = 0.05, label = "shear" })
scene:force("drag", { d = 0.002 })
scene:force("wind", { on = "particles", d = 1e-9, velocity = { 0, 2, 0 }, label = "breeze" })
scene:corrector("obstacle", { shape = "sphere", size = { 0.2, 0.2, 0.2 }, position = function(t) return { 3, t / 100, 0 } end })
return scene
]]

local folder = watched.folder()
local file = assert(io.open(folder .. "/sheet.lua", "w"))
file:write(scene)
file:close()
local w = watched.start(folder, "sheet.lua --no-output --forces")
local b = browser.open(1200, 800)

local function silent(where)
  local list = {}
  for _, text in ipairs(b:complaints()) do
    if not text:find("swiftshader") and not text:find("GPU stall") then list[#list + 1] = text end
  end
  assert(#list == 0, ("%s: the console has: %s"):format(where, table.concat(list, "\n")))
end

local function equal(got, wanted, what)
  if got ~= wanted then error(("%s: %s instead of %s"):format(what, got, wanted), 2) end
end

local function press(text)
  b:eval(("[...document.querySelectorAll('#drive button')].find((n) => n.textContent === '%s').click()"):format(text))
end

-- Where the particle with that id is on the page.
local function place(id)
  local p = b:eval(([[(() => {
    const { stage, layers } = view.page, { frame } = layers[0], i = frame.ids.indexOf(%d);
    const v = new THREE.Vector3(...frame.x.subarray(3 * i, 3 * i + 3));
    stage.render();
    v.applyMatrix4(layers[0].group.matrixWorld).project(stage.orbit.camera);
    const box = stage.canvas.getBoundingClientRect();
    return [box.left + (v.x + 1) / 2 * box.width, box.top + (1 - v.y) / 2 * box.height];
  })()]]):format(id))
  return math.floor(p[1] + 0.5), math.floor(p[2] + 0.5)
end

local function shown() return b:eval("view.page.layers[0].frame.k") end

local tests = {}

function tests.it_follows_the_run_without_a_complaint()
  b:go(w.url)
  b:wait("view.page && view.page.layers && view.page.layers[0].frame")
  b:eval("view.link.ask('pace', { pace: 1 })")
  local first = shown()
  b:wait(("view.page.layers[0].frame.k > %d + 10"):format(first))
  equal(b:eval("document.querySelector('.doing').textContent"), "running", "what it is doing")
  assert(b:eval("document.querySelectorAll('.chart path').length") > 3, "no lines in the charts")
  local energy = b:eval("(() => { const list = view.page.sources[0].series.filter((s) => s.group === 'Energy'), k = 5; "
    .. "return { names: list.map((s) => s.name).join(), values: list.map((s) => s.values[k]), times: list[2].values.length } })()")
  equal(energy.names, "kinetic,potential,total,work", "the chart of energies")
  equal(energy.values[3], energy.values[1] + energy.values[2], "the total energy")
  silent("following")
end

function tests.it_shows_obstacles_and_the_wind()
  local got = b:eval([[(() => { const { sources, layers } = view.page, { frame } = layers[0], [s] = sources;
    return { kind: s.solids.map((one) => one.kind).join(), t: frame.t, y: frame.solids[1] + s.origin[1], radius: frame.solids[3],
      marks: s.marks.map((m) => `${m.name} ${m.kind}`).join(), wind: [...frame.marks["mark 0"].vectors.subarray(0, 3)],
      count: frame.marks["mark 0"].count, n: frame.n, drawn: layers[0].solids.parts.length }; })()]])
  equal(got.kind, "sphere", "the obstacle")
  equal(got.marks, "breeze wind,contact contact", "what there is to mark")
  assert(math.abs(got.y - got.t / 100) < 1e-6 and math.abs(got.radius - 0.1) < 1e-6, "where it is, in single precision")
  assert(got.wind[1] == 0 and got.wind[2] == 2 and got.wind[3] == 0 and got.count == got.n)
  equal(got.drawn, 2, "the ball and its shadow")
  local groups = b:eval("(() => { const { sources: [s], layers: [{ frame }] } = view.page; "
    .. "const of = frame.groups; "
    .. "return `${s.groups.join()} ${of.length === frame.n} ${new Set(of).size} ${of[0]} ${frame.radii.length}` })()")
  equal(groups, "default,sheet true 1 1 0", "groups; there is no strand")
  silent("surroundings")
end

function tests.pause_single_frame_and_going_on()
  press("pause")
  w:wait(function(s) return s.doing == "paused" end)
  b:wait("document.querySelector('.doing').textContent === 'paused'")
  local frames = w:state().frames
  b:wait(("view.page.layers[0].frame.k === %d"):format(frames - 1))
  press("step")
  w:wait(function(s) return s.frames == frames + 1 end)
  b:wait(("view.page.layers[0].frame.k === %d"):format(frames))
  press("go on")
  w:wait(function(s) return s.doing == "running" and s.frames > frames + 5 end)
end

-- What is drawn are pixels of the sheet, not background alone, and they move.
function tests.an_earlier_frame_stays_while_the_run_goes_on()
  b:eval("view.page.clock.seek(3)")
  b:wait("view.page.layers[0].frame.k === 3")
  local frames = w:state().frames
  w:wait(function(s) return s.frames > frames + 20 end)
  equal(shown(), 3, "the frame shown")
  b:eval("view.page.clock.seek(1e9)")
  b:wait("view.page.layers[0].frame.k > 20")
end

local function choose(name, value)
  b:eval(([[(() => {
    const s = [...document.querySelectorAll("#controls label")].find((n) => n.textContent.startsWith("%s")).querySelector("select");
    s.value = "%s";
    s.dispatchEvent(new Event("change"));
  })()]]):format(name, value))
end

-- With --forces each force is a field: as arrows, which nothing has at first, and as colours.
function tests.forces_are_shown_as_arrows_and_colours()
  local drawn = "view.page.layers[0].arrows.geometry.instanceCount"
  equal(b:eval(drawn), 0, "arrows that nobody asked for")
  choose("Arrows", "force structural")
  choose("Colour", "force structural")
  b:wait(drawn .. " > 0")
  b:wait("document.getElementById('legend').textContent.includes('force: structural, N')")
  choose("Colour", "channel tension N")
  b:wait("document.getElementById('legend').textContent.includes('tension, N')")
  silent("forces")
  choose("Arrows", "")
  choose("Colour", "")
end

local function slide(name, where)
  b:eval(([[(() => { const s = document.querySelector('.value input[type=range][aria-label="%s"]'); s.value = %d;
    s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change')); })()]]):format(name, where))
end

-- The stiffness of 10 to 1e5 N/m, in the middle of a logarithmic slider 1,000.
function tests.a_slider_acts_on_the_run_under_way()
  local before = w:state()
  slide("k", 500)
  local state = w:wait(function(s) return s.values.k and s.frames > before.frames + 20 end)
  equal(state.run, before.run, "run")
  equal(tonumber(state.values.k), 1000.0, "k")
  b:wait(("view.page.layers[0].frame.k > %d && view.page.layers[0].source.number === %d"):format(before.frames + 10, before.run))
  equal(b:eval("view.page.layers[0].source.times[0]"), 0, "the first time that plots have")
  silent("a slider that acts")
end

-- The cloth of N x N: only a start can have other particles, and the page says why another run begins.
function tests.a_slider_begins_another_run_where_only_a_start_can_have_its_value()
  local run = w:state().run
  slide("N", 200)
  local state = w:wait(function(s) return s.run == run + 1 and s.frames > 5 end)
  equal(state.values.N, "10", "N at a fifth of 3 to 40") -- 3 + 37/5 = 10.4
  b:wait("view.page.layers[0].frame.n === 100")
  b:wait("document.querySelector('.notice').textContent.includes('particles in place of')")
  local sentence = b:eval("(() => { const p = document.querySelector('.restarts'); return p.hidden ? '' : p.textContent })()")
  assert(sentence:find("acts from the run's next frame on", 1, true), sentence)
  silent("a slider")
end

function tests.the_hand_takes_a_particle_and_moves_it()
  local n = 10 * 10
  w:wait(function(s) return s.frames > 30 end)
  press("pause") -- what is to be pressed on stands still
  w:wait(function(s) return s.doing == "paused" end)
  b:wait(("view.page.layers[0].frame.k === %d"):format(w:state().latest))
  local x, y = place(n - 4)
  local before = b:eval(("Array.from(view.page.layers[0].frame.x.subarray(%d, %d))"):format(3 * (n - 5), 3 * (n - 4)))
  b:post("/actions", { actions = {
    { type = "key", id = "keyboard", actions = { { type = "keyDown", value = "\u{E008}" }, { type = "pause", duration = 0 },
      { type = "pause", duration = 0 } } },
    { type = "pointer", id = "mouse", parameters = { pointerType = "mouse" }, actions = {
      { type = "pointerMove", duration = 0, x = x, y = y }, { type = "pointerDown", button = 0 },
      { type = "pointerMove", duration = 300, x = x + 120, y = y - 160 } } } } })
  b:wait("!!view.live.hand.held")
  press("go on")
  -- 0.1 m of the sheet's 1 m, and less than half of the 200 pixels away from the pointer: the sheet holds it back
  b:wait(([[(() => { const x = view.page.layers[0].frame.x;
    return Math.hypot(x[%d] - %.9g, x[%d] - %.9g, x[%d] - %.9g) > 0.1; })()]]):format(3 * n - 15, before[1], 3 * n - 14, before[2],
    3 * n - 13, before[3]))
  b:wait("(() => { const s = view.live.hand.seen(); return Math.hypot(s.x - view.live.hand.at[0], s.y - view.live.hand.at[1]) < 100; })()")
  if os.getenv("HK_SHOTS") then b:screenshot(os.getenv("HK_SHOTS") .. "/hand.png") end
  b:post("/actions", { actions = {
    { type = "key", id = "keyboard", actions = { { type = "pause", duration = 0 }, { type = "keyUp", value = "\u{E008}" } } },
    { type = "pointer", id = "mouse", parameters = { pointerType = "mouse" }, actions = { { type = "pointerUp", button = 0 } } } } })
  b:wait("!view.live.hand.held")
  press("stop")
  local state = w:wait(function(s) return s.doing == "ended" end)
  b:wait("document.querySelector('.doing').textContent === 'ended'")
  b:eval("view.live.hand.chosen = true")
  b:press(place(n - 4))
  b:eval("view.live.hand.chosen = false")
  assert(b:eval("document.querySelector('.doing.wrong').textContent"):find("the run has ended, so that a pull moves nothing", 1, true))
  assert(b:eval("!view.live.hand.held"))
  assert(state.summary.hand_work > 0, "no work")
  b:wait("/interrupted/.test(document.querySelector('#verdicts').textContent)")
  silent("the hand")
end

function tests.a_wrong_value_is_told_in_the_page_and_the_next_run_is_fine()
  b:eval("view.live.drive.again({ N: 99 })")
  b:wait("/above the maximum 40/.test(document.querySelector('.doing').textContent)")
  b:eval("view.live.drive.again({ N: 8 })")
  b:wait("view.page.layers[0].frame.n === 64")
  silent("a wrong value")
end

function tests.ten_pages_at_once_and_their_end_do_no_harm()
  b:eval("view.live.drive.again({ N: 3 })")
  for _ = 1, 9 do b:eval(("!!window.open('%s')"):format(w.url)) end
  local frames = w:state().frames
  w:wait(function(s) return s.frames > frames + 30 end)
  b:close() -- the browser is killed with all of its pages
  frames = w:state().frames
  w:wait(function(s) return s.frames > frames + 30 and s.doing == "running" end)
  equal(w:interrupt(), 130, "exit code")
  assert(w:printed():find("verdict +interrupted"), w:printed())
end

local order = { "it_follows_the_run_without_a_complaint", "it_shows_obstacles_and_the_wind", "pause_single_frame_and_going_on",
  "an_earlier_frame_stays_while_the_run_goes_on", "a_slider_acts_on_the_run_under_way",
  "a_slider_begins_another_run_where_only_a_start_can_have_its_value",
  "forces_are_shown_as_arrows_and_colours",
  "the_hand_takes_a_particle_and_moves_it", "a_wrong_value_is_told_in_the_page_and_the_next_run_is_fine",
  "ten_pages_at_once_and_their_end_do_no_harm" }

local failed = 0
for _, name in ipairs(order) do
  local begin = child.clock()
  local went, why = xpcall(tests[name], debug.traceback)
  if not went then
    failed = failed + 1
    pcall(b.screenshot, b, folder .. "/failed.png")
    print(("FAILED %s: %s"):format(name, why))
    break -- those behind it go on from where it ends
  end
  print(("ok     %s (%.1f s)"):format(name, child.clock() - begin))
end
pcall(b.close, b)
w:close()
os.exit(failed == 0)
