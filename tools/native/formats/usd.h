/* OpenUSD in one text file (usda; UsdGeom's schemas Mesh, BasisCurves and Points), which Blender, Houdini, Maya and
 * usdview open. Triangles are a mesh, segments that are no edges of these linear curves, the other particles points;
 * each has positions, velocities and bounds as time samples, and its cells where they change. Positions are single
 * precision, relative to the middle of the first frame. Metres and seconds: `usdcat -o run.usdc run.usda` makes the
 * binary form. */
#ifndef HK_USD_H
#define HK_USD_H

#include "tools/native/formats/formats.h"

typedef enum hk_usd_attribute {
  HK_USD_POINTS,
  HK_USD_VELOCITIES,
  HK_USD_EXTENT,
  HK_USD_CELLS,   /* corners of the faces, points of the curves, ids of the points */
  HK_USD_CORNERS, /* of the mesh alone */
  HK_USD_ATTRIBUTES
} hk_usd_attribute;

typedef enum hk_usd_prim_kind { HK_USD_MESH, HK_USD_CURVES, HK_USD_PARTICLES, HK_USD_PRIMS } hk_usd_prim_kind;

typedef struct hk_usd_prim {
  uint32_t *point; /* indices of the particles that are its points, in their order */
  size_t points;
  uint32_t *length; /* how many points each curve has */
  size_t curves;
  bool begun;
  hk_whole_file samples[HK_USD_ATTRIBUTES]; /* beside the file until it is whole, since they come frame by frame */
} hk_usd_prim;

typedef struct hk_usd {
  hk_whole_file file;
  hk_usd_prim prim[HK_USD_PRIMS];
  double fps, origin[3], first, last; /* first, last: time codes, frames from t = 0 */
  double width;                       /* m, of curves and points: 1/200 of the first frame's size */
  size_t frames;
  bool z_up;
} hk_usd;

/* fps: of the recording, > 0; z_up: of the scene. False with a sentence in `why`. */
bool hk_usd_open(hk_usd *, const char *path, double fps, bool z_up, char *why, size_t size);
/* changed: the particles or cells are others than in the frame before. */
bool hk_usd_add(hk_usd *, const hk_frame_data *, bool changed, char *why, size_t size);
/* A zeroed one is allowed. Without `keep` there is no file then. */
bool hk_usd_close(hk_usd *, bool keep, char *why, size_t size);

#endif
