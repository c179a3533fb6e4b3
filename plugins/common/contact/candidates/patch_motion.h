/* The motion of patches of surfaces (surfaces.h), and pairs of patches that are near each other. Of a move from one
 * state to another each patch has the mean c of its particles' moves and the largest distance e of one of them from it;
 * two features of the patches a and b then come nearer by |c_a - c_b| + e_a + e_b at most, however far both have gone.
 */
#ifndef HK_PATCH_MOTION_H
#define HK_PATCH_MOTION_H

#include "plugins/common/space/bvh.h"
#include "plugins/common/contact/surfaces/surfaces.h"

typedef struct hk_patch_move {
  double mean[3], spread; /* m */
} hk_patch_move;

typedef struct hk_moving_patches {
  const hk_surface_patches *table;
  const double *radius; /* n, m */
  const hk_model *model;
  hk_box *box;  /* patches, m: of hk_moving_patches_box */
  bool *held;   /* patches: none of its particles can move */
  bool *wanted; /* patches: the next hk_moving_patches_box makes their boxes, and sets this to false */
  hk_bvh tree;
  size_t pairs, room;
  hk_patch_pair *pair; /* pairs: of hk_moving_patches_pair, rising by a and then by b */
} hk_moving_patches;

/* HK_NO_MEMORY. */
hk_status hk_moving_patches_open(hk_moving_patches *, const hk_host *, const hk_surfaces *, const hk_model *);
void hk_moving_patches_free(hk_moving_patches *, const hk_host *);

enum { HK_DISPLACEMENT_CHUNK = 4096 /* particles for a number of `chunk` */ };

/* m: the largest distance of a particle between two states, n x 3; INFINITY where one is not finite. Two particles come
 * nearer to each other by twice that at most. chunk: n/HK_DISPLACEMENT_CHUNK + 1 numbers of scratch memory. */
double hk_largest_displacement(const hk_host *, size_t n, const double *a, const double *b, double *chunk);

/* The moves from a to b, n x 3. */
void hk_moving_patches_measure(const hk_moving_patches *, const hk_host *, const double *a, const double *b,
                               hk_patch_move *out);
/* The boxes that the wanted patches sweep, with the radii of their particles. */
void hk_moving_patches_box(hk_moving_patches *, const hk_host *, const double *x_from, const double *x_to);
/* m: the mean of the longest sides of all boxes. */
double hk_moving_patches_size(const hk_moving_patches *);
/* All pairs of patches whose boxes are nearer than `distance`, m, but those of two that are held. HK_NO_MEMORY. */
hk_status hk_moving_patches_pair(hk_moving_patches *, const hk_host *, double distance);
/* m, between the boxes of two patches. */
double hk_moving_patches_distance(const hk_moving_patches *, uint32_t a, uint32_t b);

static inline double hk_patch_drift(const hk_patch_move *a, const hk_patch_move *b) {
  double x = a->mean[0] - b->mean[0], y = a->mean[1] - b->mean[1], z = a->mean[2] - b->mean[2];
  return sqrt(x * x + y * y + z * z);
}

static inline double hk_patch_approach(const hk_patch_move *a, const hk_patch_move *b) {
  return hk_patch_drift(a, b) + a->spread + b->spread;
}

/* m: hk_pair_motion (impact.h) of a pair of the two is no larger. It takes moves from the mean of the four, which is
 * farther from each of them than the patches' own means by up to e_a + e_b. */
static inline double hk_patch_motion(const hk_patch_move *a, const hk_patch_move *b) {
  return hk_patch_drift(a, b) + 2 * (a->spread + b->spread);
}

#endif
