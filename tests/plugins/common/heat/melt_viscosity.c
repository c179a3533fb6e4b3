/* Viscosities by the enthalpy: the laws of Arrhenius and of Vogel, Fulcher and Tammann, tables, and the melting range.
 */
#include "plugins/common/heat/melt_viscosity.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static const hk_heat_law plain = {NAN, NAN, NAN, {1, 1}, {1, 1}}, /* h = T */
    wax = {319, 329, 2e5, {2000, 2200}, {0.24, 0.15}};

static bool is(double found, double wanted) { return fabs(found / wanted - 1) < 1e-12; }

static void melts_follow_their_laws(void **state) {
  (void)state;
  const hk_melt_viscosity arrhenius = {.viscosity = 2e-6, .slope = 4000, .solid = NAN, .most = 1e8};
  assert_true(is(hk_melt_viscosity_at(&arrhenius, &plain, 300), 2e-6 * exp(4000 / 300.0)));
  const hk_melt_viscosity vft = {.viscosity = 3e-5, .slope = 5000, .pole = 600, .solid = NAN, .most = 1e8};
  assert_true(is(hk_melt_viscosity_at(&vft, &plain, 1400), 3e-5 * exp(5000 / 800.0)));
  assert_true(is(hk_melt_viscosity_at(&vft, &plain, 601), 1e8)); /* exp(5000) is more */
  assert_true(is(hk_melt_viscosity_at(&vft, &plain, 600), 1e8));
  assert_true(is(hk_melt_viscosity_at(&vft, &plain, 20), 1e8));
}

/* exp(-b T) by two entries is exact between them. */
static void tables_are_linear_in_the_logarithm(void **state) {
  (void)state;
  const double T[] = {100, 200, 400}, factor[] = {exp(-1), exp(-2), exp(-4)};
  hk_melt_viscosity m = {.viscosity = 7, .temperatures = {3, T}, .factors = {3, factor}, .solid = NAN, .most = 1e8};
  for (double t = 100; t <= 400; t += 25) assert_true(is(hk_melt_viscosity_at(&m, &plain, t), 7 * exp(-t / 100)));
  assert_true(is(hk_melt_viscosity_at(&m, &plain, 50), 7 * exp(-1)));
  assert_true(is(hk_melt_viscosity_at(&m, &plain, 500), 7 * exp(-4)));
  m.outside = HK_TABLE_REFUSED;
  assert_true(isnan(hk_melt_viscosity_at(&m, &plain, 50)) && isnan(hk_melt_viscosity_at(&m, &plain, 500)));
  assert_true(is(hk_melt_viscosity_at(&m, &plain, 400), 7 * exp(-4)));
}

/* From the solid's to the melt's, without a jump, by the molten part; without a solid's the melt's law holds all the
 * way. */
static void melting_goes_from_one_to_the_other(void **state) {
  (void)state;
  hk_melt_viscosity m = {.viscosity = 1e-3, .solid = 1e6, .most = 1e8};
  assert_true(is(hk_melt_viscosity_at(&m, &wax, -1), 1e6) && is(hk_melt_viscosity_at(&m, &wax, 0), 1e6));
  assert_true(is(hk_melt_viscosity_at(&m, &wax, 2e5 / 3), 1e3));
  assert_true(is(hk_melt_viscosity_at(&m, &wax, 2e5), 1e-3) && is(hk_melt_viscosity_at(&m, &wax, 1e6), 1e-3));
  m.most = 10;
  assert_true(is(hk_melt_viscosity_at(&m, &wax, -1), 10));
  m.solid = NAN;
  assert_true(is(hk_melt_viscosity_at(&m, &wax, -1), 1e-3));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(melts_follow_their_laws),
      cmocka_unit_test(tables_are_linear_in_the_logarithm),
      cmocka_unit_test(melting_goes_from_one_to_the_other),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
