-- Runs another scene with frames of a given number of steps, so that common/stability/largest_step.lua can choose the
-- step and the times of the recorded states. (Runs with full rights, as it runs the scene's own script.)
local path = param("limits_scene", "", "the scene's script")
local step = param("limits_step", 1, "length of a step, s")
local stride = param("limits_stride", 1, "steps in a frame")
local frames = param("limits_frames", 1, "how many")

local make = hooke.scene
rawset(hooke, "scene", function(settings)
  settings.fps, settings.duration, settings.dt = 1 / (stride * step), frames * stride * step, step
  settings.integrator, settings.accuracy = nil, nil
  return make(settings)
end)
local scene = dofile(path)
rawset(hooke, "scene", make)
return scene
