-- The test: nothing is called ok that is not as accurate as was asked, and nothing breaks. Where nobody asked, one run in a
-- hundred may be off by more than a tenth of its motion ("visible"), without a comparison that would cost too much. With
-- arguments, a measurement:
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
  local all = 0
  for _, count in pairs(counts) do all = all + count end
  return (counts["OK+WRONG"] or 0) == 0 and (counts.broken or 0) == 0 and (counts.visible or 0) <= math.max(1, all / 100)
end
