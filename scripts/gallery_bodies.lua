-- The picture of rigid bodies and surfaces of formulas in README.md: hooke gallery scripts/gallery_bodies.lua
return {
  width = 480, height = 270, columns = 4,
  { "t_handle", at = 3.2 },
  { "gyroscope", at = 6 },
  { "metaballs", at = 0.32 },
  { "cloth_on_heart", at = 0.7 },
}
