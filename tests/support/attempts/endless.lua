-- Scenes that try never to end. Those with `interrupt` get SIGINT after a second and are to end
-- by it.
local ball = 'local s = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog" }\n'
  .. "local p = s:particle { position = {0, 0, 1} }\n"

local function on_table(meta, call) return ("local t = setmetatable({}, { %s })\n%s"):format(meta, call) end

local list = {
  { "a loop", scene = "while true do end", says = "beyond its limit" },
  { "a loop as handler of its own error", scene = "local function loop() while true do end end xpcall(loop, loop)", says = "beyond" },
  { "a loop as handler, repeated", says = "beyond",
    scene = "local function loop() while true do end end while true do xpcall(loop, loop) end" },
  { "a handler that fails", says = "hooke:", scene = "xpcall(error, function() error() end) while true do end" },
  { "a loop in a coroutine's close", says = "beyond", scene = [[
local co = coroutine.create(function() local x <close> = setmetatable({}, { __close = function() while true do end end })
  coroutine.yield() end)
coroutine.resume(co)
coroutine.close(co)]] },
  { "a loop in a variable's close", says = "beyond",
    scene = "do local x <close> = setmetatable({}, { __close = function() while true do end end }) end" },
  { "a loop in a close after the limit", says = "beyond", scene = [[
pcall(function()
  local x <close> = setmetatable({}, { __close = function() while true do end end })
  while true do end
end)]] },
  { "closes without end", says = "beyond", scene = [[
local function f() local x <close> = setmetatable({}, { __close = function() f() end }) while true do end end
while true do pcall(f) end]] },
  { "sort with __index", scene = on_table("__index = math.abs, __len = function() return 1e8 end", "table.sort(t)"), says = "hooke:" },
  { "sort with a comparison that is none", says = "hooke:",
    scene = "local t = {} for i = 1, 1e5 do t[i] = i end table.sort(t, rawequal) while true do table.sort(t) end" },
  { "concat with __index", says = "hooke:",
    scene = on_table('__index = ("x").upper', "return table.concat(setmetatable({}, { __index = string.lower }), '', 1, 1e12)") },
  { "concat of empty texts", says = "hooke:",
    scene = "table.concat(setmetatable({}, { __index = function() return '' end }), '', 1, 1e15)" },
  { "unpack without end", says = "hooke:", scene = "while true do pcall(table.unpack, {}, 1, 1e6) end" },
  { "one table.move", says = "hooke:", scene = "table.move({}, 1, 1e15, 2)" },
  { "a loop of table.move", says = "hooke:", scene = "local t = {} while true do table.move(t, 1, 2^24, 2^25, t) end" },
  { "a loop of rep", says = "hooke:", scene = "while true do string.rep('', 2^24) end" },
  { "one rep of nothing", says = "hooke:", scene = "string.rep('', 1e15)" },
  { "rep by the string's method", says = "hooke:", scene = "('').rep('', 1e15)" },
  { "a loop of utf8.len", says = "hooke:", scene = "local x = string.rep('x', 2^24) while true do utf8.len(x) end" },
  { "a loop of string.byte", says = "hooke:", scene = "local x = string.rep('x', 2^24) while true do x:find('y', 1, true) end" },
  { "a loop of reverse", says = "hooke:", scene = "local x = string.rep('x', 2^26) while true do x:reverse() end" },
  { "a pattern bomb", says = "hooke:", scene = "string.find(string.rep('a', 60), string.rep('a*', 60) .. 'b')" },
  { "a pattern bomb in gsub", says = "hooke:", scene = "(string.rep('a', 5000)):gsub(string.rep('.-', 40) .. 'b', '')" },
  { "a pattern bomb in match", says = "hooke:", scene = "(string.rep('a', 1e6)):match('.-.-.-.-b')" },
  { "a pattern bomb in gmatch in a coroutine", says = "hooke:",
    scene = "coroutine.wrap(function() for x in (string.rep('a', 1e6)):gmatch('.-.-.-b') do end end)()" },
  { "a pattern bomb in a measure", says = "hooke:",
    scene = ball .. "s:measure('m', function() return #string.rep('a', 1e6):match('.-.-.-.-b') end)\nreturn s" },
  { "a pattern bomb in a tool", says = "hooke:", command = "explain", scene = "(string.rep('a', 1e6)):match('.-.-.-.-b')" },
  { "a sweep's pattern bomb", says = "hooke:", command = "sweep",
    scene = "local x = (string.rep('a', 1e6)):match('.-.-.-.-b') return hooke.sweep { scene = x }" },
  { "a sweep's loop in a coroutine", says = "hooke:", command = "sweep",
    scene = "pcall(function() while true do end end) while true do end return hooke.sweep {}" },
  { "a list of edges that holds itself", says = "expected a list of edges",
    scene = ball .. "local e = {} for i = 1, 10 do e[i] = e end\ns:force('springs', { edges = e, k = 1 })" },
  { "a list of edges that holds lists that hold lists", says = "hooke:", scene = ball .. [[
local e = {}
for i = 1, 15 do local inner = e e = {} for k = 1, 20 do e[k] = inner end end
s:force('springs', { edges = e, k = 1 })]] },
  { "joined lists of edges that hold lists", says = "hooke:", scene = ball .. [[
local e = {}
for i = 1, 15 do local inner = e e = {} for k = 1, 20 do e[k] = inner end end
local x = s:strand { n = 3 }:edges() .. e]] },
  { "a list of triangles that holds lists", any = true, scene = ball .. [[
local e = { { 1, 2, 3 } }
for i = 1, 14 do local inner = e e = {} for k = 1, 20 do e[k] = inner end end
s:force('bending', { hinges = e, k = 1 })]] },
  { "a result that holds lists", says = "hooke:", scene = ball .. [[
local e = {}
for i = 1, 3 do local inner = e e = {} for k = 1, 1e5 do e[k] = inner end end
s:measure("m", function() return e end)
return s]] },
  { "many short coroutines", says = "hooke:",
    scene = "while true do coroutine.wrap(function() for i = 1, 2000 do end end)() end" },
  { "coroutines in coroutines", says = "hooke:",
    scene = "local function f() coroutine.wrap(f)() end while true do pcall(f) end" },
  { "resumes without end", says = "hooke:",
    scene = "local co = coroutine.wrap(function() while true do coroutine.yield() end end) while true do co() end" },
  { "many short calls by a measure", says = "hooke:",
    scene = ball .. "s:measure('m', function() while true do pcall(error) end end)\nreturn s" },
  { "errors without end", says = "beyond", scene = "while true do pcall(error, 'x') end" },
  { "steps of 1e-30 s", scene = ball .. "return s", args = "--dt 1e-30", says = "hooke:" },
  { "steps of 1e-300 s", scene = ball .. "return s", args = "--dt 1e-300", says = "hooke:" },
  { "steps of 1e-18 s", scene = ball .. "return s", args = "--dt 1e-18", interrupt = true, any = true },
  { "steps of 1e-9 s, interrupted", scene = ball .. "return s", args = "--dt 1e-9", interrupt = true, says = "interrupted" },
  { "1e300 frames a second", scene = "local s = hooke.scene { fps = 1e300 } s:particle {} return s", interrupt = true, any = true },
  { "a duration of 1e300 s", scene = "local s = hooke.scene { duration = 1e300 } s:particle {} return s", interrupt = true, any = true },
  { "huge coordinates", interrupt = true, any = true, scene = [[
local s = hooke.scene { duration = 1, integrator = "leapfrog" }
local h = s:strand { n = 10, to = {1e300, 1e300, 1e300} }
s:force("springs", { edges = h:edges(), k = 1e300 })
return s]] },
  { "huge coordinates in collisions", interrupt = true, any = true, scene = [[
local s = hooke.scene { duration = 1, integrator = "leapfrog" }
s:particle { position = {1e308, -1e308, 0}, velocity = {-1e308, 1e308, 0} }
s:particle { position = {-1e308, 1e308, 1e-300} }
s:force("collisions", { radius = 1e-300 })
return s]] },
  { "huge coordinates in a lattice of neighbours", interrupt = true, any = true, scene = [[
local s = hooke.scene { duration = 1, integrator = "leapfrog" }
for i = 1, 20 do s:particle { position = {10.0^(15 * i), i, i} } end
s:force("lennard_jones", { epsilon = 1, sigma = 1e-9, cutoff = 1e-9 })
return s]] },
  { "huge coordinates in a grid that is drawn", interrupt = true, any = true, args = "--out out", scene = [[
local s = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog" }
s:grid { nx = 5, ny = 5, width = 1e300, height = 1e-300 }
s:output("frames", { width = 64, height = 64, video = false })
return s]] },
}
return list
