/* Facet of forces that keep surfaces apart: moves that are safe, and what the verdict wants to know. */
#ifndef HK_PLUGIN_SURFACES_H
#define HK_PLUGIN_SURFACES_H

#include "core/plugin/contact.h"
#include "core/plugin/force.h"

#define HK_SURFACES_ID "surfaces/1"
#define HK_SURFACES_FACET(...) HK_FACET(HK_SURFACES_ID, hk_surfaces_facet, __VA_ARGS__)

typedef struct hk_surfaces_facet {
  size_t size;
  /* The safe fraction in (0, 1] of the displacement dx (n x 3) from `from` (continuous collision detection), called
   * after `update` (facets/steps.h) for the same displacement; NULL: it is 1. */
  double (*step_limit)(void *self, const hk_view *from, const double *dx);
  /* Called at frames. False: this run has none. NULL: as false. */
  bool (*contacts)(void *self, const hk_view *view, hk_contact_report *out);
} hk_surfaces_facet;

#endif
