-- hooke scaling: the particles, steps and costs of its table, what it draws beside them, and what it refuses.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "scaling", "--quiet")
local write, read, scaling, refused = runs.write, runs.read, runs.run, runs.fails

write("row.lua", [[
local N = param("N", 4, "particles", { min = 2, max = 100 })
local scene = hooke.scene { duration = 0.2, fps = 20, integrator = "leapfrog", dt = 1e-3 }
local row = scene:strand { n = N, length = 1, mass = 1 }
scene:force("springs", { edges = row:edges(), k = 100 })
return scene
]])
write("other.csv", "by hand,5,1e-6\nby hand,50,2e-6\n")

-- Frames of 50 ms have 50 steps of 1 ms; a step of 2 ms is that of the second method, and half as many.
local code, text = scaling("row.lua N=5,50 --integrators leapfrog,rk4@0.002 --budget 10 --beside other.csv --out new/far")
assert(code == 0, text)
local rows = {}
for line in read("new/far/scaling.csv"):gmatch("[^\n]+") do rows[#rows + 1] = line end
assert(#rows == 5, read("new/far/scaling.csv"))
for k, wanted in ipairs { { "leapfrog", 5, 150, 1e-3 }, { "leapfrog", 50, 150, 1e-3 }, { "rk4@0.002", 5, 75, 2e-3 },
  { "rk4@0.002", 50, 75, 2e-3 } } do
  local method, value, n, threads, steps, dt, simulated, wall, cost = rows[k + 1]:match(
    '^"([^"]*)",(%d+),(%d+),(%d+),(%d+),([^,]+),([^,]+),([^,]+),([^,]+)$')
  assert(method == wanted[1] and tonumber(value) == wanted[2] and tonumber(n) == wanted[2] and threads == "1", rows[k + 1])
  assert(tonumber(steps) == wanted[3], rows[k + 1]) -- three of four frames: the first one warms up
  assert(math.abs(dt - wanted[4]) < 1e-9 and math.abs(simulated - 0.15) < 1e-9, rows[k + 1])
  assert(math.abs(cost - wall / simulated / n) < 1e-8 * cost and tonumber(cost) > 0, rows[k + 1])
end
assert(text:find("leapfrog +50 +50 +1.00e%-03"), text)
local drawn = read("new/far/scaling.dat")
assert(drawn:find("\n5 1\n50 2\n"), drawn) -- us

refused("row.lua", "no parameter has several values: name the one that sets the size, N=10,32,100")
refused("row.lua N=2,3 k=1,2", "both have several values")
refused("row.lua N=2,3 --integrators verlet", "no integrator 'verlet'")
refused("row.lua N=2,3 --integrators rk4@soon", "'soon' is not a step in s")
refused("row.lua N=2,3 --beside nowhere.csv", "cannot read nowhere.csv")
refused("row.lua N=2,3 --beside row.lua", "row.lua:1: not LABEL,PARTICLES,COST")
refused("none.lua N=2,3", "none.lua")
refused("row.lua N=a,b", "no run gave a cost; the first, of N=a: row.lua:1: parameter N: 'a' is not a number")
refused("row.lua N=2,3 --out row.lua/x", "cannot make the folder row.lua/x: row.lua is a file; name another folder")
code, text = scaling("row.lua N=3,1000 --budget 0.01 --out half") -- a size that fails leaves the others
assert(code == 0 and text:find("1000 row.lua:1: parameter N: 1000 is above the maximum 100", 1, true), text)

runs.close()
