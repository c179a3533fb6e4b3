-- filling: particles that fill a box, or the part of it where inside(x, y, z) is true, for the corrector `liquid`: two a
-- cell along each axis, each at random in its part of the box, with the mass density x volume. A box without depth along
-- an axis is filled in a plane; its particles have the mass of one cell's depth there.
--     local water = filling.box { low = { 0, 0, 0 }, high = { 1, 0, 0.5 }, cell = 0.05, density = 1000 }
--     scene:particles { positions = water.positions, mass = water.mass }
local filling = {}

-- Parts of the box along an axis, and the length of one.
local function parts(low, high, cell)
  if high == low then return 1, 0, cell end
  local n = math.max(1, math.floor(2 * (high - low) / cell + 0.5))
  return n, (high - low) / n, (high - low) / n
end

function filling.box(t)
  assert(type(t.low) == "table" and type(t.high) == "table", "filling.box: low and high are the corners of the box, m")
  assert(t.cell and t.cell > 0, "filling.box: cell is the size of the liquid's cells, m, above 0")
  local n, step, volume = {}, {}, 1
  for c = 1, 3 do
    assert(t.high[c] >= t.low[c], "filling.box: high is below low, so that there is no room: give the upper corner")
    local length
    n[c], step[c], length = parts(t.low[c], t.high[c], t.cell)
    volume = volume * length
  end
  local positions = {}
  local function at(c, k) return t.low[c] + (k + (step[c] > 0 and math.random() or 0)) * step[c] end
  for i = 0, n[1] - 1 do
    for j = 0, n[2] - 1 do
      for k = 0, n[3] - 1 do
        local p = { at(1, i), at(2, j), at(3, k) }
        if not t.inside or t.inside(p[1], p[2], p[3]) then positions[#positions + 1] = p end
      end
    end
  end
  return { positions = positions, mass = (t.density or 1000) * volume }
end

return filling
