/* The largest frequency from above: the smaller one of what forces state and of what Lanczos iteration bounds. A force
 * that may become stiffer counts with its largest possible stiffness. */
#include "core/numerics/stability/operation.h"
#include "core/numerics/stability/stiffness.h"

hk_status hk_bound_stiffness(hk_spectrum_work *s, hk_system *system, bool use_stated) {
  if (!(system->queries->flags & HK_DEPENDS_ON_X)) return HK_OK;
  hk_spectrum *b = &s->bounds;
  hk_stiffness stated = hk_stiffness_of(system, hk_operation_blocks(s));
  bool covered = use_stated && stated.covered;
  hk_operation_measure(s, system, stated.length);
  s->stiffening_damping = stated.stiffening_damping;
  s->damps_alone = stated.damps_alone;
  b->w_switching = sqrt(stated.stiffening * HK_INFLATE);
  hk_operation o = {s, system, false, hk_operation_step(s), hk_operation_velocities(s, system)};
  hk_status status = hk_operation_bound(&o, &s->stiffness, covered ? stated.whole : INFINITY);
  if (status != HK_OK) return status;
  double noise = hk_operation_noise(&o);
  if (covered && s->stiffness.theta > stated.whole * (1 + 1e-6) + noise) /* a force is stiffer than it states */
    return hk_bound_stiffness(s, system, false);
  double most = s->stiffness.bound + stated.stiffening; /* of the present stiffness plus its possible increase */
  if (covered) most = fmin(most, stated.whole);
  b->covered = covered;
  b->beta = covered ? stated.beta : 0;
  b->w_undamped = covered ? sqrt(stated.undamped) : 0;
  if (s->stiffness.asymmetry > 1e-4 * s->stiffness.norm + noise) b->rigorous = false;
  b->w_max = most > noise ? sqrt(most * HK_INFLATE) : 0;
  b->w_reached = s->stiffness.theta > noise ? sqrt(s->stiffness.theta) : 0;
  return HK_OK;
}
