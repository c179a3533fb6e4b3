/* What core/plugin.h asks of every integrator: a failed step changes nothing, fields carry all that a step hands on, a
 * step ends where it should, and costs the evaluations it states. */
#include "tests/support/fake_system.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { N = 3, WIDTH = 2, MOST = 2000, WARM = 7 };
static const double h = 0.05;

static void springs(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                    double *dy) {
  (void)context, (void)y, (void)v;
  for (size_t e = 0; e < 3 * N; e++) a[e] = -sin(x[e]) - 0.3 * x[(e + 3) % (3 * N)] + 0.1 * cos(t);
  for (size_t k = 0; k < N * WIDTH; k++) dy[k] = x[k] - 0.5;
  dy[N * WIDTH] = x[0];
}

static const fake_problem problem = {N, WIDTH, HK_DEPENDS_ON_X | HK_DEPENDS_ON_T, springs, NULL};

static fake_system *ready(void) {
  fake_system *f = fake_system_create(&problem);
  for (size_t e = 0; e < f->system.size; e++) f->system.X[e] = sin((double)e);
  f->system.tol = 1e30; /* adaptive methods take the step they are given */
  return f;
}

/* Implicit methods are solved to 1e-13, so that what is left of their factors and guesses shows below 1e-11 only;
 * explicit ones leave rounding, x being of order 1. */
static double slack(const fake_method *m) { return fake_method_implicit(m) ? 1e-11 : 1e-14; }

static fake_method open_method(const char *name, fake_system *f) {
  fake_method m = fake_method_open(name, f);
  fake_method_set(&m, "tolerance", 1e-13);
  return m;
}

static double apart(const fake_system *a, const fake_system *b) {
  double most = 0;
  for (size_t e = 0; e < a->system.size; e++) most = fmax(most, fabs(a->system.X[e] - b->system.X[e]));
  return most;
}

typedef void visit(const char *name);

static void for_all(visit *each) {
  const char *names[FAKE_METHODS];
  size_t count = fake_integrator_names(names);
  for (size_t k = 0; k < count; k++) {
    fake_system *f = ready();
    fake_method m = fake_method_open(names[k], f);
    bool fits = fake_method_explicit(&m) || fake_method_implicit(&m);
    fake_method_close(&m);
    fake_system_destroy(f);
    if (fits) each(names[k]);
  }
}

static void for_all_explicit(visit *each) {
  const char *names[FAKE_METHODS];
  size_t count = fake_integrator_names(names);
  for (size_t k = 0; k < count; k++) {
    fake_system *f = ready();
    fake_method m = fake_method_open(names[k], f);
    bool fits = fake_method_explicit(&m);
    fake_method_close(&m);
    fake_system_destroy(f);
    if (fits) each(names[k]);
  }
}

/* One step after `warm` good ones with its k-th evaluation failing; afterwards the step must go as if nothing had been.
 * Returns whether there was a k-th evaluation. */
static bool fails_cleanly(const char *name, size_t warm, size_t k, hk_status with) {
  fake_system *f = ready(), *twin = ready();
  fake_method m = open_method(name, f), other = open_method(name, twin);
  size_t bytes = f->system.size * sizeof(double);
  double *before = malloc(bytes);
  assert_non_null(before);
  for (size_t i = 0; i < warm; i++) {
    assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
    assert_int_equal(fake_method_step(&other, h, NULL), HK_OK);
  }
  assert_int_equal(fake_method_step(&other, h, NULL), HK_OK);
  memcpy(before, f->system.X, bytes);
  fake_system_fail(f, k, with);
  hk_status status = fake_method_step(&m, h, NULL);
  if (status != HK_OK) {
    if (status != with) fail_msg("%s, evaluation %zu: status %d, not %d", name, k, (int)status, (int)with);
    if (memcmp(before, f->system.X, bytes) != 0) fail_msg("%s changes X when evaluation %zu fails", name, k);
    assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
    if (!(apart(f, twin) < slack(&m))) fail_msg("%s: evaluation %zu leaves a trace", name, k);
  }
  free(before);
  fake_method_close(&m);
  fake_method_close(&other);
  fake_system_destroy(f);
  fake_system_destroy(twin);
  return status != HK_OK;
}

static void failure_at_any_evaluation(const char *name) {
  for (size_t warm = 0; warm <= WARM; warm += WARM) {
    size_t k = 1;
    while (fails_cleanly(name, warm, k, HK_FAILED)) k++;
    assert_true(k > 1 && k < 100);
  }
}

static void failed_step_leaves_x_as_it_was(void **state) {
  (void)state;
  for_all(failure_at_any_evaluation);
}

static void stated_evaluations(const char *name) {
  fake_system *f = ready();
  fake_method m = fake_method_open(name, f);
  for (size_t i = 0; i < WARM; i++) assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
  f->evaluations = 0;
  for (size_t i = 0; i < 10; i++) assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
  if (f->evaluations != 10 * (size_t)m.plugin->integrator->stages)
    fail_msg("%s: %zu evaluations in 10 steps", name, f->evaluations);
  fake_method_close(&m);
  fake_system_destroy(f);
}

static void step_costs_the_stated_evaluations(void **state) {
  (void)state;
  for_all_explicit(stated_evaluations);
}

/* A second instance that receives X and the fields goes on bit by bit like the first. */
static void continued(const char *name, size_t warm) {
  fake_system *f = ready(), *g = ready();
  fake_method m = open_method(name, f), copy = open_method(name, g);
  double *from[MOST], *to[MOST];
  char numbers[256];
  for (size_t i = 0; i < warm; i++) assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
  size_t count = fake_method_memory(&m, from, MOST);
  assert_true(count < MOST && count == fake_method_memory(&copy, to, MOST));
  for (size_t e = 0; e < count; e++) *to[e] = *from[e];
  fake_method_save(&m, numbers);
  fake_method_load(&copy, numbers);
  g->system.t = f->system.t;
  for (size_t i = 0; i < 9; i++) {
    assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
    assert_int_equal(fake_method_step(&copy, h, NULL), HK_OK);
  }
  bool same = memcmp(f->system.X, g->system.X, f->system.size * sizeof(double)) == 0;
  if (fake_method_implicit(&m) ? !(apart(f, g) < slack(&m)) : !same) /* factors are not in fields */
    fail_msg("%s: fields do not carry the run after %zu steps", name, warm);
  fake_method_close(&m);
  fake_method_close(&copy);
  fake_system_destroy(f);
  fake_system_destroy(g);
}

static void continued_anywhere(const char *name) {
  for (size_t warm = 1; warm < WARM; warm++) continued(name, warm);
}

static void fields_carry_a_run_across_a_checkpoint(void **state) {
  (void)state;
  for_all(continued_anywhere);
}

/* X is moved by hand: with reset, a step must be the same as that of a fresh instance, up to rounding. */
static void forgets(const char *name) {
  fake_system *f = ready(), *g = ready();
  fake_method m = open_method(name, f), fresh = open_method(name, g);
  for (size_t i = 0; i < WARM; i++) assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
  for (size_t e = 0; e < f->system.size; e++) f->system.X[e] = g->system.X[e] = cos((double)e);
  g->system.t = f->system.t;
  if (m.plugin->integrator->reset) m.plugin->integrator->reset(m.self, HK_STATE_CHANGED);
  for (size_t i = 0; i < 6; i++) {
    assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
    assert_int_equal(fake_method_step(&fresh, h, NULL), HK_OK);
  }
  if (!(apart(f, g) < slack(&m))) fail_msg("%s remembers what reset made void", name);
  fake_method_close(&m);
  fake_method_close(&fresh);
  fake_system_destroy(f);
  fake_system_destroy(g);
}

static void reset_voids_the_history(void **state) {
  (void)state;
  for_all(forgets);
}

static void table_is_complete(const char *name) {
  fake_system *f = ready();
  fake_method m = fake_method_open(name, f);
  const hk_plugin *p = m.plugin;
  assert_int_equal(p->abi, HK_ABI);
  if (!p->summary || !*p->summary || strchr(p->summary, '\n') || !p->reference)
    fail_msg("%s: no summary of one line, or no reference", name);
  assert_true(p->integrator->order > 0 && p->integrator->stages > 0 && p->integrator->step);
  fake_method_close(&m);
  fake_system_destroy(f);
}

static void descriptions_are_complete(void **state) {
  (void)state;
  for_all(table_is_complete);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(failed_step_leaves_x_as_it_was),
      cmocka_unit_test(step_costs_the_stated_evaluations),
      cmocka_unit_test(fields_carry_a_run_across_a_checkpoint),
      cmocka_unit_test(reset_voids_the_history),
      cmocka_unit_test(descriptions_are_complete),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
