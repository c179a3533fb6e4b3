/* Patches: some ten features of one surface that are near each other, and so move much alike. Of a move from one state
 * to another each patch has the mean c of its particles' moves and the largest distance e of one of them from it; two
 * features of the patches a and b then come nearer by |c_a - c_b| + e_a + e_b at most, however far both have gone. */
#ifndef HK_PATCHES_H
#define HK_PATCHES_H

#include "plugins/common/surfaces/surfaces.h"

typedef struct hk_patch_move {
  double mean[3], spread; /* m */
} hk_patch_move;

typedef struct hk_patches {
  size_t count;
  uint32_t *home;   /* n: the patch of a particle; a feature belongs to that of its particle of the lowest index */
  size_t *start;    /* count + 1, in `member` */
  uint32_t *member; /* the particles of all features of a patch */
} hk_patches;

/* Patches of the mesh at the positions of the view. HK_NO_MEMORY: there are none. */
hk_status hk_patches_open(hk_patches *, const hk_host *, const hk_surface_mesh *, const hk_view *);
void hk_patches_free(hk_patches *, const hk_host *);

/* The moves from a to b, n x 3. */
void hk_patches_measure(const hk_patches *, const hk_host *, const double *a, const double *b, hk_patch_move *out);

static inline double hk_patch_approach(const hk_patch_move *a, const hk_patch_move *b) {
  double x = a->mean[0] - b->mean[0], y = a->mean[1] - b->mean[1], z = a->mean[2] - b->mean[2];
  return sqrt(x * x + y * y + z * z) + a->spread + b->spread;
}

static inline uint32_t hk_patch_of(const hk_patches *p, const uint32_t *vertex, int count) {
  uint32_t least = vertex[0];
  for (int i = 1; i < count; i++) least = vertex[i] < least ? vertex[i] : least;
  return p->home[least];
}

#endif
