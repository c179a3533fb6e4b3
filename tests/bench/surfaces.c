/* The service surfaces/1: times of the search for pairs and of the exact count of intersections, from 5,000 to 200,000
 * triangles. Ten layers of cloth, as one folded sheet has them: triangles with sides of 1, layers 0.3 apart, with
 * waves, in a move of 0.05; thickness and reach are 0.1 each. Also the exact count in a flat sheet that stands askew,
 * where all neighbours lie in one plane but for rounding. Times are the least of repeats, of all threads together.
 *
 * "cells" is what a cell list takes to find the centres of the items within the diameter of the largest and the reach:
 * eight times as many rows, whose boxes and axes would be compared after that. All in all it is no faster than the tree
 * where triangles are of one size, and slow where they are not. */
#include "plugins/common/space/cell_list.h"
#include "tests/support/surface_scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { REPEATS = 9, LAYERS = 10 };

/* s, wall. */
static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fold(test_surfaces *s, unsigned n) {
  for (size_t i = 0; i < s->model.n; i++) {
    double *x = s->x + 3 * i;
    x[0] *= n, x[1] *= n;
    double u = x[0] * 0.8 - x[1] * 0.6;
    x[2] += 2 * sin(0.2 * u) + 0.1 * sin(0.7 * x[1]) + test_uniform(s, -0.02, 0.02);
  }
}

static test_surfaces *make(int threads, unsigned n) {
  test_surfaces *s = test_surfaces_open(threads, 1, (size_t)LAYERS * (n + 1) * (n + 1));
  for (int k = 0; k < LAYERS; k++) test_surfaces_sheet(s, n, (double[]){0, 0, 0.3 * k});
  fold(s, n);
  s->request = (hk_surface_request){.thickness = 0.1, .body_thickness = 0.1};
  test_surfaces_list(s);
  return s;
}

static void check(hk_status status, const test_surfaces *s) {
  if (status == HK_OK) return;
  fprintf(stderr, "%s\n", s->error.text);
  exit(1);
}

typedef struct figures {
  double pairs, crossings, rows; /* s */
} figures;

static size_t rows_of(const test_surfaces *s) {
  size_t sum = 0;
  for (size_t k = 0; k < s->search.near.rows; k++) sum += s->search.near.row[k].count;
  return sum;
}

static double least(double a, double b) { return a < b ? a : b; }

static figures measure(test_surfaces *s) {
  figures f = {INFINITY, INFINITY, INFINITY};
  const hk_host *host = test_surfaces_host(s);
  double *to = malloc(3 * s->model.n * sizeof *to);
  if (!to) exit(1);
  hk_surface_move move = {.x_from = s->x, .x_to = to, .reach = 0.1};
  for (int k = 0; k < REPEATS; k++) {
    for (size_t q = 0; q < 3 * s->model.n; q++) to[q] = s->x[q] + 0.05 * sin(0.1 * (double)(q / 3) + k);
    double t0 = now();
    check(hk_broad_phase_run(&s->search, host, &move), s);
    double t1 = now();
    check(hk_feature_pairs_find(&s->search, host, &move, &s->pairs), s);
    double t2 = now();
    check(hk_crossings_find(&s->search, host, s->x, &s->crossings), s);
    double t3 = now();
    f = (figures){least(f.pairs, t2 - t1), least(f.crossings, t3 - t2), least(f.rows, t1 - t0)};
  }
  free(to);
  return f;
}

/* The cell list of the items' centres; what it finds would still have to be compared as what the tree finds is. */
static double measure_cells(test_surfaces *s, size_t *found) {
  const hk_host *host = test_surfaces_host(s);
  size_t items = s->search.items.count;
  double *centre = malloc((3 * items + 1) * sizeof *centre), largest2 = 0, time = INFINITY;
  hk_cell_list list = {0};
  if (!centre) exit(1);
  for (size_t k = 0; k < items; k++) {
    const hk_box *b = &s->search.box[k];
    double size2 = 0;
    for (size_t c = 0; c < 3; c++) {
      centre[3 * k + c] = (b->low[c] + b->high[c]) / 2;
      size2 += (b->high[c] - b->low[c]) * (b->high[c] - b->low[c]);
    }
    largest2 = fmax(largest2, size2);
  }
  check(hk_cell_list_reserve(&list, host, items), s);
  for (int k = 0; k < 3; k++) {
    double begin = now();
    check(hk_cell_list_build(&list, host, centre, items, sqrt(largest2) + 0.1), s);
    time = least(time, now() - begin);
  }
  *found = list.row_start[items] / 2;
  hk_cell_list_free(&list, host);
  free(centre);
  return time;
}

static double measure_flat(int threads, unsigned n) {
  test_surfaces *s = test_surfaces_open(threads, 1, (size_t)(n + 1) * (n + 1));
  double time = INFINITY;
  test_surfaces_sheet(s, n, (double[]){0, 0, 0});
  for (size_t i = 0; i < s->model.n; i++) s->x[3 * i + 2] = 0.3 * s->x[3 * i] - 0.7 * s->x[3 * i + 1];
  test_surfaces_list(s);
  for (int k = 0; k < 3; k++) {
    double begin = now();
    check(hk_crossings_find(&s->search, test_surfaces_host(s), s->x, &s->crossings), s);
    time = least(time, now() - begin);
  }
  test_surfaces_close(s);
  return time;
}

static void measure_size(int threads, unsigned side) {
  test_surfaces *s = make(threads, side);
  figures f = measure(s);
  double triangles = (double)s->model.triangles.count;
  printf("%9.0f %7d | %8.1f %8zu | %8.1f %7.0f %8zu | %8.1f %5zu", triangles, threads, 1e3 * f.rows, rows_of(s),
         1e3 * f.pairs, 1e9 * f.pairs / triangles, s->pairs.count, 1e3 * f.crossings, s->crossings.count);
  double flat = measure_flat(threads, (unsigned)sqrt(triangles / 2));
  hk_surface_move still = {.x_from = s->x, .x_to = s->x, .reach = 0.1};
  check(hk_broad_phase_run(&s->search, test_surfaces_host(s), &still), s);
  size_t found;
  double cells = measure_cells(s, &found);
  printf(" %8.1f | %8.1f %9zu\n", 1e3 * flat, 1e3 * cells, found);
  test_surfaces_close(s);
}

int main(void) {
  static const unsigned side[] = {16, 32, 50, 71, 100};
  printf("%9s %7s | %8s %8s | %8s %7s %8s | %8s %5s %8s | %8s %9s\n", "triangles", "threads", "search", "rows",
         "pairs ms", "ns/tri.", "pairs", "exact ms", "found", "flat ms", "cells ms", "rows");
  for (size_t k = 0; k < sizeof side / sizeof *side; k++)
    for (int threads = 1; threads <= 2; threads++) measure_size(threads, side[k]);
  return 0;
}
