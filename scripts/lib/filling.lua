-- filling: particles that fill a box, or the part of it where inside(x, y, z) is true, for the corrector `liquid`: two a
-- cell along each axis, with the mass density x volume. A box without depth along an axis is filled in a plane; its
-- particles have the mass of one cell's depth there.
--     local water = filling.box { low = { 0, 0, 0 }, high = { 1, 0, 0.5 }, cell = 0.05, density = 1000 }
--     scene:particles { positions = water.positions, mass = water.mass }
-- Each particle is at random in the middle part of its place, `scatter` of it along each axis: none would leave rows that
-- later flow in step, and all of it (1) makes the mass of columns differ by chance, so that the surface is uneven at the
-- start by a tenth of a cell, a block floats 0.6 % of its draft too high and waves are 1 % too fast, 32 cells long.
-- With level(x, y), the height of the free surface, m, columns end there and not at `high`; their particles lie evenly in
-- them and have masses of their own, `masses`: so waves lower than a particle's place are right.
local filling = {}

-- Parts of the box along an axis, and the length of one.
local function parts(low, high, cell)
  if high == low then return 1, 0, cell end
  local n = math.max(1, math.floor(2 * (high - low) / cell + 0.5))
  return n, (high - low) / n, (high - low) / n
end

-- Of a call of filling.box in a scene, whose line the error has.
local function check(t)
  local function demand(fine, what) return fine or error("filling.box: " .. what, 4) end
  demand(type(t) == "table" and type(t.low) == "table" and type(t.high) == "table", "low and high are the corners of the box, m")
  demand(type(t.cell) == "number" and t.cell > 0, "cell is the size of the liquid's cells, m, above 0")
  demand(not t.scatter or t.scatter >= 0 and t.scatter <= 1,
    "scatter is the part of its place that a particle is at random in, 0 to 1")
  for c = 1, 3 do
    demand(type(t.low[c]) == "number" and type(t.high[c]) == "number", "low and high are three numbers each, {x, y, z}, m")
    demand(t.high[c] >= t.low[c], "high is below low, so that there is no room: give the upper corner")
  end
  demand(not t.level or t.high[3] > t.low[3], "a level needs a box with room along z: give high[3] above low[3]")
end

-- Adds the column over the rectangle whose lower corner is x, y; size: of its places, m; n: of them up to t.high[3].
local function add_column(t, x, y, size, n, add)
  local rise, count = size[3], n
  if t.level then
    local height = t.level(x + size[1] / 2, y + size[2] / 2) - t.low[3]
    count = math.floor(height / rise + 0.5)
    rise = height / math.max(count, 1)
  end
  local scatter = t.scatter or 0.4
  local function within(low, length)
    return length > 0 and low + length * (0.5 + scatter * (math.random() - 0.5)) or low
  end
  for k = 0, count - 1 do
    add({ within(x, size[1]), within(y, size[2]), within(t.low[3] + k * rise, rise) }, size[3] > 0 and rise / size[3] or 1)
  end
end

function filling.box(t)
  check(t)
  local n, size, volume = {}, {}, 1
  for c = 1, 3 do
    local length
    n[c], size[c], length = parts(t.low[c], t.high[c], t.cell)
    volume = volume * length
  end
  local filled = { positions = {}, masses = {}, mass = (t.density or 1000) * volume }
  local function add(p, part)
    if t.inside and not t.inside(p[1], p[2], p[3]) then return end
    filled.positions[#filled.positions + 1], filled.masses[#filled.masses + 1] = p, part * filled.mass
  end
  for i = 0, n[1] - 1 do
    for j = 0, n[2] - 1 do add_column(t, t.low[1] + i * size[1], t.low[2] + j * size[2], size, n[3], add) end
  end
  return filled
end

-- The floor and the four walls of a box as obstacles, with which pictures end the water flat (`surface_cut`) and bodies
-- stay inside; to be called before the corrector `liquid`.
function filling.tank(scene, low, high)
  local function wall(name, position, normal)
    scene:corrector("obstacle", { shape = "plane", position = position, normal = normal, label = name })
  end
  wall("floor", low, { 0, 0, 1 })
  wall("west", low, { 1, 0, 0 })
  wall("east", high, { -1, 0, 0 })
  wall("south", low, { 0, 1, 0 })
  wall("north", high, { 0, -1, 0 })
end

return filling
