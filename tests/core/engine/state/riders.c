/* Riders: points that are combinations of particles. With springs, drag and gravity on them the motion is that of their
 * carriers under the gradient of the same energy, to rounding; power, bounds and deaths go over to these. */
#include "core/numerics/step_choice/step_choice.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { CARRIERS = 4, N = 7 };

static uint32_t rider(test_engine *e, const double weight[4]) {
  hk_rider r = {.particle = test_particle(e, 0, 0, 0, 0), .carriers = 4, .carrier = {1, 2, 3, 4}};
  memcpy(r.weight, weight, sizeof r.weight);
  assert_int_equal(hk_scene_add_rider(e->scene, &r, &e->error), HK_OK);
  return r.particle;
}

/* A tetrahedron of free particles with riders 5 and 6, one far outside, and a fixed particle 7; springs join 5 to 7, 5
 * to 6 and 6 to 1. */
static void scene(test_engine *e, double damping) {
  test_engine_open(e);
  test_particle(e, 0.1, 0, 0, 1);
  test_particle(e, 1, 0.2, -0.1, 2);
  test_particle(e, 0.3, 1.1, 0, 0.5);
  test_particle(e, 0.2, 0.3, 0.9, 1.5);
  for (size_t k = 0; k < 3 * CARRIERS; k++) e->scene->particles.velocity[k] = 0.3 * sin(1.7 * (double)k);
  rider(e, (const double[4]){0.7, 0.6, -0.5, 0.2});
  rider(e, (const double[4]){-2, 1, 1.25, 0.75});
  test_pin(e, HK_PIN_FIXED, test_particle(e, 2, 2, 2, 0), NULL);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t[][2]){{5, 7}, {5, 6}, {6, 1}}, 3);
  test_number(e, springs, "k", 50);
  test_number(e, springs, "rest", 0.3);
  test_number(e, springs, "damping", damping);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -9.81);
}

static double energy(test_engine *e) {
  const hk_state *s = &e->run->state;
  return hk_state_kinetic(s, s->X) + hk_query_potential(&e->run->dynamics, s->t, s->X);
}

static void riders_are_where_their_carriers_put_them(void **state) {
  (void)state;
  test_engine e;
  scene(&e, 0.1);
  test_run(&e);
  test_advance(&e, 0.25);
  const double *w = e.run->state.rider[1].weight, *x = e.run->state.X, *v = x + 3 * N;
  for (size_t c = 0; c < 3; c++) {
    double at = 0, speed = 0;
    for (size_t k = 0; k < 4; k++) at += w[k] * x[3 * k + c], speed += w[k] * v[3 * k + c];
    assert_true(fabs(x[3 * 5 + c] - at) < 1e-14 && fabs(v[3 * 5 + c] - speed) < 1e-13);
  }
  test_engine_close(&e);
}

/* Differences of step 1e-6 of energies of some 100 J are good to 1e-8 N and 1e-4 of that by rounding: 1e-6 in all. */
static void forces_on_carriers_are_the_gradient_of_the_energy(void **state) {
  (void)state;
  test_engine e;
  scene(&e, 0);
  test_run(&e);
  hk_system *s = &e.run->dynamics.system;
  double X[6 * N + 1], a[3 * N], dy[1], h = 1e-6;
  memcpy(X, e.run->state.X, sizeof X);
  assert_int_equal(s->accelerations(s, 0, X, X + 3 * N, X + 6 * N, a, dy), HK_OK);
  for (size_t k = 0; k < 3 * CARRIERS; k++) {
    double sum = 0;
    for (int side = -1; side < 2; side += 2) {
      memcpy(X, e.run->state.X, sizeof X);
      X[k] += side * h;
      s->impose(s, 0, X, X + 3 * N);
      sum -= side * hk_query_potential(&e.run->dynamics, 0, X) / (2 * h);
    }
    double F = a[k] * e.run->state.mass[k / 3];
    if (!(fabs(F - sum) < 1e-6)) fail_msg("%zu: %.9g, expected %.9g", k, F, sum);
  }
  test_engine_close(&e);
}

/* Leapfrog's energy oscillates by some (h w)^2/8 of itself; what is lost to damping is in the work. */
static void energy_is_counted_once(void **state) {
  (void)state;
  for (int damped = 0; damped < 2; damped++) {
    test_engine e;
    scene(&e, damped ? 0.5 : 0);
    e.scene->dt = 1e-4;
    test_run(&e);
    double first = energy(&e);
    test_advance(&e, 0.5);
    const hk_state *s = &e.run->state;
    assert_true(fabs(energy(&e) - first - s->X[s->size - 1]) < 1e-5 * fabs(first));
    assert_true(damped ? s->X[s->size - 1] < -0.1 : s->X[s->size - 1] == 0);
    test_engine_close(&e);
  }
}

static void results_have_the_same_bits_for_any_number_of_threads(void **state) {
  (void)state;
  double end[2][6 * N];
  for (int k = 0; k < 2; k++) {
    test_engine e;
    scene(&e, 0.5);
    e.options.threads = 1 + 2 * k;
    test_run(&e);
    test_advance(&e, 0.2);
    memcpy(end[k], e.run->state.X, sizeof end[k]);
    test_engine_close(&e);
  }
  assert_memory_equal(end[0], end[1], sizeof end[0]);
}

/* A pair of springs k between a rider of weights (1/2, 1/2) and a fixed point: the middle of two particles of mass m
 * swings with w^2 = k/(2 m), and the bound is w^2 <= k/m; the limit of leapfrog is 2/w. */
static void the_stable_step_is_foretold(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, -1, 0, 0, 1);
  test_particle(&e, 1, 0, 0, 1);
  hk_rider r = {.particle = test_particle(&e, 0, 0, 0, 0), .carriers = 2, .carrier = {1, 2}, .weight = {0.5, 0.5}};
  assert_int_equal(hk_scene_add_rider(e.scene, &r, &e.error), HK_OK);
  test_pin(&e, HK_PIN_FIXED, test_particle(&e, 0, 1, 0, 0), NULL);
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
  test_edges(&e, springs, (const uint32_t[][2]){{3, 4}}, 1);
  test_number(&e, springs, "k", 800);
  test_run(&e);
  double limit = e.run->step->dt_limit;
  if (!(limit <= 0.1001 && limit >= 0.07)) fail_msg("%g s, expected 2/sqrt(800) to 2/sqrt(400)", limit);
  test_engine_close(&e);
}

static void refuse(test_engine *e, hk_rider r, const char *text) {
  e->error = (hk_error){0};
  assert_int_equal(hk_scene_add_rider(e->scene, &r, &e->error), HK_BAD_PARAM);
  if (!strstr(e->error.text, text)) fail_msg("%s, expected %s", e->error.text, text);
}

static void what_cannot_ride_is_refused(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  for (int k = 0; k < 3; k++) test_particle(&e, k, 0, 0, k < 2);
  test_particle(&e, 0, 0, 0, 0);
  refuse(&e, (hk_rider){.particle = 1, .carriers = 1, .carrier = {2}, .weight = {1}}, "has a mass");
  refuse(&e, (hk_rider){.particle = 3, .carriers = 2, .carrier = {1, 2}, .weight = {1, 1}}, "have the sum 2");
  refuse(&e, (hk_rider){.particle = 3, .carriers = 1, .carrier = {9}, .weight = {1}}, "no such particle");
  hk_rider fine = {.particle = 3, .carriers = 2, .carrier = {1, 2}, .weight = {2, -1}};
  assert_int_equal(hk_scene_add_rider(e.scene, &fine, &e.error), HK_OK);
  refuse(&e, (hk_rider){.particle = 4, .carriers = 1, .carrier = {3}, .weight = {1}}, "is a rider itself");
  test_engine_close(&e);
}

/* Rider 3 goes with its body or alone; without a carrier it cannot be. */
static void deaths_take_the_riders_of_a_body_with_it(void **state) {
  (void)state;
  const uint32_t maps[3][4] = {{0, 1, UINT32_MAX, 2}, {UINT32_MAX, UINT32_MAX, UINT32_MAX, 0}, {0, UINT32_MAX, 1, 2}};
  for (int k = 0; k < 3; k++) {
    hk_rider list = {.particle = 2, .carriers = 2, .carrier = {0, 1}, .weight = {0.5, 0.5}};
    uint32_t id[4] = {1, 2, 3, 4};
    hk_error error = {0};
    hk_state s = {.model = {.riders = 1}, .rider = &list, .id = id};
    assert_int_equal(hk_riders_remap(&s, maps[k], &error), k < 2 ? HK_OK : HK_FAILED);
    if (k < 2) assert_int_equal(s.model.riders, 0);
    if (k == 2) assert_non_null(strstr(error.text, "remove all of the body, or nothing"));
  }
}

/* What carries, and points that are not of a surface, are inside of a body; the newborn and others are not. */
static void contact_takes_the_surface_of_bodies(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  for (int k = 0; k < 3; k++) test_particle(&e, k, 0, 0, 1);
  for (int k = 0; k < 2; k++) {
    hk_rider r = {.particle = test_particle(&e, 0, 0, 0, 0),
                  .carriers = 2,
                  .carrier = {1, 2},
                  .weight = {0.5, 0.5},
                  .touches = k == 0};
    assert_int_equal(hk_scene_add_rider(e.scene, &r, &e.error), HK_OK);
  }
  test_run(&e);
  const hk_model *m = &e.run->state.model;
  const bool touches[5] = {false, false, true, true, false};
  for (size_t i = 0; i < 5; i++) assert_true(hk_model_moves(m, i) && hk_model_touches(m, i) == touches[i]);
  const uint32_t map[5] = {1, 2, UINT32_MAX, 3, 4};
  hk_state *s = &e.run->state;
  assert_int_equal(hk_riders_remap(s, map, &e.error), HK_OK);
  const bool inside[5] = {false, true, true, false, true};
  assert_memory_equal(m->inside, inside, sizeof inside);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(riders_are_where_their_carriers_put_them),
      cmocka_unit_test(forces_on_carriers_are_the_gradient_of_the_energy),
      cmocka_unit_test(energy_is_counted_once),
      cmocka_unit_test(results_have_the_same_bits_for_any_number_of_threads),
      cmocka_unit_test(the_stable_step_is_foretold),
      cmocka_unit_test(what_cannot_ride_is_refused),
      cmocka_unit_test(contact_takes_the_surface_of_bodies),
      cmocka_unit_test(deaths_take_the_riders_of_a_body_with_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
