-- What particles bounce off, as a page holds it: kinds, meshes, and places as 32-bit floats, once where nothing moves.
local page = require("page")
local json_text = require("common.view.json_text")

local solids = {}

-- Doubles as floats, coordinates of points (width 3 of every 12 numbers, or of every 3) from the origin.
local function floats(doubles, period, origin)
  local list = {}
  for k = 1, #doubles // 8 do
    local at = (k - 1) % period
    local value = string.unpack("<d", doubles, 8 * k - 7)
    list[k] = ("<f"):pack(at < 3 and value - origin[at + 1] or value)
  end
  return table.concat(list)
end

local function packed(out, bytes) return #bytes > 0 and out:add(page.indices(bytes)) or nil end

local function moves(r)
  for k = 2, r.frames do
    if r:solid_places(k) ~= r:solid_places(1) then return true end
  end
  return false
end

-- origin: m, of the page's coordinates. nil: there are none.
function solids.of(r, out, origin)
  if not r.solids or #r.solids == 0 then return nil end
  local data, places = { list = json_text.list(), moving = moves(r) }, {}
  for k, s in ipairs(r.solids) do
    data.list[k] = { kind = s.kind, hollow = s.hollow, body = s.body or false,
      group = s.group or 0,
      vertices = packed(out, floats(s.vertices, 3, { 0, 0, 0 })), faces = packed(out, s.faces) }
  end
  for k = 1, data.moving and r.frames or 1 do places[k] = floats(r:solid_places(k), 12, origin) end
  data.places = packed(out, table.concat(places))
  return data
end

return solids
