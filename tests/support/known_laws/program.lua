-- The test: nothing that is wrong is called ok, and nothing breaks. With arguments, a measurement:
--   HK_ROOT=. HK_BUILD=build lua tests/physics/known_laws.lua --seed 7 --cases 500 --runs 4 --family bounce --list
--   HK_ROOT=. HK_BUILD=build lua tests/physics/known_laws.lua --one bounce --seed 123 --methods leapfrog --accuracies 1e-4
local known = require("known_laws.run")

return function(arguments, cases, runs)
  local o = known.options(arguments)
  o.build = assert(os.getenv("HK_BUILD"))
  o.hooke = o.hooke or o.build .. "/hooke"
  if #arguments == 0 then o.cases, o.runs = cases, runs end
  local pipe = assert(io.popen("mktemp -d"))
  o.folder = pipe:read("l")
  pipe:close()
  local counts = known.measure(o)
  if o.keep then print("kept in " .. o.folder) else os.execute("rm -rf '" .. o.folder .. "'") end
  return (counts["OK+WRONG"] or 0) == 0 and (counts.broken or 0) == 0
end
