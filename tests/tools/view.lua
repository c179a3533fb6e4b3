-- The page in a real browser: it loads without a complaint, shows what it has to show, is moved, picked in and coloured,
-- reads back what was written, and is not harmed by names of a scene.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = ("%s/tests/?.lua;%s"):format(root, package.path)
local fine, cjson = pcall(require, "cjson")
local browser = fine and require("support.view.browser")
local function there(path)
  local file = io.open(path)
  return file and file:close()
end

local missing = not fine and "lua-cjson" or browser.missing()
  or not there(build .. "/tools/page.so") and "zlib (for the build)"
if missing then
  print(("skipped: %s is not installed (tools/install-deps test)"):format(missing))
  os.exit(77)
end

local folder = require("support.view.pages").write(root, build)
local b = browser.open(960, 620)

local open, silent, show, place, pixel = require("support.view.seen").of(b, folder)
local tests = {}

-- ---- a sheet that waves, z = 0.15 sin(4 x - 6 t) x: 16 x 16, 100 frames ----

function tests.it_loads_without_a_complaint()
  open("sheet")
  assert(b:eval("document.title") == "sheet")
  assert(b:eval("document.querySelector('.verdict strong').textContent") == "inaccurate")
  assert(b:eval("document.querySelector('.verdict p').textContent") == "the step is too long <b>")
  assert(b:eval("document.querySelector('#note').textContent"):find("of the extent", 1, true))
  for _, title in ipairs { "Energy", "Step length", "Cost by plugin", "Warnings", "Parameters", "Speed against error" } do
    assert(b:eval("document.body.innerText"):find(title, 1, true), title)
  end
  silent("sheet")
end

function tests.the_sheet_has_its_colour_and_the_background_that_of_the_page()
  local red, green, blue, alpha = pixel(place(119)) -- in the middle of the sheet
  assert(blue > green and green > red and alpha == 255, ("%d %d %d"):format(red, green, blue))
  local x, y = place(0) -- pinned: a ball of another colour
  red, green, blue = pixel(x, y)
  assert(red > green and green > blue, ("%d %d %d"):format(red, green, blue))
  red, green, blue, alpha = pixel(20, 100) -- the sky
  local paper = b:eval("getComputedStyle(document.body).backgroundColor")
  assert(alpha == 255 and ("rgb(%d, %d, %d)"):format(red, green, blue) == paper, ("%d %d %d, %s"):format(red, green, blue, paper))
end

function tests.the_picture_moves_with_the_timeline()
  show(0)
  local _, before = place(255)
  show(30)
  local _, after = place(255)
  assert(math.abs(after - before) > 20)
  b:key("\u{E014}") -- right arrow
  b:wait("view.page.clock.k === 31")
  b:key("\u{E011}") -- home
  b:wait("view.page.clock.k === 0")
  b:key(" ")
  b:wait("view.page.clock.k > 5")
  b:key(" ")
  assert(b:eval("view.page.clock.playing") == false)
  assert(b:eval("Number(document.querySelector('#timeline input').value) === view.page.clock.k"))
end

function tests.a_press_in_a_plot_moves_all_cursors_and_the_picture()
  local box = b:eval("(() => { const r = document.querySelector('.chart').getBoundingClientRect(); "
    .. "return [r.left, r.top, r.width, r.height] })()")
  b:press(math.floor(box[1] + 60 + (box[3] - 70) / 2), math.floor(box[2] + box[4] / 2))
  b:wait("Math.abs(view.page.clock.k - 49.5) <= 1") -- the middle of 100 frames, of which a pixel has 0.3
  local xs = b:eval("[...document.querySelectorAll('.cursor')].map((c) => Number(c.getAttribute('x1')))")
  assert(#xs == 2 and xs[1] == xs[2])
end

-- A chart's lines can be hidden, it grows, and it hands out its picture and its numbers; the view its picture.
function tests.a_chart_can_be_read_closely_and_saved()
  b:eval([[(() => {
    const node = document.body.appendChild(document.createElement("div"));
    node.id = "own";
    const line = (name, values) => ({ name, run: 0, times: [0, 0.5, 1], values });
    const lines = [line("small", [0, 1, 2]), line("large, too", [0, null, 100])];
    view.plots.make(node, [{ title: "a b", unit: "J", lines }], () => {}).draw();
    window.saves = {};
    window.save = view.dom.save;
    view.dom.save = (name, blob) => blob.text().then((text) => { window.saves[name] = text; });
    return true;
  })()]])
  local function count(what) return b:eval(("document.querySelectorAll('#own %s').length"):format(what)) end
  local function press(title) b:eval(("(document.querySelector('#own [title=\"%s\"]').click(), true)"):format(title)) end
  local function ticks()
    return b:eval("[...document.querySelectorAll('#own text[text-anchor=end]')].map((t) => t.textContent).join(' ')")
  end
  assert(count("path.line") == 2 and ticks():find("100", 1, true), ticks())
  b:eval("(document.querySelectorAll('#own .key-item')[1].click(), true)")
  assert(count("path.line") == 1 and count("[aria-pressed=false]") == 1 and not ticks():find("100", 1, true), ticks())
  press("larger or smaller")
  assert(b:eval("document.querySelector('#own svg').getAttribute('height')") == "340")
  press("save the numbers")
  b:wait("!!window.saves['a_b.csv']")
  local numbers = 'run,time (s),small,"large, too"\n1,0,0,0\n1,0.5,1,\n1,1,2,100\n' -- also of what is hidden
  assert(b:eval("window.saves['a_b.csv']") == numbers)
  press("save the chart as a picture")
  b:wait("!!window.saves['a_b.svg']")
  local drawn = b:eval([[(() => {
    const root = new DOMParser().parseFromString(window.saves["a_b.svg"], "image/svg+xml").documentElement;
    const path = root.querySelector("path");
    const painted = [path.getAttribute("fill"), path.getAttribute("stroke").slice(0, 3)];
    return [root.localName, root.querySelector("title").textContent, ...painted].join(" ");
  })()]])
  assert(drawn == "svg a b, J none rgb", drawn)
  b:eval("(document.querySelector('#own').remove(), true)")
  b:eval("([...document.querySelectorAll('button')].find((e) => e.textContent === 'PNG').click(), true)")
  b:wait("Object.keys(window.saves).some((name) => name.endsWith('.png') && window.saves[name].slice(1, 4) === 'PNG')")
  b:eval("(view.dom.save = window.save, true)")
end

-- A run that has just begun has no times yet; its charts are drawn nevertheless, without a coordinate that is no number.
function tests.a_chart_without_a_number_is_drawn()
  assert(b:eval([[(() => {
    const node = document.body.appendChild(document.createElement("div"));
    const line = { name: "a", run: 0, times: [], values: [] };
    const chart = view.plots.make(node, [{ title: "nothing", lines: [line] }], () => {});
    const right = () => {
      chart.draw();
      chart.show(0.5, [0]);
      return !!node.querySelector(".cursor")
        && ![...node.querySelectorAll("*")].some((n) => [...n.attributes].some((a) => /NaN|Infinity|undefined/.test(a.value)));
    };
    const empty = right();
    line.times.push(0.5);
    line.values.push(null);
    const unknown = right();
    node.remove();
    return empty && unknown;
  })()]]))
end

function tests.a_press_on_a_particle_tells_what_is_known_of_it()
  show(20)
  b:press(place(255))
  b:wait("!document.querySelector('#inspector').hidden")
  local text = b:eval("document.querySelector('#inspector').innerText")
  for _, what in ipairs { "Particle 256", "position", "velocity", "strain", "force: gravity", "−0.00981 N" } do
    assert(text:find(what, 1, true), what .. " in " .. text)
  end
  local t = 20 / 60 -- the known motion at (1, 1)
  local z, v = 0.15 * math.sin(4 - 6 * t), -0.9 * math.cos(4 - 6 * t)
  local got_z = tonumber((text:match("position%s+1, 1, (%S+) m"):gsub("−", "-")))
  local got_v = tonumber((text:match("velocity%s+0, 0, (%S+) m/s"):gsub("−", "-")))
  assert(math.abs(got_z - z) < 2e-5, ("%g %g"):format(got_z, z)) -- 1e-5 of the extent, and its rounding
  assert(math.abs(got_v - v) < 1.4e-3, ("%g %g"):format(got_v, v)) -- half of 1/1022 of the range, 8.8e-4, and three digits
  b:key("\u{E00C}") -- escape
  b:wait("document.querySelector('#inspector').hidden")
end

-- The pins of the sheet are balls; none of them is half in the floor.
function tests.the_floor_is_below_what_is_drawn()
  local floor, low, ball = table.unpack(b:eval("(() => { const { stage, layers } = view.page; stage.render(); "
    .. "return [stage.floorHeight, layers[0].source.bounds.low[2], layers[0].pins.own.radius.value] })()"))
  assert(ball > 0 and floor < low - ball, ("floor at %g, lowest particle at %g, radius %g"):format(floor, low, ball))
end

-- 60 frames a second: the trail at frame k has k pieces, the first one from where the particle was at the start.
function tests.trails_show_where_particles_have_been()
  local function press() -- the box
    b:eval("[...document.querySelectorAll('#controls label')].find((n) => n.textContent === 'trails').querySelector('input').click()")
  end
  local pieces = "view.page.layers[0].trails.segments.geometry.instanceCount"
  show(20)
  b:press(place(255))
  press()
  b:wait(pieces .. " === 20")
  local places = b:eval("(() => { const { begin, end } = view.page.layers[0].trails.segments.geometry.attributes; "
    .. "const o = view.page.sources[0].origin; "
    .. "return [...begin.array.slice(0, 3), ...end.array.slice(57, 60)].map((v, c) => v + o[c % 3]) })()")
  for k, t in ipairs { 0, 20 / 60 } do
    local x, y, z = table.unpack(places, 3 * k - 2, 3 * k)
    local off = math.max(math.abs(x - 1), math.abs(y - 1), math.abs(z - 0.15 * math.sin(4 - 6 * t)))
    assert(off < 2e-5, ("at %g s: off by %g m"):format(t, off)) -- of the recorded positions, as above
  end
  show(50)
  b:wait(pieces .. " === 50") -- the frames that were passed over came
  show(10)
  b:wait(pieces .. " === 10")
  b:key("\u{E00C}") -- escape: none is picked
  b:wait(pieces .. " === 10 * 256")
  press()
  b:wait(pieces .. " === 0")
  silent("trails")
end

-- By strain, 0.02 cos(4 x - 6 t), the sheet is blue where it is negative, and red where it is positive.
function tests.colours_stand_for_numbers_and_have_a_legend()
  show(0)
  b:eval("(() => { const s = [...document.querySelectorAll('#controls select')][0]; s.value = 'strain'; "
    .. "s.dispatchEvent(new Event('change')) })()")
  b:wait("!document.querySelector('#legend').hidden")
  local red, _, blue = pixel(place(16 * 7 + 1)) -- x = 1/15: cos(0.27) > 0
  assert(red > 1.5 * blue, ("%d %d"):format(red, blue))
  red, _, blue = pixel(place(16 * 7 + 11)) -- x = 11/15: cos(2.9) < 0
  assert(blue > 1.5 * red, ("%d %d"):format(red, blue))
  local ends = b:eval("document.querySelector('#legend').innerText")
  assert(ends:find("strain", 1, true) and ends:find("0.02", 1, true), ends)
end

-- All numbers are known of the recording; an end beyond which some lie is pointed, and its number says so.
function tests.ends_of_colours_that_saturate_are_marked()
  local wrong = b:eval("view.page.sources[0].fields.filter((f) => f.map && !(f.lowest <= f.highest)).map((f) => f.name).join()")
  assert(wrong == "", wrong)
  for _, try in ipairs { { "0, 1", "0 0.5 1", "" }, { "-1, 1", "≤ 0 0.5 1", "below" }, { "0, 2", "0 0.5 ≥ 1", "above" } } do
    local got = b:eval(([[(() => {
      const node = document.createElement("div"), { legend, scale } = view.colours;
      legend(node, "x", scale(0, 1, "viridis", %s));
      return { text: [...node.querySelectorAll(".legend-ends span")].map((one) => one.textContent).join(" "),
        points: [...node.querySelectorAll(".legend-point:not([hidden])")].map((one) => one.classList[1]).join() };
    })()]]):format(try[1]))
    assert(got.text == try[2] and got.points == try[3], ("%s: '%s' '%s'"):format(try[1], got.text, got.points))
  end
end

-- Options of the command line are said as settings of the scene as well, for those who have none.
function tests.the_verdict_says_what_to_set_in_the_scene()
  local function said(reason)
    return b:eval(("(view.report.verdict({ verdict: 'inaccurate', reason: '%s', warnings: [] })[0].querySelector('.in-scene') "
      .. "|| { textContent: '' }).textContent"):format(reason))
  end
  local text = said("the error is 3 mm; --dt 1e-04 (2e+04 steps) would do; try --integrator ias15")
  assert(text == 'In the scene: hooke.scene { dt = 1e-04 }, or hooke.scene { integrator = "ias15" }', text)
  text = said("no --tol would do, as errors of rk45 fall to tolerances of 1e-14")
  assert(text == "", text)
end

-- The bar beside arrows is as long as an arrow of that size across the line of sight, and follows the camera. A sheet of velocities.
function tests.arrows_have_a_legend_of_their_length()
  show(10)
  local function choose(name)
    b:eval(("(() => { const s = [...document.querySelectorAll('#controls label')].find((n) => n.textContent.startsWith('Arrows'))"
      .. ".querySelector('select'); s.value = '%s'; s.dispatchEvent(new Event('change')) })()"):format(name))
  end
  choose("velocity")
  b:wait("!document.querySelector('#arrow-scale').hidden && document.querySelector('.arrow-bar')")
  local got = b:eval([[(() => {
    const { stage, arrowScale: s } = view.page, text = document.querySelector("#arrow-scale").textContent, { camera } = stage.orbit;
    const size = Number(text.split(" ")[0]), half = new THREE.Vector3(size * s.length / 2, 0, 0).transformDirection(camera.matrixWorld)
      .multiplyScalar(size * s.length / 2);
    const [a, b] = [-1, 1].map((sign) => stage.middle.clone().addScaledVector(half, sign).project(camera));
    return { text, size, largest: s.field.largest, seen: (b.x - a.x) / 2 * stage.canvas.clientWidth,
      bar: parseFloat(document.querySelector(".arrow-bar").style.width) };
  })()]])
  assert(got.text:find(" m/s", 1, true) and got.size <= got.largest and got.size > got.largest / 2.51, got.text)
  assert(math.abs(got.bar - got.seen) < 0.2, ("%g pixels, and %g are seen"):format(got.bar, got.seen)) -- tenths are written
  b:eval("(() => { view.page.stage.orbit.distance /= 2; view.page.stage.orbit.update(); view.page.stage.render(); })()")
  local near = b:eval("parseFloat(document.querySelector('.arrow-bar').style.width)")
  assert(math.abs(near / got.bar - 2) < 0.02, near / got.bar)
  b:eval("view.page.stage.home()")
  if os.getenv("HK_SHOTS") then b:screenshot(os.getenv("HK_SHOTS") .. "/arrows.png") end
  choose("")
  b:wait("document.querySelector('#arrow-scale').hidden")
  silent("arrows")
end

function tests.the_camera_turns_and_comes_back()
  local x, y = place(255)
  b:press(400, 300, { 500, 330 })
  local turned_x = place(255)
  assert(math.abs(turned_x - x) > 20)
  b:eval("view.page.stage.home()")
  local back_x, back_y = place(255)
  assert(back_x == x and back_y == y)
end

function tests.another_size_of_the_window_is_followed()
  b:size(700, 900)
  b:wait("view.page.stage.canvas.clientWidth < 720")
  b:wait("Math.abs(view.page.stage.canvas.width - view.page.stage.canvas.clientWidth) < 2")
  assert(b:eval("document.documentElement.scrollWidth <= innerWidth"))
  b:size(960, 763)
  silent("sheet, later")
end

function tests.the_diagram_of_bench_tells_the_dot_under_the_pointer()
  assert(b:eval("document.querySelectorAll('.bench-chart circle').length") == 3)
  b:eval("document.querySelectorAll('.bench-chart circle')[2].dispatchEvent(new PointerEvent('pointerenter'))")
  local text = b:eval("document.querySelector('.told').textContent")
  assert(text:find("rk4", 1, true) and text:find("error 10⁻⁴", 1, true) and text:find("cost 0.05 s", 1, true), text)
end

-- ---- two runs; the second is off by 0.1 x t ----

function tests.two_runs_are_compared()
  open("two")
  show(59)
  b:eval("view.page.arrange('difference')")
  b:wait("!document.querySelector('#legend').hidden")
  local most = b:eval("Math.max(...view.compare.distances(view.page.layers[0].frame, view.page.layers[1].frame, "
    .. "view.page.sources[0].origin, view.page.sources[1].origin))")
  local off = 0.1 * 59 / 60
  assert(math.abs(most - off) < 4e-5, most) -- both are off by 1e-5 of the extent, and single precision
  assert(math.abs(b:eval("view.page.more.difference.largest") - off) < 1e-9)
  b:wait("[...document.querySelectorAll('.chart-title')].some((t) => t.textContent.startsWith('Distance between the runs'))")
  for _, mode in ipairs { "over", "side" } do
    b:eval(("view.page.arrange('%s')"):format(mode))
    b:eval("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
  end
  silent("two runs")
end

-- ---- groups and thick strands ----

function tests.groups_and_bodies_have_colours_and_strands_their_thickness()
  open("groups")
  b:eval("(() => { const s = document.querySelector('#controls select'); s.value = 'by group'; s.dispatchEvent(new Event('change')) })()")
  b:wait("!document.querySelector('#legend').hidden")
  local names = b:eval("[...document.querySelectorAll('.legend-group')].map((n) => n.textContent)")
  assert(table.concat(names, ", ") == "rope, thread <b>, crate", table.concat(names, ", "))
  local own = b:eval([[(() => { const { layers: [{ edges, solids, points, frame }] } = view.page, { attributes: a } = edges.geometry;
    return [...a.own.array.slice(0, 2), ...[0, 3].map((i) => [...a.colourBegin.array.slice(i, i + 3)]),
      solids.bodies[0].object.material.uniforms.own.value.toArray(), frame.radii.length, points.own.sized.value] })()]])
  assert(math.abs(own[1] - 0.1) < 1e-7 and math.abs(own[2] - 0.04) < 1e-7) -- single precision
  for k, group in ipairs { 1, 2, 3 } do
    for c, value in ipairs(b:eval(("view.colours.group(%d)"):format(group))) do assert(math.abs(own[2 + k][c] - value) < 1e-6) end
  end
  assert(own[6] == 4 and own[7] == 1)
  b:press(place(3))
  b:wait("document.querySelector('#inspector').innerText.includes('thread <b>')")
  silent("groups")
end

-- ---- births, deaths, a number that is none, and names that would be markup ----

function tests.what_was_written_is_read_back_within_the_error_that_is_said()
  open("births")
  local file = assert(io.open(folder .. "/births.json"))
  local expected = cjson.decode(file:read("a"))
  file:close()
  for _, k in ipairs { 0, 1, 2, 59, 60, 61, 30, 88, 89, 5 } do -- in blocks and across them, forwards and back
    local got = b:eval(("view.page.sources[0].frame(%d, ['velocity']).then((f) => ({ ids: [...f.ids], x: [...f.x], "
      .. "v: [...f.values.velocity], origin: view.page.sources[0].origin }))"):format(k))
    local want = expected.frames[k + 1]
    assert(#got.ids == #want.ids and #got.x == #want.x, ("frame %d has %d particles"):format(k, #got.ids))
    for i, id in ipairs(want.ids) do assert(got.ids[i] == id) end
    for i, x in ipairs(want.x) do
      local read = got.x[i]
      assert((x == cjson.null) == (read == cjson.null), "a number that is none stays none")
      local c = (i - 1) % 3 + 1
      -- single precision, relative to the middle: 6e-8 of the extent
      assert(x == cjson.null or math.abs(read + got.origin[c] - x) <= expected.errors.position + 1e-7 * expected.extent)
      assert(math.abs(got.v[i] - want.v[i]) <= expected.errors.velocity + 1e-7)
    end
  end
  -- By construction half a step of 1/65534 of the extent in each direction.
  assert(expected.errors.position <= math.sqrt(3) / 2 / 65534 * expected.extent * (1 + 1e-9))
  assert(expected.errors.position < 1e-4 * expected.extent)
end

function tests.names_of_a_scene_are_text_and_nothing_in_the_page_reaches_out()
  assert(b:eval("window.harmed === undefined"))
  assert(b:eval("document.querySelector('h1').textContent"):find("{{scripts}}", 1, true))
  assert(b:eval("document.querySelectorAll('img').length") == 0)
  assert(b:eval("[...document.scripts].filter((s) => !s.type).every((s) => s.nonce)"))
  silent("births")
  b:eval("(() => { const s = document.createElement('script'); s.textContent = 'window.harmed = 3'; document.body.append(s) })()")
  assert(b:eval("window.harmed === undefined"))
  assert(b:eval("fetch('http://127.0.0.1:9/').then(() => false, () => true)"))
  assert(b:eval("new Promise((done) => { const i = new Image(); i.onload = () => done(false); i.onerror = () => done(true); "
    .. "i.src = 'data:image/gif;base64,R0lGODlhAQABAAAAACw=' })"))
end

local order = { "it_loads_without_a_complaint", "the_sheet_has_its_colour_and_the_background_that_of_the_page",
  "the_picture_moves_with_the_timeline", "a_press_in_a_plot_moves_all_cursors_and_the_picture",
  "a_chart_can_be_read_closely_and_saved", "a_chart_without_a_number_is_drawn",
  "a_press_on_a_particle_tells_what_is_known_of_it", "the_floor_is_below_what_is_drawn",
  "trails_show_where_particles_have_been", "colours_stand_for_numbers_and_have_a_legend",
  "ends_of_colours_that_saturate_are_marked", "the_verdict_says_what_to_set_in_the_scene",
  "arrows_have_a_legend_of_their_length",
  "the_camera_turns_and_comes_back", "another_size_of_the_window_is_followed",
  "the_diagram_of_bench_tells_the_dot_under_the_pointer", "two_runs_are_compared",
  "groups_and_bodies_have_colours_and_strands_their_thickness",
  "what_was_written_is_read_back_within_the_error_that_is_said",
  "names_of_a_scene_are_text_and_nothing_in_the_page_reaches_out" }

local failed = 0
for _, name in ipairs(order) do
  local went, why = xpcall(tests[name], debug.traceback)
  if not went then
    failed = failed + 1
    b:screenshot(folder .. "/failed.png")
    print(("FAILED %s: %s (%s/failed.png)"):format(name, why, folder))
  end
end
b:close()
if failed == 0 then os.execute(("rm -rf '%s'"):format(folder)) end
print(failed == 0 and "passed" or failed .. " failed")
os.exit(failed == 0)
