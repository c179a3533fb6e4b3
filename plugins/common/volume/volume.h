/* Gas in pictures: smoke absorbs and scatters light by the law of Beer and Lambert, hot gas glows as a black body does.
 * Rays are marched through the grid on the processor, over a finished picture, up to what is opaque in it. The bytes do
 * not depend on the number of threads. */
#ifndef HK_VOLUME_H
#define HK_VOLUME_H

#include "plugins/common/camera/view_setup.h"
#include "plugins/common/picture/patch.h"
#include "core/plugin.h"

/* A grid in a box of the scene, z up. The value of cell (i, j, k), from 0, is at (i + 1) stride[0] + (j + 1) stride[1]
 * + (k + 1) stride[2]: there is one layer more on each side. */
typedef struct hk_volume {
  double low[3], spacing[3]; /* m */
  size_t cells[3], stride[3], size;
  const double *smoke; /* size, kg/m^3 */
  const double *heat;  /* size, K above the ambient */
  double ambient;      /* K */
} hk_volume;

/* "volumes/1": what outputs may show of a run. */
#define HK_VOLUMES_INTERFACE "volumes/1"
enum { HK_VOLUMES = 8 };
typedef struct hk_volumes {
  void *self;
  /* Called in `create`. The volume stays the caller's and valid as long as the run; its numbers may change.
   * HK_BAD_PARAM: there are too many. */
  hk_status (*show)(void *self, const hk_volume *);
  size_t count;
  const hk_volume *member[HK_VOLUMES];
} hk_volumes;

typedef struct hk_volume_optics {
  double extinction; /* m^2/kg, of smoke; NAN: volumes are not drawn */
  double glow;       /* 1/m: light of gas of 2000 K, where 1 is white */
} hk_volume_optics;

typedef struct hk_volume_draw {
  const hk_host *host;
  const hk_volume *volume;
  const hk_volume_optics *optics;
  const hk_view_setup *setup;
  double origin[3]; /* of the setup's coordinates, m */
  double key[3];    /* unit vector towards the lamp */
  int width, height;
  hk_patch patch;        /* of the picture: where the volume is seen */
  const float *distance; /* patch: along the line of sight to what is opaque, m */
} hk_volume_draw;

/* The pixels that show the box. */
hk_patch hk_volume_patch(const hk_volume_draw *, const hk_lens *);
/* Draws over rgba, width x height pixels of 4 bytes with the bottom row first. HK_NO_MEMORY. */
hk_status hk_volume_draw_on(const hk_volume_draw *, unsigned char *rgba);

/* ---- for the files of this room ---- */

/* The value of an array at x, m, in the scene's coordinates; 0 outside. */
double hk_volume_value(const hk_volume *, const double *array, const double x[3]);
/* light: size, the part of the lamp's light that comes to each cell. */
void hk_volume_light(const hk_volume_draw *, double *light);

#endif
