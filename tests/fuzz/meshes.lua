-- Damaged OBJ files; see tests/support/fuzz/run.lua.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
local run = require("fuzz.run")
local bytes = require("fuzz.bytes")

local meshes = {
  "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
  "# a square\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl x\nf 1/1/1 2/1/1 3/1/1 4/1/1\n",
  "v 0 0 0\r\nv 1 0 0\r\nv 1 1 1e-3\r\nf -1 -2 -3\r\nf -3 -2 -1\r\n",
  "v 0 0 0\nv 2 0 0\nv 0.5 0.5 0\nv 0 2 0\nf -4/1 -3//2 \\\n -2/1/2 \\\n-1\nf 4 3 2 1\n",
  "v 0 0 0 1 0.5 0.5 0.5\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nf 1//1 2//1 5//1\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 4 3 2 1\n",
}

local scene = [[
local s = hooke.scene { duration = 0.02, fps = 50, integrator = "leapfrog" }
local h = s:mesh { file = "mesh.obj", mass = 0.3, scale = 2 }
s:force("gravity", {})
if #h:edges() > 0 then s:force("springs", { edges = h:edges(), k = 10 }) end
if #h:flexion() > 0 then s:force("springs", { edges = h:flexion(), k = 1, label = "bending" }) end
if #h:triangles() > 0 then s:force("wind", {}) end
if #h:flexion() > 0 then s:force("springs", s:membrane(h, { stiffness = 10, damping = 0.1 })) end
if #h:flexion() > 0 then s:force("hinges", { rigidity = 1e-3 }) end
return s
]]

run.fuzz {
  name = "meshes",
  cases = 40,
  make = function()
    return { files = { ["mesh.obj"] = bytes.text(meshes[math.random(#meshes)]), ["scene.lua"] = scene }, words = "run scene.lua" }
  end,
}
