/* One step of a particle with an obstacle: friction takes mu times what the acceleration presses, however far below the
 * surface the method would end. A step in n parts of order 1, as xpbd makes it, ends at a h^2/2 (1 + 1/n). */
#include "plugins/common/obstacles/obstacle.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const double g = 9.81, mu = 0.35, h = 0.02;

static void stand(hk_obstacle *o) {
  hk_pose history[HK_POSES], now = {0}, end = {.t = h};
  *o = (hk_obstacle){.shape = {.kind = HK_SHAPE_PLANE, .normal = {0, 0, 1}}, .friction = mu};
  hk_motion_begin(history, &now);
  hk_motion_advance(history, 0, &end);
  hk_motion_of(&o->motion, history);
}

/* Slides at 2 m/s along x on the plane z = 0, pulled along x by `pull` m/s^2; its fall is `sink` of g h^2/2. */
static void slide(double sink, double pull, double x[3], double v[3]) {
  hk_obstacle floor_;
  stand(&floor_);
  hk_obstacle_set set = {.count = 1, .member = {&floor_}};
  const double from[3] = {0}, speed[3] = {2, 0, 0};
  x[0] = h * (2 + h / 2 * pull * sink), x[1] = 0, x[2] = -g * h * h / 2 * sink;
  v[0] = 2 + h * pull, v[1] = 0, v[2] = -g * h;
  hk_obstacle_step step = {.i = 0, .h = h, .mass = 1, .x_from = from, .v_from = speed, .x = x, .v = v};
  hk_obstacles_meet(&set, &step);
  assert_true(step.changed && !step.endless);
}

static void friction_is_mu_in_steps_of_any_number_of_parts(void **state) {
  (void)state;
  const double parts[] = {1, 2, 4, 6, 10, 40, 1000, 1e9, -1000, -40, -10};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
    for (int pulled = 0; pulled < 2; pulled++) {
      double x[3], v[3], pull = pulled ? 1.5 : 0;
      slide(1 + 1 / parts[k], pull, x, v);
      double speed = 2 + h * (pull - mu * g);
      if (!(fabs(v[0] - speed) < 1e-12)) fail_msg("%g parts: %.15g m/s, not %.15g", parts[k], v[0], speed);
      assert_true(fabs(x[2]) < 1e-15 && fabs(v[2]) < 1e-15);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(friction_is_mu_in_steps_of_any_number_of_parts)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
