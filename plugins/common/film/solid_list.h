/* Solids as a script writes them: rows of numbers. */
#ifndef HK_SOLID_LIST_H
#define HK_SOLID_LIST_H

#include "plugins/common/snapshot/appearance.h"
#include "plugins/common/frame_data/solid.h"

typedef struct hk_solid_numbers {
  hk_numbers spheres; /* x, y, z, radius */
  hk_numbers boxes;   /* x, y, z of the middle, extents */
  hk_numbers planes;  /* x, y, z of a point, normal of any length */
} hk_solid_numbers;

/* Makes a list of them in the host's memory. HK_BAD_PARAM: a row that is not complete, or is no body. */
hk_status hk_solid_list_make(const hk_host *, const hk_solid_numbers *, bool y_up, hk_frame_solid **solid,
                             size_t *count);

#endif
