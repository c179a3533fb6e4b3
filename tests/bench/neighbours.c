/* The service neighbours/1 beside what one writes by hand: linked cells and a list of half the pairs (Allen and
 * Tildesley 1987, F.20 and F.19), single-threaded. A Lennard-Jones liquid of density 0.8 and temperature 1, cut off at
 * 2.5, in a cube without walls. Times are medians of repeats taken in turn; then whole steps of leapfrog for several
 * skins, from which the default was chosen. */
#include "tests/support/engine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { REPEATS = 9, WARM = 40, STEPS = 60 };
static const double spacing = 1.0772, cutoff = 2.5, skin = 0.1, dt = 0.005;

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

static void *memory(size_t count, size_t size) {
  void *p = calloc(count + 1, size);
  if (p) return p;
  fprintf(stderr, "no memory for %zu numbers: close other programs\n", count);
  exit(1);
}

/* ---- by hand ---- */

typedef struct plain {
  size_t n, cells[3], pairs, room;
  double low[3];
  int *head, *next;
  size_t *start; /* n + 1 */
  int *other;    /* of each pair once */
} plain;

static void link_cells(plain *p, const double *x, double reach) {
  double high[3];
  size_t total = 1;
  for (size_t c = 0; c < 3; c++) {
    p->low[c] = high[c] = x[c];
    for (size_t i = 1; i < p->n; i++) {
      p->low[c] = fmin(p->low[c], x[3 * i + c]);
      high[c] = fmax(high[c], x[3 * i + c]);
    }
    p->cells[c] = (size_t)((high[c] - p->low[c]) / reach) + 1;
    total *= p->cells[c];
  }
  free(p->head);
  p->head = memory(total, sizeof *p->head);
  memset(p->head, -1, total * sizeof *p->head);
  for (size_t i = 0; i < p->n; i++) {
    size_t at = 0;
    for (size_t c = 3; c-- > 0;) at = at * p->cells[c] + (size_t)((x[3 * i + c] - p->low[c]) / reach);
    p->next[i] = p->head[at];
    p->head[at] = (int)i;
  }
}

static void keep(plain *p, int j) {
  if (p->pairs == p->room) {
    p->room = 2 * p->room + 1024;
    p->other = realloc(p->other, p->room * sizeof *p->other);
    if (!p->other) exit(1);
  }
  p->other[p->pairs++] = j;
}

static void look_in(plain *p, const double *x, size_t i, size_t cell, double reach2) {
  for (int j = p->head[cell]; j >= 0; j = p->next[j]) {
    double dx = x[3 * j] - x[3 * i], dy = x[3 * j + 1] - x[3 * i + 1], dz = x[3 * j + 2] - x[3 * i + 2];
    if ((size_t)j > i && dx * dx + dy * dy + dz * dz < reach2) keep(p, j);
  }
}

static void plain_build(plain *p, const double *x, double reach) {
  link_cells(p, x, reach);
  p->pairs = 0;
  for (size_t i = 0; i < p->n; i++) {
    long at[3];
    p->start[i] = p->pairs;
    for (size_t c = 0; c < 3; c++) at[c] = (long)((x[3 * i + c] - p->low[c]) / reach);
    for (long z = at[2] - 1; z <= at[2] + 1; z++)
      for (long y = at[1] - 1; y <= at[1] + 1; y++)
        for (long w = at[0] - 1; w <= at[0] + 1; w++)
          if (z >= 0 && y >= 0 && w >= 0 && (size_t)z < p->cells[2] && (size_t)y < p->cells[1] &&
              (size_t)w < p->cells[0])
            look_in(p, x, i, ((size_t)z * p->cells[1] + (size_t)y) * p->cells[0] + (size_t)w, reach * reach);
  }
  p->start[p->n] = p->pairs;
}

static void plain_sweep(const plain *p, const double *restrict x, double *restrict F) {
  double s6 = pow(cutoff, -6), cut = 24 * (2 * s6 * s6 - s6) / cutoff;
  for (size_t i = 0; i < p->n; i++)
    for (size_t k = p->start[i]; k < p->start[i + 1]; k++) {
      size_t j = (size_t)p->other[k];
      double dx = x[3 * j] - x[3 * i], dy = x[3 * j + 1] - x[3 * i + 1], dz = x[3 * j + 2] - x[3 * i + 2];
      double r2 = dx * dx + dy * dy + dz * dz;
      if (r2 >= cutoff * cutoff) continue;
      double u = 1 / r2, u3 = u * u * u, f = 24 * (2 * u3 * u3 - u3) * u - cut / sqrt(r2);
      F[3 * i] -= f * dx, F[3 * i + 1] -= f * dy, F[3 * i + 2] -= f * dz;
      F[3 * j] += f * dx, F[3 * j + 1] += f * dy, F[3 * j + 2] += f * dz;
    }
}

static void plain_free(plain *p) {
  free(p->head);
  free(p->next);
  free(p->start);
  free(p->other);
}

/* ---- hooke ---- */

typedef struct liquid {
  test_engine e;
  hk_plugin_spec *pairs;
  size_t n;
} liquid;

static void open_liquid(liquid *l, size_t side, double part, int threads) {
  uint64_t seed[4];
  uint32_t first;
  *l = (liquid){.n = side * side * side};
  test_engine_open(&l->e);
  double *x = memory(3 * l->n, sizeof *x), *v = memory(3 * l->n, sizeof *v);
  hk_random_seed(seed, 1);
  for (size_t i = 0; i < l->n; i++)
    for (size_t c = 0, at = i; c < 3; c++, at /= side) {
      x[3 * i + c] = spacing * (double)(at % side);
      v[3 * i + c] = sqrt(6.0) * (2 * hk_random_uniform(seed) - 1); /* half of it becomes potential energy */
    }
  l->e.scene->threads = threads;
  l->e.options.dt = dt;
  l->e.scene->fps = 1 / (dt * WARM);
  if (hk_scene_add_particles(l->e.scene, l->n, x, v, NULL, 1, 0, &first, &l->e.error) != HK_OK) exit(1);
  l->pairs = test_plugin(&l->e, HK_FORCE, "fixture:lennard_jones");
  test_number(&l->e, test_plugin(&l->e, HK_SERVICE, "neighbours"), "skin", part);
  test_run(&l->e);
  test_advance(&l->e, dt * WARM);
  free(x);
  free(v);
}

static const hk_neighbours *table_of(const liquid *l) {
  const hk_instance *service = l->e.run->plugins.kind[HK_SERVICE].item[0];
  return service->plugin->service->table(service->self);
}

static hk_neighbour_rows find(const liquid *l, const double *x) {
  hk_neighbour_rows rows;
  const hk_neighbours *table = table_of(l);
  if (table->rows(table->self, hk_run_view(l->e.run), x, &rows) != HK_OK) exit(1);
  return rows;
}

static void sweep(liquid *l, const double *x, double *F) {
  hk_instance *force = test_instance(&l->e, l->pairs);
  hk_view view = *hk_run_view(l->e.run);
  view.host = &force->host;
  view.acting = view.n;
  view.x = x;
  if (force->plugin->force->add(force->self, &view, F) != HK_OK) exit(1);
}

/* Every second time the liquid is a metre beside: the same pairs have to be found again. */
static void compare(size_t side, int threads) {
  double build[REPEATS], look[REPEATS], sum[REPEATS], build_plain[REPEATS], sum_plain[REPEATS], off = 0, largest = 0;
  liquid l;
  open_liquid(&l, side, skin, threads);
  plain p = {.n = l.n, .next = memory(l.n, sizeof(int)), .start = memory(l.n, sizeof(size_t))};
  double *x = memory(3 * l.n, sizeof *x), *F = memory(3 * l.n, sizeof *F), *G = memory(3 * l.n, sizeof *G);
  size_t pairs = 0;
  memcpy(x, hk_run_view(l.e.run)->x, 3 * l.n * sizeof *x);
  for (size_t r = 0; r < REPEATS; r++) {
    for (size_t k = 0; k < l.n; k++) x[3 * k] += r % 2 ? 1 : -1;
    memset(F, 0, 3 * l.n * sizeof *F);
    memset(G, 0, 3 * l.n * sizeof *G);
    double t0 = now();
    pairs = find(&l, x).row_start[l.n];
    double t1 = now();
    find(&l, x);
    double t2 = now();
    sweep(&l, x, F);
    double t3 = now();
    plain_build(&p, x, cutoff * (1 + skin));
    double t4 = now();
    plain_sweep(&p, x, G);
    sum_plain[r] = now() - t4;
    build_plain[r] = t4 - t3, sum[r] = t3 - t2, look[r] = t2 - t1, build[r] = t1 - t0;
  }
  for (size_t k = 0; k < 3 * l.n; k++) largest = fmax(largest, fabs(G[k])), off = fmax(off, fabs(F[k] - G[k]));
  double unit = 1e9 / (double)l.n;
  printf(
      "%6zu particles, %d thread%s, %.0f in a row: find %5.0f ns, look %4.1f ns, forces %4.0f ns a particle; by hand "
      "%5.0f and %4.0f ns; they differ by %.0e\n",
      l.n, threads, threads > 1 ? "s" : "", (double)pairs / (double)l.n, median(build, REPEATS) * unit,
      median(look, REPEATS) * unit, median(sum, REPEATS) * unit, median(build_plain, REPEATS) * unit,
      median(sum_plain, REPEATS) * unit, off / largest);
  plain_free(&p);
  free(x);
  free(F);
  free(G);
  test_engine_close(&l.e);
}

static void steps(size_t side) {
  const double part[] = {0.05, 0.1, 0.15, 0.2, 0.3, 0.4};
  for (size_t k = 0; k < sizeof part / sizeof *part; k++) {
    liquid l;
    open_liquid(&l, side, part[k], 1);
    uint64_t first = find(&l, hk_run_view(l.e.run)->x).number;
    double t0 = now();
    test_advance(&l.e, dt * (WARM + STEPS));
    double seconds = (now() - t0) / STEPS;
    uint64_t number = find(&l, hk_run_view(l.e.run)->x).number;
    printf("%6zu particles, skin %4.2f: a step %5.0f ns a particle, rows found %2llu times in %d steps\n", l.n, part[k],
           seconds / (double)l.n * 1e9, (unsigned long long)(number - first), STEPS);
    test_engine_close(&l.e);
  }
}

int main(void) {
  compare(22, 1);
  compare(46, 1);
  compare(22, 2);
  compare(46, 2);
  steps(22);
  steps(46);
  return 0;
}
