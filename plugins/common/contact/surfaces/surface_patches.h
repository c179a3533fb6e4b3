/* Patches of surfaces (surfaces.h), made of items, and the candidate pairs of features of two patches, found by
 * comparing their boxes: for few pairs of patches that is faster than a search of all surfaces. */
#ifndef HK_SURFACE_PATCHES_H
#define HK_SURFACE_PATCHES_H

#include "plugins/common/contact/candidates/feature_pairs.h"

enum {
  HK_PATCH_ITEMS = 25, /* as 5 x 5 of a grid; 16 and 49 cost more where cloth slides over a ball */
  HK_PATCH_MOST = 2 * HK_PATCH_ITEMS
};

typedef struct hk_surface_patch_set {
  hk_surface_patches table;
  size_t *first;  /* patches + 1, in `item` */
  uint32_t *item; /* those of a patch, rising; HK_PATCH_MOST at most */
  hk_box *whole;  /* patches, m, of the last move, with the radii of surfaces */
  bool *used;     /* patches: `whole` and the boxes of its items are those of the present move */
  uint32_t *list; /* of the used ones */
} hk_surface_patch_set;

/* HK_NO_MEMORY: there are none. */
hk_status hk_surface_patches_open(hk_surface_patch_set *, const hk_host *, const hk_broad_phase *);
void hk_surface_patches_free(hk_surface_patch_set *, const hk_host *);

/* Row k of `near`, whose records are hk_feature_pair: the pairs of features of pair k of patches. Not joined. As
 * hk_broad_phase_run. */
hk_status hk_patch_pairs_find(hk_broad_phase *, hk_surface_patch_set *, const hk_host *, const hk_surface_move *,
                              const hk_patch_pair *, size_t count, hk_gather *near);

#endif
