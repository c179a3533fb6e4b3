-- The engine stands alone: build/engine.a, all of core/engine, takes nothing from the rest of hooke, and the program that
-- core/README.md begins with, tests/standalone/spring.c, runs on it.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")

local function output_of(command)
  local pipe = assert(io.popen(command))
  local text = pipe:read("a")
  assert(pipe:close(), command .. "\n" .. text)
  return text
end

local function read(path)
  local file = assert(io.open(path))
  local text = file:read("a")
  file:close()
  return text
end

local settings = read(build .. "/settings")
local compiler = settings:match("^(.-) %-std")

-- The symbols that the four libraries and the compiler's own runtime define, which every program has.
local function defined_outside()
  local known = { _GLOBAL_OFFSET_TABLE_ = true } -- the linker makes it
  local function add(command)
    for symbol in output_of(command):gmatch("[%w_]+ %a ([%w_.$]+)") do known[symbol] = true end
  end
  local function path_of(name) return (output_of(("%s -print-file-name=%s"):format(compiler, name)):gsub("%s+$", "")) end
  local loader = read(path_of("libc.so")):match("/%S*/ld%-%S+") -- libc.so is a text that names libc.so.6 and its loader
  for _, path in ipairs { path_of("libc.so.6"), loader, path_of("libm.so.6"), path_of("libdl.so.2"),
    path_of("libpthread.so.0") } do
    add(("nm -D --defined-only '%s'"):format(path))
  end
  add(("nm -g --defined-only $(%s -print-libgcc-file-name) 2>/dev/null"):format(compiler))
  return known
end

-- The symbols that these objects and archives take and do not define, and `known` does not either, in a list.
local function missing(files, known)
  local taken, defined, list = {}, {}, {}
  for line in output_of("nm -g " .. files):gmatch("[^\n]+") do
    local kind, symbol = line:match("(%a) ([%w_.$]+)$")
    if kind == "U" then taken[symbol] = true elseif kind then defined[symbol] = true end
  end
  for symbol in pairs(taken) do
    local by_sanitizers = settings:find("-fsanitize", 1, true) and symbol:find("^__%l+san_")
    if not defined[symbol] and not known[symbol] and not by_sanitizers then list[#list + 1] = symbol end
  end
  table.sort(list)
  return list
end

local known = defined_outside()
local found = missing(("'%s/engine.a'"):format(build), known)
assert(#found == 0, "build/engine.a takes from elsewhere: " .. table.concat(found, ", "))
-- An object that calls another building is found.
found = missing(("'%s/engine.a' '%s/obj/core/numerics/population/sources.o'"):format(build, build), known)
assert(table.concat(found, " "):find("hk_population_apply", 1, true), "a planted call is not found")

local program = read(root .. "/tests/standalone/spring.c")
assert(select(2, program:gsub("\n", "")) <= 60, "tests/standalone/spring.c has more than 60 lines")
local shown = read(root .. "/core/README.md"):match("```c\n(.-)```\n")
assert(shown == program, "core/README.md shows another program than tests/standalone/spring.c")
io.write(output_of(("'%s/standalone/spring' '%s/plugins'"):format(build, build)))
