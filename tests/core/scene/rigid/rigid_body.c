/* The particles of a body have its mass, centre and second moments, for thick, flat and thin ones at any attitude; its
 * points are their combinations; and how it moves is read from them. Tolerances are rounding of some dozen operations.
 */
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

static hk_moments turned(double x, double y, double z) {
  hk_moments m = {0}, straight = {.mass = 2, .center = {0.1, -0.2, 0.3}, .second = {x, 0, 0, 0, y, 0, 0, 0, z}};
  hk_moments_add(&m, &straight, (const double[3]){1, 2, 3}, R);
  return m;
}

static void particles_have_the_moments_of_the_body(void **state) {
  (void)state;
  const double second[6][3] = {{3, 2, 1}, {1, 2, 3}, {1, 1, 1}, {3, 2, 0}, {0, 5, 0}, {2, 2, 1e-20}};
  const size_t count[6] = {4, 4, 4, 3, 2, 3};
  for (int k = 0; k < 6; k++) {
    hk_moments m = turned(second[k][0], second[k][1], second[k][2]);
    hk_rigid_body b;
    double x[12], v[12], mass[4], zero[3] = {0}, one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    assert_null(hk_rigid_body_of(&m, &b));
    assert_int_equal(b.count, count[k]);
    hk_rigid_body_place(&b, zero, one, zero, zero, x, v);
    for (size_t i = 0; i < b.count; i++) mass[i] = b.mass / (double)b.count;
    hk_moments found = hk_moments_of_points(b.count, x, mass);
    for (int c = 0; c < 3; c++) near(found.center[c], m.center[c], 1e-14);
    for (int p = 0; p < 9; p++) near(found.second[p], m.second[p], 3e-14);
  }
}

static void bodies_without_mass_or_extent_are_refused(void **state) {
  (void)state;
  hk_rigid_body b;
  assert_non_null(hk_rigid_body_of(&(hk_moments){.mass = 0, .second = {1, 0, 0, 0, 1, 0, 0, 0, 1}}, &b));
  assert_non_null(hk_rigid_body_of(&(hk_moments){.mass = 1}, &b));
  assert_non_null(hk_rigid_body_of(&(hk_moments){.mass = 1, .second = {NAN}}, &b));
}

/* A point goes with the body; off the plane of a flat one it has a distance and no weights. */
static void points_are_combinations_of_the_particles(void **state) {
  (void)state;
  hk_moments m = turned(3, 2, 1);
  hk_rigid_body b;
  double x[12], v[12], w[4], y[3] = {2, -1, 0.5}, at[3] = {0}, zero[3] = {0};
  assert_null(hk_rigid_body_of(&m, &b));
  hk_rigid_body_place(&b, (const double[3]){5, 6, 7}, R, zero, zero, x, v);
  near(hk_rigid_body_weights(&b, y, w), 0, 1e-15);
  near(w[0] + w[1] + w[2] + w[3], 1, 1e-15);
  for (size_t i = 0; i < 12; i++) at[i % 3] += w[i / 3] * x[i];
  for (int c = 0; c < 3; c++) near(at[c], 5 + c + R[3 * c] * y[0] + R[3 * c + 1] * y[1] + R[3 * c + 2] * y[2], 2e-14);
  m = (hk_moments){.mass = 1, .second = {3, 0, 0, 0, 2, 0, 0, 0, 0}};
  assert_null(hk_rigid_body_of(&m, &b));
  near(hk_rigid_body_weights(&b, (const double[3]){1, 1, 0}, w), 0, 1e-15);
  near(hk_rigid_body_weights(&b, (const double[3]){1, 1, 0.25}, w), 0.25, 1e-15);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(particles_have_the_moments_of_the_body),
      cmocka_unit_test(bodies_without_mass_or_extent_are_refused),
      cmocka_unit_test(points_are_combinations_of_the_particles),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
