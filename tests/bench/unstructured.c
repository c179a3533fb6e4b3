/* What a spring costs where nothing is regular: a step of leapfrog on an unstructured mesh (delaunay.h) with ids and
 * lists at random, beside a grid of as many particles and springs; and with a stiffness and damping of each spring and
 * a mass of each particle, beside common ones. Once with the edges alone, 3 springs for a particle, once with springs
 * across the edges as well, 6. One thread, ns for each spring and step; the scenes take turns, the least of each
 * counts.
 *
 *     unstructured [SIDE]: SIDE x SIDE particles; 361 makes 260,000 triangles */
#include "tests/bench/delaunay.h"
#include "tests/support/engine.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { TURNS = 15, STEPS = 8, SCENES = 4 };

typedef struct scene {
  test_engine e;
  size_t springs;
  double seconds;
} scene;

static double own(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static uint32_t below(uint32_t *state, size_t n) { return (uint32_t)(delaunay_random(state) * (double)n); }

/* Ids from 1, in this order or at random. */
static uint32_t *ids(size_t n, bool shuffle) {
  uint32_t *id = malloc(n * sizeof *id), state = 2463534242u;
  for (size_t k = 0; k < n; k++) id[k] = (uint32_t)k + 1;
  for (size_t k = n - 1; shuffle && k > 0; k--) {
    uint32_t other = below(&state, k + 1), swap = id[k];
    id[k] = id[other];
    id[other] = swap;
  }
  return id;
}

/* Puts pairs into a random order, with random ends first. */
static void strew(uint32_t (*pair)[2], size_t count) {
  uint32_t state = 88675123u;
  for (size_t k = count; k > 1; k--) {
    uint32_t other = below(&state, k), first = pair[k - 1][0], second = pair[k - 1][1], turn = below(&state, 2);
    memcpy(pair[k - 1], pair[other], sizeof *pair);
    pair[other][turn] = first;
    pair[other][1 - turn] = second;
  }
}

static double varied(double value, size_t k, bool each) { return value * (1 + (each ? 0.05 * (double)(k % 17) : 0)); }

static void number(scene *s, hk_plugin_spec *spec, const char *name, double value, size_t count, bool each) {
  double *list = malloc((count + 1) * sizeof *list);
  for (size_t k = 0; k < count; k++) list[k] = varied(value, k, true);
  if (each)
    test_list(&s->e, spec, name, list, count);
  else
    test_number(&s->e, spec, name, value);
  free(list);
}

static void join(scene *s, uint32_t (*pair)[2], size_t count, const uint32_t *id, double k, bool each) {
  for (size_t e = 0; e < count; e++) pair[e][0] = id[pair[e][0]], pair[e][1] = id[pair[e][1]];
  hk_plugin_spec *spec = test_plugin(&s->e, HK_FORCE, "springs");
  test_edges(&s->e, spec, (const uint32_t(*)[2])pair, count);
  number(s, spec, "k", k, count, each);
  number(s, spec, "damping", 1e-5 * k, count, each);
  s->springs += count;
}

static size_t grid_pairs(uint32_t N, const int offset[3][2], uint32_t (*pair)[2]) {
  size_t count = 0;
  for (int o = 0; o < 3; o++)
    for (int j = 0; j < (int)N; j++)
      for (int i = 0; i < (int)N; i++) {
        int column = i + offset[o][0], row = j + offset[o][1];
        if (column < 0 || column >= (int)N || row >= (int)N) continue;
        pair[count][0] = (uint32_t)j * N + (uint32_t)i;
        pair[count++][1] = (uint32_t)row * N + (uint32_t)column;
      }
  return count;
}

static void add_particles(scene *s, size_t n, const double (*at)[2], const uint32_t *id, bool each) {
  double(*x)[3] = malloc(n * sizeof *x), *mass = malloc(n * sizeof *mass);
  uint32_t first;
  for (size_t k = 0; k < n; k++) {
    double *p = x[id[k] - 1];
    p[0] = at[k][0], p[1] = at[k][1], p[2] = 0.01 * sin(7 * p[0] + 5 * p[1]);
    mass[id[k] - 1] = varied(1e-4, k, each);
  }
  if (hk_scene_add_particles(s->e.scene, n, x[0], NULL, mass, 0, 0, &first, &s->e.error) != HK_OK) exit(1);
  free(x);
  free(mass);
}

static void begin(scene *s) {
  *s = (scene){.seconds = INFINITY};
  test_engine_open(&s->e);
  s->e.scene->threads = 1;
  s->e.options.dt = 1e-5;
}

static void end(scene *s) {
  test_plugin(&s->e, HK_FORCE, "gravity");
  test_number(&s->e, test_plugin(&s->e, HK_FORCE, "drag"), "rate", 0.02);
  test_run(&s->e);
}

static void open_grid(scene *s, uint32_t N, bool across, bool each) {
  static const int near[3][2] = {{1, 0}, {0, 1}, {1, 1}}, far[3][2] = {{1, 2}, {2, 1}, {-1, 1}};
  size_t n = (size_t)N * N;
  uint32_t(*pair)[2] = malloc(3 * n * sizeof *pair), *id = ids(n, false);
  double(*at)[2] = malloc(n * sizeof *at);
  begin(s);
  for (size_t k = 0; k < n; k++) at[k][0] = (double)(k % N) / N, at[k][1] = (double)(k / N) / N;
  add_particles(s, n, (const double(*)[2])at, id, each);
  join(s, pair, grid_pairs(N, near, pair), id, 1000, each);
  if (across) join(s, pair, grid_pairs(N, far, pair), id, 50, each);
  end(s);
  free(pair);
  free(id);
  free(at);
}

static void open_mesh(scene *s, const delaunay *d, bool across, bool each) {
  uint32_t(*pair)[2] = malloc(3 * d->n * sizeof *pair), *id = ids(d->n, true);
  begin(s);
  add_particles(s, d->n, (const double(*)[2])d->x, id, each);
  for (int k = 0; k <= across; k++) {
    size_t count = delaunay_pairs(d, k, pair);
    strew(pair, count);
    join(s, pair, count, id, k ? 50 : 1000, each);
  }
  end(s);
  free(pair);
  free(id);
}

static void measure(scene s[SCENES]) {
  for (int turn = 0; turn <= TURNS; turn++) /* the first one warms up */
    for (int k = 0; k < SCENES; k++) {
      double start = own();
      test_advance(&s[k].e, (turn + 1) * STEPS * 1e-5);
      if (turn) s[k].seconds = fmin(s[k].seconds, own() - start);
    }
}

static double cost(const scene *s) { return 1e9 * s->seconds / STEPS / (double)s->springs; }

static void rows(uint32_t N, const delaunay *d, bool across) {
  scene s[SCENES];
  for (int k = 0; k < SCENES; k++)
    if (k < 2)
      open_grid(&s[k], N, across, k % 2);
    else
      open_mesh(&s[k], d, across, k % 2);
  measure(s);
  printf("%zu particles, ns a spring and step:         uniform   each its own\n", d->n);
  for (int k = 0; k < SCENES; k += 2)
    printf("  %s, %d x springs, %7zu of them %11.2f %14.2f: %5.2f times\n", k ? "mesh" : "grid", across ? 2 : 1,
           s[k].springs, cost(&s[k]), cost(&s[k + 1]), cost(&s[k + 1]) / cost(&s[k]));
  printf("  mesh / grid %35.2f %14.2f times\n", cost(&s[2]) / cost(&s[0]), cost(&s[3]) / cost(&s[1]));
  fflush(stdout);
  for (int k = 0; k < SCENES; k++) test_engine_close(&s[k].e);
}

int main(int arguments, char **argument) {
  uint32_t N = arguments > 1 ? (uint32_t)atoi(argument[1]) : 361;
  delaunay d = delaunay_mesh(N);
  rows(N, &d, false);
  rows(N, &d, true);
  delaunay_free(&d);
  return 0;
}
