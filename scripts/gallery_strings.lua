-- The picture of strings, hair, rods and cloth in README.md: hooke gallery scripts/gallery_strings.lua
return {
  width = 426, height = 240, columns = 3,
  { "hair", at = 1.75, param = { strands = 300 } },
  { "cantilever", at = 4 },
  { "provot", at = 1.2 },
  { "michell", at = 23 },
  { "discretization", at = 0.55 },
  { "truss", at = 1 },
}
