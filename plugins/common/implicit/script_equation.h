/* An equation g(t, x) = 0 of one particle that a function of the script states, with its derivatives: the gradient that
 * the script states as well, or differences. */
#ifndef HK_COMMON_SCRIPT_EQUATION_H
#define HK_COMMON_SCRIPT_EQUATION_H

#include "core/plugin.h"

typedef struct hk_script_equation {
  const hk_host *host;
  const hk_function *g;        /* function(t, x, y, z, id) -> g */
  const hk_function *gradient; /* function(t, x, y, z, id) -> gx, gy, gz; NULL: differences */
  double length;               /* m, over which g changes */
} hk_script_equation;

typedef struct hk_event { /* of a particle */
  double t, x[3], id;
} hk_event;

/* Each returns what a call of the script failed with. */
hk_status hk_script_value(const hk_script_equation *, const hk_event *, double *g);
hk_status hk_script_gradient(const hk_script_equation *, const hk_event *, double n[3]);
hk_status hk_script_differences(const hk_script_equation *, const hk_event *, double n[3]); /* whatever is stated */
hk_status hk_script_speed(const hk_script_equation *, const hk_event *, double *gt);        /* dg/dt at fixed x */
/* d^2 g/dt^2 without accelerations, (d/dt + v.d/dx)^2 g; `size`: the magnitude of the terms of g. */
hk_status hk_script_curvature(const hk_script_equation *, const hk_event *, const double v[3], double size, double *c);

#endif
