/* A sheet of 100 x 100 particles, some 20,000 triangles, falls onto a ball, drapes over it and hangs down in folds that
 * touch each other: the barrier with bdf2 at h = 1/120 s, two steps a frame, and no accuracy asked for beyond a
 * hundredth of the speed. Time on the wall, which on two threads is what a user waits for, and of the process, which
 * others on the machine disturb less; a twentieth of a second at a time, from the landing on.
 *     build/bench/drape [solver] [threads] [seconds] */
#include "tests/support/engine.h"
#include "tests/support/sheets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SIDE = 100, RINGS = 24, FPS = 60 };
static const double pi = 3.14159265358979323846, ball = 0.25, thickness = 4e-3;

static double seconds(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void must(test_engine *e, hk_status status) {
  if (status == HK_OK) return;
  fprintf(stderr, "%s\n", e->error.text);
  exit(1);
}

static uint32_t corner(uint32_t i, uint32_t j) { return 1 + j * SIDE + i; }

/* Springs of 100 N/m along the sides of the squares and both of their diagonals, and hinges of 2e-5 N m. */
static void add_sheet(test_engine *e) {
  static uint32_t edge[4 * SIDE * SIDE][2], triangle[2 * SIDE * SIDE][3];
  size_t edges = 0, triangles = 0;
  for (int k = 0; k < SIDE * SIDE; k++)
    test_particle(e, (k % SIDE) / (SIDE - 1.) - 0.5, (k / SIDE) / (SIDE - 1.) - 0.5, ball + 0.02, 0.2 / SIDE / SIDE);
  for (uint32_t j = 0; j < SIDE; j++)
    for (uint32_t i = 0; i < SIDE; i++) {
      if (i) memcpy(edge[edges++], (uint32_t[]){corner(i - 1, j), corner(i, j)}, sizeof *edge);
      if (j) memcpy(edge[edges++], (uint32_t[]){corner(i, j - 1), corner(i, j)}, sizeof *edge);
      if (!i || !j) continue;
      uint32_t a = corner(i - 1, j - 1), b = corner(i, j - 1), c = corner(i, j), d = corner(i - 1, j);
      bool other = (i + j) % 2;
      memcpy(edge[edges++], (uint32_t[]){a, c}, sizeof *edge);
      memcpy(edge[edges++], (uint32_t[]){b, d}, sizeof *edge);
      memcpy(triangle[triangles++], (uint32_t[]){a, b, other ? c : d}, sizeof *triangle);
      memcpy(triangle[triangles++], (uint32_t[]){other ? a : b, c, d}, sizeof *triangle);
    }
  must(e, hk_scene_add_triangles(e->scene, triangles, (const uint32_t(*)[3])triangle, &e->error));
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs"), *hinges = test_plugin(e, HK_FORCE, "hinges");
  test_edges(e, springs, (const uint32_t(*)[2])edge, edges);
  test_number(e, springs, "k", 50);
  test_number(e, springs, "damping", 1e-3);
  test_tuples(e, hinges, "triangles", 3, &triangle[0][0], triangles);
  test_number(e, hinges, "rigidity", 2e-5);
  test_number(e, hinges, "damping", 1e-6);
}

static uint32_t ring(int i, int j) {
  if (i == 0) return SIDE * SIDE + 1;
  if (i == RINGS) return SIDE * SIDE + 2;
  return (uint32_t)(SIDE * SIDE + 3 + (i - 1) * 2 * RINGS + j % (2 * RINGS));
}

static void add_ball(test_engine *e) {
  static uint32_t triangle[4 * RINGS * RINGS][3];
  size_t triangles = 0;
  test_particle(e, 0, 0, ball, 1);
  test_particle(e, 0, 0, -ball, 1);
  for (int i = 1; i < RINGS; i++)
    for (int j = 0; j < 2 * RINGS; j++) {
      double a = pi * i / RINGS, b = pi * j / RINGS;
      test_particle(e, ball * sin(a) * cos(b), ball * sin(a) * sin(b), ball * cos(a), 1);
    }
  for (uint32_t id = SIDE * SIDE + 1; id <= e->scene->particles.n; id++) test_pin(e, HK_PIN_FIXED, id, NULL);
  for (int i = 0; i < RINGS; i++)
    for (int j = 0; j < 2 * RINGS; j++) {
      if (i > 0)
        memcpy(triangle[triangles++], (uint32_t[]){ring(i, j), ring(i + 1, j), ring(i, j + 1)}, sizeof *triangle);
      if (i + 1 < RINGS)
        memcpy(triangle[triangles++], (uint32_t[]){ring(i, j + 1), ring(i + 1, j), ring(i + 1, j + 1)},
               sizeof *triangle);
    }
  must(e, hk_scene_add_triangles(e->scene, triangles, (const uint32_t(*)[3])triangle, &e->error));
}

static void open_world(test_engine *e, const char *solver, int threads) {
  test_engine_open(e);
  e->options.integrator = "bdf2:tolerance=1e-2";
  e->options.dt = 1. / (2 * FPS);
  e->options.threads = threads;
  e->scene->duration = 100;
  e->scene->fps = FPS;
  add_sheet(e);
  add_ball(e);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -9.81);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 1);
  if (strcmp(solver, "chosen") != 0) test_plugin(e, HK_SOLVER, solver);
  hk_plugin_spec *barrier = test_plugin(e, HK_FORCE, "barrier");
  test_number(e, barrier, "thickness", thickness / 2);
  test_number(e, barrier, "d_hat", thickness / 2);
  test_number(e, barrier, "friction", 0.3);
  test_run(e);
}

int main(int count, char **argument) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  const char *solver = count > 1 ? argument[1] : "pcg";
  int threads = count > 2 ? atoi(argument[2]) : 2;
  double until = count > 3 ? atof(argument[3]) : 0.6;
  test_engine e;
  open_world(&e, solver, threads);
  printf("solver %s, %d threads:\n", solver, threads);
  for (double t = 0.05; t < until + 0.025; t += 0.05) {
    hk_summary before, after;
    hk_run_summary(e.run, &before);
    size_t jacobians = e.run->dynamics.count.jacobians;
    double wall = seconds(CLOCK_MONOTONIC), own = seconds(CLOCK_PROCESS_CPUTIME_ID);
    test_advance(&e, t);
    wall = seconds(CLOCK_MONOTONIC) - wall, own = seconds(CLOCK_PROCESS_CPUTIME_ID) - own;
    hk_run_summary(e.run, &after);
    double frames = 0.05 * FPS, steps = (double)(after.steps - before.steps);
    printf("to %.2f s: %5.2f s a frame on the wall, %5.2f s of the process; a frame has %.1f steps and %.1f Jacobians, "
           "%g intersections\n",
           t, wall / frames, own / frames, steps / frames,
           (double)(e.run->dynamics.count.jacobians - jacobians) / frames, after.intersections);
  }
  test_engine_close(&e);
  return 0;
}
