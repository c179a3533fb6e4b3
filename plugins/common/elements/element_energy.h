/* Elements with an `evaluate` in an implicit step: their energy, forces and weights in a constant matrix. */
#ifndef HK_ELEMENT_ENERGY_H
#define HK_ELEMENT_ENERGY_H

#include "plugins/common/elements/element_tuples.h"

/* Zeroed before the first use. The memory is the instance's and goes with it. */
typedef struct hk_element_energy {
  hk_element_tuples tuples;
  double *C, (*dC)[3]; /* of all tuples, of the last hk_element_energy_evaluate */
  double (*start)[3];  /* dC at the start of the step: the direction of damping */
  double *steepness;   /* per tuple: the sum of |dC|^2 where they were weighed */
  bool *anchored;      /* per tuple: moving it as a whole changes C */
  bool damped;         /* one of them has damping */
  size_t pairs;        /* of members of the same tuple */
} hk_element_energy;

/* Collects them and weighs them at x. `fresh`: the topology is new; it allocates then only. */
hk_status hk_element_energy_take(hk_element_energy *, const hk_host *, const hk_model *, const double *x, bool fresh);
/* Weighs those again that have become steeper at the last evaluation; whether there are any. */
bool hk_element_energy_raise(hk_element_energy *);
/* The pairs of members (tuples in order), which the matrix joins. */
void hk_element_energy_pairs(const hk_element_energy *, uint32_t (*pair)[2]);
/* Their weights for a step of h, and what comes to the diagonal (n, added to): see element_energy.c. */
void hk_element_energy_weights(const hk_element_energy *, double h, double *weight, double *diagonal);
void hk_element_energy_start(hk_element_energy *, const hk_host *, const double *x); /* of a step */
void hk_element_energy_evaluate(hk_element_energy *, const hk_host *, const double *x);
/* Of the last evaluation, d = x - x_start, n x 3: h^2 E + the damping's quadratic. *slope += about how much it changes
 * by when coordinates change by 1 m, which is what rounding of x tells by. */
double hk_element_energy_value(const hk_element_energy *, const double *d, double h, double *slope);
/* F += forces of the last evaluation; *power += the damping's, unless NULL. */
void hk_element_energy_forces(const hk_element_energy *, const double *d, double h, double *F, double *power);

#endif
