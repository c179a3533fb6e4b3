-- The film of the gallery shows the cloth come to rest: with a quarter of its particles, the speed (RMS over them) at the film's end is
-- below a twentieth of the largest. It is 0.024 of it at 2.4 s and 0.12 at 1.2 s.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = root .. "/tests/support/?.lua;" .. package.path
local files = require("files")
local runs = require("tool_runs").new(build, "run", "--quiet --no-check")

local film = dofile(root .. "/scripts/gallery.lua").film
local scene = files.read(("%s/scripts/scenes/%s.lua"):format(root, film[1]))
runs.write("film.lua", scene:gsub("scene:output%b()", [[
local ids = cloth:ids()
scene:measure("speed", function(s)
  local sum = 0
  for _, i in ipairs(ids) do
    local v = s:velocity(i)
    sum = sum + v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2
  end
  return math.sqrt(sum / #ids)
end)]]))
local code, said = runs.run(("film.lua N=21 --until %g --out out"):format(film.at))
assert(code == 0, said)
local largest, last = 0, nil
for value in runs.read("out/measures.csv"):gmatch(",([^,\n]+)\n") do
  last = tonumber(value)
  if last then largest = math.max(largest, last) end
end
assert(largest > 1 and last < 0.05 * largest, ("%g m/s at the end, %g at most"):format(last, largest))
runs.close()
