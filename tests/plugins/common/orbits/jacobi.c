/* Jacobi's coordinates: by their definition, there and back, and what they keep of the kinetic energy. */
#include "plugins/common/orbits/jacobi.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { N = 5, BODIES = 4 };
static const double mass[N] = {0.3, 7, 1e-30, 0.02, 1.5};
static uint32_t order[BODIES] = {1, 4, 0, 3};
static double upto[BODIES], part[BODIES];
static const double x[3 * N] = {1, 2, 3, -4, 5, 6, 7, 8, 9, 0.1, -11, 12, 13, 14, -15};

static hk_jacobi bodies(void) {
  hk_jacobi j = {.count = BODIES, .order = order, .upto = upto, .part = part};
  hk_jacobi_weigh(&j, mass);
  return j;
}

static void places_are_from_the_centre_of_those_before(void **state) {
  (void)state;
  hk_jacobi j = bodies();
  double to[3 * BODIES];
  hk_jacobi_from(&j, x, to);
  for (size_t k = 1; k <= BODIES; k++)
    for (size_t c = 0; c < 3; c++) {
      double centre = 0, sum = 0;
      for (size_t i = 0; i < k; i++) centre += mass[order[i]] * x[3 * order[i] + c], sum += mass[order[i]];
      double right = k < BODIES ? x[3 * order[k] + c] - centre / sum : centre / sum;
      assert_true(fabs(to[3 * (k % BODIES) + c] - right) < 1e-14 * 20);
      assert_true(fabs(upto[k - 1] / sum - 1) < 1e-15);
    }
}

static void there_and_back_is_where_it_was(void **state) {
  (void)state;
  hk_jacobi j = bodies();
  double to[3 * BODIES], back[3 * N];
  memset(back, 0, sizeof back);
  hk_jacobi_from(&j, x, to);
  hk_jacobi_to(&j, to, back);
  for (size_t e = 0; e < 3 * N; e++)
    if (e / 3 == 2)
      assert_true(back[e] == 0); /* none of the bodies */
    else
      assert_true(fabs(back[e] - x[e]) < 1e-14 * 20);
}

/* Rein and Tamayo 2015, equation 9: a sum of squares with the masses m_k M_(k-1)/M_k. */
static void kinetic_energy_is_a_sum_of_squares(void **state) {
  (void)state;
  hk_jacobi j = bodies();
  double u[3 * BODIES], sum = 0, right = 0;
  hk_jacobi_from(&j, x, u);
  for (size_t e = 0; e < 3 * BODIES; e++) {
    size_t k = e / 3;
    sum += (k == 0 ? upto[BODIES - 1] : part[k] * upto[k - 1]) * u[e] * u[e];
    right += mass[order[k]] * x[3 * order[k] + e % 3] * x[3 * order[k] + e % 3];
  }
  assert_true(fabs(sum / right - 1) < 1e-14);
}

static void no_bodies_are_nothing(void **state) {
  (void)state;
  hk_jacobi j = {0};
  double untouched[3] = {1, 2, 3};
  hk_jacobi_weigh(&j, mass);
  hk_jacobi_from(&j, x, untouched);
  hk_jacobi_to(&j, x, untouched);
  assert_true(untouched[0] == 1 && untouched[1] == 2 && untouched[2] == 3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(places_are_from_the_centre_of_those_before),
      cmocka_unit_test(there_and_back_is_where_it_was),
      cmocka_unit_test(kinetic_energy_is_a_sum_of_squares),
      cmocka_unit_test(no_bodies_are_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
