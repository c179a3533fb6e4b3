/* Whether the velocities that paths and rotations of pins give are the derivatives of their positions. A velocity that
 * is not moves dampers and counts as work beside what the positions do, and no shorter step shows it: both runs that
 * are compared have it. It is compared with differences at random times, of which nearly none are at corners. */
#include "core/numerics/functions/functions.h"
#include "core/run/judge/judge.h"

enum { TIMES = 32 };
static const double tolerance = 1e-3, /* of the largest speed: slips such as a forgotten factor are larger */
    trusted = 100;                    /* estimates of the differences' error */

typedef struct comparison {
  double t, apart, given, found; /* s, m/s: where they are furthest apart beyond the differences' error, and both */
  double fastest;                /* m/s */
} comparison;

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

static void compare_at(const hk_function *path, const hk_differences *by, double t, comparison *worst) {
  double at[HK_RESULTS], apart[3];
  size_t got = 0;
  hk_error ignored = {0};
  hk_derivative found;
  if (path->call(path, NULL, &t, 1, at, HK_RESULTS, &got, &ignored) != HK_OK || got < HK_RESULTS) return;
  if (hk_derivative_find(path, 1, 0, by, t, at, &found, &ignored) != HK_OK) return;
  for (int c = 0; c < 3; c++) apart[c] = at[3 + c] - found.value[c];
  worst->fastest = fmax(worst->fastest, fmax(length(at + 3), length(found.value)));
  double beyond = length(apart) - trusted * found.error;
  if (beyond > worst->apart) *worst = (comparison){t, beyond, length(at + 3), length(found.value), worst->fastest};
}

static void check_path(hk_loop *loop, const hk_path *path, const char *unit, double end) {
  comparison worst = {.apart = 0};
  hk_differences by = hk_derivative_prepare(path->function, 1, 0, loop->state->t, end);
  uint64_t random[4];
  hk_random_seed(random, 1);
  for (int k = 0; k < TIMES; k++)
    compare_at(path->function, &by, loop->state->t + (end - loop->state->t) * (k + hk_random_uniform(random)) / TIMES,
               &worst);
  if (worst.apart > tolerance * worst.fastest)
    hk_warn(loop->warnings,
            "%s: pin: the velocity that the %s gives is not the derivative of its positions: at t = %.6g s its length "
            "is %.6g %s and should be %.6g %s, or its direction is another; return x, y, z alone, and the velocity is "
            "found by differences",
            path->where, path->name, worst.t, worst.given, unit, worst.found, unit);
}

void hk_check_given_speeds(hk_loop *loop, double end) {
  for (size_t k = 0; k < loop->pins->count; k++) {
    const hk_scripted_motion *motion = hk_scripted_motion_of(loop->pins->item[k].motion);
    if (!motion) continue;
    double last = fmin(end, loop->pins->item[k].spec->release);
    if (last > loop->state->t && motion->offset.gives_velocity) check_path(loop, &motion->offset, "m/s", last);
    if (last > loop->state->t && motion->rotation.gives_velocity) check_path(loop, &motion->rotation, "rad/s", last);
  }
}
