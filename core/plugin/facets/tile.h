/* An evaluation fused with what a method does before and after it, while the particles' data are in the cache, and the
 * facet of a method that takes several steps at once: a tile. */
#ifndef HK_PLUGIN_TILE_H
#define HK_PLUGIN_TILE_H

#include "core/plugin/integrator.h"

/* For hk_system.fused: block by block in one traversal of the particles where the forces offer parts
 * (core/plugin/parts.h), else in separate traversals on all threads. y is complete when it is called. If it fails, a is
 * void, and for some particles `before` or `after` may not have been called. Both get the particles begin to end - 1,
 * from several threads at once. They must not read or write the x and v of others. */
typedef struct hk_fused {
  void *context;
  void (*before)(void *context, size_t begin, size_t end); /* writes x and v; may read a; NULL: they are there */
  void (*after)(void *context, size_t begin, size_t end);  /* a is complete, and no force reads x and v any more */
} hk_fused;

enum { HK_TILE_STEPS = 32 }; /* at most */

/* A step in a tile: a fused evaluation. */
typedef struct hk_tile_step {
  double t;
  double *x, *v, *a; /* n x 3 */
  hk_fused fused;
  double power; /* W, of pins and forces whose work is counted: the rate of the last entry of X; set by the host */
} hk_tile_step;

#define HK_TILE_ID "tile/1"

typedef struct hk_tile_facet {
  size_t size;
  /* For methods of fixed steps with one evaluation each and HK_USES_SPARE: takes *count steps of h at once by
   * hk_system.tile, as `step` would one after another; or sets *count to 0 where it cannot at present. t[k]: s, the end
   * of step k. The first step goes from s->X, which must not be changed, to s->spare, the others work there in place;
   * the host makes it X. hk_system.tile makes the evaluations of `count` steps as if they were fused ones made one
   * after another: block by block step k begins what step k - 1 has completed; if it fails, all are void, and `reset`
   * is called. The host calls it where nobody needs the states between the steps; there are then neither channels nor
   * constraints. Required. */
  hk_status (*steps)(void *self, const void *method, hk_system *s, const double *t, double h, size_t *count);
} hk_tile_facet;

#endif
