-- What a force does in a periodic box where it claims HK_PERIODIC, and acts between any that are near: it is the same in
-- whichever of its images each particle is, and wherever the faces are.
local inspect = require("inspect")
local cases = require("common.check.force.cases")
local worst = require("common.check.force.worst")

local periodic = {}

local HK_PERIODIC = 65536
local SIZES, SPACING = { 6, 12 }, 0.8 -- m: of boxes that are tried, and between particles
local ROUNDING = 1e-9 -- of differences that are known to 1e-14 of a force that may go as their 13th power

-- In a box of that size; nil: the plugin takes none of them.
local function open(plugin, size)
  local shape = cases.cloud((size / SPACING) ^ 3 // 1 | 0, size)
  for _, case in ipairs(cases.list(plugin)) do
    if case.base then
      local run = cases.open(plugin, cases.variant(case, shape), { box = size })
      if run then return inspect.open(run, plugin.name) end
    end
  end
end

-- F with each coordinate changed by `change`.
local function force_at(subject, x, change)
  local moved = {}
  for k = 1, #x do moved[k] = change(x[k], k) end
  inspect.set(subject, { x = moved })
  return inspect.force(subject, 0)
end

local function takes_images(plugin, lines)
  local images, faces, subject, size = worst.new(), worst.new(), nil, nil
  for _, tried in ipairs(SIZES) do
    size, subject = tried, subject or open(plugin, tried)
    if subject then break end
  end
  if not subject then
    local words = ("it starts in no periodic box of up to %g m"):format(SIZES[#SIZES])
    if not plugin.scene then error(words, 0) end
    return lines:note(("periodic boxes: %s, where it is without what %s has"):format(words, plugin.scene))
  end
  local where = ("periodic box of %g m"):format(size)
  local x = inspect.state(subject).x
  local F = force_at(subject, x, function(at) return at end)
  local off, text = worst.difference(force_at(subject, x, function(at, k) return at + (7 * k % 5 - 2) * size end), F)
  images:take(off, text and ("%s, particles in other images: %s"):format(where, text) or where)
  off, text = worst.difference(force_at(subject, x, function(at) return (at + 0.37 * size) % size end), F)
  faces:take(off, text and ("%s, all moved by %g m: %s"):format(where, 0.37 * size, text) or where)
  lines:most("it is the same for every image of a particle, as claimed", images.figure, ROUNDING,
    "take each difference of positions through hk_nearest_image; or drop HK_PERIODIC", images.where)
  lines:most("it does not depend on where the faces of the box are, as claimed", faces.figure, ROUNDING,
    "ask for neighbours by reach_images, and act across the faces; or drop HK_PERIODIC", faces.where)
end

-- Forces on tuples of the script's act where these are, and those that keep no momentum may depend on the place.
function periodic.try(plugin, report)
  local listed = { edges = true, triangles = true, tetrahedra = true }
  for _, p in ipairs(plugin.params) do
    if listed[p.type] then return end
  end
  if plugin.momentum and plugin.flags & HK_PERIODIC ~= 0 then
    report:try("periodic boxes", function(l) takes_images(plugin, l) end)
  end
end

return periodic
