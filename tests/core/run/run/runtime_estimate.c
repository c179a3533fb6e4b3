/* core/run/run/runtime_estimate.c: how long a run takes is known before its first step, where that is long, and the
 * run's bits are those of a run that was not foretold. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { N = 1000 }; /* so that a step takes several microseconds on any machine, and the runs minutes */

/* A chain that hangs at one end, under gravity that changes in time. */
static hk_status swaying(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                         size_t max_out, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  for (int c = 0; c < 3; c++) out[c] = c ? 0 : sin(in[0]);
  *n_out = 3;
  return HK_OK;
}

static void chain(test_engine *e, const char *method, double duration, double dt) {
  uint32_t edge[N - 1][2];
  test_engine_open(e);
  for (int k = 0; k < N; k++) test_particle(e, 0.01 * k, 0, 0, 0.01);
  for (uint32_t k = 0; k + 1 < N; k++) edge[k][0] = k + 1, edge[k][1] = k + 2;
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_function(e, test_plugin(e, HK_FORCE, "gravity"), "g", (hk_function){.call = swaying});
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, N - 1);
  test_number(e, springs, "k", 100);
  test_plugin(e, HK_INTEGRATOR, method);
  e->scene->duration = duration;
  e->scene->fps = 100;
  e->scene->threads = 1;
  e->scene->dt = dt;
  e->options.progress = 1;
  e->options.no_output = true;
  test_run(e);
}

typedef struct reopening {
  hk_scene *scene;
  int opened;
} reopening;

static hk_status open_again(void *context, const hk_run_options *options, hk_run **again, hk_error *error) {
  reopening *second = context;
  second->opened++;
  return hk_run_open(second->scene, options, again, error);
}

static void close_again(void *context, hk_run *again) {
  (void)context;
  hk_run_destroy(again);
}

/* Returns how often the scene was opened again; *said: s, what was said, 0: nothing. */
static int foretell(test_engine *e, double *said) {
  reopening second = {.scene = e->scene};
  hk_scene_loader loader = {open_again, close_again, &second};
  hk_runtime_estimate(&loader, &e->options, e->run);
  *said = e->run->progress.expected;
  return second.opened;
}

static double whole_time(const test_engine *e) {
  const hk_loop *loop = &e->run->loop;
  return loop->seconds * e->scene->duration / loop->state->t;
}

static void a_long_run_is_foretold_and_not_changed(void **state) {
  static const struct {
    const char *method;
    double duration, dt;
  } runs[] = {{"leapfrog", 900, 1e-4}, {"rk4", 900, 1e-4}, {"bdf2", 1e4, 1e-2}, {"dopri5", 1e5, NAN}};
  (void)state;
  for (size_t k = 0; k < sizeof runs / sizeof *runs; k++) {
    test_engine foretold, other;
    double said;
    chain(&foretold, runs[k].method, runs[k].duration, runs[k].dt);
    chain(&other, runs[k].method, runs[k].duration, runs[k].dt);
    int opened = foretell(&foretold, &said);
    if (opened != 1 || !(said > 10)) fail_msg("%s: tried %d times, %g s were foretold", runs[k].method, opened, said);
    test_advance(&foretold, 0.5);
    test_advance(&other, 0.5);
    double shown = whole_time(&other);
    bool adaptive = isnan(runs[k].dt);                          /* its steps become other ones when the chain swings */
    if (!adaptive && !(said > shown / 30 && said < 30 * shown)) /* others may have the processor for all of the trial */
      fail_msg("%s: %g s were foretold, and its steps take %g s", runs[k].method, said, shown);
    assert_int_equal(foretold.run->record.steps, other.run->record.steps);
    assert_memory_equal(foretold.run->state.X, other.run->state.X, other.run->state.size * sizeof(double));
    test_engine_close(&foretold);
    test_engine_close(&other);
  }
}

static void a_short_run_is_not_tried(void **state) {
  static const char *const methods[] = {"leapfrog", "bdf2", "dopri5"};
  (void)state;
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    test_engine e;
    double said;
    chain(&e, methods[k], 0.05, NAN);
    assert_int_equal(foretell(&e, &said), 0);
    assert_true(said == 0);
    test_engine_close(&e);
  }
}

static void a_quiet_run_is_not_tried(void **state) {
  test_engine e;
  double said;
  (void)state;
  chain(&e, "leapfrog", 900, 1e-4);
  e.options.progress = 0;
  assert_int_equal(foretell(&e, &said), 0);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_long_run_is_foretold_and_not_changed),
      cmocka_unit_test(a_short_run_is_not_tried),
      cmocka_unit_test(a_quiet_run_is_not_tried),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
