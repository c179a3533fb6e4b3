/* The pins and the timed parameters of a time, at the start of every evaluation. */
#include "core/dynamics/dynamics.h"

static hk_status set_timed(hk_dynamics *d, double t) {
  static const hk_kind kinds[] = {HK_FORCE, HK_CONSTRAINT};
  hk_status status = HK_OK;
  for (int j = 0; j < 2; j++)
    for (size_t k = 0; k < d->plugins->kind[kinds[j]].count && status == HK_OK; k++)
      status = hk_instance_set_time(d->plugins->kind[kinds[j]].item[k], t, d->error);
  d->timed_at = status == HK_OK ? t : NAN;
  return status;
}

hk_status hk_dynamics_set_time(hk_dynamics *d, double t) {
  hk_evaluations_note(&d->evaluations, t);
  hk_status status = hk_pins_find(d->pins, t, d->error);
  return status == HK_OK && d->has_timed && t != d->timed_at ? set_timed(d, t) : status;
}

hk_status hk_dynamics_impose(hk_dynamics *d, double t, double *x, double *v) {
  hk_status status = hk_dynamics_set_time(d, t);
  if (status == HK_OK) hk_pins_impose(d->pins, 0, d->state->model.n, x, v);
  return status;
}
