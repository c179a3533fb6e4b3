/* The settings shared by all pictures of a motion. Lengths are in m, positions relative to the snapshots' origin. */
#ifndef HK_VIEW_SETUP_H
#define HK_VIEW_SETUP_H

#include "plugins/common/camera/camera.h"
#include "plugins/common/camera/water_optics.h"
#include "plugins/common/sprites/sprite.h"

#include <stdbool.h>

typedef struct hk_view_setup {
  hk_camera camera;
  double low[3], high[3]; /* box of the motion */
  double size;            /* half its diagonal, never 0 */
  double middle[3];       /* what is farther from here than fifty times the size is left out */
  bool floor, shadows;
  bool see_through;          /* obstacles that hide most of the motion are transparent */
  double obstacle_clearness; /* 0: obstacles are opaque, but for what see_through does; 1: they are not seen */
  double height;             /* height of the floor */
  double offset[2];          /* offset of the origin from the scene's, so that grid lines are at round coordinates */
  double point, tube, pin;   /* radii of particles, springs and pinned particles */
  double point_unit;         /* radius of a particle whose size (hk_snapshot3d.extra) is 1, m */
  double streak;             /* s */
  double thickness;          /* m, of surfaces of particles */
  float background[3];       /* 0..1, colour of its middle */
  hk_sprite_shading sprites; /* without the light */
  hk_water_optics water;
} hk_view_setup;

/* On a dark background, lines and text are light. */
static inline bool hk_is_dark(const float background[3]) {
  return 0.3f * background[0] + 0.6f * background[1] + 0.1f * background[2] < 0.35f;
}

#endif
