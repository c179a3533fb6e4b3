/* Motions of gravitating bodies whose ends are known. */
#ifndef HK_TEST_NBODY_SCENES_H
#define HK_TEST_NBODY_SCENES_H

#include "tests/support/engine.h"

typedef struct nbody_problem {
  const char *name;
  size_t count;
  double G, end; /* m^3/(kg s^2), s */
  const double *mass;
  const double (*x)[3], (*v)[3], (*answer)[3]; /* count; the places at the end, m */
} nbody_problem;

extern const nbody_problem nbody_pleiades, nbody_pythagorean, nbody_solar, nbody_kepler;

/* The problem in an empty scene, without frames on the way; `method`: name of an integrator. */
hk_plugin_spec *nbody_open(test_engine *, const nbody_problem *, const char *method);
/* m, RMS over the bodies at the end of a run with a step, s, or where that is 0 a tolerance. *evaluations may be NULL.
 */
double nbody_error(const nbody_problem *, const char *method, double dt, double tol, size_t *evaluations);
/* A Plummer sphere of radius and mass 1 in equilibrium, cut off at 10; G = 1. */
void nbody_add_sphere(test_engine *, size_t count, uint64_t seed);

#endif
