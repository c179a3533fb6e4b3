/* What a pair of features costs: nearest points, derivatives, continuous collision, exact predicates; one thread, pairs
 * of the size of 1 cm at distances as contact asks for. Times are the least of repeats. */
#include "plugins/common/contact/geometry/ccd.h"
#include "plugins/common/contact/geometry/exact.h"
#include "plugins/common/contact/geometry/orientation.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { PAIRS = 200, REPEATS = 5000 }; /* in the nearest cache */
static double x0[PAIRS][12], x1[PAIRS][12], H[144];
static double sink; /* so that nothing is left out */

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static uint64_t seed = 1;
static double noise(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) * 0x1.0p-52 - 1;
}

/* Features of 1 cm within `apart` of each other, each moving by up to `move`. */
static void scatter(hk_pair_kind kind, double apart, double move) {
  for (int p = 0; p < PAIRS; p++) {
    for (int k = 0; k < 12; k++) x0[p][k] = 0.01 * noise();
    hk_nearest n = hk_nearest_of_pair(kind, x0[p]);
    double d = sqrt(n.squared), by = (apart * (1 + 0.5 * noise()) - d) / d;
    for (int i = 0; i < (kind == HK_POINT_TRIANGLE ? 3 : 6); i++) x0[p][i] += by * n.d[i % 3];
    for (int k = 0; k < 12; k++) x1[p][k] = x0[p][k] + move * noise();
  }
}

static void nearest(hk_pair_kind kind, int p) { sink += hk_nearest_of_pair(kind, x0[p]).squared; }

static void gradient(hk_pair_kind kind, int p) {
  hk_nearest n = hk_nearest_of_pair(kind, x0[p]);
  hk_distance_gradient(&n, H);
  sink += H[3];
}

static void hessian(hk_pair_kind kind, int p) {
  hk_nearest n = hk_nearest_of_pair(kind, x0[p]);
  hk_distance_energy_hessian(&n, x0[p], 1, 0, false, H);
  sink += H[13];
}

static void definite(hk_pair_kind kind, int p) {
  hk_nearest n = hk_nearest_of_pair(kind, x0[p]);
  hk_distance_energy_hessian(&n, x0[p], -1, 1e4, true, H);
  sink += H[13];
}

static void mollifier(hk_pair_kind kind, int p) {
  (void)kind;
  double g[12];
  sink += hk_edge_mollifier(x0[p], 1e-8, g, H);
}

static void ccd(hk_pair_kind kind, int p) {
  double t;
  hk_ccd(kind, x0[p], x1[p], 1e-4, 1e-6, &t);
  sink += t;
}

static void orient3d(hk_pair_kind kind, int p) {
  (void)kind;
  sink += hk_orient3d(x0[p], x0[p] + 3, x0[p] + 6, x0[p] + 9);
}

static void orient2d(hk_pair_kind kind, int p) {
  (void)kind;
  sink += hk_orient2d(x0[p], x0[p] + 3, x0[p] + 6);
}

static void segment(hk_pair_kind kind, int p) {
  (void)kind;
  sink += hk_segment_meets_triangle(x0[p], x1[p], x0[p] + 3, x0[p] + 6, x0[p] + 9);
}

/* Four points of a plane that is not one of the axes', but for rounding: what the filter leaves open. */
static void into_a_plane(void) {
  for (int p = 0; p < PAIRS; p++)
    for (int i = 0; i < 4; i++) x0[p][3 * i + 2] = 0.3 * x0[p][3 * i] + 0.7 * x0[p][3 * i + 1];
}

static void measure(const char *what, hk_pair_kind kind, void (*one)(hk_pair_kind, int)) {
  double best = INFINITY;
  for (int r = 0; r < REPEATS; r++) {
    double start = now();
    for (int p = 0; p < PAIRS; p++) one(kind, p);
    best = fmin(best, now() - start);
  }
  printf("  %-52s %8.1f ns\n", what, best / PAIRS * 1e9);
}

static void measure_pair(const char *name, hk_pair_kind kind) {
  printf("%s\n", name);
  scatter(kind, 2e-3, 0);
  measure("nearest points, 2 mm apart", kind, nearest);
  measure("with gradient", kind, gradient);
  measure("with Hessian", kind, hessian);
  measure("with Hessian of an energy, definite", kind, definite);
  scatter(kind, 2e-2, 2e-3);
  measure("continuous collision, 20 mm apart, moves of 2 mm", kind, ccd);
  scatter(kind, 2e-3, 2e-3);
  measure("continuous collision, 2 mm apart, moves of 2 mm", kind, ccd);
  scatter(kind, 2e-3, 1e-2);
  measure("continuous collision, 2 mm apart, moves of 10 mm", kind, ccd);
}

int main(void) {
  measure_pair("point and triangle", HK_POINT_TRIANGLE);
  measure_pair("edge and edge", HK_EDGE_EDGE);
  measure("mollifier with its derivatives", HK_EDGE_EDGE, mollifier);
  printf("exact\n");
  scatter(HK_POINT_TRIANGLE, 2e-3, 1e-2);
  measure("orient2d", HK_POINT_TRIANGLE, orient2d);
  measure("orient3d", HK_POINT_TRIANGLE, orient3d);
  measure("segment and triangle", HK_POINT_TRIANGLE, segment);
  into_a_plane();
  measure("orient3d of points in a plane", HK_POINT_TRIANGLE, orient3d);
  return sink == 1.5;
}
