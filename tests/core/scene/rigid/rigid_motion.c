/* Attitude, spin, momenta and energy of a body are read from its particles as they were given to them; by rounding. */
#include "core/scene/rigid/rigid.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void near(double found, double expected, double within) {
  if (!(fabs(found - expected) <= within)) fail_msg("%.17g, expected %.17g", found, expected);
}

static const double R[9] = {0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6}; /* a rotation */
static const double origin[3] = {1, 2, 3}, velocity[3] = {-1, 0.5, 2}, spin[3] = {3, -4, 5};

static void a_motion_is_read_as_it_was_given(void **state) {
  (void)state;
  for (int flat = 0; flat < 2; flat++) {
    hk_moments m = {.mass = 2, .center = {0.1, 0.2, 0.3}, .second = {3, 0, 0, 0, 2, 0, 0, 0, flat ? 0 : 1}};
    const double I[3] = {flat ? 2 : 3, flat ? 3 : 4, 5};
    hk_rigid_body b;
    double x[12], v[12], energy = 2 * (1 + 0.25 + 4) / 2;
    assert_null(hk_rigid_body_of(&m, &b));
    hk_rigid_body_place(&b, origin, R, velocity, spin, x, v);
    hk_rigid_motion found = hk_rigid_motion_of(&b, x, v);
    for (int p = 0; p < 9; p++) near(found.attitude[p], R[p], 1e-14);
    for (int c = 0; c < 3; c++) {
      double inside = R[c] * spin[0] + R[3 + c] * spin[1] + R[6 + c] * spin[2], L = 0;
      energy += I[c] * inside * inside / 2;
      for (int k = 0; k < 3; k++) L += R[3 * c + k] * I[k] * (R[k] * spin[0] + R[3 + k] * spin[1] + R[6 + k] * spin[2]);
      near(found.spin[c], spin[c], 1e-13);
      near(found.momentum[c], 2 * velocity[c], 1e-14);
      near(found.angular_momentum[c], L, 1e-13);
      near(found.center[c], origin[c] + R[3 * c] * 0.1 + R[3 * c + 1] * 0.2 + R[3 * c + 2] * 0.3, 1e-14);
    }
    near(found.energy, energy, 1e-12);
  }
}

/* A rod has no spin along itself, and its attitude is the shortest turn, also where it is turned over. */
static void a_rod_is_turned_the_shortest_way(void **state) {
  (void)state;
  hk_moments m = {.mass = 1, .second = {0, 0, 0, 0, 0, 0, 0, 0, 4}};
  hk_rigid_body b;
  double x[12], v[12], zero[3] = {0};
  const double over[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1}, quarter[9] = {1, 0, 0, 0, 0, -1, 0, 1, 0};
  assert_null(hk_rigid_body_of(&m, &b));
  hk_rigid_body_place(&b, zero, quarter, zero, (const double[3]){1, 2, 3}, x, v);
  hk_rigid_motion found = hk_rigid_motion_of(&b, x, v);
  for (int p = 0; p < 9; p++) near(found.attitude[p], quarter[p], 1e-14);
  near(found.spin[1], 0, 1e-14); /* the rod lies along y */
  near(found.spin[2], 3, 1e-14);
  hk_rigid_body_place(&b, zero, over, zero, zero, x, v);
  found = hk_rigid_motion_of(&b, x, v);
  near(found.attitude[8], -1, 1e-14);
  near(hk_rotation_error(found.attitude), 0, 1e-14);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_motion_is_read_as_it_was_given),
      cmocka_unit_test(a_rod_is_turned_the_shortest_way),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
