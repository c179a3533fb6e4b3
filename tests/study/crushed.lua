-- crushed.lua: cloth and a soft block that are jammed, wrung, crushed, wedged and dragged through gaps, one case each: the
-- scenes of tests/study/crushed.c.
local drape = require("drape")
local case = param("case", "box", "box, compactor, edge, ring, wring, wedge, slot, fold, stack, block, ball")
local N = param("N", 11, "particles across the sheet", { min = 3, max = 256 })
local thickness = param("thickness", 4e-3, "of the cloth in contact, m", { min = 1e-5 })
local friction = param("friction", 0.2, "Coulomb's mu", { min = 0 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")
local T = param("T", 1, "s", { min = 0.01 })
local to = param("to", 0.05, "half of the width that walls leave, m", { min = 0.01, max = 0.15 })

local scene = drape.scene(contact, { duration = T })
local sheet

local function smooth(s) return s * s * (3 - 2 * s) end
local function eased(t) return smooth(math.min(t / (0.8 * T), 1)) end

local function square(t)
  t.nx, t.ny, t.width, t.height = t.nx or N, t.ny or N, t.width or 0.3, t.height or 0.3
  return drape.sheet(scene, t)
end

-- Pairs of walls that close; those of different axes have different sizes, so that no edge lies in an edge.
local function walls(axes, from, left)
  for _, axis in ipairs(axes) do
    for side = -1, 1, 2 do
      local size, position = { 0.6, 0.6, 0.6 }, { 0, 0, 0 }
      size[axis], position[axis] = 0.02, side * (from + 0.01)
      for k = 1, axis - 1 do size[k] = 0.6 - 0.05 * k end
      scene:body { shape = "box", size = size, position = position, path = function(t)
        local d = { 0, 0, 0 }
        d[axis] = -side * (from - left) * eased(t)
        return d[1], d[2], d[3]
      end }
    end
  end
end

local function torus(R, r) -- of capsules
  local n = 16
  for k = 1, n do
    local a = 2 * math.pi * k / n
    scene:body { shape = "capsule", radius = r, length = 1.6 * math.pi * R / n, detail = 2e-2,
      position = { R * math.cos(a), R * math.sin(a), 0 },
      orientation = { math.pi / 2 * math.cos(a), math.pi / 2 * math.sin(a), 0 } }
  end
end

local cases = {}

function cases.box() -- six walls close
  sheet = square { origin = { -0.12, -0.12, 0 }, u = { 1, 0, 0.1 }, v = { -0.02, 1, 0.2 }, width = 0.24, height = 0.24 }
  walls({ 1, 2, 3 }, 0.16, to)
end

function cases.compactor() -- four walls close, two stay
  sheet = square { origin = { -0.15, 0, -0.15 }, u = { 1, 0.1, 0.1 }, v = { -0.11, 0.1, 1 } }
  walls({ 1, 3 }, 0.2, to)
  for side = -1, 1, 2 do scene:body { shape = "box", size = { 0.8, 0.02, 0.8 }, position = { 0, side * 0.13, 0 } } end
end

function cases.edge() -- a sheet on its edge between two plates
  sheet = square { origin = { -0.15, 0, -0.15 }, u = { 1, 0.05, 0 }, v = { -0.0025, 0.05, 1 } }
  walls({ 3 }, 0.2, 0.02)
end

function cases.ring() -- pulled by its middle through a ring
  sheet = square { origin = { -0.15, -0.15, 0.03 }, nx = 2 * N - 1, ny = 2 * N - 1 }
  torus(0.06, 0.01)
  scene:pin({ sheet:at(N, N) }, { path = function(t) return 0, 0, -0.3 * eased(t) end })
end

function cases.wring() -- five turns of each end
  local M = 3 * (N - 1) + 1
  sheet = square { nx = M, width = 0.6, height = 0.2, origin = { -0.3, 0, -0.1 }, u = { 1, 0, 0 }, v = { 0, 0, 1 } }
  for side, i in pairs { [-1] = 1, [1] = M } do
    local ids = {}
    for j = 1, N do ids[j] = sheet:at(i, j) end
    scene:pin(ids, { rotation = function(t) return side * 5 * math.pi * eased(t), 0, 0 end,
      path = function(t) return -0.06 * side * eased(t), 0, 0 end })
  end
end

function cases.wedge() -- pulled down between two slopes
  for side = -1, 1, 2 do
    scene:body { shape = "box", size = { 0.02, 0.6, 0.5 }, position = { side * 0.14, 0, 0.2 }, orientation = { 0, side * 0.5, 0 } }
  end
  sheet = square { origin = { -0.15, -0.15, 0.3 } }
  local middle = {}
  for j = 1, N do middle[j] = sheet:at((N + 1) // 2, j) end
  scene:pin(middle, { path = function(t) return 0, 0, -0.27 * eased(t) end })
end

function cases.slot() -- dragged by a part of its edge through a slot as wide as four layers
  for side = -1, 1, 2 do
    scene:body { shape = "box", size = { 0.3, 0.6, 0.04 }, position = { 0.17, 0, side * (0.02 + 2 * thickness) } }
  end
  sheet = square { origin = { -0.32, -0.15, 0 } }
  local first = {}
  for j = N // 3, N - N // 3 + 1 do first[#first + 1] = sheet:at(N, j) end
  scene:pin(first, { path = function(t) return 0.5 * eased(t), 0, 0 end })
end

function cases.fold() -- folded over, let go and pressed flat
  sheet = square { origin = { -0.15, -0.15, 0.01 } }
  scene:body { shape = "plane", size = 1, position = { 0, 0, 0 } }
  local edge, last = {}, {}
  for j = 1, N do edge[j], last[j] = sheet:at(1, j), sheet:at(N, j) end
  scene:pin(last)
  scene:pin(edge, { release = 0.5 * T, path = function(t)
    local s = math.min(t / (0.5 * T), 1)
    local a = math.pi * smooth(s)
    return 0.12 * (1 - math.cos(a)), 0, 0.12 * math.sin(a) + 0.01 * s
  end })
  scene:body { shape = "box", size = { 0.5, 0.5, 0.02 }, position = { 0, 0, 0.3 }, path = function(t)
    return 0, 0, -(0.29 - 4 * thickness) * smooth(math.min(math.max(t / T - 0.5, 0) / 0.4, 1))
  end }
end

function cases.stack() -- six sheets fall on each other
  scene:body { shape = "plane", size = 1, position = { 0, 0, 0 } }
  for k = 1, 6 do
    local c, s = math.cos(k), math.sin(k)
    sheet = square { origin = { -0.15, -0.15, 0.02 * k }, group = "sheet" .. k, u = { c, s, 0 }, v = { -s, c, 0 } }
  end
end

function cases.block() -- a soft block is pressed to half of its height
  local b = scene:block { nx = 5, ny = 5, nz = 5, size = { 0.1, 0.1, 0.1 }, origin = { -0.05, -0.05, -0.05 }, density = 1000 }
  scene:force("neo_hookean", { tetrahedra = b:tetrahedra(), E = 2e4, nu = 0.3, damping = 1e-3 })
  walls({ 3 }, 0.06, 0.025)
end

function cases.ball() -- a sheet is pressed by a ball through a ring
  sheet = square { origin = { -0.15, -0.15, 0.02 } }
  torus(0.08, 0.015)
  scene:body { shape = "sphere", radius = 0.05, detail = 1e-2, position = { 0, 0, 0.09 },
    path = function(t) return 0, 0, -0.15 * eased(t) end }
end

assert(cases[case], "case: " .. case .. " is none of them")()
scene:force("drag", { rate = 1 })
drape.contact(scene, contact, { thickness = thickness, friction = friction })
scene:output("frames", { color = "none", plain = { 0.5, 0.4, 0.7 }, thickness = thickness, particles = "off",
  from = { 0.6, -1.2, 0.6 }, look_at = { 0, 0, 0 }, fov = 40 })
return scene
