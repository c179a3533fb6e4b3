/* The kernel of angle springs beside the straightforward scalar loop with the C library's atan2, compiled with the same
 * flags, one thread, on hair of 32 particles a strand and on one chain. Times are the least of repeats taken in turn.
 */
#include "core/engine/contract/contract.h"
#include "tests/support/engine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { STRANDS = 1000, EACH = 32, N = STRANDS * EACH, REPEATS = 60 };

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void cross(const double *a, const double *b, double *into) {
  for (int c = 0; c < 3; c++) into[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Straight at rest: f_m = (z/s) e_m x b/|e_m|^2, as in the kernel. */
static void scalar(const uint32_t (*joint)[3], size_t count, double k, double c, const double *x, const double *v,
                   double *F) {
  for (size_t j = 0; j < count; j++) {
    double e[2][3], u[2][3], b[3], g[2][3];
    for (int m = 0; m < 2; m++)
      for (int q = 0; q < 3; q++) {
        e[m][q] = x[3 * joint[j][m + 1] + q] - x[3 * joint[j][m] + q];
        u[m][q] = v[3 * joint[j][m + 1] + q] - v[3 * joint[j][m] + q];
      }
    cross(e[0], e[1], b);
    double s = sqrt(dot(b, b)), z = k * atan2(s, dot(e[0], e[1]));
    if (s == 0) continue;
    cross(e[0], b, g[0]);
    cross(b, e[1], g[1]);
    for (int m = 0; m < 2; m++) {
      double factor = 1 / (s * dot(e[m], e[m]));
      for (int q = 0; q < 3; q++) g[m][q] *= factor;
    }
    if (c > 0) z += c * (dot(g[0], u[0]) + dot(g[1], u[1]));
    for (int q = 0; q < 3; q++) {
      F[3 * joint[j][0] + q] += z * g[0][q];
      F[3 * joint[j][1] + q] += z * (g[1][q] - g[0][q]);
      F[3 * joint[j][2] + q] -= z * g[1][q];
    }
  }
}

static void compare(const char *what, size_t strand, double damping) {
  static uint32_t joint[N][3];
  static double v[3 * N], F[2][3 * N];
  double best[2] = {INFINITY, INFINITY}, off = 0, largest = 0;
  size_t count = 0;
  test_engine e;
  test_engine_open(&e);
  e.scene->threads = 1;
  e.options.dt = 1e-6;
  for (size_t i = 0; i < N; i++) {
    double a = 0.3 * (double)(i % strand);
    test_particle(&e, cos(a), sin(a), 0.2 * a + (double)(i / strand), 1);
    if (i % strand > 1)
      memcpy(joint[count++], (uint32_t[]){(uint32_t)i - 1, (uint32_t)i, (uint32_t)i + 1}, sizeof *joint);
  }
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "angle_springs");
  test_tuples(&e, spec, "joints", 3, &joint[0][0], count);
  test_number(&e, spec, "k", 2);
  test_number(&e, spec, "damping", damping);
  test_number(&e, spec, "rest", 0);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = *hk_run_view(e.run);
  for (size_t k = 0; k < 3 * N; k++) v[k] = cos(0.1 * (double)k);
  for (size_t k = 0; k < 3 * count; k++) joint[k / 3][k % 3]--;
  view.v = v;
  view.host = &force->host;
  for (int r = 0; r < REPEATS; r++) {
    memset(F, 0, sizeof F);
    double t0 = now();
    scalar((const uint32_t(*)[3])joint, count, 2, damping, view.x, v, F[0]);
    double t1 = now();
    force->plugin->force->add(force->self, &view, F[1]);
    best[0] = fmin(best[0], t1 - t0);
    best[1] = fmin(best[1], now() - t1);
  }
  for (size_t k = 0; k < 3 * N; k++) largest = fmax(largest, fabs(F[0][k])), off = fmax(off, fabs(F[0][k] - F[1][k]));
  printf("%-24s scalar %6.2f ns, angle_springs %6.2f ns a joint: %.2fx; they differ by %.1e of the largest force\n",
         what, best[0] / (double)count * 1e9, best[1] / (double)count * 1e9, best[0] / best[1], off / largest);
  test_engine_close(&e);
}

/* The blocks of a chain, five in a row of its matrix, on one thread. */
static void blocks(const char *what, double damping, unsigned want) {
  static uint32_t joint[N][3];
  double best = INFINITY;
  size_t count = 0;
  test_engine e;
  test_engine_open(&e);
  e.scene->threads = 1;
  e.options.dt = 1e-6;
  for (size_t i = 0; i < N; i++) {
    test_particle(&e, cos(0.3 * (double)i), sin(0.3 * (double)i), 0.06 * (double)i, 1);
    if (i > 1) memcpy(joint[count++], (uint32_t[]){(uint32_t)i - 1, (uint32_t)i, (uint32_t)i + 1}, sizeof *joint);
  }
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "angle_springs");
  test_tuples(&e, spec, "joints", 3, &joint[0][0], count);
  test_number(&e, spec, "k", 2);
  test_number(&e, spec, "damping", damping);
  test_number(&e, spec, "rest", 0);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = *hk_run_view(e.run);
  view.host = &force->host;
  size_t *slot = malloc(9 * count * sizeof *slot);
  double *K = calloc(9 * 5 * N, sizeof *K), *D = calloc(9 * 5 * N, sizeof *D);
  for (size_t k = 0; k < 9 * count; k++) slot[k] = 5 * (k / 9 + k % 9 / 3) + (k % 3 + 2) - k % 9 / 3;
  for (int r = 0; r < REPEATS / 4; r++) {
    double t0 = now();
    hk_force_of(force->plugin)
        ->implicit.jacobian(force->self, &view, &(hk_blocks){.slot = slot, .K = K, .D = D, .want = want});
    best = fmin(best, now() - t0);
  }
  printf("%-24s %6.0f ns a joint\n", what, best / (double)count * 1e9);
  free(slot);
  free(K);
  free(D);
  test_engine_close(&e);
}

int main(void) {
  blocks("blocks, exact", 0, 0);
  blocks("blocks, exact, damped", 0.1, 0);
  blocks("blocks, definite", 0, HK_WANT_SYMMETRIC | HK_WANT_DEFINITE);
  compare("hair", EACH, 0);
  compare("hair, damped", EACH, 0.1);
  compare("one chain", N, 0);
  compare("one chain, damped", N, 0.1);
  return 0;
}
