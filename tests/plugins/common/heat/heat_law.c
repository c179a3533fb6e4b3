/* Temperature, molten part and Kirchhoff's transform by the enthalpy: continuous, rising, with the slopes of the
 * phases. */
#include "plugins/common/heat/heat_law.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static const hk_heat_law wax = {319, 329, 2e5, {2000, 2200}, {0.24, 0.15}},
                         ice = {273.15, 273.15, 333600, {2100, 4220}, {2.16, 0.561}},
                         plain = {NAN, NAN, NAN, {500, 500}, {3, 3}};

static void temperatures_are_piecewise_linear(void **state) {
  (void)state;
  assert_true(hk_heat_temperature(&wax, -2000) == 318 && hk_heat_temperature(&wax, 0) == 319);
  assert_true(hk_heat_temperature(&wax, 1e5) == 324 && hk_heat_temperature(&wax, 2e5) == 329);
  assert_true(hk_heat_temperature(&wax, 2e5 + 2200) == 330);
  assert_true(hk_heat_temperature(&ice, 1) == 273.15 && hk_heat_temperature(&ice, 333599) == 273.15);
  assert_true(hk_heat_temperature(&plain, 1000) == 2);
  assert_true(hk_heat_molten(&wax, -1) == 0 && hk_heat_molten(&wax, 5e4) == 0.25 && hk_heat_molten(&wax, 3e5) == 1);
  assert_true(hk_heat_molten(&plain, 3e5) == 0);
}

/* The slope of the potential by the temperature is the conductivity of the phase, and no slope by the enthalpy is above
 * the steepest. */
static void the_potential_is_the_integral_of_the_conductivity(void **state) {
  (void)state;
  const hk_heat_law *law[] = {&wax, &ice, &plain};
  for (int k = 0; k < 3; k++) {
    double before = hk_heat_potential(law[k], -1e5), steepest = hk_heat_steepest_potential(law[k]);
    for (double h = -1e5 + 500; h <= 6e5; h += 500) {
      double now = hk_heat_potential(law[k], h), T = hk_heat_temperature(law[k], h);
      double rise = T - hk_heat_temperature(law[k], h - 500), molten = hk_heat_molten(law[k], h - 250);
      assert_true(now >= before && now - before <= steepest * 500 * (1 + 1e-9));
      if (h < 0 || !hk_heat_melts(law[k]))
        assert_true(fabs((now - before) / rise / law[k]->conductivity[0] - 1) < 1e-8);
      if (molten == 1) assert_true(fabs((now - before) / rise / law[k]->conductivity[1] - 1) < 1e-8);
      before = now;
    }
  }
  double across = hk_heat_potential(&wax, 2e5) - hk_heat_potential(&wax, 0);
  assert_true(fabs(across / ((0.24 + 0.15) / 2 * 10) - 1) < 1e-12);
  assert_true(hk_heat_potential(&ice, 333600) == 0);
  assert_true(hk_heat_least_capacity(&wax) == 2000 && hk_heat_least_capacity(&ice) == 2100);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(temperatures_are_piecewise_linear),
      cmocka_unit_test(the_potential_is_the_integral_of_the_conductivity),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
