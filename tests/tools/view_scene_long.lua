-- What a page shows beside particles, in a real browser: obstacles where they are, at every frame, the floor among them.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = ("%s/tests/?.lua;%s"):format(root, package.path)
local fine, browser = pcall(require, "support.view.browser")
local page = io.open(build .. "/tools/page.so")
local missing = not fine and "lua-cjson" or browser.missing() or not page and "zlib (for the build)"
if missing then
  print(("skipped: %s is not installed (tools/install-deps test)"):format(missing))
  os.exit(77)
end
page:close()

local folder = require("support.view.pages").write(root, build)
local b = browser.open(960, 620)
local open, silent, show, _, pixel = require("support.view.seen").of(b, folder)

-- Where a point of the scene is on the page: x, y.
local function at(x, y, z)
  local p = b:eval(([[(() => {
    const { stage, layers, sources } = view.page, o = sources[0].origin, v = new THREE.Vector3(%g - o[0], %g - o[1], %g - o[2]);
    stage.render();
    v.applyMatrix4(layers[0].group.matrixWorld).project(stage.orbit.camera);
    const box = stage.canvas.getBoundingClientRect();
    return [box.left + (v.x + 1) / 2 * box.width, box.top + (1 - v.y) / 2 * box.height];
  })()]]):format(x, y, z))
  return math.floor(p[1] + 0.5), math.floor(p[2] + 0.5)
end

local function switch(name)
  b:eval(("[...document.querySelectorAll('#controls label')].find((l) => l.textContent === '%s').querySelector('input').click()")
    :format(name))
  b:eval("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
end

-- Obstacles are a warm grey, which is opaque; behind them is the floor, colder, or nothing.
local function is_solid(x, y, z)
  local red, _, blue, alpha = pixel(at(x, y, z))
  return alpha == 255 and red > blue
end

local tests = {}
local function test(name, run) tests[#tests + 1] = { name, run } end

-- A ball of 0.4 m at (0.1 k, 0, 0), a cube of 1 m at (3, 0, 0), a floor at z = -0.5; particles are at x = -1 and y = 1.2.

test("obstacles are drawn where they are", function()
  open("solids")
  for _, k in ipairs { 0, 19 } do
    show(k)
    local middle = 0.1 * (k + 1)
    assert(is_solid(middle, 0, 0) and is_solid(middle, 0, 0.36), "the ball")
    assert(not is_solid(middle, 0, 0.5), "above the ball")
    assert(is_solid(3, 0, 0) and is_solid(2.6, -0.4, 0.45) and not is_solid(3, 0, 0.7), "the cube")
  end
  show(0)
  assert(not is_solid(2, 0, 0) , "the ball has not come there yet")
  silent("solids")
end)

test("the floor is the level plane", function()
  local height = b:eval("view.page.stage.floorHeight + view.page.sources[0].origin[2]")
  assert(math.abs(height + 0.5) < 1e-6, height)
  assert(b:eval("view.page.layers[0].solids.planes[0].disc.mesh.visible") == false, "a second one in its place")
end)

test("they cast a shadow on the floor", function()
  show(0)
  -- The sun's direction is (-0.45, -0.55, 0.85): the middle of the ball, 0.5 m above the floor, is cast there.
  local x, y = 0.1 + 0.5 * 0.45 / 0.85 + 0.25, 0.5 * 0.55 / 0.85 + 0.3 -- and a little farther, where the ball hides nothing
  local shade = pixel(at(x, y, -0.5))
  switch("shadows")
  local light = pixel(at(x, y, -0.5))
  assert(shade < light - 10, ("%d is not darker than %d"):format(shade, light))
  switch("shadows")
end)

test("they can be switched off", function()
  switch("obstacles")
  assert(not is_solid(3, 0, 0.3))
  switch("obstacles")
  assert(is_solid(3, 0, 0.3))
end)

-- The colour there is much greener than red, or redder than green.
local function is_green(x, y, z)
  local red, green = pixel(at(x, y, z))
  return green > 1.5 * red
end

local function is_red(x, y, z)
  local red, green = pixel(at(x, y, z))
  return red > 2 * green
end

test("the wind is an arrow", function()
  show(5)
  local length = 0.18 * b:eval("view.page.layers[0].size")
  assert(is_green(-1, 0.3 * length, 1), "the arrow")
  assert(not is_green(-1, -0.3 * length, 1), "behind its place")
  switch("wind")
  b:wait("!view.page.layers[0].wind.mesh.visible")
  assert(not is_green(-1, 0.3 * length, 1), "switched off")
  switch("wind")
  b:wait("view.page.layers[0].wind.mesh.visible")
  show(12)
  assert(b:eval("view.page.layers[0].wind.mesh.visible") == false, "it does not blow any more")
end)

test("contacts are dots, and of many the page says how many it shows", function()
  show(5)
  assert(not is_red(2, 1.2, 0.5), "they are not asked for")
  switch("contacts")
  b:wait("view.page.layers[0].contacts.mesh.visible")
  assert(is_red(2, 1.2, 0.5))
  show(12)
  b:wait("document.querySelector('#note').textContent.includes('1000 of 4000 contacts are shown')")
  silent("marks")
end)

-- A headless browser draws by software; a page that takes it for a graphics card draws points. Their rims differ: a point
-- is cut off in the middle of a pixel, and a ball that the page draws has whole ones.
test("many particles look without a graphics card as with one", function()
  open("many")
  local off = b:eval([[(() => {
    const { page } = view, { stage } = page, gl = stage.renderer.getContext(), frame = page.layers[0].frame;
    const paint = new Float32Array(3 * frame.n).map((_, k) => [0.9, 0.5, 0.2][k % 3]);
    stage.orbit.zoom(0.2);
    stage.orbit.update();
    stage.floorless = true;
    const seen = (software) => {
      page.economy.software = software;
      page.layers[0].show(frame, paint, null, null);
      stage.render();
      const { width, height } = stage.canvas, got = new Uint8Array(4 * width * height);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, got);
      return got;
    };
    page.layers[0].shown.shadows = false;
    const page_s = seen(true), graphics = seen(false);
    let balls = 0, sum = 0, inside = 0;
    for (let k = 0; k < graphics.length; k += 4) {
      if (graphics[k + 3] > 0) balls++;
      if (graphics[k + 3] !== 255 || page_s[k + 3] !== 255) continue;
      inside++;
      for (let c = 0; c < 3; c++) sum += Math.abs(graphics[k + c] - page_s[k + c]) / 3;
    }
    page.economy.software = true;
    return { balls, inside, mean: sum / inside };
  })()]])
  assert(off.balls > 20000 and off.inside > 0.8 * off.balls, ("%d of %d"):format(off.inside, off.balls))
  assert(off.mean < 7 + 4, off.mean) -- of 255: half a step of brightness, and of colour
  silent("many")
end)

-- Pictures that come 100 ms after each other, by a clock of the test's own, while it plays.
test("a slow machine draws fewer particles, and the page says so", function()
  open("many")
  local drawn = "view.page.layers[0].splats.many.count"
  assert(b:eval(drawn) == 24000)
  b:eval([[(() => {
    const { page } = view, real = performance.now.bind(performance), frame = page.layers[0].frame;
    let at = real();
    performance.now = () => at += 100;
    page.clock.playing = true;
    page.layers[0].splats.took = 50; // as a slow processor does
    for (let k = 0; k < 8; k++) page.show([frame]);
    page.clock.playing = false;
    performance.now = real;
    page.show([frame]);
  })()]])
  assert(b:eval(drawn) == 12000, b:eval(drawn))
  local note = b:eval("document.querySelector('#note').textContent")
  assert(note:find("one of 2 particles is drawn, of 24000", 1, true), note)
  silent("many")
end)

-- The eye is at y < 0 (side -1) or y > 0, and at the height of the sheet's middle.
local function face(side)
  b:eval(("(() => { const { orbit } = view.page.stage; Object.assign(orbit, { azimuth: %d * Math.PI / 2, height: 0 }).update(); })()")
    :format(side))
end

-- The id that a press on the place of particle i takes.
local function taken(i)
  return b:eval(([[(() => {
    const { stage, layers } = view.page, v = new THREE.Vector3(...layers[0].frame.x.subarray(%d, %d));
    stage.render();
    v.applyMatrix4(layers[0].group.matrixWorld).project(stage.orbit.camera);
    const found = stage.pick((v.x + 1) / 2 * stage.canvas.clientWidth, (1 - v.y) / 2 * stage.canvas.clientHeight);
    return found ? found.id : 0;
  })()]]):format(3 * i - 3, 3 * i))
end

local function opacity() return b:eval("view.page.layers[0].solids.bodies[0].object.material.uniforms.opacity.value") end

test("a press takes no particle that a surface or an obstacle hides", function()
  open("sight")
  for side, hidden in pairs { [-1] = 5, [1] = 6 } do
    show(0)
    face(side)
    if side == 1 then switch("obstacles") end -- the wall would be before all
    for id = 1, 6 do
      local got = taken(id)
      assert(got == (id == hidden and 0 or id), ("from side %d a press on %d takes %d"):format(side, id, got))
    end
  end
  switch("obstacles")
  face(-1)
  show(2)
  assert(taken(6) == 0 and taken(1) == 1, "behind the small wall, and beside it")
end)

test("obstacles that hide more than half of the motion are transparent", function()
  face(-1)
  for k, wanted in pairs { [0] = 1, [1] = 0.18, [2] = 1 } do -- as pictures: all is hidden; one of six particles is
    show(k)
    b:eval("view.page.stage.render()")
    assert(math.abs(opacity() - wanted) < 1e-9, ("%g in frame %d"):format(opacity(), k))
  end
  show(0)
  local sheet = { pixel(at(0.6, 0, 0.6)) }
  show(1)
  local veiled = { pixel(at(0.6, 0, 0.6)) }
  local wall = { pixel(at(0.5, -1, 1.4)) } -- above the sheet, before the background
  switch("obstacles")
  local behind = { pixel(at(0.5, -1, 1.4)) }
  switch("obstacles")
  for c = 1, 3 do -- a veil of 0.18 of a colour
    assert(math.abs(veiled[c] - sheet[c]) <= 0.18 * 255 + 1, ("%d and %d"):format(veiled[c], sheet[c]))
    assert(math.abs(wall[c] - behind[c]) <= 0.18 * 255 + 1, ("%d and %d"):format(wall[c], behind[c]))
  end
  assert(wall[1] ~= behind[1] and veiled[1] ~= sheet[1], "it is seen")
  assert(taken(6) == 6 and taken(5) == 0, "through the veil, but not through the sheet")
  face(1)
  b:eval("view.page.stage.render()")
  assert(opacity() == 1, "from behind, where it hides nothing")
  silent("sight")
end)

-- A body is no obstacle: it stays opaque, its particles are taken within it, and colours of what it hides have no legend.
test("a legend stands beside what has its colours only", function()
  open("body")
  b:eval("(() => { const s = document.querySelector('#controls select'); s.value = 'velocity'; s.dispatchEvent(new Event('change')) })()")
  b:wait("view.page.layers[0].coloured")
  local hidden = "document.querySelector('#legend').hidden"
  assert(b:eval(hidden) and opacity() == 1 and taken(1) == 1 and taken(2) == 2)
  switch("obstacles")
  b:wait("!" .. hidden)
  switch("obstacles")
  b:wait(hidden)
  silent("body")
end)

test("three.js as ES modules shows the same", function()
  local there = io.open(folder .. "/modules.html")
  if not there then return print("three.js is not here as ES modules: their part is left out") end
  there:close()
  local colours = {}
  for _, name in ipairs { "sheet", "modules" } do
    open(name)
    show(30)
    colours[name] = ""
    for _, p in ipairs { { 0.5, 0.5, 0 }, { 0, 0, 0 }, { -0.5, 1, -0.15 } } do -- the sheet, a pin, the floor
      colours[name] = colours[name] .. table.concat({ pixel(at(p[1], p[2], p[3])) }, " ") .. "; "
    end
    silent(name)
  end
  assert(colours.sheet == colours.modules, colours.sheet .. " and " .. colours.modules)
end)

local failed = 0
for _, one in ipairs(tests) do
  local went, why = xpcall(one[2], debug.traceback)
  if not went then
    failed = failed + 1
    b:screenshot(folder .. "/failed.png")
    print(("FAILED %s: %s (%s/failed.png)"):format(one[1], why, folder))
  end
end
b:close()
if failed == 0 then os.execute(("rm -rf '%s'"):format(folder)) end
print(failed == 0 and "passed" or failed .. " failed")
os.exit(failed == 0)
