-- hooke write_pages FOLDER, in the tests' own tree of tools (pages.lua): writes the pages that tests/tools/view.lua
-- looks at, and beside them what they have to show.
local made = require("support.view.made_recording")
local make = require("common.view.make")

local folder = arg[1]
local evil = "</script><script>window.harmed = 1</script><img src=x onerror='window.harmed = 2'>{{scripts}}\u{2028}"

local function file_with(name, text)
  local file = assert(io.open(folder .. "/" .. name, "w"))
  file:write(text)
  file:close()
end

local function page(name, runs, what)
  return assert(make.page(folder .. "/" .. name .. ".html", runs, what))
end

local summary = '{"scene":"sheet","verdict":"inaccurate","reason":"the step is too long <b>","integrator":"leapfrog",'
  .. '"particles":256,"steps":100,"warnings":["wind: from </script>"],"plugins":[{"kind":"force","name":"springs",'
  .. '"label":"weave","seconds":0.25}],"origin":{"the parameter k":"1000","the seed":"0"},"energy":{"drift":0.125}}'
local bench = '{"metric":"x","rows":[{"integrator":"leapfrog","dt":0.01,"error_x_rms":1e-3,"wall_s":0.01,"verdict":"ok",'
  .. '"pareto":1},{"integrator":"leapfrog","dt":0.001,"error_x_rms":1e-5,"wall_s":0.1,"verdict":"ok","pareto":1},'
  .. '{"integrator":"rk4","dt":0.01,"error_x_rms":1e-4,"wall_s":0.05,"verdict":"ok","pareto":0}],'
  .. '"recommendation":{"text":"leapfrog, dt 0.01"}}'

page("sheet", { { recording = made.sheet(16, 100), title = "sheet", summary = summary } },
  { title = "sheet", subtitle = "16 x 16", bench = bench })
page("two", { { recording = made.sheet(8, 60), title = "first" }, { recording = made.sheet(8, 60, 0.1), title = "second" } },
  { title = "first and second" })

-- ---- the same by three.js as ES modules, where they are installed ----

local three = require("common.view.three")
for _, place in ipairs(three.places) do
  local module = io.open(place .. "three.module.js", "rb")
  if module then
    local modules = folder .. "/modules/"
    os.execute("mkdir -p " .. modules)
    for _, name in ipairs { "three.module.js", "three.core.js" } do
      local from = io.open(place .. name, "rb")
      if from then
        local to = assert(io.open(modules .. name, "wb"))
        to:write((from:read("a")))
        to:close()
        from:close()
      end
    end
    module:close()
    page("modules", { { recording = made.sheet(16, 100), title = "sheet", summary = summary } },
      { title = "sheet", three = { modules } })
    break
  end
end

-- ---- a ball that rolls, a box of triangles and a floor ----

local box_vertices, box_faces = {}, { 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2,
  1, 3, 7, 1, 7, 5 }
for k = 0, 7 do
  for c = 0, 2 do box_vertices[#box_vertices + 1] = (k >> c & 1) - 0.5 end
end

page("solids", { { title = "solids", recording = made.recording { frames = 20, at = function(k)
  return { -1, 0, 0.05 * k, 3, 0, 1.2 }, { 0, 0, 0, 0, 0, 0 }, { 1, 2 }
end, solids = { { kind = "plane", vertices = "", faces = "" }, { kind = "sphere", vertices = "", faces = "" },
  { kind = "mesh", vertices = made.doubles(box_vertices), faces = made.indices(box_faces) } },
marks = { { name = "breeze", kind = "wind" }, { name = "contact", kind = "contact" } },
marks_of = function(j, k) -- the wind blows along y at first; from the 11th frame on 1000 points of 4000 at one place
  if j == 1 then return made.doubles(k < 11 and { -1, 0, 1 } or {}), made.doubles(k < 11 and { 0, 5, 0 } or {}), 1 end
  local x, n = {}, {}
  for i = 1, k < 11 and 1 or 1000 do
    for c, value in ipairs { 2, 1.2, 0.5 } do x[3 * i - 3 + c], n[3 * i - 3 + c] = value, c == 3 and 1 or 0 end
  end
  return made.doubles(x), made.doubles(n), k < 11 and 1 or 4000
end,
places = function(k)
  return made.doubles { 0, 0, -0.5, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0.1 * k, 0, 0, 0.4, 0, 0, 0, 0.4, 0, 0, 0, 0.4,
    3, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 }
end } } }, { title = "solids" })

-- ---- an upright sheet at y = 0 with a particle behind it and one before it, and a wall ----

-- The wall is behind all, in the second frame before all; a small one is in the third before the particle before the sheet.
local walls = { { 3, 3 }, { -1, 3 }, { 3, -0.7 } } -- y, m

page("sight", { { title = "sight", recording = made.recording { frames = 3, at = function()
  local x = { 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 1, 0.5, 0.5, 0.5, 0.3, -0.5, 0.3 }
  local v = {}
  for k = 1, #x do v[k] = k / 10 end
  return x, v, { 1, 2, 3, 4, 5, 6 }
end, triangles = { 0, 1, 3, 0, 3, 2 },
solids = { { kind = "box", vertices = "", faces = "" }, { kind = "box", vertices = "", faces = "" } },
places = function(k)
  local large, small = table.unpack(walls[k])
  return made.doubles { 0.5, large, 0.5, 1, 0, 0, 0, 0.05, 0, 0, 0, 1, 0.3, small, 0.3, 0.1, 0, 0, 0, 0.02, 0, 0, 0, 0.1 }
end } } }, { title = "sight" })

-- ---- a rigid body that hides its particles ----

page("body", { { title = "body", recording = made.recording { frames = 2, at = function()
  return { 0.1, 0, 0, -0.1, 0, 0.2 }, { 1, 0, 0, 2, 0, 0 }, { 1, 2 }
end, edges = { 0, 1 },
solids = { { kind = "mesh", body = true, vertices = made.doubles(box_vertices), faces = made.indices(box_faces) } },
places = function() return made.doubles { 0, 0, 0, 0, 1, 0, -1, 0, 0, 0, 0, 1 } end } } }, { title = "body" })

-- ---- two strands, of another group and radius each, and a rigid body of a third ----

page("groups", { { title = "groups", recording = made.recording { frames = 2, at = function()
  return { 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0 }, { 0, 0, 0, 1, 0, 0, 0, 0, 0, 2, 0, 0 }, { 1, 2, 3, 4 }
end, edges = { 0, 1, 2, 3 }, groups = { "default", "rope", "thread <b>", "crate", "of none" }, group_of = { 1, 1, 2, 2 },
strand_radii = { 0.1, 0.1, 0, 0.04 },
solids = { { kind = "mesh", body = true, group = 4, vertices = made.doubles(box_vertices), faces = made.indices(box_faces) } },
places = function() return made.doubles { 0.5, 0.5, 0.8, 0.3, 0, 0, 0, 0.3, 0, 0, 0, 0.3 } end } } }, { title = "groups" })

-- ---- more particles than a slow machine draws: 24,000 that rise ----

local many, ids, still = {}, {}, {}
for i = 0, 23999 do
  ids[i + 1] = i + 1
  for c, value in ipairs { i % 155 / 155, i // 155 / 155, 0 } do many[3 * i + c], still[3 * i + c] = value, 0 end
end
page("many", { { title = "many", recording = made.recording { frames = 4, at = function(k)
  local x = table.move(many, 1, #many, 1, {})
  for i = 3, #x, 3 do x[i] = 0.02 * k end
  return x, still, ids
end } } }, { title = "many" })

-- ---- births and deaths; numbers of any kind; names that would be markup ----

-- A random motion of particles, of which some die and others are born.
local function restless(frames)
  local list, next_id = {}, 1
  for k = 1, frames do
    local before, now = list[k - 1], { x = {}, v = {}, ids = {} }
    local function put(id, x, y, z)
      now.ids[#now.ids + 1] = id
      for _, value in ipairs { x, y, z } do now.x[#now.x + 1], now.v[#now.v + 1] = value, math.random() - 0.5 end
    end
    for i, id in ipairs(before and before.ids or {}) do
      local function moved(c) return before.x[3 * i - 3 + c] + 0.1 * (math.random() - 0.5) end
      if math.random() > 0.1 then put(id, moved(1), moved(2), moved(3)) end
    end
    for _ = 1, k == 1 and 40 or math.random(0, 8) do
      put(next_id, 100 + math.random(), math.random(), -math.random())
      next_id = next_id + 1
    end
    list[k] = now
  end
  return list
end

math.randomseed(7)
local frames = restless(90)
frames[90].x[4] = 0 / 0 -- the end of a run that diverged
local births = made.recording { frames = 90, at = function(k) return frames[k].x, frames[k].v, frames[k].ids end,
  series = { [evil] = { 1, 2, 3 } } }
local made_page = page("births", { { recording = births, title = evil,
  summary = ('{"verdict":"ok","reason":"","warnings":[%q],"plugins":[]}'):format((evil:gsub("\u{2028}", ""))) } },
  { title = evil, subtitle = evil })

local json = require("common.view.json_text")
local expected = json.list()
for k, frame in ipairs(frames) do
  expected[k] = { ids = json.list(frame.ids), x = json.list(frame.x), v = json.list(frame.v) }
end
local errors = {}
for _, s in ipairs(made_page.runs[1].streams) do errors[s.name] = s.error end
file_with("births.json", json.encode { frames = expected, errors = errors,
  extent = (function()
    local most, s = 0, made_page.runs[1].streams[1]
    for c = 1, 3 do most = math.max(most, s.high[c] - s.low[c]) end
    return most
  end)() })
return 0
