/* Methods that evaluate parts of the sum of forces, and the facet of those that take a fast subset of the forces in
 * shorter steps of their own. */
#ifndef HK_PLUGIN_SPLIT_H
#define HK_PLUGIN_SPLIT_H

#include "core/plugin/force.h"
#include "core/plugin/integrator.h"

/* Data of one force. */
typedef struct hk_force_info {
  const char *label;
  unsigned flags; /* hk_force.flags */
  bool jacobian, elements;
  bool gradient; /* whether the force is the gradient of its energy, with no other part */
} hk_force_info;

/* The fast subset of the forces that a method has selected. */
typedef struct hk_fast_subset {
  void *self;
  /* Takes the subset's accelerations at x and v (n x 3) out of a, m/s^2. */
  void (*remove)(const void *self, const hk_system *, const double *x, const double *v, double *a);
  /* Takes its share out of the blocks of bounds of the stiffness, as the forces' stiffness_bound states them. */
  void (*remove_bound)(const void *self, const hk_system *, hk_stiffness_part part, double (*block)[6]);
} hk_fast_subset;

/* hk_system.split: the forces in the scene's order, and which of them evaluations, energies and Jacobians include. All
 * are included when a step begins; a method that splits the sum sets `takes` before its calls. */
typedef struct hk_split_table {
  size_t forces;
  const hk_force_info *force;
  bool *takes;
  bool takes_channels; /* whether evaluations include the channels' own rates */
  /* Set by the method in `select_fast`, and valid as long as the method; NULL: no force is in a fast subset. */
  const hk_fast_subset *fast;
} hk_split_table;

#define HK_SPLIT_ID "split/1"

typedef struct hk_split_facet {
  size_t size;
  /* Selects the fast subset at s->X and sets s->split->fast. The host calls it before every estimate of the largest
   * stable step, which is then that of the rest. May allocate, and must do nothing where the subset is still right.
   * Required. */
  hk_status (*select_fast)(void *self, hk_system *s);
  /* As hk_integrator.growth in a step of h, of the rest's modes (1/s) with the fast subset beside them. Required. */
  double (*coupled_growth)(const void *self, double h, double w, double g, double b);
} hk_split_facet;

#endif
