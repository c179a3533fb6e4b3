/* What it takes to find a surface in an array of 128^3 values, by marching tetrahedra and by marching cubes on one
 * thread, nanoseconds a cell: a sphere, and a gyroid whose surface is in every block. Beside it scikit-image's
 * marching_cubes (Lewiner's method) on the same array, where python3 has it. The least of turns counts. */
#include "plugins/common/isosurface/isosurface.h"
#include "core/engine/host/host.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { N = 128, TURNS = 12 };

static const double cells = (double)(N - 1) * (N - 1) * (N - 1);

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Three waves of the gyroid along each axis, cut by a ball so that its surface stays in the box. */
static double value_at(bool gyroid, const double x[3]) {
  double ball = 0.81 - x[0] * x[0] - x[1] * x[1] - x[2] * x[2], k = 3 * 3.141592653589793;
  if (!gyroid) return ball;
  double g = sin(k * x[0]) * cos(k * x[1]) + sin(k * x[1]) * cos(k * x[2]) + sin(k * x[2]) * cos(k * x[0]);
  return fmin(g, 5 * ball);
}

static void fill(bool gyroid, double *value) {
  for (size_t k = 0; k < (size_t)N * N * N; k++) {
    size_t at[3] = {k % N, k / N % N, k / N / N};
    double x[3];
    for (int c = 0; c < 3; c++) x[c] = 2.0 * (double)at[c] / (N - 1) - 1;
    value[k] = value_at(gyroid, x);
  }
}

/* The same array in numpy, and the least time of TURNS calls. */
static void print_peer(bool gyroid) {
  static const char script[] =
      "try: import time, numpy as n; from skimage.measure import marching_cubes as m\n"
      "except ImportError: print('    scikit-image is not installed'); raise SystemExit\n"
      "a = n.linspace(-1, 1, %d); z, y, x = n.meshgrid(a, a, a, indexing='ij')\n"
      "f = 0.81 - x*x - y*y - z*z; k = 3 * n.pi; s = n.sin; c = n.cos\n"
      "if %d: f = n.minimum(s(k*x)*c(k*y) + s(k*y)*c(k*z) + s(k*z)*c(k*x), 5 * f)\n"
      "least = 1e9\n"
      "for turn in range(%d):\n"
      "  b = time.perf_counter(); v, t, q, w = m(f, 0.0); least = min(least, time.perf_counter() - b)\n"
      "print('    scikit-image  %%7.2f ns a cell, %%d triangles' %% (1e9 * least / %.1f, len(t)))\n";
  FILE *python = popen("python3 - 2>/dev/null || echo '    python3 is not installed'", "w");
  if (!python) return;
  fprintf(python, script, N, gyroid, TURNS, cells);
  pclose(python);
}

static void measure(const hk_host *host, const double *value, hk_isosurface_method method) {
  hk_isosurface_grid grid = {{N, N, N}, {-1, -1, -1}, {2.0 / (N - 1), 2.0 / (N - 1), 2.0 / (N - 1)}};
  hk_isosurface_field field = {.values = value};
  hk_isosurface_options options = {.method = method};
  hk_isosurface surface = {0};
  double least = INFINITY;
  for (int turn = 0; turn < TURNS; turn++) {
    double begin = now();
    if (hk_isosurface_find(&surface, host, &grid, &field, &options) != HK_OK) exit(1);
    least = fmin(least, now() - begin);
  }
  printf("    %-12s %8.2f ns a cell, %zu triangles, %.0f ns each\n", method ? "cubes" : "tetrahedra",
         1e9 * least / cells, surface.triangles, 1e9 * least / (double)surface.triangles);
  fflush(stdout);
  hk_isosurface_free(&surface, host);
}

int main(void) {
  hk_error error = {0};
  hk_plugin plugin = {.kind = HK_SERVICE};
  hk_shared shared = {
      .error = &error, .threads = hk_threads_create(1), .allocations_left = -1, .lanes = hk_processor_lanes()};
  hk_instance instance = {
      .host = hk_host_table, .shared = &shared, .plugin = &plugin, .label = "isosurface", .where = ""};
  double *value = malloc((size_t)N * N * N * sizeof *value);
  if (!value || !shared.threads) return 1;
  for (int gyroid = 0; gyroid < 2; gyroid++) {
    printf("%s\n", gyroid ? "gyroid" : "sphere");
    fill(gyroid, value);
    measure(&instance.host, value, HK_MARCHING_TETRAHEDRA);
    measure(&instance.host, value, HK_MARCHING_CUBES);
    print_peer(gyroid);
  }
  free(value);
  hk_memory_clear(&instance.blocks);
  hk_threads_destroy(shared.threads);
  return 0;
}
