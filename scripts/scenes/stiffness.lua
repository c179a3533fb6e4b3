-- stiffness.lua: a chain of 20 links that hardly stretches falls from 60 degrees and swings, by four remedies: springs so
-- stiff that the steps have to be short, implicit steps of stiff springs, and in the place of springs bars, or corrections
-- after each step. Each has a level: from one to the next springs are four times as stiff and steps half as long. The
-- error is against a chain that does not stretch, computed in its angles (lib/links.lua). scripts/sweeps/remedies.lua
-- draws speed against error.
local links = require("links")
local remedy = param("remedy", "bars", "shorter steps, implicit, bars, correction")
local level = param("level", 3, "the higher, the more accurate and the slower", { min = 0, max = 16 })
local n = param("n", 20, "links", { min = 2, max = 64 })

local L, g, angle, mass = 1, 9.81, math.rad(60), 0.1 / n
local h = 1 / 120 / 2 ^ level
local methods = {
  ["shorter steps"] = { integrator = "leapfrog" },
  implicit = { integrator = "implicit_midpoint", dt = h },
  bars = { integrator = "leapfrog", dt = h },
  correction = { integrator = "leapfrog", dt = h },
}
local settings = methods[remedy] or error("remedy: one of shorter steps, implicit, bars, correction")
settings.duration, settings.fps = 1.5, 60
local scene = hooke.scene(settings)

local chain = scene:strand { n = n + 1, from = { 0, 0, 0 }, to = { L * math.sin(angle), 0, -L * math.cos(angle) },
  mass = mass * (n + 1) }
scene:pin { chain:at(1) }
scene:force("gravity", { g = { 0, 0, -g } })

local edges = chain:structural()
if remedy == "bars" then scene:constraint("bars", { edges = edges })
elseif remedy == "correction" then scene:corrector("strain_limit", { edges = edges, limit = 0, compression = 0 })
else scene:force("springs", { edges = edges, k = (remedy == "implicit" and 1e5 or 1e3) * 4 ^ level }) end

local swing = links.pendulum { n = n, length = L / n, mass = mass, g = g, angle = angle, h = 2e-3 } -- to 3e-7 m
scene:exact(function(t)
  local list = { 0, 0, 0 }
  for _, place in ipairs(swing(t)) do
    list[#list + 1], list[#list + 2], list[#list + 3] = place[1], 0, place[2]
  end
  return table.unpack(list)
end)
scene:output("frames", { width = 960, height = 720, color = "speed", particles = "on" })
return scene
