/* The border of a snapshot's surfaces: sides that one triangle of cloth has alone. */
#ifndef HK_BORDER_H
#define HK_BORDER_H

#include "plugins/common/snapshot/snapshot3d.h"

typedef struct hk_border { /* a zeroed one is empty */
  size_t count, room;
  uint64_t *side;    /* count: a side's two particles, the larger one above 32 bits */
  uint64_t topology; /* of the snapshot, as in hk_snapshot3d */
} hk_border;

/* Finds the border anew if the snapshot's topology is another one than last time. HK_NO_MEMORY. */
hk_status hk_border_follow(hk_border *, const hk_host *, const hk_snapshot3d *);
void hk_border_free(hk_border *, const hk_host *);

static inline void hk_border_ends(const hk_border *b, size_t k, uint32_t end[2]) {
  end[0] = (uint32_t)(b->side[k] >> 32), end[1] = (uint32_t)b->side[k];
}

#endif
