/* Facet of forces that look at every step: before a move, to find pairs that may act, and after it. */
#ifndef HK_PLUGIN_STEPS_H
#define HK_PLUGIN_STEPS_H

#include "core/plugin/force.h"

#define HK_STEPS_ID "steps/1"
#define HK_STEPS_FACET(...) HK_FACET(HK_STEPS_ID, hk_steps_facet, __VA_ARGS__)

typedef struct hk_steps_facet {
  size_t size;
  /* Finds the elements that may act between the positions of `from` and x_to (n x 3), on the straight line. Called at
   * the start of a run, after births, deaths, events and corrections (x_to is then the present positions), at the start
   * of every step (x_to is predicted with the present velocities) and before every line search of an implicit step,
   * never during evaluations. Explicit methods also evaluate forces off the line, by the effect of accelerations within
   * a step, so elements must be found with a margin. *pattern_changed, false on entry: whether the blocks
   * (facets/implicit.h) differ from those before. May be NULL. */
  hk_status (*update)(void *self, const hk_view *from, const double *x_to, bool *pattern_changed);
  /* Called after an accepted step of h s that ended at `view`: updates data that change once per step (lagged
   * friction). What dissipates energy then is of facets/internal.h. May be NULL. */
  hk_status (*accepted)(void *self, const hk_view *view, double h);
  /* What `accepted` keeps says on which branch of a function of the state the force is, as of an angle that is counted
   * on through whole turns, and nothing else: what an earlier or later step has left gives the same force as long as no
   * branch is left. Such a force is differentiated as if it kept nothing. */
  bool keeps_branch;
} hk_steps_facet;

#endif
