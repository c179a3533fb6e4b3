/* Tangents are the derivatives of the steps: in closed form for an oscillator, and against whole runs. */
#include "tests/support/varied_scenes.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static const double start[VARIED_PARAMETERS] = {50, 0.7, 2, 0.3};

/* One particle, 0.1 m from a centre that pulls with p[0] x per mass. */
static void oscillator(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_particle(e, 0.1, 0, 0, 1);
  test_number(e, test_plugin(e, HK_FORCE, "central"), "strength", p[0]);
}

/* Leapfrog's x after N steps is A cos(N a) with cos a = 1 - h^2 w^2/2, w^2 the strength: exactly. The force is linear
 * in the strength, so that its difference is good to eps/1e-5 = 2e-11, and errors of N steps add up. */
static void tangent_of_an_oscillator_is_that_of_its_steps(void **state) {
  (void)state;
  enum { N = 200 };
  const double h = 0.01, strength = 40, a = acos(1 - h * h * strength / 2), by_strength = h * h / (2 * sin(a));
  varied_runs r;
  varied_open(&r, oscillator, "leapfrog", (double[]){strength, 1, 1, 1}, 1, h);
  varied_run(&r, N * h);
  varied_tangents kept = {.numbers = 9, .n = 1};
  hk_error error = {0};
  assert_int_equal(hk_sensitivity_tangents(r.s, r.by, 1, varied_keep_tangents, &kept, &error), HK_OK);
  assert_int_equal(r.s->steps, N);
  double exact = -0.1 * N * sin(N * a) * by_strength;
  assert_true(fabs(kept.last[0] - exact) < 1e-9 * fabs(exact));
  varied_close(&r);
}

/* Central differences of whole runs with 1e-4 of a parameter leave 1e-8 times a third derivative, and rounding of some
 * 1e-15 over 1e-4. */
static void tangents_are_the_differences_of_whole_runs(void **state) {
  (void)state;
  const double t = 0.4;
  for (size_t m = 0; m < VARIED_ALL; m++) {
    varied_runs r;
    varied_open(&r, varied_tetrahedron, varied_method[m], start, VARIED_PARAMETERS, 2e-3);
    varied_run(&r, t);
    varied_tangents kept = {.numbers = VARIED_PARAMETERS * r.s->wide, .n = 4};
    hk_error error = {0};
    assert_int_equal(hk_sensitivity_tangents(r.s, r.by, VARIED_PARAMETERS, varied_keep_tangents, &kept, &error), HK_OK);
    for (size_t k = 0; k < VARIED_PARAMETERS; k++) {
      double more[24], less[24], by = 1e-4 * start[k], most = 0, worst = 0;
      varied_end(&r, k, by, t, more);
      varied_end(&r, k, -by, t, less);
      for (size_t e = 0; e < 24; e++) {
        double exact = (more[e] - less[e]) / (2 * by);
        most = fmax(most, fabs(exact));
        worst = fmax(worst, fabs(kept.last[r.s->wide * k + e] - exact));
      }
      if (!(worst < 1e-6 * most)) fail_msg("%s, parameter %zu: %g of %g", varied_method[m], k, worst, most);
    }
    varied_close(&r);
  }
}

/* Forces whose Jacobian is not exact are differentiated along the tangent, with errors of eps^(2/3). */
static void differences_take_the_place_of_a_jacobian(void **state) {
  (void)state;
  varied_runs r;
  varied_tangents exact = {.numbers = 2 * 36, .n = 4}, kept = exact;
  hk_error error = {0};
  varied_open(&r, varied_tetrahedron, "leapfrog", start, 2, 2e-3);
  varied_run(&r, 0.4);
  assert_true(r.s->all_exact);
  assert_int_equal(hk_sensitivity_tangents(r.s, r.by, 2, varied_keep_tangents, &exact, &error), HK_OK);
  r.s->exact[0] = r.s->all_exact = false; /* the springs, with drag and pull exact as they were */
  assert_int_equal(hk_sensitivity_tangents(r.s, r.by, 2, varied_keep_tangents, &kept, &error), HK_OK);
  for (size_t k = 0; k < 2; k++) {
    double most = 0;
    for (size_t e = 0; e < 36; e++) most = fmax(most, fabs(exact.last[36 * k + e]));
    for (size_t e = 0; e < 36; e++) assert_true(fabs(kept.last[36 * k + e] - exact.last[36 * k + e]) < 1e-8 * most);
  }
  varied_close(&r);
}

static void kicked(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_particle(e, 1, 0, 0, p[0]);
  test_plugin(e, HK_FORCE, "fixture:kicker"); /* claims to depend on v */
}

static void a_force_without_a_jacobian_has_no_adjoint(void **state) {
  (void)state;
  varied_runs r;
  varied_open(&r, kicked, "leapfrog", (double[]){1, 1, 1, 1}, 1, 1e-2);
  varied_run(&r, 0.1);
  double X[6] = {1}, slope;
  hk_error error = {0};
  assert_int_equal(hk_sensitivity_adjoint(r.s, X, r.by, 1, &slope, &error), HK_FAILED);
  assert_string_equal(error.text,
                      "force 'kicker' states no exact Jacobian, which the derivative backwards needs: take it "
                      "forwards, by parameters");
  varied_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tangent_of_an_oscillator_is_that_of_its_steps),
      cmocka_unit_test(tangents_are_the_differences_of_whole_runs),
      cmocka_unit_test(differences_take_the_place_of_a_jacobian),
      cmocka_unit_test(a_force_without_a_jacobian_has_no_adjoint),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
