/* The motion of pinned particles: rotations against closed forms and against the defining property, that each is the
 * derivative of the one before, at small and large angles and with axes that turn. */
#include "core/numerics/functions/functions.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static const double center[3] = {0.3, -0.2, 1.1}, origin[3] = {1, 0.5, -0.4};

/* A rotation vector whose size and axis both change; `size` is its scale. */
static hk_status tumble(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                        size_t max_out, size_t *n_out, hk_error *error) {
  double size = *(const double *)f->context, t = in[0];
  (void)caller, (void)n_in, (void)max_out, (void)error;
  out[0] = size * sin(1.3 * t), out[1] = size * cos(0.7 * t), out[2] = size * (0.4 + 0.2 * t);
  out[3] = 1.3 * size * cos(1.3 * t), out[4] = -0.7 * size * sin(0.7 * t), out[5] = 0.2 * size;
  *n_out = 6;
  return HK_OK;
}

static hk_status slide(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                       size_t max_out, size_t *n_out, hk_error *error) {
  double t = in[0];
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  out[0] = t * t, out[1] = sin(t), out[2] = 0;
  out[3] = 2 * t, out[4] = cos(t), out[5] = 0;
  *n_out = 6;
  return HK_OK;
}

static void place(hk_scripted_motion *m, double t, double x[3], double v[3]) {
  hk_error error = {0};
  assert_int_equal(m->motion.find(&m->motion, t, &error), HK_OK);
  hk_pin_motion_place(&m->motion, origin, x, v);
}

static double apart(const double a[3], const double b[3]) {
  double square = 0;
  for (int c = 0; c < 3; c++) square += (a[c] - b[c]) * (a[c] - b[c]);
  return sqrt(square);
}

/* Central differences over h and 2h, of order 4: with h = 1e-3 s and a motion of about 1 rad/s off by 1e-12 of the
 * motion's size to the fourth power of its speed, and roundings of 1e-13. */
static void derivatives_are_those_of_the_positions(void **state) {
  (void)state;
  const double h = 1e-3, sizes[] = {0, 1e-9, 1e-4, 0.3, 0.9999 / sqrt(1.5), 1.2, 2.9, 40};
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
    for (double t = 0.2; t < 2; t += 0.3) {
      hk_function turn = {.call = tumble, .context = (void *)(uintptr_t)&sizes[k]}, path = {.call = slide};
      hk_scripted_motion m;
      hk_error error = {0};
      double x[5][3], v[5][3], a[3], slope[3], bend[3], scale = 1 + pow(sizes[k], 4);
      hk_motion_open(&m, &path, &turn, center, "here", 3);
      for (int j = 0; j < 5; j++) place(&m, t + (j - 2) * h, x[j], v[j]);
      assert_int_equal(m.motion.bend(&m.motion, t, &error), HK_OK);
      hk_pin_motion_acceleration(&m.motion, origin, a);
      for (int c = 0; c < 3; c++) {
        slope[c] = (8 * (x[3][c] - x[1][c]) - (x[4][c] - x[0][c])) / (12 * h);
        bend[c] = (8 * (v[3][c] - v[1][c]) - (v[4][c] - v[0][c])) / (12 * h);
      }
      assert_true(apart(slope, v[2]) < 3e-12 * scale);
      assert_true(apart(bend, a) < 3e-12 * scale * (1 + sizes[k]));
    }
}

/* A turn by 90 degrees about z takes the arm (0.7, 0.7, -1.5) to (-0.7, 0.7, -1.5). */
static void a_right_angle_is_one(void **state) {
  (void)state;
  const double quarter = 1.5707963267948966;
  hk_scripted_motion m;
  hk_function turn = {.call = tumble, .context = (void *)(uintptr_t)&quarter}, none = {0};
  double x[3], v[3];
  hk_motion_open(&m, &none, &turn, center, "here", 3);
  place(&m, 3, x, v);
  double R[9], *r = m.rotation.value;
  memcpy(R, m.motion.turn, sizeof R);
  for (int i = 0; i < 3; i++) { /* the axis stays, columns are orthonormal */
    double kept = R[3 * i] * r[0] + R[3 * i + 1] * r[1] + R[3 * i + 2] * r[2];
    assert_true(fabs(kept - r[i]) < 1e-14);
    for (int j = 0; j < 3; j++) {
      double product = R[i] * R[j] + R[3 + i] * R[3 + j] + R[6 + i] * R[6 + j];
      assert_true(fabs(product - (i == j)) < 1e-15 * 8);
    }
  }
  double angle = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]), trace = R[0] + R[4] + R[8];
  assert_true(fabs(trace - 1 - 2 * cos(angle)) < 1e-14);
}

static hk_status rise(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                      size_t max_out, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  out[0] = out[1] = 0, out[2] = in[0];
  *n_out = 3;
  return HK_OK;
}

/* Derivatives by differences: at t = pi/2 about z with 1 rad/s. */
static void rates_that_are_not_given_are_found(void **state) {
  (void)state;
  hk_scripted_motion m;
  hk_error error = {0};
  hk_function turn = {.call = rise}, none = {0};
  double x[3], v[3], a[3];
  hk_motion_open(&m, &none, &turn, center, "here", 3);
  place(&m, 1.5707963267948966, x, v);
  assert_int_equal(m.motion.bend(&m.motion, 1.5707963267948966, &error), HK_OK);
  hk_pin_motion_acceleration(&m.motion, origin, a);
  assert_true(apart(x, (const double[]){0.3 - 0.7, -0.2 + 0.7, -0.4}) < 1e-15 * 4);
  assert_true(apart(v, (const double[]){-0.7, -0.7, 0}) < 1e-9);
  assert_true(apart(a, (const double[]){0.7, -0.7, 0}) < 1e-5); /* second differences of roundings over (2^-10 s)^2 */
  assert_true(m.motion.speed_error < 1e-6); /* an estimate from above: roundings over 2^-17 s or so */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(derivatives_are_those_of_the_positions),
      cmocka_unit_test(a_right_angle_is_one),
      cmocka_unit_test(rates_that_are_not_given_are_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
