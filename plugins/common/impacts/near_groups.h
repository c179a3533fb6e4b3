/* The groups of the pairs in a list, by their patches, and the boxes of the patches: parts of nearby.c. */
#ifndef HK_NEAR_GROUPS_H
#define HK_NEAR_GROUPS_H

#include "plugins/common/impacts/nearby.h"

typedef struct hk_patch_box {
  double low[3], high[3]; /* m, swept by the moves of the search, with the radii of its particles */
} hk_patch_box;

/* Of the list's pairs, all of them due. */
void hk_near_groups_make(hk_nearby *);
/* Fills `index` with the pairs that are due on the groups' paths. */
void hk_near_groups_mark(hk_nearby *);
void hk_near_boxes_make(hk_nearby *);
/* Whether all patches have, by `moves`, come nearer to each other by less than `skin`, or than their boxes were apart
 * less the reach. */
bool hk_near_boxes_apart(const hk_nearby *, double skin);

#endif
