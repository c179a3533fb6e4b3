/* The groups of the pairs in a list, by their patches, and the boxes of the patches: parts of nearby.c. */
#ifndef HK_NEAR_GROUPS_H
#define HK_NEAR_GROUPS_H

#include "plugins/common/impacts/nearby.h"

typedef struct hk_patch_box {
  double low[3], high[3]; /* m, swept by the moves of the search, with the radii of its particles */
} hk_patch_box;

/* Of the list's pairs, all of them due. */
void hk_near_groups_make(hk_nearby *);
/* Fills `index` with the pairs that are due when all patches have come nearer by `more` beside the groups' paths. */
void hk_near_groups_mark(hk_nearby *, double more);
void hk_near_boxes_make(hk_nearby *);
/* m: of how much all pairs of patches have left, after their `moves` since the search, of the skin, or of the distance
 * of their boxes less the reach. Below 0: a pair that is not listed may be within reach. */
double hk_near_boxes_slack(const hk_nearby *);

#endif
