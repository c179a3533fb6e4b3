/* Surveys of the foretold largest stable step against the truth, for random scenes and every explicit method: springs
 * stretched, at rest or pressed, drag, magnetic fields and pulls, masses over two decades.
 *
 * The truth is that of the scene's linear equations at the start, K and D by differences of its accelerations, and of
 * the plugin's own step on them: the spectral radius of its matrix (tests/support/linear_scene.h). */
#ifndef HK_TEST_FORETOLD_H
#define HK_TEST_FORETOLD_H

#include "core/numerics/stability/stability.h"
#include "tests/support/linear_scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = 4, SCENES = 16, METHODS = FAKE_METHODS };

static uint64_t state_of_random;

/* splitmix64 (Steele, Lea and Flood 2014), in [0, 1). */
static inline double uniform(void) {
  uint64_t z = state_of_random += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

static inline double between(double low, double high) { return low + (high - low) * uniform(); }
static inline double decades(double low, double high) { return low * pow(high / low, uniform()); }

/* ---- the scenes ---- */

typedef enum ingredient { SPRINGS = 1, DAMPING = 2, DRAG = 4, MAGNETIC = 8, CENTRAL = 16, BENDING = 32 } ingredient;

static inline void add_springs(test_engine *e, size_t n, unsigned with) {
  uint32_t pair[MOST * MOST][2];
  double rest[MOST * MOST];
  size_t count = 0;
  double k = decades(1, 1e4), stretch = with & CENTRAL ? 1 : between(0.9, 1.6);
  for (uint32_t i = 1; i <= n; i++)
    for (uint32_t j = i + 1; j <= n; j++)
      if (j == i + 1 || uniform() < 0.4) {
        const double *a = e->scene->particles.position + 3 * (i - 1), *b = e->scene->particles.position + 3 * (j - 1);
        pair[count][0] = i, pair[count][1] = j;
        rest[count++] =
            sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2])) /
            stretch;
      }
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])pair, count);
  test_number(e, springs, "k", k);
  test_list(e, springs, "rest", rest, count);
  if (with & DAMPING) test_number(e, springs, "damping", k * decades(1e-4, 1e-2));
}

/* Joints without damping between springs that have some. */
static inline void add_joints(test_engine *e, size_t n) {
  uint32_t joint[3 * MOST];
  size_t count = 0;
  for (uint32_t i = 1; i + 2 <= n; i++)
    for (uint32_t corner = 0; corner < 3; corner++) joint[count++] = i + corner;
  hk_plugin_spec *joints = test_plugin(e, HK_FORCE, "angle_springs");
  test_tuples(e, joints, "joints", 3, joint, count / 3);
  test_number(e, joints, "k", decades(0.1, 10));
}

static inline void add_field(test_engine *e) {
  hk_plugin_spec *field = test_plugin(e, HK_FORCE, "magnetic");
  test_vector(e, field, "B", between(-1, 1), between(-1, 1), between(-1, 1));
  test_number(e, field, uniform() < 0.5 ? "charge" : "ratio", decades(0.1, 100));
}

static inline void build(test_engine *e, unsigned with) {
  size_t n = 2 + (size_t)(uniform() * (MOST - 1));
  test_engine_open(e);
  for (size_t i = 0; i < n; i++) test_particle(e, between(-1, 1), between(-1, 1), between(-1, 1), decades(0.1, 10));
  if (with & SPRINGS) add_springs(e, n, with);
  if (with & BENDING && n > 2) add_joints(e, n);
  if (with & DRAG) test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", decades(0.1, 100));
  if (with & MAGNETIC) add_field(e);
  if (with & CENTRAL) test_number(e, test_plugin(e, HK_FORCE, "central"), "strength", decades(1, 1e4));
  test_plugin(e, HK_INTEGRATOR, "rk4");
  test_run(e);
}

/* ---- all of them ---- */

static inline int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

typedef struct tally {
  size_t count, none;
  double ratio[SCENES];
} tally;

static inline void add_ratio(tally *t, const char *name, const hk_stable *s, linear_scene *q) {
  double h = s->limit > 0 ? s->limit : s->suggestion;
  if (s->limit == 0) {
    t->none++;
    return;
  }
  if (!isfinite(h) || !linear_scene_rests(q)) return; /* an unstable rest has no limit */
  double ratio = linear_scene_ratio(name, q, h);
  t->ratio[t->count++] = ratio;
}

static inline void take_scene(unsigned with, tally *of) {
  test_engine e;
  const char *names[FAKE_METHODS];
  hk_spectrum spectrum;
  size_t count = fake_integrator_names(names);
  build(&e, with);
  linear_scene q = linear_scene_of(&e);
  assert_int_equal(hk_spectrum_estimate(&e.run->dynamics.system, &spectrum, &e.error), HK_OK);
  for (size_t k = 0; k < count; k++) {
    fake_method m = linear_scene_open(names[k], &q, 1);
    bool fits = fake_method_explicit(&m) && !(m.plugin->integrator->flags & HK_ADAPTIVE);
    hk_stable s = {0};
    if (fits) s = hk_stable_step(m.plugin->integrator, m.self, &spectrum);
    linear_scene_close(&m);
    if (fits) add_ratio(&of[k], names[k], &s, &q);
  }
  test_engine_close(&e);
}

/* *least: the least median of foretold over true of a method. */
static inline void judge(const char *name, tally *t, double least) {
  qsort(t->ratio, t->count, sizeof *t->ratio, by_value);
  print_message("  %-18s %2zu without a stable step; %2zu foretold over true: ", name, t->none, t->count);
  if (t->count == 0) {
    print_message("-\n");
    return;
  }
  double median = t->ratio[t->count / 2];
  print_message("%.3f to %.3f, median %.3f\n", t->ratio[0], t->ratio[t->count - 1], median);
  if (t->ratio[t->count - 1] > 1 + LINEAR_PRECISION) fail_msg("%s is foretold a step above the true limit", name);
  if (median < least) fail_msg("%s is foretold too short a step", name);
}

/* Three methods grow in narrow bands of h w near pi, of which the lower end is foretold: scenes without damping, of
 * which none of the few modes lies in the band, could go on to 5.63, 5.99 and 5.03. */
static inline double least_median(const char *name, const char *sharp) {
  if (sharp && !strstr(sharp, name)) return 0;
  if (strcmp(name, "kahan_li8") == 0 || strcmp(name, "wisdom_holman") == 0) return 0.5;
  return strcmp(name, "blanes_moan") == 0 ? 0.6 : 0.8;
}

static tally all[METHODS]; /* of the last survey */

static inline const tally *tally_of(const char *name) {
  const char *names[FAKE_METHODS];
  for (size_t k = 0; k < fake_integrator_names(names); k++)
    if (strcmp(names[k], name) == 0) return &all[k];
  fail_msg("there is no method %s", name);
  return NULL;
}

/* `sharp`: the methods for which the median of foretold over true is to be at least 0.8; NULL: all. */
static inline void survey(unsigned with, const char *sharp) {
  const char *names[FAKE_METHODS];
  size_t count = fake_integrator_names(names);
  assert_true(count <= METHODS);
  memset(all, 0, sizeof all);
  for (unsigned k = 0; k < SCENES; k++) {
    state_of_random = (uint64_t)with << 32 | k; /* the same scenes for any number of methods */
    take_scene(with, all);
  }
  for (size_t k = 0; k < count; k++)
    if (all[k].count + all[k].none > 0) judge(names[k], &all[k], least_median(names[k], sharp));
}

#endif
