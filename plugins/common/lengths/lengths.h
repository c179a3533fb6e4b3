/* The lengths of edges as equations, for constraints that hold a length (bars) or bound it (cables): g = L - |d| with
 * d = x_j - x_i, so that multipliers are positive in tension. With n = d/|d| and u = v_j - v_i: dg/dx_i = n = -dg/dx_j,
 * and d^2 g/dt^2 - J a = -(u.u - (n.u)^2)/|d|. Where the ends coincide there is no direction: J and the curvature are
 * 0.
 */
#ifndef HK_COMMON_LENGTHS_H
#define HK_COMMON_LENGTHS_H

#include "core/plugin.h"

typedef struct hk_lengths {
  hk_tuples edges;
  hk_per_tuple length; /* m */
} hk_lengths;

/* Sets lengths that the script does not give to those at the start. HK_BAD_PARAM: a length is 0, for the reason
 * `remedy`, which ends the message; HK_NO_MEMORY. */
hk_status hk_lengths_start(hk_lengths *, const hk_host *, const hk_view *, const char *remedy);

/* Functions of hk_constraint. The instance `self` is a hk_lengths. */
size_t hk_lengths_count(void *self);
void hk_lengths_pattern(void *self, hk_pattern *);
hk_status hk_lengths_value(void *self, const hk_view *, double *g);
hk_status hk_lengths_jacobian(void *self, const hk_view *, double (*J)[3]);
hk_status hk_lengths_curvature(void *self, const hk_view *, double *c);

#endif
