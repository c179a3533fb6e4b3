/* Drag of particles towards moving air, F = d (u(x, t) - v), d = rate m or one number per particle. A force gives the
 * velocity u of its air, and where u depends on x its gradient; what is the same for all airs is here.
 *
 * All of F is counted as work: the power is F.v. Drag is linear, so airs that act together are summed: all but one of
 * them with relative = false, which leaves -d v to the one. */
#ifndef HK_FLOW_AIR_DRAG_H
#define HK_FLOW_AIR_DRAG_H

#include "core/plugin.h"
#include "plugins/kit/parts/particle_sums.h"

typedef struct hk_air_drag { /* parameters of the force */
  double d, rate;            /* N s/m, 1/s; one of them is NAN */
  bool relative;
} hk_air_drag;

/* clang-format off */
/* The rows of a parameter table for the member `drag` of `type`. */
#define HK_AIR_DRAG_PARAMS(type, drag)                                                                                 \
  {"d", "N s/m", "drag coefficient of a particle, F = d (u - v); u: velocity of the air",                              \
     .number = HK_AT(type, drag.d), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},                                   \
  {"rate", "1/s", "drag rate, F = rate m (u - v)", .number = HK_AT(type, drag.rate), .limits = HK_AT_LEAST(0),         \
     .flags = HK_OPTIONAL},                                                                                            \
  {"relative", "", "false: F = d u, for air whose drag another force of the same d has",                               \
     .boolean = HK_AT(type, drag.relative), .initial = {1}}
/* clang-format on */

typedef struct hk_air {
  const hk_air_drag *drag;
  const void *self; /* argument of the functions */
  /* u (count x 3, m/s) at the places x (count x 3, m). Called by several threads at once, for at most
   * HK_AIR_BLOCK places. */
  void (*velocity)(const void *self, double t, const double *x, size_t count, double *u);
  void (*gradient)(const void *self, double t, const double x[3], double G[9]); /* du_i/dx_j, 1/s; NULL: u is uniform */
} hk_air;

enum { HK_AIR_BLOCK = 64 };

hk_status hk_air_check(const hk_air_drag *, const hk_host *);              /* for `create` */
double hk_air_coefficient(const hk_air_drag *, const hk_view *, size_t i); /* N s/m */
/* u (count x 3) at any number of places, for pictures. */
void hk_air_flow(const hk_air *, double t, const double *x, size_t count, double *u);
/* One part, or HK_ALL_PARTS. */
void hk_air_add(const hk_air *, const hk_view *, size_t part, double *F);
void hk_air_pattern(const hk_view *, hk_pattern *);
hk_status hk_air_jacobian(const hk_air *, const hk_view *, const hk_blocks *into);

#endif
