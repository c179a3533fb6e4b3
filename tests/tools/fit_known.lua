-- hooke fit on scenes whose least squares are known in closed form, since their measures are linear in the parameters: priors, with
-- the mean and the covariance that Bayes' rule gives; the ellipses of confidence; kinks; what is left of an interrupted fit; the keys of
-- its JSON; and tables as other programs write them.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local json = require("cjson")
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "fit", "--quiet")
local write, read, fit, refused = runs.write, runs.read, runs.run, runs.refused

local function near(what, x, wanted, tolerance)
  assert(math.abs(x - wanted) <= tolerance, ("%s: %.12g instead of %.12g"):format(what, x, wanted))
end

-- x = v t + g t^2/2 of a free particle, exactly so by leapfrog's steps.
write("throw.lua", [[
local v, g = param("v", 1, "m/s"), param("g", 1, "m/s^2")
local n = param("n", 1, "of particles")
local scene = hooke.scene { duration = 2, fps = 10, integrator = "leapfrog", dt = 0.05 }
local p = scene:particle { velocity = { v, 0, 0 } }
for k = 2, n do p = scene:particle { position = { k, 0, 0 } } end
scene:force("gravity", { g = { g, 0, 0 } })
scene:measure("x", function(s) return s:position(p)[1] end)
return scene
]])
local times, sd, lines, plain = { 0.5, 1, 1.5, 2 }, 0.1, { "t,x,x_sd" }, { "t,x" }
local measured = { 1.55, 3.9, 7.6, 11.85 }
for k, t in ipairs(times) do
  lines[k + 1], plain[k + 1] = ("%g,%g,%g"):format(t, measured[k], sd), ("%g,%g"):format(t, measured[k])
end
write("data.csv", table.concat(lines, "\n") .. "\n")
write("plain.csv", table.concat(plain, "\n") .. "\n")

-- The normal equations, (A^T A/sd^2 + P) p = A^T y/sd^2 + P mean, with the prior's precision P of g.
local function posterior(mean, deviation)
  local a, b, c, d, e = 0, 0, 0, 0, 0
  for k, t in ipairs(times) do
    local f = t * t / 2
    a, b, c = a + t * t / sd ^ 2, b + t * f / sd ^ 2, c + f * f / sd ^ 2
    d, e = d + t * measured[k] / sd ^ 2, e + f * measured[k] / sd ^ 2
  end
  local precision = deviation and 1 / deviation ^ 2 or 0
  c, e = c + precision, e + precision * (mean or 0)
  local det = a * c - b * b
  return { v = (c * d - b * e) / det, g = (a * e - b * d) / det, v_sd = math.sqrt(c / det), g_sd = math.sqrt(a / det),
    correlation = -b / math.sqrt(a * c) }
end

local function check(words, wanted)
  local code, text = fit("throw.lua --data data.csv --by v,g " .. words)
  assert(code == 0, text)
  local all = json.decode((read("out/fit/throw/fit.json")))
  local found = all.minima[1].parameters
  for _, name in ipairs { "v", "g" } do -- linear: what is left is that of differences of 1e-5, rounding of 1e-10
    near(name, found[name].value, wanted[name], 1e-7)
    near(name .. "'s deviation", found[name].deviation, wanted[name .. "_sd"], 1e-7)
  end
  near("correlation", found.v.correlation.g, wanted.correlation, 1e-7)
  return all, text
end
local all = check("", posterior())
assert(all.doubts ~= nil and #all.doubts == 0 and all.answer == json.null and all.minima[1].parameters.g.prior == json.null)
assert(read("out/fit/throw/fit.json"):find('"doubts":[]', 1, true))
all = check("--prior g=4.2:0.3", posterior(4.2, 0.3))
assert(all.minima[1].parameters.g.prior.mean == 4.2 and all.minima[1].numbers == 4)

-- Points of the ellipse of 95 % have (p - best)^T C^-1 (p - best) = -2 ln 0.05.
local wanted, seen = posterior(4.2, 0.3), 0
for line in read("out/fit/throw/fit.confidence-v-g.dat"):gmatch("[^\n]+") do
  local v, g = line:match("^(%S+) (%S+)$")
  v, g = tonumber(v), tonumber(g)
  if v and g then
    local x, y, c = (v - wanted.v) / wanted.v_sd, (g - wanted.g) / wanted.g_sd, wanted.correlation
    local level = (x * x - 2 * c * x * y + y * y) / (1 - c * c)
    if math.abs(level + 2 * math.log(0.05)) < 1e-3 then seen = seen + 1 end -- the table has nine digits
  end
end
assert(seen >= 101, seen)
assert(read("out/fit/throw/fit.confidence-v-g.gp"):find("v (m/s)", 1, true) and read("out/fit/throw/fit.residuals.png"):find("^\137PNG"))

-- A prior determines what the data leave open; without one they are as many as the numbers, and tell no deviations.
write("one.csv", "t,x,x_sd\n1,3,0.1\n")
local code, text = fit("throw.lua --data one.csv --by v,g --prior g=4:0.2")
assert(code == 0, text)
local p = json.decode((read("out/fit/throw/fit.json"))).minima[1].parameters
near("v", p.v.value, 1, 1e-7) -- 3 = v + 4/2
near("v's deviation", p.v.deviation, math.sqrt(0.1 ^ 2 + 0.1 ^ 2), 1e-7)
write("two.csv", "t,x\n1,3\n2,10\n")
code, text = fit("throw.lua --data two.csv --by v,g")
assert(code == 0 and text:find("there are as many parameters as numbers", 1, true), text)

refused("throw.lua --data plain.csv --by v,g --prior g=4:1", "--prior: the data have no standard deviations, beside which")
refused("throw.lua --data data.csv --by v --prior g=4:1", "--prior: g is not fitted: name it in --by too")
refused("throw.lua --data data.csv --by v,g --prior g=4", "--prior: g: a mean and a standard deviation, g=MEAN:DEVIATION")
refused("throw.lua --data data.csv --by v,g --prior g=4:0", "--prior: g: the standard deviation, 0, is not above 0")
refused("throw.lua --data data.csv --by v,g --prior g=4:1,g=3:1", "--prior: g is there twice")
refused("throw.lua --data data.csv --by v,g --prior g=x", "--prior: g: 'x' is not a number")

-- In a script, too.
write("said.lua", [[return hooke.fit { scene = "throw.lua", data = "data.csv", by = { "v", "g" }, prior = { g = { 4.2, 0.3 } },
  found = function(fit) return fit.best.parameters.g.value end }]])
code, text = fit("said.lua --json")
assert(code == 0, text)
near("answer", json.decode(text:match("{.*}")).answer, posterior(4.2, 0.3).g, 1e-7)

-- ---- the page: one file, without scripts and addresses elsewhere, with all that is said and drawn ----

write("a<b.lua", read("throw.lua"))
code, text = fit("'a<b.lua' --data data.csv --by v,g")
assert(code == 0, text)
local page = read("out/fit/a<b/page.html")
assert(page:find("^<!DOCTYPE html>") and page:find("</html>\n$"))
assert(page:find("a&lt;b.lua", 1, true) and not page:find("a<b", 1, true), "a scene's name is text")
assert(not page:find("<script", 1, true) and not page:find("://", 1, true), "it needs nothing else")
local figures = select(2, page:gsub('<img src="data:image/svg%+xml,%%3C%%3Fxml', ""))
assert(figures == 3, figures .. " diagrams in place of that of x, of the residuals and of v and g")
for _, words in ipairs { "<td>v</td>", "<td>g</td>", "residuals: rms", "Nothing was found" } do assert(page:find(words, 1, true), words) end
os.remove("out/fit/a<b/page.html")
code, text = fit("'a<b.lua' --data data.csv --by v,g --no-diagrams")
assert(code == 0 and not text:find("page.html", 1, true), text)
assert(not io.open("out/fit/a<b/page.html"), "without diagrams there is no page")

-- ---- a jump: with a little less than one particle more the measure is another one ----

code, text = fit("throw.lua --data plain.csv --by n=2")
assert(code == 2 and text:find("n: the measures have a kink or jump at this value", 1, true), text)

-- A kink at the best value of a single parameter, to which secants lead: |v t - 2 t| above data that are below 0.
write("kink.lua", [[
local v = param("v", 3, "m/s")
local scene = hooke.scene { duration = 1, fps = 10, integrator = "leapfrog", dt = 0.05 }
local p = scene:particle { velocity = { v, 0, 0 } }
scene:measure("bent", function(s) return math.abs(s:position(p)[1] - 2 * s.t) end)
scene:measure("straight", function(s) return 0.1 * s:position(p)[1] end)
return scene
]])
write("kink.csv", "t,bent,bent_sd,straight,straight_sd\n1,-1,1,0.2,1\n")
for _, start in ipairs { "v", "v=1.7" } do
  code, text = fit("kink.lua --data kink.csv --by " .. start)
  assert(code == 2 and text:find("the measures have a kink or jump at these values", 1, true), text)
end

-- ---- priors that are none ----

refused("throw.lua --data data.csv --by v,g --prior g=1e999:1", "--prior: g: two finite numbers, g=MEAN:DEVIATION")
refused("throw.lua --data data.csv --by v,g --prior g=1:1e999", "--prior: g: two finite numbers, g=MEAN:DEVIATION")

-- ---- the best of the moment, while a fit goes on ----

write("slow.lua", [[
local k = param("k", 30, "N/m")
local scene = hooke.scene { duration = 2, fps = 20, integrator = "leapfrog", dt = 2e-6 }
local p = scene:particle { position = { 1, 0, 0 } }
scene:force("central", { strength = k, per = "particle" })
scene:measure("x", function(s) return s:position(p)[1] end)
return scene
]])
write("slow.csv", "t,x\n0.2,0.2\n0.3,-0.3\n")
fit("slow.lua --data slow.csv --by k --jobs 1", "sh -c '\"$@\" & p=$!; while [ ! -s out/fit/slow/now.txt ] && kill -0 $p 2>/dev/null; do "
  .. "sleep 0.01; done; kill -9 $p' sh")
assert(read("out/fit/slow/now.txt"):find("^k=[%d.]+\n$"), read("out/fit/slow/now.txt"))

-- ---- tables as other programs write them ----

write("mark.csv", "\xEF\xBB\xBF" .. table.concat(plain, "\r\n") .. "\r\n")
code, text = fit("throw.lua --data mark.csv --by v,g")
assert(code == 0, text)
write("semi.csv", "t;x\n1;3,5\n")
refused("throw.lua --data semi.csv --by v", "semi.csv:1: the columns are apart by semicolons: put commas between them")
refused("throw.lua --data . --by v", "cannot read .: it is no file of text, but perhaps a folder")
refused("throw.lua --data plain.csv --by v=1:0:9 --starts 1e9", "--starts: 1000000000 are more than 10000: take fewer")
write("nan.csv", "t,x\n1,nan\n")
refused("throw.lua --data nan.csv --by v", "nan.csv:2: x: 'nan' is not a finite number: the cell of a gap stays empty")
write("long.lua", 'local T = param("T", 2, "s")\nlocal scene = hooke.scene { duration = T }\n'
  .. 'local p = scene:particle { velocity = { 1, 0, 0 } }\n'
  .. 'scene:measure("x", function(s) return s:position(p)[1] end)\nreturn scene\n')
refused("long.lua --data plain.csv --by T", "from the start, T = 2: run: to: 2 s is after the scene's duration")
runs.close()
