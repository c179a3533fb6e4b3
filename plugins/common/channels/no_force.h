/* A force that changes channels alone: what it says of F, its energy and its blocks, which is nothing. */
#ifndef HK_CHANNELS_NO_FORCE_H
#define HK_CHANNELS_NO_FORCE_H

#include "core/plugin.h"

static inline hk_status hk_no_force(void *self, const hk_view *view, double *F) {
  (void)self, (void)view, (void)F;
  return HK_OK;
}

static inline double hk_no_energy(void *self, const hk_view *view) {
  (void)self, (void)view;
  return 0;
}

static inline void hk_no_pattern(void *self, const hk_view *view, hk_pattern *p) { (void)self, (void)view, (void)p; }

static inline hk_status hk_no_jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  (void)self, (void)view, (void)into;
  return HK_OK;
}

#define HK_NO_BLOCKS HK_IMPLICIT_FACET(.pattern = hk_no_pattern, .jacobian = hk_no_jacobian)

#endif
