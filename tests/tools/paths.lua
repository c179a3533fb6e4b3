-- hooke paths: Euler's spiral and leapfrog's ring in closed form, particles that are born and drained, and what it refuses.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "paths")
local write, read, paths, refused = runs.write, runs.read, runs.run, runs.fails

-- w = 2 1/s: Euler multiplies the radius by sqrt(1 + h^2 w^2) in each step.
write("circle.lua", [[
local scene = hooke.scene { duration = 1, fps = 60, integrator = "leapfrog", dt = 1e-3 }
scene:particle { position = { 1, 0, 0 }, velocity = { 0, 0, 2 }, mass = 1 }
scene:force("central", { strength = 4, power = 1 })
return scene
]])
local code, text = paths("circle.lua --integrators euler@0.05,leapfrog --out new/ring")
assert(code == 0, text)
local rows = { euler = {}, leapfrog = {} }
for line in read("new/ring/paths.csv"):gmatch("[^\n]+") do
  local method, id, t, x, y, z = line:match('^"(%a+)[^"]*",(%d+),([^,]+),([^,]+),([^,]+),([^,]+)$')
  if method then table.insert(rows[method], { id = id, t = t + 0, x = x + 0, y = y + 0, z = z + 0 }) end
end
assert(#rows.euler == 21 and #rows.leapfrog == 61, #rows.euler .. " and " .. #rows.leapfrog .. " rows")
for k, row in ipairs(rows.euler) do
  assert(row.id == "1" and math.abs(row.t - 0.05 * (k - 1)) < 1e-12 and row.y == 0)
  local radius = (1 + (0.05 * 2) ^ 2) ^ ((k - 1) / 2)
  assert(math.abs(math.sqrt(row.x ^ 2 + row.z ^ 2) - radius) < 1e-12, k) -- 20 roundings
end
local last = rows.leapfrog[61] -- (h w)^2 / 24 of a swing of 2 radians: 3.4e-7
assert(math.abs(last.x - math.cos(2)) < 1e-6 and math.abs(last.z - math.sin(2)) < 1e-6)
local drawn = read("new/ring/paths.gp")
assert(drawn:find("set xlabel 'x, m'", 1, true) and drawn:find("set ylabel 'z, m'", 1, true), drawn) -- the plane of the motion

-- A particle that a drain takes away, or that is born, has a path as long as it is there.
write("drained.lua", [[
local scene = hooke.scene { duration = 1, fps = 10, integrator = "leapfrog", dt = 0.1 }
scene:particle { position = { 0, 0, 0 }, velocity = { 1, 0, 0 }, mass = 1 }
scene:particle { position = { 0, 5, 0 }, velocity = { 1, 0, 0 }, mass = 1 }
scene:source("drain", { low = { 0.45, -1, -1 }, high = { 1.45, 1, 1 } })
return scene
]])
code, text = paths("drained.lua --integrators leapfrog --of 1,2 --axes tx --out drained")
assert(code == 0, text)
text = read("drained/paths.csv")
assert(select(2, text:gsub('\n"leapfrog",1,[^,]+,,,', "")) >= 5 and not text:find('",2,[^,]+,,'), text)
assert(read("drained/paths.gp"):find("set xlabel 't, s'", 1, true))

refused("", "missing argument 'scene'")
refused("none.lua", "none.lua")
refused("circle.lua --integrators verlet", "no integrator 'verlet'")
refused("circle.lua --integrators rk4@soon", "'soon' is not a step in s")
refused("circle.lua --axes xx", "--axes: 'xx' are not two of t, x, y and z")
refused("circle.lua --of 1,a", "--of: 'a' is not the id of a particle")
refused("circle.lua --of 7", "no particle with the id 7")
refused("circle.lua --of 1,2,3,4,5,6,7", "28 curves (particles times methods) cannot be told apart: at most 24")
code, text = paths("circle.lua --integrators rk4,verlet --out half") -- one that fails leaves the others
assert(code == 0 and text:find("no integrator 'verlet'", 1, true), text)

runs.close()
