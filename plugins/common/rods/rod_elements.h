/* Rods for the methods that work element by element. */
#ifndef HK_ROD_ELEMENTS_H
#define HK_ROD_ELEMENTS_H

#include "core/plugin.h"
#include "plugins/common/rods/rod_path.h"

typedef struct hk_rod_elements {
  size_t count;
  uint32_t *node;    /* count x 3 */
  double *stiffness; /* J */
} hk_rod_elements;

/* Into arrays with room for all joints. */
void hk_rod_elements_fill(hk_rod_elements *, const hk_rod_rows *, const hk_rod_batch *, size_t batches);
/* As hk_force.elements: none where some rod has frames. */
void hk_rod_elements_offer(const hk_rod_elements *, const hk_rod_batch *, size_t batches, hk_elements *out);

#endif
