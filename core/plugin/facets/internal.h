/* Facet of forces with internal variables: elements that flow, lose their tension or break. The variables are fields of
 * the force (`per_tuple` of hk_field). They are constant during a step: `add`, `energy` and the Jacobian are functions
 * of the view and of them, and may foresee what `evolve` will do to them, as return mapping does. `energy` is then the
 * potential of the forces within a step, what is stored and what will have been dissipated, and after `evolve` it is
 * what is stored. A force whose variables have rates finds in view->t - view->model->t, s, how long ago they were
 * those; it depends on t then (Simo and Hughes 1998, Computational Inelasticity, 1.4 and 10.3). */
#ifndef HK_PLUGIN_INTERNAL_H
#define HK_PLUGIN_INTERNAL_H

#include "core/plugin/force.h"

#define HK_INTERNAL_ID "internal/1"
#define HK_INTERNAL_FACET(...) HK_FACET(HK_INTERNAL_ID, hk_internal_facet, __VA_ARGS__)

/* What `evolve` reports; all is 0 or false on entry. */
typedef struct hk_evolution {
  double dissipated;    /* J, finite: the elements lost it in the step; negative: they were given it */
  bool changed;         /* the force at this very state is another one than before the call, as when an element breaks:
                           the histories of methods are void. Not where `add` has foreseen it */
  bool pattern_changed; /* the blocks (facets/implicit.h) differ from those before */
} hk_evolution;

/* Edges or triangles, k of which is gone for ever where gone[k * stride] > 0. */
typedef struct hk_lost_elements {
  hk_tuples node;
  const double *gone;
  size_t stride;
} hk_lost_elements;

typedef struct hk_internal_facet {
  size_t size;
  /* Moves the internal variables to the end of an accepted step of h s, whose state is `view`, after all that corrects
   * it; a step that is taken back never comes here. Called once more with h = 0 for the same state it changes nothing
   * but by rounding: so it is where a force begins to act. Not called while the force does not act. The energy balance
   * counts what is dissipated: the energy of the scene falls by it, and no work was done. The force needs an `energy`.
   */
  hk_status (*evolve)(void *self, const hk_view *view, double h, hk_evolution *e);
  /* Asked after every step and at the start. What is gone leaves the scene's surface (hk_model.triangles and edges), of
   * which pictures, contact and recordings are made: the edge or triangle itself, triangles of which a side is
   * gone, and edges that only held such triangles together. NULL: nothing ever is gone. */
  void (*lost)(const void *self, hk_lost_elements *out);
} hk_internal_facet;

#endif
