/* A function of time of the script in a run, such as the path of a pin: it gives three numbers, and their derivatives
 * or not. Derivatives that it does not give, and second ones, are found by differences. */
#include "core/numerics/functions/functions.h"

#include <string.h>

void hk_path_open(hk_path *path, const hk_function *function, const char *name, const char *where, double end) {
  double t = 0, out[HK_RESULTS];
  size_t got = 0;
  hk_error ignored = {0}; /* an error here is one of the first evaluation, too */
  *path = (hk_path){.function = function, .name = name, .where = where, .at = NAN};
  if (!function->call) return;
  function->call(function, NULL, &t, 1, out, HK_RESULTS, &got, &ignored);
  path->gives_velocity = got == HK_RESULTS;
  path->end = end;
  if (!path->gives_velocity) path->by[0] = hk_derivative_prepare(function, 1, 0, 0, end);
}

static hk_status call(const hk_path *path, double t, double out[HK_RESULTS], size_t *got, hk_error *error) {
  hk_status status = path->function->call(path->function, NULL, &t, 1, out, HK_RESULTS, got, error);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < *got; k++)
    if (!isfinite(out[k]))
      return hk_error_set(error, HK_SCRIPT, "%s: pin: the %s is not finite at t = %g s", path->where, path->name, t);
  if (*got == HK_COLUMNS || *got == HK_RESULTS) return HK_OK;
  return hk_error_set(error, HK_SCRIPT, "%s: pin: the %s gave %zu numbers at t = %g s, expected x, y, z [, vx, vy, vz]",
                      path->where, path->name, *got, t);
}

hk_status hk_path_find(hk_path *path, double t, hk_error *error) {
  hk_derivative velocity;
  size_t got = 0;
  if (t == path->at || !path->function->call) return HK_OK;
  path->at = NAN;
  hk_status status = call(path, t, path->value, &got, error);
  if (status == HK_OK && got == HK_COLUMNS) {
    status = hk_derivative_find(path->function, 1, 0, &path->by[0], t, path->value, &velocity, error);
    memcpy(path->value + HK_COLUMNS, velocity.value, sizeof velocity.value);
    path->speed_error = fmax(path->speed_error, velocity.error);
  }
  if (status == HK_OK) path->at = t;
  return status;
}

hk_status hk_path_acceleration(hk_path *path, double t, double out[HK_COLUMNS], hk_error *error) {
  int order = path->gives_velocity ? 1 : 2;
  size_t column = path->gives_velocity ? HK_COLUMNS : 0, got = 0;
  hk_derivative acceleration;
  double at[HK_RESULTS];
  memset(out, 0, HK_COLUMNS * sizeof *out);
  if (!path->function->call) return HK_OK;
  if (!(path->by[1].step > 0)) path->by[1] = hk_derivative_prepare(path->function, order, column, 0, path->end);
  hk_status status = call(path, t, at, &got, error);
  if (status != HK_OK) return status;
  status = hk_derivative_find(path->function, order, column, &path->by[1], t, at, &acceleration, error);
  memcpy(out, acceleration.value, sizeof acceleration.value);
  return status;
}
