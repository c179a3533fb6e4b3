/* Grains beside a plain loop: 100,000 spheres that settle in a box, with a remembered slip in every contact. The plain
 * loop has the pairs in a list, each once, and the slip beside it; it is the law of the plugin, single-threaded. Both
 * in turn, each as its least of REPEATS. Then the search for the neighbours of a million grains, in the order of a
 * lattice and in a random one. */
#include "core/engine/contract/contract.h"
#include "plugins/common/grains/grain_law.h"
#include "tests/support/engine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { REPEATS = 9 };
static const double R = 0.5, K = 1e4, dt = 1e-4, friction = 0.5;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* s, of the process: others on the machine disturb it less. */
static double own(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *memory(size_t count, size_t size) {
  void *p = calloc(count + 1, size);
  if (p) return p;
  fprintf(stderr, "no memory for %zu numbers: close other programs\n", count);
  exit(1);
}

/* ---- the box ---- */

typedef struct box {
  test_engine e;
  hk_plugin_spec *grains;
  size_t n;
} box;

/* side^3 spheres on a lattice closer than their size, a little shaken; `mixed`: in a random order. */
static void open_box(box *b, size_t side, double spacing, bool mixed, int threads) {
  uint64_t seed[4];
  uint32_t first;
  *b = (box){.n = side * side * side};
  test_engine_open(&b->e);
  hk_random_seed(seed, 1);
  size_t *place = memory(b->n, sizeof *place);
  double *x = memory(3 * b->n, sizeof *x), *v = memory(3 * b->n, sizeof *v);
  for (size_t i = 0; i < b->n; i++) place[i] = i;
  for (size_t i = b->n; mixed && i-- > 1;) {
    size_t j = (size_t)(hk_random_uniform(seed) * (double)(i + 1)), kept = place[i];
    place[i] = place[j];
    place[j] = kept;
  }
  for (size_t i = 0; i < b->n; i++)
    for (size_t c = 0, at = place[i]; c < 3; c++, at /= side) {
      x[3 * i + c] = spacing * (double)(at % side) + 0.1 * R * (hk_random_uniform(seed) - 0.5);
      v[3 * i + c] = hk_random_uniform(seed) - 0.5;
    }
  b->e.scene->threads = threads;
  b->e.options.integrator = "dopri5"; /* which needs no estimate of the stable step */
  b->e.scene->fps = 1 / dt;
  if (hk_scene_add_particles(b->e.scene, b->n, x, v, NULL, 1, 0, &first, &b->e.error) != HK_OK) exit(1);
  b->grains = test_plugin(&b->e, HK_FORCE, "soft_spheres");
  test_number(&b->e, b->grains, "radius", R);
  test_number(&b->e, b->grains, "stiffness", K);
  test_number(&b->e, b->grains, "friction", friction);
  test_run(&b->e);
  free(place);
  free(x);
  free(v);
}

static hk_view view_of(box *b, const hk_instance *force) {
  hk_view view = *hk_run_view(b->e.run);
  view.host = &force->host;
  view.acting = view.n;
  return view;
}

static hk_neighbour_rows rows_of(const box *b, const double *x) {
  hk_neighbour_rows rows;
  const hk_instance *service = b->e.run->plugins.kind[HK_SERVICE].item[0];
  const hk_neighbours *table = service->plugin->service->table(service->self);
  if (table->rows(table->self, hk_run_view(b->e.run), x, &rows) != HK_OK) exit(1);
  return rows;
}

/* ---- the plain loop ---- */

typedef struct plain {
  size_t pairs;
  uint32_t (*pair)[2];
  double (*slip)[3];
} plain;

static void list_pairs(plain *p, const box *b, const double *x) {
  hk_neighbour_rows rows = rows_of(b, x);
  p->pair = memory(rows.row_start[rows.n], sizeof *p->pair);
  p->slip = memory(rows.row_start[rows.n], sizeof *p->slip);
  for (size_t i = 0; i < rows.n; i++)
    for (size_t k = rows.row_start[i]; k < rows.row_start[i + 1]; k++)
      if (rows.other[k] > i) p->pair[p->pairs][0] = (uint32_t)i, p->pair[p->pairs++][1] = rows.other[k];
}

static size_t plain_sweep(const plain *p, const hk_grain_law *law, const double *x, const double *v, double *F) {
  size_t contacts = 0;
  for (size_t k = 0; k < p->pairs; k++) {
    size_t i = p->pair[k][0], j = p->pair[k][1];
    double r[3], r2 = 0, along = 0;
    for (size_t c = 0; c < 3; c++) r[c] = x[3 * i + c] - x[3 * j + c], r2 += r[c] * r[c];
    if (!(r2 < 4 * R * R)) continue;
    hk_grain_contact c = {.overlap = 2 * R - sqrt(r2), .mass = 0.5};
    for (size_t a = 0; a < 3; a++) {
      c.normal[a] = r[a] / sqrt(r2), c.u[a] = v[3 * i + a] - v[3 * j + a];
      c.slip[a] = p->slip[k][a] + dt * c.u[a];
      along += c.slip[a] * c.normal[a];
    }
    for (int a = 0; a < 3; a++) c.slip[a] -= along * c.normal[a];
    hk_grain_force(law, &c);
    for (size_t a = 0; a < 3; a++) {
      F[3 * i + a] += c.force[a], F[3 * j + a] -= c.force[a];
      p->slip[k][a] = c.slip[a];
    }
    contacts++;
  }
  return contacts;
}

/* ---- contacts a second ---- */

static double least(double a, double b) { return a < b ? a : b; }

static void contacts(size_t side, int threads) {
  box b;
  plain p = {0};
  double sum = INFINITY, step = INFINITY, by_hand = INFINITY;
  size_t touching = 0;
  open_box(&b, side, 1.9 * R, false, threads);
  test_advance(&b.e, 2 * dt);
  hk_instance *force = test_instance(&b.e, b.grains);
  double *F = memory(3 * b.n, sizeof *F);
  hk_grain_law law = {K, 2. / 7 * K, friction, hk_grain_damping(0.8), 1};
  hk_view view = view_of(&b, force);
  list_pairs(&p, &b, view.x);
  for (int r = 0; r < REPEATS; r++) {
    view = view_of(&b, force);
    double t0 = own();
    if (force->plugin->force->add(force->self, &view, F) != HK_OK) exit(1);
    double t1 = own();
    if (hk_force_of(force->plugin)->steps.accepted(force->self, &view, 0) != HK_OK) exit(1);
    double t2 = own();
    touching = plain_sweep(&p, &law, view.x, view.v, F);
    by_hand = least(by_hand, own() - t2);
    sum = least(sum, t1 - t0), step = least(step, t2 - t0);
  }
  double unit = 1e-6 * (double)touching;
  printf("%zu grains, %d thread%s, %zu contacts: %.1f million contacts a second of processor time, %.1f with what is "
         "remembered; by hand %.1f\n",
         b.n, threads, threads > 1 ? "s" : "", touching, unit / sum, unit / step, unit / by_hand);
  free(p.pair);
  free(p.slip);
  free(F);
  test_engine_close(&b.e);
}

/* ---- the search ---- */

/* Every second time the grains are a metre beside: all rows have to be found again. */
static void search(size_t side, bool mixed, int threads) {
  box b;
  double wall = INFINITY, processor = INFINITY, pairs = 0;
  open_box(&b, side, 1.97 * R, mixed, threads);
  double *x = memory(3 * b.n, sizeof *x);
  memcpy(x, hk_run_view(b.e.run)->x, 3 * b.n * sizeof *x);
  for (int r = 0; r < REPEATS; r++) {
    for (size_t k = 0; k < b.n; k++) x[3 * k] += r % 2 ? 1 : -1;
    double t0 = now(), p0 = own();
    pairs = (double)rows_of(&b, x).row_start[b.n];
    wall = least(wall, now() - t0), processor = least(processor, own() - p0);
  }
  printf("%zu grains %s, %d thread%s, %.1f in a row: rows found in %.0f ms, %.0f ms of processor time\n", b.n,
         mixed ? "in a random order" : "in the order of a lattice", threads, threads > 1 ? "s" : "",
         pairs / (double)b.n, 1e3 * wall, 1e3 * processor);
  free(x);
  test_engine_close(&b.e);
}

int main(void) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  contacts(47, 1);
  contacts(47, 2);
  for (int mixed = 0; mixed < 2; mixed++)
    for (int threads = 1; threads <= 2; threads++) search(100, mixed, threads);
  return 0;
}
