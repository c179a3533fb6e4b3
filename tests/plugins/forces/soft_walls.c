/* The shape of walls: a force without friction and damping is minus the gradient of its energy wherever a sphere is,
 * and distances are those of the nearest point. How walls hold and rub is tested with the grains (soft_spheres.c). */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double R = 0.1, K = 1e4; /* m, N/m */

static hk_plugin_spec *walls(test_engine *e) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "soft_walls");
  test_number(e, spec, "radius", R);
  test_number(e, spec, "stiffness", K);
  test_number(e, spec, "restitution", 1);
  test_number(e, spec, "friction", 0);
  e->options.dt = 1e-4;
  return spec;
}

/* Three spheres beside a funnel of neck 0.2 m and slope 1 at z = 0.5 m: on the upper cone, on the lower one, and in the
 * plane of the neck, which is nearest there. Overlaps of 1 cm by hand. */
static void a_funnel_pushes_from_its_nearest_point(void **state) {
  (void)state;
  test_engine e;
  double F[9], s = sqrt(0.5), d = 0.01, off = (R - d) / s; /* distance from the cone along the radius */
  test_engine_open(&e);
  test_particle(&e, 0.2 + 0.3 - off, 0, 0.5 + 0.3, 1);
  test_particle(&e, 0, -(0.2 + 0.3 - off), 0.5 - 0.3, 1);
  test_particle(&e, 0.2 - R + d, 0, 0.5, 1);
  test_list(&e, walls(&e), "funnel", (const double[]){0, 0, 0.5, 0.2, 1}, 5);
  test_run(&e);
  hk_instance *force = e.run->plugins.kind[HK_FORCE].item[0];
  hk_view view = force_view(&e, force);
  force_evaluate(force, &view, F);
  const double wanted[9] = {-s, 0, s, 0, s, -s, -1, 0, 0};
  for (int c = 0; c < 9; c++) assert_true(fabs(F[c] - K * d * wanted[c]) < 1e-10 * K * d);
  test_engine_close(&e);
}

/* Random places on both cones, at the edge, within the wall, and at planes; the differences do not see the kinks of the
 * normal on the cones' bisectors, where no centre comes to lie. */
static void force_is_minus_the_gradient_of_the_energy(void **state) {
  (void)state;
  uint64_t seed[4];
  hk_random_seed(seed, 12);
  int touched = 0;
  for (int round = 0; round < 40; round++) {
    test_engine e;
    test_engine_open(&e);
    for (int i = 0; i < 4; i++)
      test_particle(&e, 0.6 * hk_random_uniform(seed) - 0.3, 0.6 * hk_random_uniform(seed) - 0.3,
                    0.5 * hk_random_uniform(seed) + 0.01, 1);
    hk_plugin_spec *spec = walls(&e);
    test_list(&e, spec, "funnel", (const double[]){0.02, -0.01, 0.25, 0.15, 0.2 * (round % 5)}, 5);
    test_list(&e, spec, "planes", (const double[]){0, 0, 1, 0, 1, 2, 2, -0.2}, 8);
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    double E = force->plugin->force->energy(force->self, &view), off = force_gradient_error(force, &view);
    if (E > 0 && !(off < FORCE_DIFFERENCES)) fail_msg("round %d: gradient %g", round, off);
    touched += E > 0;
    test_engine_close(&e);
  }
  assert_true(touched > 20);
}

static void what_is_wrong_is_named(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    const char *const says[] = {"give either radius = NUMBER or radii", "radii: the scene has no channel 'size'",
                                "planes: 3 numbers", "funnel: a neck of 0 m"};
    test_engine e;
    test_engine_open(&e);
    test_particle(&e, 0, 0, 1, 1);
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "soft_walls");
    test_number(&e, spec, "stiffness", K);
    if (k == 1) test_text(&e, spec, "radii", "size");
    if (k > 1) test_number(&e, spec, "radius", R);
    if (k == 2) test_list(&e, spec, "planes", (const double[]){0, 0, 1}, 3);
    if (k == 3) test_list(&e, spec, "funnel", (const double[]){0, 0, 1, 0, 1}, 5);
    assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
    if (!strstr(e.error.text, says[k])) fail_msg("%s", e.error.text);
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_funnel_pushes_from_its_nearest_point),
      cmocka_unit_test(force_is_minus_the_gradient_of_the_energy),
      cmocka_unit_test(what_is_wrong_is_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
