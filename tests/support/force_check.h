/* Checks that every force has to stand: against its energy and against differences of itself. Each returns the largest
 * deviation, relative to the largest entry, at the best of several steps of central differences: too long a step shows
 * curvature, too short a one rounding. */
#ifndef HK_TEST_FORCE_CHECK_H
#define HK_TEST_FORCE_CHECK_H

#include "tests/support/engine.h"

/* What one force sees of a run: its own host and the particles it acts on. Valid until the run changes. */
hk_view force_view(test_engine *, const hk_instance *force);
/* F (n x 3) is set to the force; returns its power. Fails the test when the force does. */
double force_evaluate(const hk_instance *force, const hk_view *view, double *F);

/* The best step of central differences is near eps^(1/3) = 6e-6 and leaves eps^(2/3) = 4e-11 times derivatives of
 * higher order over the first, which are up to some tens for the states of the tests. */
#define FORCE_DIFFERENCES 2e-9

double force_gradient_error(const hk_instance *force, const hk_view *view);  /* F + dE/dx */
double force_stiffness_error(const hk_instance *force, const hk_view *view); /* K + dF/dx */
double force_damping_error(const hk_instance *force, const hk_view *view);   /* D + dF/dv */
/* K and D as full matrices, 3n x 3n each; returns the number of blocks that the force named. */
size_t force_matrices(const hk_instance *force, const hk_view *view, double *K, double *D);

#endif
