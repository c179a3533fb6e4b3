/* Forces: they add to F. What one may offer beside that (Jacobians, elements, contact) are its facets. */
#ifndef HK_PLUGIN_FORCE_H
#define HK_PLUGIN_FORCE_H

#include "core/plugin/model.h"
#include "core/plugin/parts.h"

enum { /* hk_force.flags; facets/implicit.h and facets/bounds.h have more */
       HK_DEPENDS_ON_X = 1,
       HK_DEPENDS_ON_V = 2,
       HK_DEPENDS_ON_T = 4,
       HK_DEPENDS_ON_CHANNELS = 8,
       HK_CONSERVES_MOMENTUM = 16,
       HK_CONSERVES_ANGULAR_MOMENTUM = 32,
       HK_POWER = 128 /* the part of F that is not the gradient of `energy` adds its power to *view->power; a force
                         without this flag is the gradient of its energy, or, without energy, the host counts all of
                         F.v as its power (also where a parameter is a function of time) */
};

/* `add` or `add_part` is required. */
typedef struct hk_force {
  size_t size;
  unsigned flags;
  /* F[3*i..] += force on particle i, N, for active particles only (a tuple acts when all its members are active).
   * NULL: the host adds all parts, those without a common particle at the same time, in an order that depends on the
   * partition alone. */
  hk_status (*add)(void *self, const hk_view *view, double *F);
  /* For a force that is a sum over elements or particles: adds to F what belongs to one part (core/plugin/parts.h) of
   * view->model->partition, and its power to *view->power. The parts in any order are the force, up to rounding. It may
   * be called by several threads at once, for parts without a common particle; it reads of x and v the particles of its
   * part alone, since others may not have been computed yet, and calls no function of the host. A force on each
   * particle alone has in part b < blocks the particles of block b and no others; elements are named in
   * facets/parts.h. The host calls it where it can, and adds a force with `rates` or published fields as a whole. NULL:
   * the host calls `add`, once for all particles, before the forces with parts. */
  void (*add_part)(void *self, const hk_view *view, size_t part, double *F);
  double (*energy)(void *self, const hk_view *view);               /* J; NULL: no energy */
  hk_status (*rates)(void *self, const hk_view *view, double *dy); /* dy += rates of the channels; may be NULL */
  const hk_facet *facets;                                          /* core/plugin/facets; NULL: none */
} hk_force;

#endif
