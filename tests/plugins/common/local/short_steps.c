/* The short steps of components of any shape, in lanes and in arrays, against the rule of local_filter.h written down
 * spring by spring. */
#include "plugins/common/local/short_steps.h"
#include "tests/support/fake_system.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = 400, EDGES = 2 * MOST };

typedef struct scene {
  size_t n;
  uint32_t pair[EDGES][2];
  double values[3 * EDGES]; /* k, c, L */
  hk_stiff_edges edges;
  fake_system *f;
} scene;

static uint64_t state_of_random = 7;

/* splitmix64 (Steele, Lea and Flood 2014), in [0, 1). */
static double uniform(void) {
  uint64_t z = state_of_random += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

static double length(const scene *s, size_t i, size_t j) {
  double l2 = 0;
  for (size_t c = 0; c < 3; c++) l2 += pow(s->f->system.X[3 * i + c] - s->f->system.X[3 * j + c], 2);
  return sqrt(l2);
}

static void spring(scene *s, uint32_t i, uint32_t j) {
  size_t e = s->edges.count++;
  s->pair[e][0] = i, s->pair[e][1] = j;
  s->edges.k[e] = pow(10, 3 + 2 * uniform());
  s->edges.L[e] = e % 5 ? 0.5 * uniform() * length(s, i, j) : 0; /* stretched, as compressed springs buckle */
}

/* A component of `size` particles in a random order of their own: a random tree, with some springs more. */
static void component(scene *s, const uint32_t *particle, size_t size) {
  for (size_t i = 1; i < size; i++) spring(s, particle[i], particle[(size_t)(uniform() * (double)i)]);
  for (size_t more = 0; more < size / 3; more++) {
    size_t i = (size_t)(uniform() * (double)size), j = (size_t)(uniform() * (double)size);
    if (i != j) spring(s, particle[i], particle[j]);
  }
}

static void shuffle(uint32_t *list, size_t count) {
  for (size_t i = count; i > 1; i--) {
    size_t j = (size_t)(uniform() * (double)i);
    uint32_t kept = list[i - 1];
    list[i - 1] = list[j], list[j] = kept;
  }
}

static bool slides(size_t i) { return i % 40 == 7; }

/* Some particles cannot move along x. */
static void filter(hk_system *system, double *vector) {
  for (size_t i = 0; i < system->n; i++)
    if (slides(i)) vector[3 * i] = 0;
}

/* Components of 2 to 30 particles, most of them small, between particles without stiff springs. */
static void open_scene(scene *s) {
  uint32_t order[MOST];
  memset(s, 0, sizeof *s);
  s->n = MOST;
  s->edges.pair = s->pair;
  s->edges.k = s->values, s->edges.c = s->values + EDGES, s->edges.L = s->values + 2 * EDGES;
  s->f = fake_system_create(&(fake_problem){.n = s->n});
  s->f->system.filter = filter;
  for (size_t c = 0; c < 3 * s->n; c++) s->f->system.X[c] = uniform();
  for (uint32_t i = 0; i < s->n; i++) {
    order[i] = i;
    s->f->mass[i] = i % 11 == 0 ? 0 : 0.5 + uniform(); /* what the model has as the inverse mass */
    if (slides(i)) s->f->pin[i] = HK_PIN_PLANE;
  }
  shuffle(order, s->n);
  for (size_t at = 0, size; at + 30 < s->n; at += size + 1) {
    size = uniform() < 0.6 ? 2 : uniform() < 0.9 ? 3 + (size_t)(6 * uniform()) : 9 + (size_t)(20 * uniform());
    component(s, order + at, size);
  }
  s->edges.stiffest = 1e6; /* sets the scale of the parts alone */
}

static void add_forces(scene *s, const double *x, const double *d, double *F) {
  memset(F, 0, 3 * s->n * sizeof *F);
  for (size_t e = 0; e < s->edges.count; e++) {
    size_t i = s->pair[e][0], j = s->pair[e][1];
    double u[3], l2 = 0;
    for (size_t c = 0; c < 3; c++) {
      u[c] = x[3 * j + c] + d[3 * j + c] - x[3 * i + c] - d[3 * i + c];
      l2 += u[c] * u[c];
    }
    for (size_t c = 0; c < 3; c++) {
      double f = s->edges.k[e] * (1 - s->edges.L[e] / sqrt(l2)) * u[c];
      F[3 * i + c] += f, F[3 * j + c] -= f;
    }
  }
  filter(&s->f->system, F);
}

/* Displacements of all particles by p short steps, with T_k as cosh(k s/p). */
static void take_plainly(scene *s, const double *a, double h, int p, double *d) {
  static double at_rest[3 * MOST], F[3 * MOST], before[3 * MOST];
  const double *x = s->f->system.X, *w = s->f->model.inverse_mass, turn = hk_local_damping / p;
  memset(d, 0, 3 * s->n * sizeof *d);
  add_forces(s, x, d, at_rest);
  for (int k = 0; k < p; k++) {
    double g = 2 * h * h / hk_local_omega(p) * cosh(k * turn) / cosh((k + 1) * turn);
    double f = cosh((k - 1) * turn) / cosh((k + 1) * turn);
    add_forces(s, x, d, F);
    for (size_t c = 0; c < 3 * s->n; c++) {
      double now = d[c], acceleration = a[c] + w[c / 3] * (F[c] - at_rest[c]);
      d[c] += k == 0 ? g / 2 * acceleration : f * (now - before[c]) + g * acceleration;
      before[c] = now;
    }
  }
}

static void close_scene(scene *s) { fake_system_destroy(s->f); }

/* Each component has its own number of short steps, of which `built` tells: particles of other numbers are not
 * compared. Rounding: forces of 1e5 N at places rounded to 1e-16 m, 1e-11 m/s^2, move by 2e-15 m in 0.02 s. */
static void compare(scene *s, const hk_short_steps *built, const double *a, const double *result, double h) {
  static double d[3 * MOST];
  for (size_t k = 0; k < built->lanes.batches; k++) {
    const hk_short_batch *b = &built->lanes.batch[k];
    take_plainly(s, a, h, b->rule.count, d);
    for (size_t i = 0; i < b->shape.n; i++)
      for (size_t lane = 0; lane < b->filled; lane++)
        for (size_t c = 0; c < 3; c++) {
          size_t at = 3 * (size_t)b->index[i][lane] + c;
          double error = fabs(result[at] * h * h / 2 - d[at]);
          if (!(error < 2e-14))
            fail_msg("particle %zu of shape of %d: off by %g m of %g", at / 3, b->shape.n, error, d[at]);
        }
  }
  for (size_t k = 0; k < built->parts; k++) {
    const hk_short_part *part = &built->part[k];
    if (part->n == 0) continue;
    take_plainly(s, a, h, hk_local_rule_of(part->stiffest, h).count, d);
    for (size_t i = part->begin; i < part->begin + part->n; i++)
      for (size_t c = 0; c < 3; c++) {
        size_t at = 3 * (size_t)built->index[i] + c;
        assert_true(fabs(result[at] * h * h / 2 - d[at]) < 2e-14);
      }
  }
}

static void components_move_by_the_rule(void **state) {
  static double a[3 * MOST], result[3 * MOST], v[3 * MOST];
  static scene s;
  hk_short_steps built = {0};
  const double h = 0.02;
  size_t lanes = 0, large = 0;
  (void)state;
  open_scene(&s);
  assert_int_equal(hk_short_steps_build(&built, &s.f->system, &s.edges, s.f->system.spare), HK_OK);
  for (size_t c = 0; c < 3 * s.n; c++) a[c] = uniform() - 0.5, v[c] = 0;
  for (size_t i = 0; i < s.n; i++)
    for (size_t c = 0; c < 3; c++) a[3 * i + c] *= s.f->mass[i];
  filter(&s.f->system, a);
  memcpy(result, a, sizeof a);
  hk_short_steps_take(&built, &s.f->host, s.f->system.X, h, result, v);
  compare(&s, &built, a, result, h);
  for (size_t c = 0; c < 3 * s.n; c++) assert_float_equal(v[c], h / 2 * (result[c] - a[c]), 1e-15);
  for (size_t k = 0; k < built.lanes.batches; k++) lanes += built.lanes.batch[k].filled;
  for (size_t k = 0; k < built.parts; k++) large += built.part[k].n;
  if (!(lanes > 60 && large > 20)) fail_msg("%zu small components, %zu particles of large ones", lanes, large);
  hk_short_steps_free(&built, &s.f->host);
  close_scene(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(components_move_by_the_rule)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
