/* The order of things in a run, pins, events, and runs that stop and go on. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void spring(test_engine *e, uint32_t i, uint32_t j) {
  uint32_t edge[1][2] = {{i, j}};
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, 1);
  test_number(e, springs, "k", 100);
  test_number(e, springs, "damping", 0.1);
}

/* ---- pins ---- */

static void fixed_particles_do_not_move_by_a_bit(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0.1, 0.2, 0.3, 1);
  test_particle(&e, 1, 0, 0, 1);
  spring(&e, 1, 2);
  test_plugin(&e, HK_FORCE, "gravity");
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  test_run(&e);
  test_advance(&e, 1);
  assert_memory_equal(test_position(&e, 1), ((double[]){0.1, 0.2, 0.3}), 3 * sizeof(double));
  assert_memory_equal(test_velocity(&e, 1), ((double[]){0, 0, 0}), 3 * sizeof(double));
  test_engine_close(&e);
}

static void beads_keep_to_their_line_and_plane(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 1, 2, 3, 1);
  test_particle(&e, 4, 5, 6, 1);
  test_pin(&e, HK_PIN_LINE, 1, (double[]){0, 0, 2});
  test_pin(&e, HK_PIN_PLANE, 2, (double[]){0, 0, 1});
  test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 1, 2, -9.81);
  test_run(&e);
  test_advance(&e, 1);
  const double *line = test_position(&e, 1), *plane = test_position(&e, 2);
  assert_true(line[0] == 1 && line[1] == 2); /* exactly: the axis is a coordinate axis */
  assert_true(fabs(line[2] - (3 - 9.81 / 2)) < 1e-12);
  assert_true(plane[2] == 6);
  assert_true(fabs(plane[0] - 4.5) < 1e-12 && fabs(plane[1] - 6) < 1e-12);
  test_engine_close(&e);
}

/* x = sin t */
static hk_status swing(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out, size_t max,
                       size_t *n_out, hk_error *error) {
  (void)caller, (void)f, (void)n_in, (void)max, (void)error;
  out[0] = sin(in[0]);
  out[1] = out[2] = 0;
  *n_out = 3;
  return HK_OK;
}

/* A driven oscillator: m u'' = -k (u - L - sin t); u'' = -100 (u - 1 - sin t), from rest at its length: the solution is
 * u = 1 + (100 sin t - 10 sin 10t)/99. rk4 must keep its order with the moving end. */
static double driven_error(double h) {
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 1, 0, 0, 1);
  uint32_t edge[1][2] = {{1, 2}}, id = 1;
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
  test_edges(&e, springs, (const uint32_t(*)[2])edge, 1);
  test_number(&e, springs, "k", 100);
  hk_pin_spec pin = {.kind = HK_PIN_PATH, .count = 1, .id = &id, .path = {.call = swing}, .release = INFINITY};
  assert_int_equal(hk_scene_add_pin(e.scene, &pin, &e.error), HK_OK);
  e.options.integrator = "rk4";
  e.options.dt = h;
  e.scene->fps = 10;
  test_run(&e);
  test_advance(&e, 1);
  double error = fabs(test_position(&e, 2)[0] - (1 + (100 * sin(1) - 10 * sin(10)) / 99));
  hk_summary s;
  hk_run_summary(e.run, &s);
  assert_true(fabs(s.energy_drift) < 1e-4); /* the work of the pin is in the balance */
  test_engine_close(&e);
  return error;
}

static void moving_pins_are_exact_and_keep_the_order(void **state) {
  (void)state;
  double coarse = driven_error(0.01), fine = driven_error(0.005);
  assert_true(fine < 1e-6);
  assert_true(log2(coarse / fine) > 3.6);
}

static void a_release_happens_on_its_instant(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  uint32_t id = test_particle(&e, 0, 0, 0, 1);
  hk_pin_spec pin = {.kind = HK_PIN_FIXED, .count = 1, .id = &id, .release = 0.3217};
  assert_int_equal(hk_scene_add_pin(e.scene, &pin, &e.error), HK_OK);
  test_plugin(&e, HK_FORCE, "gravity");
  test_run(&e);
  test_advance(&e, 1);
  double t = 1 - 0.3217;
  assert_true(fabs(test_position(&e, 1)[2] + 9.81 * t * t / 2) < 1e-12);
  test_engine_close(&e);
}

static void a_force_acts_from_and_to_its_instants(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 2);
  hk_plugin_spec *gravity = test_plugin(&e, HK_FORCE, "gravity");
  test_vector(&e, gravity, "g", 1, 0, 0);
  gravity->from = 0.111;
  gravity->to = 0.777;
  test_run(&e);
  test_advance(&e, 1);
  double t = 0.777 - 0.111;
  assert_true(fabs(test_velocity(&e, 1)[0] - t) < 1e-13);
  assert_true(fabs(test_position(&e, 1)[0] - (t * t / 2 + t * (1 - 0.777))) < 1e-13);
  test_engine_close(&e);
}

/* ---- the order of hooks ---- */

/* The source emits before the integrator moves, the corrector repairs after it, the frame shows the repaired state. */
static void hooks_run_in_their_order(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_number(&e, test_plugin(&e, HK_SOURCE, "fixture:spout"), "every", 10);
  test_plugin(&e, HK_FORCE, "gravity");
  test_plugin(&e, HK_CORRECTOR, "fixture:floor");
  e.scene->fps = 1;
  e.options.dt = 0.5;
  test_run(&e);
  test_advance(&e, 0.5);
  assert_true(test_position(&e, 1)[2] == 0); /* it fell, and was lifted in the same step */
  assert_int_equal(hk_run_view(e.run)->n, 2);
  assert_true(test_velocity(&e, 2)[2] < 1); /* born at the start of the step with 1 m/s, then moved by it */
  hk_summary s;
  hk_run_summary(e.run, &s);
  assert_true(isnan(s.energy_drift)); /* a corrector and a source: the balance is not known, and nobody says it is */
  test_engine_close(&e);
}

/* ---- channels ---- */

static void a_channel_follows_its_plugin_rate(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  assert_int_equal(hk_scene_add_channel(e.scene, "cold", 2, (double[]){5, 6}, -1, NULL, &e.error), HK_OK);
  assert_int_equal(hk_scene_add_channel(e.scene, "heat", 1, NULL, NAN, NULL, &e.error), HK_OK);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 0, 0, 0, 1);
  test_number(&e, test_plugin(&e, HK_FORCE, "fixture:kicker"), "rate", 3);
  e.options.integrator = "rk4";
  e.options.dt = 0.01;
  test_run(&e);
  test_advance(&e, 1);
  const hk_view *view = hk_run_view(e.run);
  const double *y = view->y;
  assert_true(fabs(y[0] - 5 * exp(-1)) < 1e-9 && fabs(y[3] - 6 * exp(-1)) < 1e-9); /* h^4 = 1e-8 of it, with 1/120 */
  assert_true(fabs(y[4] - 3) < 1e-13 && fabs(y[5] - 3) < 1e-13);
  test_engine_close(&e);
}

/* ---- stopping and going on ---- */

static void busy_scene(test_engine *e) {
  test_engine_open(e);
  for (int i = 0; i < 6; i++) test_particle(e, i, 0.1 * i * i, 0, 1);
  assert_int_equal(hk_scene_add_channel(e->scene, "heat", 1, NULL, NAN, NULL, &e->error), HK_OK);
  for (uint32_t i = 1; i < 6; i++) spring(e, i, i + 1);
  test_plugin(e, HK_FORCE, "fixture:kicker");
  hk_plugin_spec *emitter = test_plugin(e, HK_SOURCE, "fixture:spout");
  test_number(e, emitter, "every", 0.3);
  test_number(e, emitter, "lifetime", 0.7);
  e->options.dt = 1.0 / 600;
  e->scene->duration = 4;
}

/* Positions, velocities, channels, ids and the plugins' counters are the same bits as without the stop: births, deaths,
 * random numbers and leapfrog's cached forces included. */
static void a_checkpoint_goes_on_bit_by_bit(void **state) {
  (void)state;
  const char *const methods[] = {"leapfrog", "stoermer", "rk4", "symplectic_euler"};
  for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
    test_engine whole, first, second;
    char path[512];
    snprintf(path, sizeof path, "%s/state.bin", test_folder());
    busy_scene(&whole);
    whole.options.integrator = methods[m];
    test_run(&whole);
    test_advance(&whole, 2);
    busy_scene(&first);
    first.options.integrator = methods[m];
    test_run(&first);
    test_advance(&first, 1);
    assert_int_equal(hk_run_save(first.run, path, &first.error), HK_OK);
    busy_scene(&second);
    second.options.integrator = methods[m];
    second.scene->start_file = strdup(path);
    test_run(&second);
    test_advance(&second, 2);
    const hk_view *a = hk_run_view(whole.run), *b = hk_run_view(second.run);
    assert_int_equal(a->n, b->n);
    assert_memory_equal(a->model->id, b->model->id, a->n * sizeof *a->model->id);
    assert_memory_equal(a->x, b->x, 3 * a->n * sizeof *a->x);
    assert_memory_equal(a->v, b->v, 3 * a->n * sizeof *a->v);
    assert_memory_equal(a->y, b->y, a->n * sizeof *a->y);
    test_engine_close(&whole);
    test_engine_close(&first);
    test_engine_close(&second);
  }
}

static void a_state_file_read_back_is_the_same_bits(void **state) {
  (void)state;
  test_engine e, again;
  char path[512];
  snprintf(path, sizeof path, "%s/state.csv", test_folder());
  test_engine_open(&e);
  test_particle(&e, 0.1, 0.2, 0.3, 1.0 / 3);
  test_particle(&e, 1, 0, 0, 2);
  spring(&e, 1, 2);
  e.scene->particles.position[0] = -0.7;
  test_run(&e);
  test_advance(&e, 0.5);
  assert_int_equal(hk_run_write_state(e.run, path, &e.error), HK_OK);
  test_engine_open(&again);
  test_particle(&again, 0, 0, 0, 1);
  test_particle(&again, 1, 0, 0, 2);
  spring(&again, 1, 2);
  again.scene->start_file = strdup(path);
  test_run(&again);
  assert_memory_equal(hk_run_view(e.run)->x, hk_run_view(again.run)->x, 6 * sizeof(double));
  assert_memory_equal(hk_run_view(e.run)->v, hk_run_view(again.run)->v, 6 * sizeof(double));
  assert_true(hk_run_view(again.run)->model->mass[0] == 1.0 / 3);
  assert_true(hk_run_view(again.run)->model->element_list[0].elements.rest.value[0] ==
              1); /* of the scene, not the file */
  test_engine_close(&e);
  test_engine_close(&again);
}

static void a_bad_state_file_is_refused(void **state) {
  (void)state;
  const char *const texts[] = {"id,x,y,z,vx,vy,vz,mass\n1,0,0\n", "hello\n",
                               "id,x,y,z,vx,vy,vz,mass\n9,0,0,0,0,0,0,1\n",
                               "id,x,y,z,vx,vy,vz,mass\n1,nan,0,0,0,0,0,1\n", "hooke checkpoint 1\n"};
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    test_engine e;
    test_engine_open(&e);
    test_particle(&e, 0, 0, 0, 1);
    e.scene->start_file = strdup(test_write("bad.csv", texts[k]));
    assert_int_not_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_OK);
    assert_non_null(strstr(e.error.text, "bad.csv"));
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(fixed_particles_do_not_move_by_a_bit),     cmocka_unit_test(beads_keep_to_their_line_and_plane),
      cmocka_unit_test(moving_pins_are_exact_and_keep_the_order), cmocka_unit_test(a_release_happens_on_its_instant),
      cmocka_unit_test(a_force_acts_from_and_to_its_instants),    cmocka_unit_test(hooks_run_in_their_order),
      cmocka_unit_test(a_channel_follows_its_plugin_rate),        cmocka_unit_test(a_checkpoint_goes_on_bit_by_bit),
      cmocka_unit_test(a_state_file_read_back_is_the_same_bits),  cmocka_unit_test(a_bad_state_file_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
