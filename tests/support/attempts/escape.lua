-- Scenes that try to have native code loaded, to reach what the sandbox keeps from them, or to see addresses.
local ball = 'local s = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog" }\n'
  .. "local p = s:particle { position = {0, 0, 1} }\n"
local native = 'hooke.scene{}:force("./escape.so")'
local in_measure = ball .. 's:measure("m", function() ' .. native .. " return 1 end)\nreturn s"

local list = {
  { "native code named by the script", scene = native, says = "native code outside the installation" },
  { "native code named by an absolute path", scene = 'hooke.scene{}:force("@HERE@/escape.so")', says = "native code outside" },
  { "native code by climbing out of the installation's folder", says = "hooke:",
    scene = 'hooke.scene{}:force("@PLUGINS@/../../../../../../../../../@HERE@/escape.so")' },
  { "native code as integrator", scene = 'hooke.scene { integrator = "./escape.so" }', says = "native code outside" },
  { "native code as rate of a channel", scene = ball .. 's:channel("c", { rate = "./escape.so" })', says = "native code outside" },
  { "native code by a service", scene = 'hooke.scene{}:service("./escape.so")', says = "native code outside" },
  { "native code by a name that climbs", scene = 'hooke.scene{}:force("../../escape")', says = "hooke:" },
  { "native code beside the scene as a module", scene = 'require("escape")', says = "there is no module" },
  { "native code in a function of time", says = "hooke:",
    scene = ball .. 's:force("gravity", { g = function(t) ' .. native .. " return 0, 0, -1 end })\nreturn s" },
  { "native code in on_frame", scene = ball .. "s:on_frame(function() " .. native .. " end)\nreturn s", says = "hooke:" },
  { "native code in the exact solution", scene = ball .. "s:exact(function() " .. native .. " return 0 end)\nreturn s", says = "hooke:" },
  { "native code in a coroutine", scene = "coroutine.wrap(function() " .. native .. " end)()", says = "native code outside" },
  { "native code hidden by pcall", scene = "pcall(function() " .. native .. ' end) error("end")', says = "end" },
  { "os", scene = 'os.execute("touch ESCAPED")', says = "os.execute is not available" },
  { "io", scene = 'io.open("@OUTSIDE@/secret")', says = "io.open is not available" },
  { "package.loadlib", scene = 'package.loadlib("./escape.so", "*")', says = "package.loadlib is not available" },
  { "debug", scene = "debug.getregistry()", says = "debug.getregistry is not available" },
  { "load, also of bytecode", scene = 'load("\\27Lua")', says = "load is not available" },
  { "bytecode made of a function", scene = "string.dump(print)", says = "dump" },
  { "bytecode as the scene", scene = "\27Lua\x54\0\x19\x93", says = "binary chunk" },
  { "bytecode as a module", scene = 'require("bytes")', setup = "printf '\\033LuaT' > bytes.lua", says = "binary chunk" },
  { "dofile", scene = 'dofile("@OUTSIDE@/secret")', says = "dofile is not available" },
  { "collectgarbage", scene = 'collectgarbage("stop")', says = "collectgarbage is not available" },
  { "a module outside of the folder", scene = 'require("../outside/secret")', says = "is not the name of a module" },
  { "a module that is a link to outside", scene = 'require("link")', setup = "ln -s ../outside/secret.lua link.lua",
    says = "outside" },
  { "the environment's metatable", scene = 'getmetatable(_G).__index = nil', says = "hooke:" },
  { "the strings' metatable", scene = 'getmetatable("").__index = nil', says = "hooke:" },
  { "a metatable of strings put in the place of the protected one", scene = 'setmetatable("", {})', says = "table expected" },
  { "the metatable of a scene", scene = "getmetatable(hooke.scene{}).__index = nil", says = "hooke:" },
  { "the metatable of a run", says = "hooke:",
    scene = ball .. "local r = s:run()\ngetmetatable(r).__index = nil" },
  { "a finalizer through the metatable of a run", says = "hooke:",
    scene = ball .. "getmetatable(s:run()).__gc = function() while true do end end" },
  { "a finalizer of its own", scene = "setmetatable({}, { __gc = function() while true do end end })",
    says = "__gc is not available" },
  { "a finalizer added later", any = true,
    scene = "local m = {} setmetatable({}, m) m.__gc = function() while true do end end\n" .. ball .. "return s" },
  { "a run saved to a file", scene = ball .. 's:run():save("@OUTSIDE@/ESCAPED")', says = "run:save writes a file" },
  { "addresses by %p", scene = 'error(string.format("%p", {}))', hides = "0x%x+" },
  { "addresses by %p of strings' methods", scene = 'error(("%-20p"):format(print))', hides = "0x%x+" },
  { "addresses by %p behind a zero", scene = 'error((("\\0%p"):format({}):gsub("%z", "")), 0)', hides = "0x%x+" },
  { "addresses by %s behind a zero", scene = 'error((("\\0%s"):format({}):gsub("%z", "")), 0)', hides = "0x%x+" },
  { "addresses of functions", scene = 'error(tostring(math.sin), 0)', hides = "0x%x+", says = "function" },
  { "addresses of tables", scene = 'error(tostring({}), 0)', hides = "0x%x+", says = "table" },
  { "addresses of coroutines", scene = 'error(tostring(coroutine.create(print)), 0)', hides = "0x%x+", says = "thread" },
  { "addresses of scenes", scene = 'error(tostring(hooke.scene{}), 0)', hides = "0x%x+", says = "hooke.scene" },
  { "addresses of runs", hides = "0x%x+", says = "hooke.run", scene = ball .. "error(tostring(s:run()), 0)" },
  { "addresses of states", hides = "0x%x+", says = "hooke.state",
    scene = ball .. 's:measure("m", function(q) error(tostring(q), 0) end)\nreturn s' },
  { "addresses by %s", scene = 'error(string.format("%s %s", {}, print), 0)', hides = "0x%x+", says = "table" },
  { "addresses by print", scene = 'print({}, print, hooke.scene{}) error("end")', hides = "0x%x+", says = "end" },
  { "addresses by the text of an error", scene = 'param({}, print)', hides = "0x%x+", says = "hooke:" },
  { "addresses in the values of parameters", scene = 'param("a", print) param("b", {}) error("end")',
    args = "--help", any = true, hides = "0x%x+" },
  { "addresses by a __name", scene = 'error(tostring(setmetatable({}, { __name = "n" })), 0)', hides = "0x%x+" },
  { "the address in the seed of random numbers", says = "same",
    scene = 'local a, b = math.randomseed()\nerror((b == 0 or b == nil) and "same" or "other", 0)' },
  { "the address in the random numbers before a seed", says = "hooke:", same = true,
    scene = 'error(tostring(math.random(0)), 0)' },
}
local burglar = ball .. 's:force("@FIXTURES@/burglar.so")\nreturn s'
local lets_in = "HOOKE_PLUGIN_PATH=@FIXTURES@ HOOKE_OUTSIDE=@OUTSIDE@"
for _, tool in ipairs { "run", "sweep", "explain" } do
  list[#list + 1] = { "native code that got in all the same, under " .. tool, scene = burglar, environment = lets_in, any = true,
    command = tool, args = tool == "run" and "--out out --state final.csv", says = "burglar: 0 of 17 doors were open" }
end
for _, tool in ipairs { "run", "explain", "stability", "bench --budget 2 --jobs 1", "sweep" } do
  list[#list + 1] = { "native code in a measure, under " .. tool, scene = in_measure, command = tool, any = true }
  list[#list + 1] = { "native code in a measure of a run that the script drives, under " .. tool, command = tool, any = true,
    scene = in_measure:gsub("return s$", "s:run()") }
end
return list
