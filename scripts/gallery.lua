-- What `hooke gallery` shows: scenes, each at a moment (s) that tells what it is about, and the film.
return {
  width = 480, height = 270, columns = 4, -- of a picture in the gallery, pixels
  { "flag", at = 1.3 },
  { "cloth", at = 0.45 },
  { "cloth_on_sphere", at = 1.0 },
  { "net", at = 1.0 },
  { "hair_on_shoulder", at = 1 },
  { "folds", at = 1.5 },
  { "twist", at = 2.0 },
  { "sand", at = 0.6 },
  { "fountain", at = 3 },
  { "smoke", at = 3 },
  { "galaxy", at = 16 },
  { "truss", at = 2 },
  { "drop", at = 0.006 },
  { "chocolate", at = 0.28 },
  { "skipping_stone", at = 0.3 },
  { "luxo", at = 0.9 },
  film = { "cloth_on_sphere", at = 2.4, width = 480, fps = 20 }, -- until the cloth hangs nearly still
}
