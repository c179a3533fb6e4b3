-- Recordings made by a formula, with the interface of the module `recording`: the page's tests need no run for them.
local made = {}

local function doubles(t) return string.pack("<" .. ("d"):rep(#t), table.unpack(t)) end
local function indices(t) return string.pack("<" .. ("I4"):rep(#t), table.unpack(t)) end

-- In pieces: a call takes so many arguments only.
local function in_pieces(pack, t)
  local pieces = {}
  for k = 1, #t, 90 do pieces[#pieces + 1] = pack(table.move(t, k, math.min(k + 89, #t), 1, {})) end
  return table.concat(pieces)
end

made.doubles = function(t) return in_pieces(doubles, t) end
made.indices = function(t) return in_pieces(indices, t) end

-- what: frames, fps, at(k) -> positions, velocities, ids, strain (tables); edges, triangles, pins (tables of indices);
-- groups (names), group_of, strand_radii (of each particle); series; forces { name -> function(k) -> table };
-- solids, places(k) -> string, marks,
-- marks_of(j, k): as in the module
function made.recording(what)
  local r = { frames = what.frames, fps = what.fps or 60, times = {}, series = what.series or {},
    attributes = {} }
  for k = 1, r.frames do r.times[k] = (k - 1) / r.fps end
  local last, kept
  local function at(k)
    if k ~= last then last, kept = k, { what.at(k) } end
    return kept
  end
  local function always(list)
    local packed = made.indices(list or {})
    return function() return packed end
  end
  function r.n(_, k) return #at(k)[1] // 3 end
  function r.positions(_, k) return made.doubles(at(k)[1]) end
  function r.velocities(_, k) return made.doubles(at(k)[2]) end
  function r.ids(_, k) return made.indices(at(k)[3]) end
  function r.strain(_, k) return at(k)[4] and made.doubles(at(k)[4]) end
  local of_field = { r.velocities }
  r.fields = { { kind = "velocity", name = "velocity", components = 3 } }
  if at(1)[4] then
    r.fields[2], of_field[2] = { kind = "strain", name = "strain", components = 1 }, r.strain
  end
  for name, values in pairs(what.forces or {}) do
    table.insert(r.fields, { kind = "force", name = name, components = 3 })
    of_field[#r.fields] = function(_, k) return made.doubles(values(k)) end
  end
  function r.field(self, j, k) return of_field[j](self, k) end
  function r.topology_changed(_) return false end
  r.edges, r.triangles = always(what.edges), always(what.triangles)
  function r.pins(_, k)
    local bytes = {}
    for i = 1, #at(k)[1] // 3 do bytes[i] = "\0" end
    for _, i in ipairs(what.pins or {}) do bytes[i + 1] = "\1" end
    return table.concat(bytes)
  end
  r.solids, r.marks, r.groups = what.solids, what.marks, what.groups or {}
  function r.groups_and_radii(_)
    return what.group_of and made.indices(what.group_of), what.strand_radii and made.doubles(what.strand_radii)
  end
  function r.marks_of(_, j, k) return what.marks_of(j, k) end
  function r.solid_places(_, k) return what.places(k) end
  return r
end

-- A square sheet of N x N particles that waves: z = 0.15 sin(4 x - 6 t) x, pinned along x = 0. off: added to z.
function made.sheet(N, frames, off)
  local edges, triangles, pins, ids = {}, {}, {}, {}
  local function index(i, j) return (j - 1) * N + i - 1 end
  for j = 1, N do
    pins[#pins + 1] = index(1, j)
    for i = 1, N do
      ids[#ids + 1] = #ids + 1
      if i < N then table.move({ index(i, j), index(i + 1, j) }, 1, 2, #edges + 1, edges) end
      if j < N then table.move({ index(i, j), index(i, j + 1) }, 1, 2, #edges + 1, edges) end
      if i < N and j < N then
        local a, b, c, d = index(i, j), index(i + 1, j), index(i, j + 1), index(i + 1, j + 1)
        table.move({ a, b, d, a, d, c }, 1, 6, #triangles + 1, triangles)
      end
    end
  end
  local function at(k)
    local t, x, v, s = (k - 1) / 60, {}, {}, {}
    for j = 0, N - 1 do
      for i = 0, N - 1 do
        local u = i / (N - 1)
        local phase = 4 * u - 6 * t
        table.move({ u, j / (N - 1), 0.15 * math.sin(phase) * u + (off or 0) * u * t }, 1, 3, #x + 1, x)
        table.move({ 0, 0, -0.9 * math.cos(phase) * u + (off or 0) * u }, 1, 3, #v + 1, v)
        s[#s + 1] = 0.02 * math.cos(phase)
      end
    end
    return x, v, ids, s
  end
  local series = { kinetic = {}, potential = {}, step = {} }
  for k = 1, frames do
    local t = (k - 1) / 60
    series.kinetic[k], series.potential[k], series.step[k] = math.sin(3 * t) ^ 2, math.cos(3 * t) ^ 2, 1e-3
  end
  return made.recording { frames = frames, at = at, edges = edges, triangles = triangles, pins = pins, series = series,
    forces = { gravity = function()
      local f = {}
      for i = 1, N * N do f[3 * i - 2], f[3 * i - 1], f[3 * i] = 0, 0, -9.81e-3 end
      return f
    end } }
end

return made
