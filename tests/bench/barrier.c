/* What the barrier costs on ten sheets that lie on each other, from 5,000 to 200,000 triangles: each of its functions
 * by itself, one thread, the least of REPEATS, with blocks that are projected, which are the dearest; then whole steps
 * of bdf2 on springs with conjugate gradients, up to 50,000 triangles, on one thread and on two. Times are those of the
 * process, so that others on the machine disturb less; of steps the time on the wall is given as well.
 * The four steps are dear ones: the first is one of TR-BDF2, with two stages, and one is repeated by backward Euler.
 * With 50,000 triangles they take about 1 s of the process each, where 0.25 s would be fit for use: a third are
 * searches and gaps, a fifth the barrier's blocks, a sixth incomplete factors. */
#include "core/engine/contract/contract.h"
#include "tests/support/force_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { REPEATS = 3, LAYERS = 10, SLOTS = 1 << 16, STEPS = 4 };

static const double thickness = 1e-3, reach = 1e-3;

static double seconds(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double own(void) { return seconds(CLOCK_PROCESS_CPUTIME_ID); }

static void *memory(size_t count, size_t size) {
  void *p = calloc(count + 1, size);
  if (p) return p;
  fprintf(stderr, "no memory for %zu numbers: close other programs\n", count);
  exit(1);
}

/* n x n squares of side 1/n with their diagonals. */
static void add_sheet(test_engine *e, uint32_t n, int layer) {
  uint32_t(*edge)[2] = memory(3 * (size_t)(n + 1) * (n + 1), sizeof *edge),
  (*triangle)[3] = memory(2 * (size_t)n * n, sizeof *triangle);
  size_t edges = 0, triangles = 0;
  for (uint32_t j = 0; j <= n; j++)
    for (uint32_t i = 0; i <= n; i++) {
      double z = layer * (thickness + 0.95 * reach);
      uint32_t id = test_particle(e, 0.003 * layer + (double)i / n, 0.002 * layer + (double)j / n, z, 0.2 / n / n);
      if (i) memcpy(edge[edges++], (uint32_t[]){id - 1, id}, sizeof *edge);
      if (j) memcpy(edge[edges++], (uint32_t[]){id - n - 1, id}, sizeof *edge);
      if (!i || !j) continue;
      memcpy(edge[edges++], (uint32_t[]){id - n - 2, id}, sizeof *edge);
      memcpy(triangle[triangles++], (uint32_t[]){id - n - 2, id - n - 1, id}, sizeof *triangle);
      memcpy(triangle[triangles++], (uint32_t[]){id - n - 2, id, id - 1}, sizeof *triangle);
    }
  if (hk_scene_add_triangles(e->scene, triangles, (const uint32_t(*)[3])triangle, &e->error) != HK_OK) exit(1);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, edges);
  test_number(e, springs, "k", 300);
  test_number(e, springs, "damping", 0.05);
  free(edge), free(triangle);
}

static hk_plugin_spec *open_stack(test_engine *e, uint32_t n, int threads) {
  test_engine_open(e);
  e->options.integrator = "bdf2:tolerance=1e-2";
  e->options.threads = threads;
  e->options.dt = 1. / 120;
  e->scene->duration = 10;
  e->scene->fps = 60;
  for (int layer = 1; layer <= LAYERS; layer++) add_sheet(e, n, layer);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -9.81);
  test_plugin(e, HK_SOLVER, "pcg");
  hk_plugin_spec *barrier = test_plugin(e, HK_FORCE, "barrier");
  test_number(e, barrier, "thickness", thickness);
  test_number(e, barrier, "d_hat", reach);
  test_run(e);
  return barrier;
}

/* ---- one function after the other ---- */

typedef struct counter {
  hk_pattern pattern;
  size_t count;
} counter;

static void count_block(hk_pattern *p, uint32_t row, uint32_t column) {
  (void)row, (void)column;
  ((counter *)(void *)p)->count++;
}

typedef enum part { SEARCH, UPDATE, LIMIT, ENERGY, FORCE, PATTERN, BLOCKS, ACCEPTED, PARTS } part;
static const char *const names[PARTS] = {"search", "update", "limit", "energy", "force", "names", "blocks", "accepted"};

typedef struct bench {
  const hk_force_tables *force;
  void *self;
  hk_view view;
  double *far, *near, *dx, *F;
  counter blocks;
  hk_blocks into;
} bench;

static void call(bench *b, part which) {
  bool changed = false;
  b->blocks.count = 0;
  if (which == SEARCH) b->force->steps.update(b->self, &b->view, b->far, &changed);
  if (which == UPDATE) b->force->steps.update(b->self, &b->view, b->near, &changed);
  if (which == LIMIT) b->force->surfaces.step_limit(b->self, &b->view, b->dx);
  if (which == ENERGY) b->force->own.energy(b->self, &b->view);
  if (which == FORCE) b->force->own.add(b->self, &b->view, b->F);
  if (which == PATTERN) b->force->implicit.pattern(b->self, &b->view, &b->blocks.pattern);
  if (which == BLOCKS) b->force->implicit.jacobian(b->self, &b->view, &b->into);
  if (which == ACCEPTED) b->force->steps.accepted(b->self, &b->view, 1e-3);
}

static double least(bench *b, part which) {
  double best = INFINITY;
  for (int k = 0; k < REPEATS; k++) {
    double begin = own();
    call(b, which);
    best = fmin(best, own() - begin);
  }
  return best;
}

/* A move of 1/100 of the reach, which keeps the list, and one of every other sheet by 2, which does not. The blocks
 * of the pairs go to SLOTS places in turn. */
static void functions_of(uint32_t n) {
  test_engine e;
  hk_plugin_spec *spec = open_stack(&e, n, 1);
  hk_instance *instance = test_instance(&e, spec);
  bench b = {.force = hk_force_of(instance->plugin), .self = instance->self, .view = force_view(&e, instance)};
  size_t m = 3 * b.view.n, sheet = m / LAYERS;
  b.far = memory(m, sizeof *b.far), b.near = memory(m, sizeof *b.near), b.dx = memory(m, sizeof *b.dx);
  b.F = memory(m, sizeof *b.F);
  for (size_t k = 0; k < m; k++) {
    b.dx[k] = 0.01 * reach * sin(1.7 * (double)k);
    b.near[k] = b.view.x[k] + b.dx[k];
    b.far[k] = b.view.x[k] + (k % 3 == 0 && k / sheet % 2 ? 2 * reach : 0);
  }
  b.blocks.pattern.block = count_block;
  double seconds[PARTS], iteration = 0;
  seconds[SEARCH] = least(&b, SEARCH);
  call(&b, UPDATE);
  call(&b, PATTERN);
  size_t count = b.blocks.count, *slot = memory(count, sizeof *slot);
  for (size_t k = 0; k < count; k++) slot[k] = k % SLOTS;
  b.into = (hk_blocks){.slot = slot, .want = HK_WANT_DEFINITE};
  b.into.K = memory(9 * SLOTS, sizeof(double));
  b.into.D = memory(9 * SLOTS, sizeof(double));
  for (part p = UPDATE; p < PARTS; p++) seconds[p] = least(&b, p);
  size_t triangles = 2 * (size_t)n * n * LAYERS;
  for (part p = UPDATE; p < ACCEPTED; p++) iteration += seconds[p];
  printf("%7zu triangles, %8zu pairs with names:", triangles, count / 16);
  for (part p = 0; p < PARTS; p++) printf(" %s %.3g", names[p], 1e3 * seconds[p]);
  printf(" ms; an iteration %.3g us per triangle, a search %.3g\n", 1e6 * iteration / (double)triangles,
         1e6 * seconds[SEARCH] / (double)triangles);
  free(b.far), free(b.near), free(b.dx), free(b.F), free(slot), free(b.into.K), free(b.into.D);
  test_engine_close(&e);
}

/* ---- whole steps ---- */

static void steps_of(uint32_t n, int threads) {
  test_engine e;
  open_stack(&e, n, threads);
  double begin = own(), start = seconds(CLOCK_MONOTONIC);
  test_advance(&e, STEPS / 120.);
  double whole = own() - begin, wall = seconds(CLOCK_MONOTONIC) - start;
  hk_summary s;
  hk_run_summary(e.run, &s);
  double steps = (double)s.steps, triangles = 2. * n * n * LAYERS;
  printf("%7.0f triangles, %d threads: %.3g s of the process a step, %.3g s on the wall, %.3g us per triangle; %zu "
         "steps, %zu Jacobians, %g intersections\n",
         triangles, threads, whole / steps, wall / steps, 1e6 * whole / steps / triangles, s.steps,
         e.run->dynamics.count.jacobians, s.intersections);
  test_engine_close(&e);
}

int main(void) {
  const uint32_t cells[] = {16, 32, 50, 100};
  for (int k = 0; k < 4; k++) functions_of(cells[k]);
  for (int threads = 1; threads <= 2; threads++)
    for (int k = 0; k < 3; k++) steps_of(cells[k], threads);
  return 0;
}
