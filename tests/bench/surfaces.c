/* The service surfaces/1: time of the search for pairs and of the exact count of intersections, from 5,000 to 200,000
 * triangles. Ten layers of cloth, as one folded sheet has them: triangles with sides of 1, layers 0.3 apart, with
 * waves, in a move of 0.05; thickness and reach are 0.1 each. Times are the least of repeats. */
#include "tests/support/surface_scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { REPEATS = 9, LAYERS = 10 };

/* s, of all threads of the process: what other processes do disturbs it less. */
static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
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
    check(hk_surface_search_run(&s->search, host, &move), s);
    double t1 = now();
    check(hk_surface_pairs_find(&s->search, host, &move, &s->pairs), s);
    double t2 = now();
    check(hk_surface_crossings_find(&s->search, host, s->x, &s->crossings), s);
    double t3 = now();
    f = (figures){least(f.pairs, t2 - t1), least(f.crossings, t3 - t2), least(f.rows, t1 - t0)};
  }
  free(to);
  return f;
}

int main(void) {
  printf("%9s %7s | %10s %9s | %10s %9s %9s | %9s %9s\n", "triangles", "threads", "items ms", "rows", "pairs ms",
         "ns/tri.", "pairs", "exact ms", "found");
  static const unsigned side[] = {16, 32, 50, 71, 100};
  for (size_t k = 0; k < sizeof side / sizeof *side; k++)
    for (int threads = 1; threads <= 2; threads++) {
      test_surfaces *s = make(threads, side[k]);
      figures f = measure(s);
      double triangles = (double)s->model.triangles.count;
      printf("%9.0f %7d | %10.2f %9zu | %10.2f %9.0f %9zu | %9.2f %9zu\n", triangles, threads, 1e3 * f.rows, rows_of(s),
             1e3 * f.pairs, 1e9 * f.pairs / triangles, s->pairs.count, 1e3 * f.crossings, s->crossings.count);
      test_surfaces_close(s);
    }
  return 0;
}
