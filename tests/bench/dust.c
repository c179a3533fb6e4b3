/* A million particles under gravity, drag, wind and a vortex, by symplectic Euler: updates a second and resident
 * memory, beside one plain loop over the particles that does the same in one pass, with as many threads. Both sides
 * take the same steps in turn, the least times of some repeats count, and where the particles end has to be the same.
 */
#include "tests/support/engine.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = 1000000, THREADS = 2, STEPS = 5, REPEATS = 60 };

static const double h = 1e-3, wanted_rate = 40e6, wanted_memory = 250;                              /* s, 1/s, MB */
static const double g[3] = {0, 0, -9.81}, w[3] = {3, 1, 0}, center[3] = {0.5, 0.5, 0}, mass = 1e-6; /* kg */
static const double rate = 5, strength = 2, core = 0.2, two_pi = 6.283185307179586;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* MB, the largest resident memory of this process so far. */
static double resident(void) {
  char line[256];
  double kilobytes = NAN;
  FILE *f = fopen("/proc/self/status", "r");
  while (f && fgets(line, sizeof line, f)) sscanf(line, "VmHWM: %lf", &kilobytes);
  if (f) fclose(f);
  return kilobytes / 1000;
}

static double place(size_t k) { return (double)(k * 2654435761u % 1000003) / 1000003; }

/* ---- hooke ---- */

static void open_engine(test_engine *e, const char *profile) {
  double *x = malloc(3 * N * sizeof *x);
  uint32_t id;
  test_engine_open(e);
  for (size_t k = 0; k < 3 * N; k++) x[k] = place(k);
  if (hk_scene_add_particles(e->scene, N, x, NULL, NULL, mass, 0, &id, &e->error) != HK_OK) exit(1);
  free(x);
  e->scene->threads = THREADS;
  e->scene->duration = 1e3;
  e->scene->fps = 1 / (20 * STEPS * h); /* one part in twenty has a frame in it */
  e->options.dt = h;
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", g[0], g[1], g[2]);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", rate);
  hk_plugin_spec *wind = test_plugin(e, HK_FORCE, "wind"), *vortex = test_plugin(e, HK_FORCE, "vortex");
  test_text(e, wind, "on", "particles");
  test_vector(e, wind, "velocity", w[0], w[1], w[2]);
  test_number(e, vortex, "strength", strength);
  test_number(e, vortex, "core", core);
  test_vector(e, vortex, "center", center[0], center[1], center[2]);
  test_text(e, vortex, "profile", profile);
  for (int k = 0; k < 2; k++) {
    test_number(e, k ? wind : vortex, "rate", rate);
    test_boolean(e, k ? wind : vortex, "relative", false);
  }
  test_plugin(e, HK_INTEGRATOR, "symplectic_euler");
  test_run(e);
}

/* ---- by hand ---- */

typedef struct plain {
  double *x, *v, *m;
  bool smooth;
  size_t begin, end;
} plain;

static void *steps(void *context) {
  const plain *p = context;
  for (int s = 0; s < STEPS; s++)
    for (size_t i = p->begin; i < p->end; i++) {
      double *x = p->x + 3 * i, *v = p->v + 3 * i, d = rate * p->m[i], rx = x[0] - center[0], ry = x[1] - center[1];
      double q = (rx * rx + ry * ry) / (core * core), falls = p->smooth ? -expm1(-q) / q : q < 1 ? 1 : 1 / q;
      double turn = strength / (two_pi * core * core) * falls, u[3] = {-turn * ry, turn * rx, 0};
      for (int c = 0; c < 3; c++) {
        double F = p->m[i] * g[c] - d * v[c] + d * w[c] + d * u[c];
        v[c] += h * (F / p->m[i]);
        x[c] += h * v[c];
      }
    }
  return NULL;
}

static void advance(plain all, int threads) {
  pthread_t thread[THREADS];
  plain part[THREADS];
  for (int k = 0; k < threads; k++) {
    part[k] = all;
    part[k].begin = (size_t)k * N / (size_t)threads, part[k].end = (size_t)(k + 1) * N / (size_t)threads;
    if (k && pthread_create(&thread[k], NULL, steps, &part[k]) != 0) exit(1);
  }
  steps(&part[0]);
  for (int k = 1; k < threads; k++) pthread_join(thread[k], NULL);
}

static plain open_plain(bool smooth) {
  plain p = {calloc(3 * N, sizeof *p.x), calloc(3 * N, sizeof *p.v), calloc(N, sizeof *p.m), smooth, 0, N};
  for (size_t k = 0; k < 3 * N; k++) p.x[k] = place(k);
  for (size_t i = 0; i < N; i++) p.m[i] = mass;
  return p;
}

/* ---- both in turn ---- */

/* Memory is that of the first engine: afterwards the largest so far has the plain loop in it. */
static bool compare(const char *profile, bool first) {
  test_engine e;
  double least[2] = {INFINITY, INFINITY}, apart = 0;
  open_engine(&e, profile);
  test_advance(&e, STEPS * h);
  double memory = resident();
  plain p = open_plain(strcmp(profile, "lamb_oseen") == 0);
  advance(p, THREADS);
  for (int k = 1; k < REPEATS; k++) {
    double begin = now();
    test_advance(&e, (k + 1) * STEPS * h);
    double middle = now();
    advance(p, THREADS);
    least[0] = fmin(least[0], middle - begin);
    least[1] = fmin(least[1], now() - middle);
  }
  const double *x = e.run->state.X;
  for (size_t k = 0; k < 3 * N; k++) apart = fmax(apart, fabs(x[k] - p.x[k]));
  double updates = (double)N * STEPS;
  printf("%-10s hooke %6.1f million updates/s, plain loop %6.1f; %.2f times its time; %.1e m apart\n", profile,
         1e-6 * updates / least[0], 1e-6 * updates / least[1], least[0] / least[1], apart);
  if (first) printf("largest resident memory of hooke: %.0f MB\n", memory);
  fflush(stdout);
  test_engine_close(&e);
  free(p.x), free(p.v), free(p.m);
  return apart < 1e-9 && updates / least[0] >= wanted_rate && (!first || memory <= wanted_memory);
}

int main(void) {
  printf("%d particles, gravity, drag, wind, a vortex, symplectic_euler, %d threads; wanted: %.0f million updates/s, "
         "%.0f MB\n",
         N, THREADS, 1e-6 * wanted_rate, wanted_memory);
  bool fine = compare("rankine", true);
  return compare("lamb_oseen", false) && fine ? 0 : 1;
}
