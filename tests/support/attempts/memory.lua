-- Scenes that try to have memory read or written that is not theirs, or to change a scene while it is read.
local scene = 'local s = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog" }\n'
local ball = scene .. "local p = s:particle { position = {0, 0, 1} }\n"
local chain = scene .. "local h = s:strand { n = 3 }\n"
local end_it = '\nerror("end")'

-- A table whose fields are read through a function that runs the scene, or adds particles to it.
local function trap(call, what)
  return 'local armed = true\nlocal t = setmetatable({}, { __index = function(_, k) if armed then armed = false\n' .. what
    .. ' end return ({ position = {0, 0, 0}, file = "x", path = nil, g = {0, 0, -9} })[k] end })\n' .. call .. "\nreturn s"
end

local runs = "for i = 1, 2000 do s:particle { position = {i, 0, 0} } end s:run()"

-- A chain whose __concat is the script's, here one that calls itself through 150 calls of C.
local joined = [[
local mt, depth = {}, 0
local t = setmetatable({}, mt)
local function join() depth = 0 local r = "x" .. t .. "y" .. t .. t .. "z" assert(r == t or type(r) ~= "table") end
]]
local nest = [[
mt.__concat = function()
  depth = depth + 1
  if depth < 150 then local _ = "a" .. t .. "b" .. t end
  return t
end
]]

local list = {
  { "a grid's structural called with memory as handle", says = "functions of a handle are called with a colon",
    scene = chain .. 'h.structural(string.rep("\\0\\1\\2\\3AAAA", 100))' },
  { "edges of a table", scene = chain .. "h.edges({})", says = "functions of a handle are called with a colon" },
  { "edges of a number", scene = chain .. "h.edges(4096)", says = "functions of a handle are called with a colon" },
  { "edges of nothing", scene = chain .. "h.edges()", says = "functions of a handle are called with a colon" },
  { "flexion of a scene", scene = chain .. "h.flexion(s)", says = "functions of a handle are called with a colon" },
  { "flexion of a function", scene = chain .. "h.flexion(print)", says = "functions of a handle are called with a colon" },
  { "triangles of a text", scene = chain .. 'h.triangles("x")', says = "functions of a handle are called with a colon" },
  { "structural of particles without edges", says = "particles have no edges of their own",
    scene = scene .. "local h = s:particles { positions = { {0, 0, 0} } }\nh:structural()" },
  { "a scene's method of a handle", scene = chain .. "s.force(h, 'gravity')", says = "called with a colon" },
  { "a run's method of a scene", scene = ball .. "local r = s:run()\nr.state(s)", says = "functions of a run are called with a colon" },
  { "a state's method of a run", says = "functions of a state are called with a colon",
    scene = ball .. "local r = s:run()\nr:state().position(r, 1)" },
  { "an edge's metamethod of a handle", scene = chain .. "return #h:edges() .. h", says = "hooke:" },
  { "the environment's __index of a number", scene = 'getmetatable(_G).__index(42, "x")', says = "hooke:" },
  { "param re-entered from __tostring", says = "hooke:", scene = [[
local t = setmetatable({}, { __tostring = function() for i = 1, 100 do param("p" .. i, i) end return "x" end })
param("a", t, "h")]] .. end_it },
  { "param with a help that re-enters", says = "hooke:", scene = [[
local t = setmetatable({}, { __tostring = function() param("x", 1) return 5 end })
param("a", t)]] .. end_it },
  { "a particle's table runs the scene", scene = ball .. trap("s:particle(t)", runs), says = "hooke:" },
  { "a particle's channels run the scene", says = "hooke:",
    scene = ball .. 's:channel("c", { size = 2, initial = {1, 1} })\n' .. trap("s:particle(t)", runs) },
  { "a table of particles adds channels", says = "hooke:",
    scene = ball .. trap("s:particle(t)", 'for i = 1, 100 do s:channel("c" .. i, { initial = 1 }) end') },
  { "a force's table runs the scene", scene = ball .. trap('s:force("gravity", t)', runs), any = true },
  { "a force's label drops the force", any = true,
    scene = ball .. trap('s:integrator("leapfrog", t)', 's:integrator("rk4") s:integrator("auto")') },
  { "a pin's table runs the scene", scene = ball .. trap("s:pin({ 1 }, t)", runs), says = "hooke:" },
  { "a channel's table runs the scene", scene = ball .. trap('s:channel("c", t)', runs), says = "hooke:" },
  { "a channel's table adds channels", says = "hooke:",
    scene = ball .. trap('s:channel("c", t)', 'for i = 1, 100 do s:channel("c" .. i) end') },
  { "a solver's table chooses another", any = true,
    scene = ball .. trap('s:solver("pcg", t)', 's:solver("cholesky") s:solver("auto")') },
  { "an integrator's list chooses another", any = true, scene = [[
local s
local t = setmetatable({ "rk4" }, { __index = function() return 1 end, __newindex = function() end })
s = hooke.scene { integrator = t }]] .. end_it },
  { "a scene's table makes scenes", says = "hooke:", scene = [[
local t = setmetatable({}, { __index = function(_, k) for i = 1, 1000 do hooke.scene{} end return nil end })
hooke.scene(t)]] .. end_it },
  { "the table of a run runs the scene", scene = ball .. trap("s:run(t)", "s:run()"), says = "hooke:" },
  { "the table of a start is changed", scene = ball .. trap("s:start(t)", runs), says = "hooke:" },
  { "the table of a mesh runs the scene", scene = ball .. trap("s:mesh(t)", runs), says = "hooke:" },
  { "the table of a grid runs the scene", scene = ball .. trap("s:grid(t)", runs), says = "hooke:" },
  { "the table of a strand runs the scene", scene = ball .. trap("s:strand(t)", runs), says = "hooke:" },
  { "the table of particles runs the scene", scene = ball .. trap("s:particles(t)", runs), says = "hooke:" },
  { "limits of a parameter that declare parameters", says = "hooke:", scene = [[
param("a", 1, "", setmetatable({}, { __index = function() for i = 1, 100 do param("b" .. i, 1) end return 2 end }))]] .. end_it },
  { "springs with an empty list of stiffnesses", says = "k has 0 numbers",
    scene = chain .. 's:force("springs", { edges = h:edges(), k = {} })\nreturn s' },
  { "springs with an empty list of rest lengths", any = true,
    scene = chain .. 's:force("springs", { edges = h:edges(), k = 1, rest = {} })\nreturn s' },
  { "springs with one stiffness for two edges as a list", any = true,
    scene = chain .. 's:force("springs", { edges = h:edges(), k = {1} })\nreturn s' },
  { "a force that was refused and stays", says = "verdict           ok", any = true,
    scene = chain .. 'pcall(s.force, s, "springs", { edges = h:edges(), k = -1 })\npcall(s.force, s, "springs", {})\nreturn s' },
  { "springs between particles that are not there", says = "there is no particle",
    scene = ball .. 's:force("springs", { edges = { {1, 4294967295} }, k = 1 })' },
  { "strain in a measure without springs", says = "hooke:",
    scene = ball .. 's:measure("m", function(q) return q:strain() end)\nreturn s' },
  { "strain of a force without elements", says = "hooke:",
    scene = ball .. 's:force("gravity")\ns:measure("m", function(q) return q:strain("gravity") end)\nreturn s' },
  { "the force on a particle that is not there", says = "there is no particle",
    scene = ball .. 's:force("gravity")\ns:measure("m", function(q) return q:force("gravity", 77)[1] end)\nreturn s' },
  { "a channel of a particle with a huge id", says = "there is no particle",
    scene = ball .. 's:measure("m", function(q) return q:channel("c", math.maxinteger) end)\nreturn s' },
  { "a state after its run", says = "hooke:", scene = ball .. "local q = s:run():state()\nreturn q.t .. q:position(2)[1]" },
  { "a state without a run", says = "hooke:", scene = ball .. [[
local kept
s:measure("m", function(q) kept = q return 1 end)
hooke.scene{}
return kept.t]] },
  { "a scene edited while it runs", says = "hooke:",
    scene = ball .. 's:on_frame(function() s:particle { position = {1, 0, 0} } end)\nreturn s' },
  { "a scene run by its measure", says = "hooke:", scene = ball .. 's:measure("m", function() s:run() return 1 end)\nreturn s' },
  { "a scene made by a measure", says = "hooke:", scene = ball .. 's:measure("m", function() hooke.scene{} return 1 end)\nreturn s' },
  { "a group with a zero in its name", any = true, scene = scene .. 's:particle { group = "a\\0b" }\nreturn s' },
  { "a name of 100,000 letters for everything", says = "hooke:", scene = scene .. [[
local n = string.rep("x", 100000)
s:channel(n, { initial = 1 })
s:particle { group = n, [n] = 2 }
s:measure(n, function() return 1 end)
s:force("gravity", { label = n })
s:force(n)]] },
  { "a plugin's name of 100,000 letters", says = "hooke:", scene = 'hooke.scene{}:force(string.rep("/x", 50000))' },
  { "a grid of more particles than ids", says = "hooke:", scene = scene .. "s:grid { nx = 1e6, ny = 1e6 }" },
  { "ids that are not whole", says = "hooke:", scene = ball .. "s:pin { 0.5 }" },
  { "ids that are not numbers", says = "hooke:", scene = ball .. "s:pin { 0/0 }" },
  { "a list of ids that changes its length", says = "hooke:",
    scene = ball .. "s:pin(setmetatable({}, { __len = function() return 1e9 end, __index = function() return 1 end }))" .. end_it },
  { "many channels at once", says = "hooke:",
    scene = scene .. 'for i = 1, 100 do s:channel("c" .. i, { initial = i }) end\ns:particle { c99 = 1 }\nreturn s.x' },
  { "a yield from a function that the run calls", says = "hooke:", scene = ball ..
    's:measure("m", function() coroutine.yield(1) return 1 end)\nreturn s' },
  { "a run that is driven in a coroutine which is dropped", any = true, scene = ball ..
    's:on_frame(function() coroutine.yield() end)\nlocal co = coroutine.create(function() s:run() end)\n' ..
    "coroutine.resume(co) co = nil\nfor i = 1, 100 do local t = string.rep('x', 2^20) end\nreturn s" },
  { "recursion without end", scene = "local function f() return 1 + f() end f()", says = "stack overflow" },
  { "recursion without end in a coroutine, caught again and again", says = "f.lua:3: stack overflow", name = "f.lua",
    scene = "local function f() return 1 + f() end\nlocal co = coroutine.wrap(function() for k = 1, 9 do pcall(f) end end)\nco()" },
  { "a deep __concat", scene = joined .. nest .. "join()" .. end_it, says = "end" },
  { "a deep __concat in a coroutine", scene = joined .. nest .. "coroutine.wrap(join)()" .. end_it, says = "end" },
  { "a __concat in a deep call", says = "end", scene = joined .. nest ..
    "local function deep(n) if n == 0 then join() return 0 end return 1 + deep(n - 1) end\nfor n = 200, 400, 7 do deep(n) end" ..
    end_it },
  { "a __concat that calls deeply", says = "end", scene = joined .. [[
local function deep(n) if n == 0 then return 0 end return 1 + deep(n - 1) end
mt.__concat = function() deep(3000) return t end
for _ = 1, 20 do join() end]] .. end_it },
  { "a __concat that calls without end and catches it", says = "stack overflow", scene = joined .. [[
local function f() return 1 + f() end
mt.__concat = function() pcall(f) return t end
join()]] },
  { "a __concat of many results", says = "hooke:", scene = joined .. [[
for i = 1, 7000 do t[i] = t end
mt.__concat = function(a, b) return (select(-1, table.unpack(t))) end
coroutine.wrap(join)()
mt.__concat = table.unpack
coroutine.wrap(join)()]] .. end_it },
  { "a coroutine whose stack grows for its arguments", says = "20000 arguments are more", scene = joined ..
    "local many = {} for i = 1, 20000 do many[i] = i end\ncoroutine.wrap(join)(table.unpack(many))" },
  { "more results than slots", says = "table.unpack: 50000 results are more", scene = "return table.unpack({}, 1, 50000)" },
  { "more bytes than slots", says = "a text's part: 49999 results are more", scene = 'return ("x"):rep(50000):byte(-50000, -2)' },
  { "recursion through C", says = "hooke:", scene = 'local function f(s) return s:gsub(".", f) end f("x")' },
  { "recursion through metamethods", says = "hooke:",
    scene = "local t = {} setmetatable(t, { __index = function(t, k) return t[k .. 'x'] end }) return t.a" },
  { "nested patterns", says = "hooke:", scene = 'string.find(string.rep("a", 1e6), string.rep("a?", 1e6))' .. end_it },
  { "arguments without end", says = "hooke:", scene = "return string.char(table.unpack({}, 1, 1e7))" },
  { "a pack format that wants much", says = "hooke:", scene = 'return string.pack(string.rep("i16", 1e5), 1)' },
  { "a scene that was run and is then returned", scene = ball .. 's:force("gravity")\ns:run()\nreturn s', twice = true },
}
return list
