-- Scenes that try to take all memory.
local ball = 'local s = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog" }\n'
  .. "local p = s:particle { position = {0, 0, 1} }\n"

return {
  { "scenes without end", scene = "while true do hooke.scene{} end", says = "memory", memory = 3000000 },
  { "scenes without end, kept by pcall", scene = "while true do pcall(hooke.scene, {}) end", says = "memory", memory = 3000000 },
  { "particles without end", says = "memory", memory = 3000000,
    scene = ball .. "while true do s:particles { positions = setmetatable({ {0, 0, 0} }, {}) } s:grid { nx = 1000, ny = 1000 } end" },
  { "plugins without end", says = "hooke:", memory = 3000000,
    scene = ball .. "local h = s:grid { nx = 300, ny = 300 } while true do s:force('springs', { edges = h:edges(), k = 1 }) end" },
  { "plugins without end that replace one another", says = "hooke:", memory = 3000000,
    scene = ball .. "while true do s:integrator('rk4') end" },
  { "pins without end", says = "hooke:", memory = 3000000,
    scene = ball .. "local h = s:grid { nx = 300, ny = 300 } while true do s:pin(h) end" },
  { "selections without end", says = "hooke:", memory = 3000000,
    scene = ball .. "local h = s:grid { nx = 300, ny = 300 } while true do s:force('gravity', { only = h }) end" },
  { "channels without end", says = "hooke:", memory = 3000000, scene = ball ..
    "s:grid { nx = 1000, ny = 1000 } local i = 0 while true do i = i + 1 s:channel('c' .. i, { size = 16 }) end" },
  { "measures without end", says = "hooke:", memory = 3000000, scene = ball ..
    "local i = 0 while true do i = i + 1 s:measure(i .. string.rep('x', 1e5), print) end" },
  { "parameters without end", says = "hooke:", memory = 3000000,
    scene = "local x = string.rep('x', 1e6) while true do param('a', x, x) end" },
  { "groups without end", says = "hooke:", memory = 3000000, scene = ball ..
    "local i = 0 while true do i = i + 1 s:particle { group = i .. string.rep('x', 1e5) } end" },
  { "runs without end", says = "hooke:", memory = 3000000, scene = [[
while true do
  local s = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog" }
  s:grid { nx = 100, ny = 100 }
  s:run { to = 0.01 }
end]] },
  { "meshes without end", says = "hooke:", memory = 3000000,
    setup = "awk 'BEGIN { for (i = 0; i < 200000; i++) print \"v 0 0\", i }' > m.obj",
    scene = ball .. "while true do s:mesh { file = 'm.obj' } end" },
  { "functions without end", says = "hooke:", memory = 3000000,
    scene = ball .. "while true do s:on_frame(function() end) end" },
  { "texts without end", says = "beyond its limit of", memory = 3000000,
    scene = "local t = {} while true do t[#t + 1] = string.rep('x', 2^20) .. #t end" },
  { "texts without end in a measure", says = "hooke:", memory = 3000000, scene = ball ..
    "local t = {} s:measure('m', function() while true do t[#t + 1] = string.rep('x', 2^20) .. #t end end) return s" },
  { "a sweep's texts without end", says = "hooke:", memory = 3000000, command = "sweep",
    scene = "local t = {} while true do t[#t + 1] = string.rep('x', 2^20) .. #t end return hooke.sweep {}" },
  { "a sweep's cases without end", says = "hooke:", memory = 3000000, command = "sweep --print-cases",
    scene = "local t = {} for i = 1, 1e6 do t[i] = i end return hooke.sweep { scene = 'x.lua', params = { a = t, b = t, c = t } }" },
  { "a sweep's huge list", says = "hooke:", memory = 3000000, command = "sweep",
    scene = "return hooke.sweep { scene = string.rep('x', 2^33) }" },
}
