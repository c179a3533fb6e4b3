-- Pictures a second of a page with 100,000 particles, as it plays in a headless Chromium without a graphics card: a lower
-- bound of what anybody sees. What a picture takes in JavaScript alone, unpacking and copying, is told beside it: that is
-- what is left where a graphics card draws.
--   HK_ROOT=. HK_BUILD=build lua5.4 tests/bench/page_frames.lua [PARTICLES]
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = ("%s/tests/?.lua;%s"):format(root, package.path)
local browser = require("support.view.browser")
local n = tonumber(arg[1]) or 100000

local folder = os.tmpname()
os.remove(folder)
assert(os.execute("mkdir " .. folder))
local file = assert(io.open(folder .. "/cloud.lua", "w"))
file:write(([[
local scene = hooke.scene { duration = 2, fps = 30, integrator = "leapfrog", dt = 1 / 30 }
for _ = 1, %d do
  scene:particle { position = { math.random(), math.random(), math.random() }, velocity = { 0, 0, math.random() - 0.5 } }
end
scene:force("gravity", { g = { 0, 0, -0.5 } })
return scene
]]):format(n))
file:close()
local hooke = build:find("^/") and build or os.getenv("PWD") .. "/" .. build
assert(os.execute(("cd %s && %s/hooke view cloud.lua --quiet >said 2>&1"):format(folder, hooke)))

local b = browser.open(1280, 720)
local function play()
  return b:eval([[new Promise((done) => {
    const { page } = view, show = page.show.bind(page), spent = [];
    let first = 0, last = 0, count = 0;
    page.show = (frames) => {
      const begin = performance.now();
      show(frames);
      spent.push(performance.now() - begin);
      first = first || begin;
      last = begin;
      count++;
    };
    page.clock.loop = true;
    page.clock.play(true);
    setTimeout(() => {
      page.clock.play(false);
      page.show = show;
      spent.sort((x, y) => x - y);
      done({ rate: (count - 1) / (last - first) * 1000, copying: spent[0], every: page.economy.every });
    }, 6000);
  })]])
end

local went, why = pcall(function()
  b:go("file://" .. folder .. "/out/cloud/page.html")
  b:wait("view.page && view.page.layers[0].frame", 30)
  local unpacking = b:eval([[(async () => {
    const [source] = view.page.sources;
    let least = Infinity;
    for (let k = 0; k < 24; k++) {
      const begin = performance.now();
      await source.frame(k, []);
      least = Math.min(least, performance.now() - begin);
    }
    return least;
  })()]])
  local drawing = b:eval([[(() => {
    const { stage } = view.page, gl = stage.renderer.getContext(), pixel = new Uint8Array(4);
    let least = Infinity;
    for (let k = 0; k < 24; k++) {
      const begin = performance.now();
      stage.render();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // waits until it is drawn
      least = Math.min(least, performance.now() - begin);
    }
    return least;
  })()]])
  play() -- until it has found how many it can draw
  local got = play()
  print(("%d particles: %.1f pictures/s, one of %d particles drawn; at best unpacking takes %.1f ms, copying %.1f ms, drawing "
    .. "%.1f ms a picture"):format(n, got.rate, got.every, unpacking, got.copying, drawing))
  if got.every > 1 then
    b:eval("(() => { Object.defineProperty(view.page.economy, 'every', { get: () => 1, set: () => {} }); })()")
    print(("all drawn: %.1f pictures/s"):format(play().rate))
  end
end)
b:close()
os.execute("rm -rf " .. folder)
if not went then error(why) end
