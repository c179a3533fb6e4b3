/* The springs kernel beside the straightforward scalar loop, compiled with the same flags; and what a whole step costs
 * beside its force evaluation. Times are medians of repeats taken in turn, so that both sides see the same machine. */
#include "tests/support/engine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *list, size_t count) {
  qsort(list, count, sizeof *list, by_size);
  return list[count / 2];
}

/* ---- the scalar loop: x as n x 3, both ends written ---- */

typedef struct spring {
  uint32_t i, j;
  double k, c, L;
} spring;

static void scalar(const spring *s, size_t count, const double *restrict x, const double *restrict v,
                   double *restrict F) {
  for (size_t e = 0; e < count; e++) {
    size_t i = 3 * (size_t)s[e].i, j = 3 * (size_t)s[e].j;
    double dx = x[j] - x[i], dy = x[j + 1] - x[i + 1], dz = x[j + 2] - x[i + 2];
    double l = sqrt(dx * dx + dy * dy + dz * dz);
    if (l == 0) continue;
    double r = 1 / l, w = dx * (v[j] - v[i]) + dy * (v[j + 1] - v[i + 1]) + dz * (v[j + 2] - v[i + 2]);
    double f = (s[e].k * (l - s[e].L) + s[e].c * w * r) * r;
    F[i] += f * dx, F[i + 1] += f * dy, F[i + 2] += f * dz;
    F[j] -= f * dx, F[j + 1] -= f * dy, F[j + 2] -= f * dz;
  }
}

/* ---- the scene: hang(N) of three springs plugins, ids shuffled or not, coefficients common or per edge ---- */

typedef struct cloth {
  test_engine e;
  size_t n, count;
  spring *all;
  double *x, *v, *F;
} cloth;

static uint32_t *ids(uint32_t n, bool shuffle) {
  uint32_t *id = malloc(n * sizeof *id), state = 12345;
  for (uint32_t k = 0; k < n; k++) id[k] = k + 1;
  for (uint32_t k = n - 1; shuffle && k > 0; k--) {
    state = state * 1664525 + 1013904223;
    uint32_t other = (uint32_t)(((uint64_t)state * (k + 1)) >> 32), swap = id[k];
    id[k] = id[other];
    id[other] = swap;
  }
  return id;
}

static void set_list(cloth *c, hk_plugin_spec *spec, const char *name, double value, size_t count, bool each) {
  double *list = malloc((count + 1) * sizeof *list);
  for (size_t e = 0; e < count; e++) list[e] = value * (1 + (each ? 1e-3 * (double)(e % 7) : 0));
  hk_value v = {.kind = each ? HK_VALUE_LIST : HK_VALUE_NUMBER, .number = value, .count = count, .list = list};
  const hk_param *p = hk_spec_param(spec, name, &c->e.error);
  if (hk_spec_set(spec, p, &v, c->n, &c->e.error) != HK_OK) exit(1);
  free(list);
}

static void add_springs(cloth *c, uint32_t N, const uint32_t *id, const int (*offset)[2], double k, double damping,
                        bool each) {
  uint32_t(*edge)[2] = malloc(2 * c->n * sizeof *edge);
  size_t count = 0;
  for (int o = 0; o < 2; o++)
    for (uint32_t j = 0; j + (uint32_t)offset[o][1] < N; j++)
      for (uint32_t i = 0; i < N; i++) {
        int64_t other = (int64_t)i + offset[o][0];
        if (other < 0 || other >= N) continue;
        edge[count][0] = id[j * N + i];
        edge[count++][1] = id[(j + (uint32_t)offset[o][1]) * N + (uint32_t)other];
      }
  hk_plugin_spec *springs = test_plugin(&c->e, HK_FORCE, "springs");
  test_edges(&c->e, springs, (const uint32_t(*)[2])edge, count);
  set_list(c, springs, "k", k, count, each);
  set_list(c, springs, "damping", damping, count, each);
  for (size_t e = 0; e < count; e++) {
    const double *a = c->e.scene->particles.position + 3 * (edge[e][0] - 1),
                 *b = c->e.scene->particles.position + 3 * (edge[e][1] - 1);
    double factor = 1 + (each ? 1e-3 * (double)(e % 7) : 0);
    double L = sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
    c->all[c->count++] = (spring){edge[e][0] - 1, edge[e][1] - 1, k * factor, damping * factor, L};
  }
  free(edge);
}

/* s, stable: particles get lighter as N^2. */
static double step_of(uint32_t N) { return N > 128 ? 1e-5 * 64 / N : 1e-5; }

static void open_cloth(cloth *c, uint32_t N, bool shuffle, int threads) {
  static const int structural[2][2] = {{1, 0}, {0, 1}}, shear[2][2] = {{1, 1}, {-1, 1}},
                   flexion[2][2] = {{2, 0}, {0, 2}};
  *c = (cloth){.n = (size_t)N * N};
  test_engine_open(&c->e);
  c->e.scene->threads = threads;
  c->e.options.dt = step_of(N) * (1 + 1e-9);
  c->all = malloc(6 * c->n * sizeof *c->all);
  uint32_t *id = ids(N * N, shuffle), first;
  double *x = malloc(3 * c->n * sizeof *x);
  for (uint32_t k = 0; k < N * N; k++) {
    double *at = x + 3 * (id[k] - 1);
    at[0] = k % N / (N - 1.0);
    at[1] = k / N / (N - 1.0);
    at[2] = 0.01 * sin(7 * at[0] + 5 * at[1]);
  }
  if (hk_scene_add_particles(c->e.scene, c->n, x, NULL, NULL, 0.15 / (double)c->n, 0, &first, &c->e.error) != HK_OK)
    exit(1);
  add_springs(c, N, id, structural, 1000, 0.02, shuffle);
  add_springs(c, N, id, shear, 300, 0.01, shuffle);
  add_springs(c, N, id, flexion, 50, 0.005, shuffle);
  test_plugin(&c->e, HK_FORCE, "gravity");
  test_number(&c->e, test_plugin(&c->e, HK_FORCE, "drag"), "rate", 0.02);
  test_run(&c->e);
  c->x = malloc(3 * c->n * sizeof *c->x);
  c->v = malloc(3 * c->n * sizeof *c->v);
  c->F = malloc((3 * c->n + 8) * sizeof *c->F);
  memcpy(c->x, hk_run_view(c->e.run)->x, 3 * c->n * sizeof *c->x);
  for (size_t k = 0; k < 3 * c->n; k++) c->x[k] *= 1 + 1e-3 * sin((double)k), c->v[k] = cos(0.1 * (double)k);
  free(id);
  free(x);
}

static void close_cloth(cloth *c) {
  test_engine_close(&c->e);
  free(c->all);
  free(c->x);
  free(c->v);
  free(c->F);
}

/* The three springs plugins on the bench's x and v. */
static void plugin(cloth *c) {
  hk_view view = *hk_run_view(c->e.run);
  double power = 0;
  view.x = c->x;
  view.v = c->v;
  view.power = &power;
  for (size_t k = 0; k < 3; k++) {
    hk_instance *force = c->e.run->plugins.kind[HK_FORCE].item[k];
    view.host = &force->host;
    force->plugin->force->add(force->self, &view, c->F);
  }
}

static void compare(const char *what, uint32_t N, bool shuffle) {
  enum { REPEATS = 41 };
  double a[REPEATS], b[REPEATS], largest = 0, off = 0;
  cloth c;
  open_cloth(&c, N, shuffle, 1);
  double *F = calloc(3 * c.n, sizeof *F);
  for (int r = 0; r < REPEATS; r++) {
    memset(F, 0, 3 * c.n * sizeof *F);
    memset(c.F, 0, 3 * c.n * sizeof *F);
    double t0 = now();
    scalar(c.all, c.count, c.x, c.v, F);
    double t1 = now();
    plugin(&c);
    a[r] = t1 - t0;
    b[r] = now() - t1;
  }
  for (size_t k = 0; k < 3 * c.n; k++) largest = fmax(largest, fabs(F[k])), off = fmax(off, fabs(F[k] - c.F[k]));
  double ta = median(a, REPEATS) / (double)c.count * 1e9, tb = median(b, REPEATS) / (double)c.count * 1e9;
  printf("%-34s scalar %6.2f ns, springs %6.2f ns a spring: %.2fx; they differ by %.1e of the largest force\n", what,
         ta, tb, ta / tb, off / largest);
  free(F);
  close_cloth(&c);
}

static void two_threads(uint32_t N, bool shuffle) {
  enum { REPEATS = 21 };
  double a[REPEATS], b[REPEATS];
  cloth one, two;
  open_cloth(&one, N, shuffle, 1);
  open_cloth(&two, N, shuffle, 2);
  for (int r = 0; r < REPEATS; r++) {
    memset(one.F, 0, 3 * one.n * sizeof *one.F);
    memset(two.F, 0, 3 * two.n * sizeof *two.F);
    double t0 = now();
    plugin(&one);
    double t1 = now();
    plugin(&two);
    a[r] = t1 - t0;
    b[r] = now() - t1;
  }
  bool same = memcmp(one.F, two.F, 3 * one.n * sizeof *one.F) == 0;
  printf("%u x %u, threads: one %.2f ms, two %.2f ms: %.2fx; results %s\n", N, N, median(a, REPEATS) * 1e3,
         median(b, REPEATS) * 1e3, median(a, REPEATS) / median(b, REPEATS), same ? "bitwise equal" : "DIFFER");
  close_cloth(&one);
  close_cloth(&two);
}

/* A leapfrog step of the running engine beside one evaluation of f, both at 128 x 128 on one thread. */
static void step(void) {
  enum { REPEATS = 15, STEPS = 40 };
  double a[REPEATS], b[REPEATS], t = 0;
  cloth c;
  open_cloth(&c, 128, false, 1);
  hk_system *s = &c.e.run->dynamics.system;
  double *x = malloc(s->size * sizeof *x), *dX = malloc(s->size * sizeof *dX);
  for (int r = 0; r < REPEATS; r++) {
    memcpy(x, s->X, s->size * sizeof *x);
    double t0 = now();
    for (int k = 0; k < STEPS; k++) s->accelerations(s, s->t, x, x + 3 * s->n, x + 6 * s->n, dX, dX + 3 * s->n);
    double t1 = now();
    test_advance(&c.e, t += STEPS * 1e-5);
    a[r] = (t1 - t0) / STEPS;
    b[r] = (now() - t1) / STEPS;
  }
  double f = median(a, REPEATS) * 1e6, whole = median(b, REPEATS) * 1e6;
  printf("128 x 128: evaluation %.0f us, leapfrog step %.0f us: %.2fx\n", f, whole, whole / f);
  free(x);
  free(dX);
  close_cloth(&c);
}

/* s, CPU time of all threads. */
static double spent(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ns of a whole leapfrog step for each spring, on one thread and on two: CPU time of one, wall time of both. The minima
 * of repeats taken in turn. */
static void sizes(uint32_t N, bool shuffle) {
  enum { REPEATS = 9 };
  double best = INFINITY, wall[2] = {INFINITY, INFINITY}, t = 0;
  cloth c[2];
  for (int k = 0; k < 2; k++) open_cloth(&c[k], N, shuffle, k + 1);
  int steps = N < 128 ? 256 : N < 512 ? 128 : 64; /* whole waves */
  for (int r = 0; r < REPEATS; r++) {
    t += steps * step_of(N);
    for (int k = 0; k < 2; k++) {
      double t0 = now(), own = spent();
      test_advance(&c[k].e, t);
      wall[k] = fmin(wall[k], now() - t0);
      if (k == 0) best = fmin(best, spent() - own);
    }
  }
  bool same = memcmp(hk_run_view(c[0].e.run)->x, hk_run_view(c[1].e.run)->x, 3 * c[0].n * sizeof(double)) == 0;
  double each = 1e9 / (double)steps / (double)c[0].count;
  printf("%4u x %-4u leapfrog%s, ns a spring and step: CPU %5.2f, wall %5.2f; two threads %5.2f: %.2fx, results %s\n",
         N, N, shuffle ? ", random ids, coefficients per spring" : "", best * each, wall[0] * each, wall[1] * each,
         wall[0] / wall[1], same ? "bitwise equal" : "DIFFER");
  for (int k = 0; k < 2; k++) close_cloth(&c[k]);
}

static void small(void) {
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 1, 0, 0, 1);
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
  uint32_t edge[1][2] = {{1, 2}};
  test_edges(&e, springs, (const uint32_t(*)[2])edge, 1);
  test_number(&e, springs, "k", 100);
  test_plugin(&e, HK_FORCE, "gravity");
  e.options.dt = 1e-3;
  e.scene->fps = 1;
  e.options.until = 3000;
  test_run(&e);
  enum { REPEATS = 11, CALLS = 100000 };
  double list[REPEATS], F[6] = {0}, power = 0;
  const hk_instance *force = test_instance(&e, springs);
  hk_view view = *hk_run_view(e.run);
  view.host = &force->host;
  view.power = &power;
  for (int r = 0; r < REPEATS; r++) {
    double t0 = now();
    for (int k = 0; k < CALLS; k++) force->plugin->force->add(force->self, &view, F);
    list[r] = (now() - t0) / CALLS;
  }
  double t0 = now();
  test_advance(&e, 3000);
  printf("two particles: one spring %.1f ns; %.3g million leapfrog steps a second\n", median(list, REPEATS) * 1e9,
         3 / (now() - t0));
  test_engine_close(&e);
}

static void all_sizes(void) {
  for (uint32_t N = 32; N <= 1024; N *= 2) sizes(N, false);
  sizes(128, true);
  sizes(512, true);
}

/* `springs sizes` makes that measurement alone. */
int main(int arguments, char **argument) {
  all_sizes();
  if (arguments > 1 && strcmp(argument[1], "sizes") == 0) return 0;
  compare("128 x 128, grid order", 128, false);
  compare("128 x 128, shuffled, per edge", 128, true);
  compare("512 x 512, grid order", 512, false);
  compare("512 x 512, shuffled, per edge", 512, true);
  two_threads(512, false);
  two_threads(512, true);
  step();
  small();
  return 0;
}
