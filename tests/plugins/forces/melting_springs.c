/* Springs that soften by their channel, melt and break: the force, the energy that is lost, and what stays gone. */
#include "tests/support/melting.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double K = 40, softens = 250, melts = 270, mass = 1, reach = 0.2; /* N/m; K; kg; m */

/* A spring of 1 m from a fixed particle, stretched by `reach`, of two particles at the temperature T. */
static hk_plugin_spec *spring(test_engine *e, double T) {
  const uint32_t edge[1][2] = {{1, 2}};
  test_engine_open(e);
  melting_channel(e, T);
  test_particle(e, 0, 0, 0, mass);
  test_particle(e, 1 + reach, 0, 0, mass);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "melting_springs");
  test_edges(e, spec, edge, 1);
  test_number(e, spec, "k", K);
  test_number(e, spec, "rest", 1);
  melting_follows(e, spec, softens, melts - softens);
  e->options.integrator = "leapfrog";
  e->options.dt = 1e-3;
  e->scene->fps = 1000;
  return spec;
}

/* After `t` at the temperature T a swing of the spring's softened stiffness. */
static void softened_springs_swing_slower(void **state) {
  (void)state;
  for (double T = 240; T < melts; T += 5) {
    test_engine e;
    double s = fmin(1, (melts - T) / (melts - softens)), w = sqrt(s * K / mass);
    spring(&e, T);
    test_run(&e);
    test_advance(&e, 1);
    double off = test_position(&e, 2)[0] - 1 - reach * cos(w);
    if (fabs(off) > 1e-5) fail_msg("at %g K: off by %g m", T, off); /* (w h)^2/24 w t reach = 2e-6 */
    test_engine_close(&e);
  }
}

/* Of a spring that warms by 40 K/s and is gone after 0.5 s the energy balance closes: what it loses is dissipated. Then
 * its particle flies on. */
static void what_melts_is_gone_and_its_energy_is_counted(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  spring(&e, softens);
  melting_warms(&e, 40);
  test_run(&e);
  double first = 0.5 * K * reach * reach;
  test_advance(&e, 0.6);
  double v = test_velocity(&e, 2)[0];
  test_advance(&e, 0.7);
  assert_true(test_velocity(&e, 2)[0] == v && fabs(v) > 0.1);
  hk_run_summary(e.run, &s);
  printf("energy %.4g J of %.4g J, drift %.2g\n", 0.5 * mass * v * v, first, s.energy_drift);
  assert_true(fabs(s.energy_drift) < 1e-3);
  test_engine_close(&e);
}

/* A particle that cools again has its spring back as long as it has not melted. */
static void what_has_only_softened_is_stiff_again(void **state) {
  (void)state;
  for (int molten = 0; molten < 2; molten++) {
    test_engine e;
    spring(&e, melts + (molten ? 1 : -1));
    melting_warms(&e, -100);
    test_run(&e);
    test_advance(&e, 1);
    double before = test_velocity(&e, 2)[0];
    test_advance(&e, 1.5);
    bool flies = test_velocity(&e, 2)[0] == before;
    assert_true(flies == molten);
    test_engine_close(&e);
  }
}

/* Cold, it breaks above its strain. */
static void strain_breaks(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    test_engine e;
    test_number(&e, spring(&e, 0), "breaking", k ? 0.19 : 0.21);
    test_run(&e);
    test_advance(&e, 0.2);
    double v = test_velocity(&e, 2)[0];
    test_advance(&e, 0.3);
    assert_true((test_velocity(&e, 2)[0] == v) == k);
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(softened_springs_swing_slower),
      cmocka_unit_test(what_melts_is_gone_and_its_energy_is_counted),
      cmocka_unit_test(what_has_only_softened_is_stiff_again),
      cmocka_unit_test(strain_breaks),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
