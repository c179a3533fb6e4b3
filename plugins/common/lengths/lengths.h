/* The lengths of edges as equations, for constraints that hold a length (bars) or bound it (cables): g = s (|d| - L)
 * with d = x_j - x_i and s = 1 or -1. With n = d/|d| and u = v_j - v_i: dg/dx_j = s n = -dg/dx_i, and
 * d^2 g/dt^2 - J a = s (u.u - (n.u)^2)/|d|. Where the ends coincide there is no direction: J and the curvature are 0.
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

/* The functions of hk_constraint, for the sign s. */
void hk_lengths_pattern(const hk_lengths *, hk_pattern *);
void hk_lengths_value(const hk_lengths *, double s, const hk_view *, double *g);
void hk_lengths_jacobian(const hk_lengths *, double s, const hk_view *, double (*J)[3]);
void hk_lengths_curvature(const hk_lengths *, double s, const hk_view *, double *c);

#endif
