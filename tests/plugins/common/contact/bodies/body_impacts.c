/* The corrector contact with particles that constraints join: the law of impact is that of the body. A rod that meets a
 * floor of one triangle moves without forces, so that the law is exact: rounding. A box of bars and one of cables never
 * intersects its floor at a frame, whatever the step, and is in balance. */
#include "tests/support/bar_box.h"

#include <stdio.h>
#include <string.h>

static const double L = 0.8, m = 0.5, slope = 0.7, radius = 0.01;

/* A rod of two masses falls on the triangle with its lower end, at 1 m/s. The impulse without friction is J =
 * (1 + e)/(1/(2 m) + (L/2 cos)^2/I), I = m L^2/2, upwards. */
static void a_rod_on_a_triangle_obeys_the_law_of_a_body(void **state) {
  (void)state;
  for (double e = 0.5; e <= 1; e += 0.5) {
    test_engine w;
    const uint32_t edge[1][2] = {{4, 5}};
    test_engine_open(&w);
    w.options.integrator = "leapfrog";
    w.options.dt = 1e-3;
    w.scene->duration = 1;
    w.scene->fps = 100;
    for (int k = 0; k < 3; k++)
      test_pin(&w, HK_PIN_FIXED, test_particle(&w, 5 * cos(2.1 * k), 5 * sin(2.1 * k), 0, 1), NULL);
    bar_box_triangle(&w, 1, 2, 3);
    test_particle(&w, 0, 0, 0.03, m);
    test_particle(&w, L * cos(slope), 0, 0.03 + L * sin(slope), m);
    w.scene->particles.velocity[3 * 3 + 2] = w.scene->particles.velocity[3 * 4 + 2] = -1;
    test_edges(&w, test_plugin(&w, HK_CONSTRAINT, "bars"), edge, 1);
    hk_plugin_spec *contact = test_plugin(&w, HK_CORRECTOR, "contact");
    test_number(&w, contact, "radius", radius);
    test_number(&w, contact, "restitution", e);
    test_run(&w);
    test_advance(&w, 0.04);
    double I = m * L * L / 2, r = L / 2 * cos(slope), J = (1 + e) / (1 / (2 * m) + r * r / I);
    const double *p = test_velocity(&w, 4), *q = test_velocity(&w, 5);
    double centre = fabs((p[2] + q[2]) / 2 + 1 - J / (2 * m)),
           spin = fabs(sqrt(pow(q[0] - p[0], 2) + pow(q[2] - p[2], 2)) / L - r * J / I);
    print_message("rod on a triangle, e = %g: centre off by %.1e m/s, spin by %.1e rad/s\n", e, centre, spin);
    assert_true(centre < 1e-12 && spin < 1e-11);
    test_engine_close(&w);
  }
}

static void drop_box(const char *kind, double h, double restitution, double friction) {
  test_engine w;
  hk_summary s;
  test_engine_open(&w);
  w.options.integrator = "leapfrog";
  w.options.dt = h;
  w.scene->duration = 1;
  w.scene->fps = 30;
  bar_box_add(&w, kind);
  hk_plugin_spec *contact = test_plugin(&w, HK_CORRECTOR, "contact");
  test_number(&w, contact, "thickness", 4e-3);
  test_number(&w, contact, "restitution", restitution);
  test_number(&w, contact, "friction", friction);
  test_run(&w);
  test_advance(&w, 1);
  hk_run_summary(w.run, &s);
  print_message("box of %s, h = %.2e s, e = %g: %g intersections at %g frames, least gap %.1e m, energy drift %.1e, "
                "lengths off by %.1e m\n",
                kind, h, restitution, s.intersections, s.contact_frames, s.closest, s.energy_drift,
                s.constraint_violation);
  assert_true(s.contact_frames >= 30 && s.intersections == 0 && s.closest > -4e-5); /* a hundredth of the thickness */
  assert_true(fabs(s.energy_drift) < 1e-11 && s.constraint_violation < 1e-12);
  if (restitution == 1) assert_true(fabs(s.impact_energy) < 1e-5 * s.energy_first);
  test_engine_close(&w);
}

static void a_box_of_bars_never_intersects_its_floor(void **state) {
  (void)state;
  for (double h = 1.0 / 240; h > 1.0 / 2000; h /= 2) drop_box("bars", h, 0, 0.3);
  drop_box("bars", 1.0 / 480, 0.6, 0.3);
}

/* Steps end where the box lands, with 5e-8 m to go: m g of that, some 1e-7 of the energy an impact. */
static void a_box_that_bounces_keeps_its_energy(void **state) {
  (void)state;
  for (double h = 1.0 / 240; h > 1.0 / 1000; h /= 2) drop_box("bars", h, 1, 0);
}

static void a_box_of_cables_falls_into_a_heap_without_an_intersection(void **state) {
  (void)state;
  drop_box("cables", 1.0 / 480, 0, 0.3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_rod_on_a_triangle_obeys_the_law_of_a_body),
      cmocka_unit_test(a_box_of_bars_never_intersects_its_floor),
      cmocka_unit_test(a_box_that_bounces_keeps_its_energy),
      cmocka_unit_test(a_box_of_cables_falls_into_a_heap_without_an_intersection),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
