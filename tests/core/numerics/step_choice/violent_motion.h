/* The foretold largest stable step while a scene moves: it is lowered before it is passed. At every step of violent
 * motions the step is compared with the limit by a full estimate of that moment, which is at most the truth
 * (foretold.c). Each file that includes it says how many SEEDS it takes. */
#ifndef HK_TEST_VIOLENT_MOTION_H
#define HK_TEST_VIOLENT_MOTION_H

#include "core/numerics/step_choice/step_choice.h"
#include "core/numerics/stability/stability.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { LOOKS = 300, SIDE = 6 };

/* Of the steps, may be above the limit of their moment: those in which a scene under pressure bursts, within less than
 * an interval of the watch. Without it, half of them are in the collapsing sheet. */
static const double passed_part = 0.015;

static uint64_t state_of_random;

/* splitmix64 (Steele, Lea and Flood 2014), in [low, high). */
static double between(double low, double high) {
  uint64_t z = state_of_random += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return low + (high - low) * (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

static double decades(double low, double high) { return low * pow(high / low, between(0, 1)); }

static void place(test_engine *e, const double x[3], double speed, double mass) {
  uint32_t id;
  double v[3] = {speed * between(-1, 1), speed * between(-1, 1), speed * between(-1, 1)};
  assert_int_equal(hk_scene_add_particles(e->scene, 1, x, v, NULL, mass, 0, &id, &e->error), HK_OK);
}

/* A grid of edges, of particles that move at random up to `speed`; returns the number of edges. */
static size_t grid(test_engine *e, size_t n, double speed, uint32_t (*pair)[2], double *rest, double length) {
  size_t count = 0;
  for (size_t i = 0; i < n * n; i++)
    place(e, (double[]){0.1 * (double)(i % n) + between(-0.01, 0.01), 0.1 * (double)(i / n), between(-0.01, 0.01)},
          speed, decades(0.5, 2) * 0.01);
  for (uint32_t i = 0; i < n * n; i++) {
    if (i % n + 1 < n) pair[count][0] = i + 1, pair[count][1] = i + 2, rest[count++] = length;
    if (i + n < n * n) pair[count][0] = i + 1, pair[count][1] = i + 1 + (uint32_t)n, rest[count++] = length;
  }
  return count;
}

typedef void build(test_engine *e);

static hk_plugin_spec *on_grid(test_engine *e, const char *force, double speed, double length) {
  uint32_t pair[2 * SIDE * SIDE][2];
  double rest[2 * SIDE * SIDE];
  size_t count = grid(e, SIDE, speed, pair, rest, length);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, force);
  test_edges(e, spec, (const uint32_t(*)[2])pair, count);
  test_list(e, spec, "rest", rest, count);
  return spec;
}

static void collapsing_sheet(test_engine *e) { test_number(e, on_grid(e, "springs", 0.5, 0.1), "k", 1000); }

static void damped_sheet(test_engine *e) {
  hk_plugin_spec *springs = on_grid(e, "springs", 1, 0.1);
  test_number(e, springs, "k", 1000);
  test_number(e, springs, "damping", decades(0.1, 3));
}

static void pressed_sheet(test_engine *e) { test_number(e, on_grid(e, "springs", 0.1, between(0.1, 0.2)), "k", 1000); }

static void drawn_sheet(test_engine *e) { test_number(e, on_grid(e, "springs", 0.1, between(0.03, 0.1)), "k", 1000); }

static void hardening_sheet(test_engine *e) { test_number(e, on_grid(e, "cubic_springs", 0.3, 0.05), "k", 1e5); }

static void infall(test_engine *e) {
  for (int k = 0; k < 5; k++) place(e, (double[]){between(1, 2), between(-1, 1), 0}, 0.1, 1);
  hk_plugin_spec *pull = test_plugin(e, HK_FORCE, "central");
  test_number(e, pull, "strength", 1);
  test_number(e, pull, "power", -2);
  test_number(e, pull, "softening", 0.1);
}

static void tightening_ropes(test_engine *e) {
  hk_plugin_spec *ropes = on_grid(e, "ropes", 3, 0.12);
  test_number(e, ropes, "k", 1000);
  test_number(e, ropes, "damping", decades(0.03, 0.3));
}

static int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

typedef struct tally {
  double ratio[SEEDS * LOOKS];
  double beyond; /* largest step over the limit of its moment */
  size_t passed;
  size_t count, evaluations, estimates, measurements;
} tally;

static double fresh_limit(hk_run *run) {
  hk_spectrum s;
  hk_error error = {0};
  hk_counts kept = run->dynamics.count;
  assert_int_equal(hk_spectrum_estimate(&run->dynamics.system, &s, &error), HK_OK);
  run->dynamics.count = kept;
  return hk_stable_step(run->step->method, run->step->parameters, &s).limit;
}

static void follow(build *scene, const char *method, double dt, tally *t) {
  test_engine e;
  test_engine_open(&e);
  scene(&e);
  test_plugin(&e, HK_INTEGRATOR, method);
  e.options.dt = dt;
  e.scene->fps = 20;
  test_run(&e);
  double h = e.run->step->length.dt;
  for (int k = 1; k <= LOOKS; k++) {
    test_advance(&e, k * h);
    double fresh = fresh_limit(e.run), now = e.run->step->length.limit_now;
    if (fresh > 0 && isfinite(fresh) && isfinite(now)) {
      double part = e.run->loop.last_h / fresh;
      t->ratio[t->count++] = now / fresh;
      t->beyond = fmax(t->beyond, part);
      t->passed += part > 1;
    }
  }
  t->evaluations += e.run->dynamics.count.evaluations;
  t->estimates += e.run->step->estimates_cost;
  t->measurements += e.run->step->watch.measurements;
  test_engine_close(&e);
}

static void survey(const char *what, build *scene, double dt) {
  static const char *const methods[] = {"leapfrog", "rk4", "stoermer", "symplectic_euler"};
  static tally t;
  for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
    t.beyond = 0, t.passed = 0, t.count = t.evaluations = t.estimates = t.measurements = 0;
    state_of_random = 1;
    for (int k = 0; k < SEEDS; k++) follow(scene, methods[m], dt, &t);
    qsort(t.ratio, t.count, sizeof *t.ratio, by_value);
    print_message("%-18s %-18s foretold over present %.2f to %.2f, median %.2f; step over it at most %.2f; "
                  "%zu evaluations, %zu in estimates, %zu measurements\n",
                  what, methods[m], t.ratio[0], t.ratio[t.count - 1], t.ratio[t.count / 2], t.beyond, t.evaluations,
                  t.estimates, t.measurements);
    assert_true((double)t.passed <= passed_part * (double)t.count);
  }
}

static inline void limits_are_lowered_before_they_are_passed(void **state) {
  (void)state;
  survey("collapsing sheet", collapsing_sheet, NAN);
  survey("damped sheet", damped_sheet, NAN);
  survey("pressed sheet", pressed_sheet, NAN);
  survey("drawn sheet", drawn_sheet, NAN);
  survey("hardening sheet", hardening_sheet, NAN);
  survey("infall", infall, NAN);
  survey("tightening ropes", tightening_ropes, NAN);
}

#endif
