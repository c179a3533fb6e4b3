/* The functions of a force's tables, of an instance whose first member is a membrane. */
#include "plugins/common/membranes/membrane.h"

hk_status hk_membrane_add(void *self, const hk_view *view, double *F) {
  hk_membrane_forces(self, view, HK_ALL_PARTS, F);
  return HK_OK;
}

void hk_membrane_add_part(void *self, const hk_view *view, size_t part, double *F) {
  hk_membrane_forces(self, view, part, F);
}

void hk_membrane_touch(void *self, const hk_view *view, const hk_part_use *use) {
  const hk_membrane *m = self;
  (void)view;
  hk_part_lists_touch(&m->sums.lists, &m->node, use);
}

double hk_membrane_potential(void *self, const hk_view *view) { return hk_membrane_sum_energy(self, view); }

void hk_membrane_name_blocks(void *self, const hk_view *view, hk_pattern *pattern) {
  (void)view;
  hk_membrane_pattern(self, pattern);
}

hk_status hk_membrane_add_blocks(void *self, const hk_view *view, const hk_blocks *into) {
  hk_membrane_blocks(self, view, into);
  return HK_OK;
}

void hk_membrane_add_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  hk_membrane_bound(self, view, part, block);
}
