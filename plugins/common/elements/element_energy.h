/* Elements with an `evaluate` in an implicit step: their energy, forces and weights in a constant matrix. */
#ifndef HK_ELEMENT_ENERGY_H
#define HK_ELEMENT_ENERGY_H

#include "plugins/common/elements/element_tuples.h"

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_element_energy {
  hk_element_tuples tuples;
  double *C, (*dC)[3]; /* of all tuples, from the last hk_element_energy_evaluate */
  double (*start)[3];  /* dC at the start of the step: the direction of damping */
  double *steepness;   /* per tuple: the sum of |dC|^2 when its weight was last computed */
  bool *anchored;      /* per tuple: a translation of it changes C */
  bool damped;         /* at least one tuple has damping */
  size_t pairs;        /* number of pairs of members of the same tuple */
} hk_element_energy;

/* Collects the tuples and computes their steepness at x. `fresh`: the topology is new; it allocates only then. */
hk_status hk_element_energy_take(hk_element_energy *, const hk_host *, const hk_model *, const double *x, bool fresh);
/* Updates the steepness of tuples that have become steeper at the last evaluation; returns whether there are any. */
bool hk_element_energy_raise(hk_element_energy *);
/* The pairs of members of each tuple (tuples in order), which the matrix couples. */
void hk_element_energy_pairs(const hk_element_energy *, uint32_t (*pair)[2]);
/* The weights of the pairs for a step of h; what belongs to the diagonal is added to `diagonal` (n): see
 * element_energy.c. */
void hk_element_energy_weights(const hk_element_energy *, double h, double *weight, double *diagonal);
void hk_element_energy_start(hk_element_energy *, const hk_host *, const double *x); /* called when a step starts */
void hk_element_energy_evaluate(hk_element_energy *, const hk_host *, const double *x);
/* h^2 E + Q, the quadratic form of damping, of the last evaluation; d = x - x_start, n x 3. *slope += an estimate of
 * its change per metre of change of the coordinates, from which its rounding error follows. */
double hk_element_energy_value(const hk_element_energy *, const double *d, double h, double *slope);
/* F += forces of the last evaluation; *power += the power of damping, unless power is NULL. */
void hk_element_energy_forces(const hk_element_energy *, const double *d, double h, double *F, double *power);

#endif
