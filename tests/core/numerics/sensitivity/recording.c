/* What cannot be differentiated is refused in one sentence, and what the states take is known before. */
#include "tests/support/varied_scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

/* Opens a scene of two particles, on a spring and beside, and one more thing of it; fails where it is not refused. */
static void refused(void (*add)(test_engine *), const char *integrator, const char *text) {
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 1, 0, 0, 1);
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
  test_edges(&e, springs, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, springs, "k", 50);
  if (add) add(&e);
  e.options.integrator = integrator;
  e.options.dt = 1e-3;
  test_run(&e);
  hk_sensitivity *s = NULL;
  hk_error error = {0};
  if (hk_sensitivity_open(&e.run->loop, &s, &error) != HK_FAILED) fail_msg("not refused: %s", text);
  if (!strstr(error.text, text)) fail_msg("'%s' is not in: %s", text, error.text);
  hk_sensitivity_close(s);
  test_engine_close(&e);
}

static void bar(test_engine *e) {
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "bars"), (const uint32_t[][2]){{1, 2}}, 1);
}

static void cable(test_engine *e) {
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "cables"), (const uint32_t[][2]){{1, 2}}, 1);
}

static void floor_below(test_engine *e) {
  hk_plugin_spec *floor = test_plugin(e, HK_CORRECTOR, "obstacle");
  test_text(e, floor, "shape", "plane");
}

static void iterative(test_engine *e) { test_plugin(e, HK_SOLVER, "pcg"); }

static void rider(test_engine *e) {
  hk_rider r = {.particle = test_particle(e, 0.5, 0, 0, 0), .carriers = 2, .carrier = {1, 2}};
  r.weight[0] = r.weight[1] = 0.5;
  assert_int_equal(hk_scene_add_rider(e->scene, &r, &e->error), HK_OK);
}

static void ending(test_engine *e) { e->scene->plugin[HK_FORCE].item[0]->to = 0.5; }

static void plastic(test_engine *e) {
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "plastic_springs");
  test_edges(e, springs, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(e, springs, "k", 50);
  test_number(e, springs, "yield", 0.1);
}

static void released(test_engine *e) {
  uint32_t id = 1;
  const hk_pin_spec spec = {.kind = HK_PIN_FIXED, .count = 1, .id = &id, .release = 0.2};
  assert_int_equal(hk_scene_add_pin(e->scene, &spec, &e->error), HK_OK);
}

static void what_is_not_differentiated_is_refused(void **state) {
  (void)state;
  refused(NULL, "dopri5", "integrator 'dopri5' does not state its step as stages (stages/1)");
  refused(bar, "linear_bdf2", "integrator 'linear_bdf2'");
  refused(iterative, "linear_bdf2",
          "the linear steps of 'linear_bdf2' are not differentiated with an iterative solver");
  refused(rider, "linear_bdf2", "the linear steps of 'linear_bdf2' are not differentiated with particles that ride");
  refused(bar, "rk4", "integrator 'rk4' brings the state back onto constraints by an iteration that is not");
  refused(cable, "leapfrog", "constraint 'cables' acts on one side only, and its begin and end are not differentiated");
  refused(floor_below, "leapfrog", "corrector 'obstacle' acts on the steps");
  refused(ending, "leapfrog", "force 'springs' begins or ends at a time");
  refused(plastic, "leapfrog", "force 'plastic_springs' remembers what happened");
  refused(released, "leapfrog", "a pin is released at t = 0.2 s");
}

/* Of a long run sqrt N states, and the points of the sqrt N steps between two of them, 9 numbers a particle and stage
 * each; of a short one all points. */
static void memory_grows_with_the_root_of_the_steps(void **state) {
  (void)state;
  double few = hk_sensitivity_bytes(10000, 2 * 9000, 9000), many = hk_sensitivity_bytes(1000000, 2 * 9000, 9000);
  assert_true(fabs(few - 300 * 9 * 1000 * 8.0) < 1);
  assert_true(many < 10.1 * few);
  assert_true(fabs(hk_sensitivity_bytes(100, 4 * 90, 90) - (9 * 10 + 100 * 4 * 9 * 10) * 8.0) < 1);
}

static void braked(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_particle(e, 0, 0, 0, 1);
  e->scene->particles.velocity[0] = p[3];
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 60);
}

/* Of one particle that comes to rest the last speed is e^-60 of the first, and its place is the origin of all others:
 * its way is its size, and rounding is a part of that. */
static void a_particle_at_rest_is_where_it_was(void **state) {
  (void)state;
  varied_runs r;
  varied_open(&r, braked, "bdf2", (double[]){1, 1, 1, 1}, 0, 5e-3);
  varied_run(&r, 1);
  assert_true(r.s->off < 1e-12);
  varied_close(&r);
}

/* Hooks of the run are called as before, and are its own again afterwards. */
static void the_run_keeps_its_hooks(void **state) {
  (void)state;
  varied_runs r;
  varied_open(&r, varied_tetrahedron, "leapfrog", (double[]){50, 0.7, 2, 0.3}, 0, 2e-3);
  size_t frames = r.base.run->record.frames;
  hk_loop_hooks hooks = r.s->hooks;
  varied_run(&r, 0.4);
  assert_true(r.base.run->record.frames > frames);
  assert_memory_equal(&hooks, &r.base.run->loop.hooks, sizeof hooks);
  varied_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_not_differentiated_is_refused),
      cmocka_unit_test(memory_grows_with_the_root_of_the_steps),
      cmocka_unit_test(a_particle_at_rest_is_where_it_was),
      cmocka_unit_test(the_run_keeps_its_hooks),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
