/* local_leapfrog on linear networks: springs of rest length 0, each force k (x_j - x_i), of two kinds. Its own step is
 * driven, and the growth read off its matrix (tests/support/step_matrix.h). */
#include "tests/support/fake_system.h"
#include "tests/support/step_matrix.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = 12, EDGES = 3 * MOST };

typedef struct network {
  size_t n, edges, stiff; /* the first `stiff` edges */
  uint32_t pair[EDGES][2];
  double k[EDGES], rest, drag; /* N/m; m; 1/s */
  double pull;                 /* 1/s^2, of every particle to 0 */
  hk_element_list list;
} network;

static uint64_t state_of_random;

/* splitmix64 (Steele, Lea and Flood 2014), in [0, 1). */
static double uniform(void) {
  uint64_t z = state_of_random += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

static void apply(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                  double *dy) {
  const network *w = context;
  (void)t, (void)y, (void)dy;
  for (size_t e = 0; e < w->edges; e++) {
    const double *xi = x + 3 * w->pair[e][0], *xj = x + 3 * w->pair[e][1];
    for (size_t c = 0; c < 3; c++) {
      a[3 * w->pair[e][0] + c] += w->k[e] * (xj[c] - xi[c]);
      a[3 * w->pair[e][1] + c] -= w->k[e] * (xj[c] - xi[c]);
    }
  }
  for (size_t c = 0; c < 3 * w->n; c++) a[c] -= w->pull * x[c] + w->drag * v[c];
}

static fake_system *system_of(network *w) {
  fake_system *f = fake_system_create(&(fake_problem){w->n, 0, HK_DEPENDS_ON_X | HK_DEPENDS_ON_V, apply, w});
  w->list = (hk_element_list){.force = "springs", .acts = true};
  w->list.elements = (hk_elements){.node = {w->edges, 2, &w->pair[0][0]}, .values = 1};
  w->list.elements.stiffness = (hk_per_tuple){w->edges, w->k};
  w->list.elements.rest = (hk_per_tuple){1, &w->rest};
  f->model.element_lists = 1;
  f->model.element_list = &w->list;
  return f;
}

static void join(network *w, uint32_t i, uint32_t j, double k) {
  w->pair[w->edges][0] = i;
  w->pair[w->edges][1] = j;
  w->k[w->edges++] = k;
}

/* Stiff springs on some of the particles, then soft ones on all. */
static network random_network(double ratio) {
  network w = {.n = 6 + (size_t)(uniform() * (MOST - 6))};
  size_t stiff = 1 + (size_t)(uniform() * 4);
  for (uint32_t i = 0; i < stiff; i++) join(&w, i, i + 1, ratio * (0.6 + 0.4 * uniform()));
  w.stiff = w.edges;
  for (uint32_t i = 0; i + 1 < w.n; i++) join(&w, i, i + 1, 0.5 + 0.5 * uniform());
  for (uint32_t i = 0; i + 2 < w.n; i++) join(&w, i, i + 2, uniform());
  return w;
}

/* The largest eigenvalue of the soft springs, by 2000 steps of power iteration: to some 1e-4, from below. */
static double softest(const network *w) {
  network soft = {.n = w->n, .edges = w->edges - w->stiff};
  memcpy(soft.pair, w->pair + w->stiff, soft.edges * sizeof *w->pair);
  memcpy(soft.k, w->k + w->stiff, soft.edges * sizeof *w->k);
  double x[3 * MOST], a[3 * MOST], length = 0;
  for (size_t c = 0; c < 3 * w->n; c++) x[c] = uniform() - 0.5;
  for (int k = 0; k < 2000; k++) {
    memset(a, 0, sizeof a);
    apply(&soft, 0, x, x, NULL, a, NULL);
    length = 0;
    for (size_t c = 0; c < 3 * w->n; c++) length += a[c] * a[c];
    length = sqrt(length);
    for (size_t c = 0; c < 3 * w->n; c++) x[c] = -a[c] / length;
  }
  return length;
}

static void scale(network *w, double by) {
  for (size_t e = 0; e < w->edges; e++) w->k[e] *= by;
}

/* Steps of 1 s at 0.999 of the limit that the method states. A pull of 1e-6 of the softest spring makes the modes
 * without stiffness, whose double roots rounding would split, distinct. */
static void no_step_below_the_stated_limit_grows(void **state) {
  (void)state;
  size_t local = 0;
  double worst = 0;
  for (int trial = 0; trial < 150; trial++) {
    network w = random_network(pow(10, 1 + 3 * uniform()));
    double limit = 4 * 0.8 / softest(&w);
    scale(&w, limit);
    w.pull = 1e-6;
    fake_system *f = system_of(&w);
    for (size_t c = 0; c < 6 * w.n; c++) f->system.X[c] = uniform() - 0.5;
    fake_method m = fake_method_open("local_leapfrog", f);
    assert_int_equal(m.plugin->integrator->divide(m.self, &f->system), HK_OK);
    local += f->system.aside != NULL;
    double growth = f->system.aside ? step_growth(&m) : 1;
    print_message("%d growth %g\n", trial, growth - 1);
    worst = fmax(worst, growth);
    fake_method_close(&m);
    fake_system_destroy(f);
  }
  print_message("local %zu worst %g\n", local, worst - 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(no_step_below_the_stated_limit_grows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
