/* The springs kernel against the straightforward loop, and what a spring must and must not do. */
#include "core/engine/contract/contract.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t seed = 1;

static double noise(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) * 0x1.0p-52 - 1;
}

typedef struct graph {
  test_engine e;
  hk_plugin_spec *spec;
  hk_instance *springs;
  size_t n, count;
  uint32_t (*edge)[2];
  double *k, *c, *L, *F, *v;
} graph;

static void open_graph(graph *g, size_t n, size_t room) {
  *g = (graph){.n = n};
  test_engine_open(&g->e);
  for (size_t i = 0; i < n; i++) test_particle(&g->e, noise(), noise(), noise(), 1);
  g->edge = malloc((room + 1) * sizeof *g->edge);
  g->k = malloc((room + 1) * sizeof(double));
  g->c = malloc((room + 1) * sizeof(double));
  g->L = malloc((room + 1) * sizeof(double));
  g->F = malloc(3 * n * sizeof(double));
  g->v = malloc(3 * n * sizeof(double));
  for (size_t e = 0; e < 3 * n; e++) g->v[e] = noise();
}

static void add_edge(graph *g, size_t i, size_t j) {
  if (i == j) return;
  g->edge[g->count][0] = (uint32_t)i + 1;
  g->edge[g->count][1] = (uint32_t)j + 1;
  g->k[g->count] = 100 + 50 * noise();
  g->c[g->count] = 1 + noise();
  g->L[g->count++] = 0.5 + 0.5 * noise();
}

static void set_list(graph *g, const char *name, const double *list, size_t count) {
  if (count > 1)
    test_list(&g->e, g->spec, name, list, count);
  else
    test_number(&g->e, g->spec, name, list[0]);
}

/* `each`: coefficients per edge; else those of the first edge for all. */
static void start(graph *g, bool each, int threads) {
  g->e.scene->threads = threads;
  g->spec = test_plugin(&g->e, HK_FORCE, "springs");
  test_edges(&g->e, g->spec, (const uint32_t(*)[2])g->edge, g->count);
  set_list(g, "k", g->k, each ? g->count : 1);
  set_list(g, "damping", g->c, each ? g->count : 1);
  set_list(g, "rest", g->L, each ? g->count : 1);
  for (size_t e = 1; e < g->count && !each; e++) g->k[e] = g->k[0], g->c[e] = g->c[0], g->L[e] = g->L[0];
  g->e.options.dt = 1e-3;
  test_run(&g->e);
  g->springs = test_instance(&g->e, g->spec);
}

static void close_graph(graph *g) {
  test_engine_close(&g->e);
  free(g->edge);
  free(g->k);
  free(g->c);
  free(g->L);
  free(g->F);
  free(g->v);
}

static double evaluate(graph *g) {
  hk_view view = *hk_run_view(g->e.run);
  double power = 0;
  view.v = g->v;
  view.power = &power;
  view.host = &g->springs->host;
  memset(g->F, 0, 3 * g->n * sizeof *g->F);
  assert_int_equal(g->springs->plugin->force->add(g->springs->self, &view, g->F), HK_OK);
  return power;
}

/* The straightforward loop; returns the power of the damping. */
static double reference(const graph *g, double *F, double *scale) {
  const double *x = hk_run_view(g->e.run)->x;
  double power = 0;
  memset(F, 0, 3 * g->n * sizeof *F);
  for (size_t e = 0; e < g->count; e++) {
    size_t i = 3 * (g->edge[e][0] - 1u), j = 3 * (g->edge[e][1] - 1u);
    double d[3], l = 0, w = 0;
    for (size_t c = 0; c < 3; c++)
      d[c] = x[j + c] - x[i + c], l += d[c] * d[c], w += d[c] * (g->v[j + c] - g->v[i + c]);
    l = sqrt(l);
    if (l == 0) continue;
    double f = g->k[e] * (l - g->L[e]) + g->c[e] * w / l;
    power -= g->c[e] * w * w / (l * l);
    for (size_t c = 0; c < 3; c++) F[i + c] += f * d[c] / l, F[j + c] -= f * d[c] / l;
    *scale = fmax(*scale, fabs(f));
  }
  return power;
}

/* A particle sums 2 count/n springs in another order than the loop does: each addition rounds by 1.1e-16 of a sum that
 * is at most that many times the largest force, but grows as a random walk: a factor of 4 on the count is ample. */
static void agree(graph *g) {
  double *F = malloc(3 * g->n * sizeof *F), scale = 0, off = 0;
  double power = evaluate(g), known = reference(g, F, &scale);
  for (size_t k = 0; k < 3 * g->n; k++) off = fmax(off, fabs(F[k] - g->F[k]));
  if (!(off <= 1.1e-16 * (20 + 8 * (double)g->count / (double)g->n) * scale))
    fail_msg("forces differ by %g of %g", off, scale);
  if (!(fabs(power - known) <= 1e-12 * fabs(known))) fail_msg("power %.17g instead of %.17g", power, known);
  free(F);
}

/* The energy, and the trace of the bound of K: a spring adds 2 (k + 2 max(0, k (1 - L/l))) to each of two equal ends,
 * k along it and the rest in two directions across. All terms are positive, so the sums are off by at most count
 * roundings of them. */
static void sums_agree(graph *g) {
  const hk_view *view = hk_run_view(g->e.run);
  const hk_force_tables *force = hk_force_of(g->springs->plugin);
  double(*block)[6] = calloc(g->n, sizeof *block), energy = 0, trace = 0, bound = 0;
  for (size_t e = 0; e < g->count; e++) {
    size_t i = 3 * (g->edge[e][0] - 1u), j = 3 * (g->edge[e][1] - 1u);
    double l = 0;
    for (size_t c = 0; c < 3; c++) l += pow(view->x[j + c] - view->x[i + c], 2);
    l = sqrt(l);
    energy += g->k[e] * pow(l - g->L[e], 2) / 2;
    trace += 4 * (g->k[e] + 2 * fmax(0, l > 0 ? g->k[e] * (1 - g->L[e] / l) : 0));
  }
  force->bounds.stiffness_bound(g->springs->self, view, HK_STIFFNESS_WHOLE, block);
  for (size_t i = 0; i < g->n; i++) bound += block[i][0] + block[i][3] + block[i][5];
  free(block);
  double found = force->own.energy(g->springs->self, view), most = 1.2e-16 * (4 + (double)g->count);
  if (!(fabs(found - energy) <= most * energy)) fail_msg("energy %.17g instead of %.17g", found, energy);
  if (!(fabs(bound - trace) <= 12 * most * trace)) fail_msg("bound %.17g instead of %.17g", bound, trace);
}

static void grid(graph *g, size_t side, bool shuffle) {
  uint32_t *at = malloc(side * side * sizeof *at);
  open_graph(g, side * side, 4 * side * side);
  for (uint32_t k = 0; k < side * side; k++) at[k] = k;
  for (size_t k = side * side - 1; shuffle && k > 0; k--) {
    size_t other = (size_t)((noise() + 1) / 2 * (double)k);
    uint32_t swap = at[k];
    at[k] = at[other];
    at[other] = swap;
  }
  for (size_t j = 0; j < side; j++)
    for (size_t i = 0; i + 1 < side; i++) add_edge(g, at[j * side + i], at[j * side + i + 1]);
  for (size_t j = 0; j + 1 < side; j++)
    for (size_t i = 0; i < side; i++) add_edge(g, at[j * side + i], at[(j + 1) * side + i]);
  for (size_t j = 0; j + 1 < side; j++)
    for (size_t i = 0; i + 1 < side; i++) add_edge(g, at[j * side + i], at[(j + 1) * side + i + 1]);
  free(at);
}

static void every_path_equals_the_plain_loop(void **state) {
  (void)state;
  const size_t sides[] = {2, 3, 5, 17, 64, 90}; /* one spring at a time, lists, runs, several ranges */
  for (size_t s = 0; s < sizeof sides / sizeof *sides; s++)
    for (int kind = 0; kind < 4; kind++) {
      graph g;
      grid(&g, sides[s], kind & 1);
      start(&g, kind & 2, 1);
      agree(&g);
      sums_agree(&g);
      close_graph(&g);
    }
}

static void random_graphs_with_doubled_edges_agree(void **state) {
  (void)state;
  for (size_t count = 1; count < 40000; count = count * 3 + 1) {
    graph g;
    open_graph(&g, 300, count);
    for (size_t e = 0; e < count; e++) add_edge(&g, (size_t)(150 * (noise() + 1)), (size_t)(150 * (noise() + 1)) % 300);
    if (g.count) {
      start(&g, true, 1);
      agree(&g);
      sums_agree(&g);
    }
    close_graph(&g);
  }
}

static void threads_give_the_same_bits(void **state) {
  (void)state;
  double *first = malloc(3 * 90 * 90 * sizeof *first), power[3];
  for (int threads = 1; threads <= 3; threads++) {
    graph g;
    seed = 5;
    grid(&g, 90, true);
    start(&g, true, threads);
    power[threads - 1] = evaluate(&g);
    if (threads == 1)
      memcpy(first, g.F, 3 * g.n * sizeof *first);
    else
      assert_memory_equal(first, g.F, 3 * g.n * sizeof *first);
    close_graph(&g);
  }
  assert_true(power[0] == power[1] && power[0] == power[2]);
  free(first);
}

/* f = -(k (l - L) + c (u.d)/l) d/l by hand: l = 5, k = 10, L = 3, c = 2, u.d/l = 2: f = -(20 + 4) (3, 4, 0)/5. */
static void one_spring_by_hand(void **state) {
  (void)state;
  graph g;
  open_graph(&g, 2, 1);
  add_edge(&g, 0, 1);
  g.k[0] = 10, g.c[0] = 2, g.L[0] = 3;
  memcpy(g.e.scene->particles.position, (double[]){1, 1, 1, 4, 5, 1}, 6 * sizeof(double));
  memcpy(g.v, (double[]){0, 0, 0, 2, 1, 7}, 6 * sizeof(double));
  start(&g, false, 1);
  double power = evaluate(&g), wanted[6] = {14.4, 19.2, 0, -14.4, -19.2, 0};
  for (int k = 0; k < 6; k++) assert_true(fabs(g.F[k] - wanted[k]) < 1e-14);
  assert_true(fabs(power + 8) < 1e-14); /* -c 2^2 */
  close_graph(&g);
}

static void springs_of_no_length_are_smooth_and_never_nan(void **state) {
  (void)state;
  graph g;
  open_graph(&g, 40, 39);
  for (size_t i = 0; i + 1 < 40; i++) add_edge(&g, i, i + 1);
  g.L[0] = 0;
  memset(g.e.scene->particles.position, 0, 3 * 40 * sizeof(double)); /* all at one point */
  start(&g, false, 1);
  double power = evaluate(&g);
  for (size_t k = 0; k < 3 * g.n; k++) assert_true(g.F[k] == 0);
  assert_true(power == 0);
  close_graph(&g);
}

static void momentum_and_torque_are_zero(void **state) {
  (void)state;
  graph g;
  grid(&g, 30, true);
  start(&g, true, 1);
  evaluate(&g);
  const double *x = hk_run_view(g.e.run)->x;
  double sum[3] = {0}, torque[3] = {0}, scale = 0;
  for (size_t i = 0; i < g.n; i++)
    for (size_t c = 0; c < 3; c++) {
      size_t a = 3 * i + (c + 1) % 3, b = 3 * i + (c + 2) % 3;
      sum[c] += g.F[3 * i + c];
      torque[c] += x[a] * g.F[b] - x[b] * g.F[a];
      scale += fabs(g.F[3 * i + c]);
    }
  for (int c = 0; c < 3; c++) assert_true(fabs(sum[c]) < 1e-14 * scale && fabs(torque[c]) < 1e-14 * scale);
  close_graph(&g);
}

/* Central differences with h = eps^(1/3): truncation and rounding are both about eps^(2/3) = 4e-11, times the third
 * derivative, some hundreds here. */
static void undamped_force_is_minus_the_gradient_of_the_energy(void **state) {
  (void)state;
  graph g;
  open_graph(&g, 6, 10);
  for (size_t i = 0; i < 5; i++) add_edge(&g, i, i + 1);
  for (size_t e = 0; e < g.count; e++) g.c[e] = 0;
  start(&g, true, 1);
  evaluate(&g);
  hk_view view = *hk_run_view(g.e.run);
  double x[18], h = 6e-6;
  memcpy(x, view.x, sizeof x);
  view.x = x;
  for (int k = 0; k < 18; k++) {
    double at = x[k];
    x[k] = at + h;
    double up = g.springs->plugin->force->energy(g.springs->self, &view);
    x[k] = at - h;
    double down = g.springs->plugin->force->energy(g.springs->self, &view);
    x[k] = at;
    assert_true(fabs(-(up - down) / (2 * h) - g.F[k]) < 1e-7);
  }
  close_graph(&g);
}

/* The k-th allocation fails, for every k: an error and no leak. */
static void no_memory_is_an_error_at_every_allocation(void **state) {
  (void)state;
  for (long k = 0;; k++) {
    graph g;
    open_graph(&g, 400, 1200);
    for (size_t i = 0; i + 1 < 400; i++) add_edge(&g, i, i + 1);
    for (size_t i = 0; i + 7 < 400; i += 3) add_edge(&g, i + 7, i);
    g.spec = test_plugin(&g.e, HK_FORCE, "springs");
    test_edges(&g.e, g.spec, (const uint32_t(*)[2])g.edge, g.count);
    test_number(&g.e, g.spec, "k", 1);
    g.e.options.dt = 1e-3;
    g.e.options.allocations = k + 1;
    hk_status status = hk_run_open(g.e.scene, &g.e.options, &g.e.run, &g.e.error);
    bool enough = status == HK_OK;
    if (!enough) assert_int_equal(status, HK_NO_MEMORY);
    close_graph(&g);
    if (enough) {
      assert_true(k > 8);
      return;
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_path_equals_the_plain_loop),
      cmocka_unit_test(random_graphs_with_doubled_edges_agree),
      cmocka_unit_test(threads_give_the_same_bits),
      cmocka_unit_test(one_spring_by_hand),
      cmocka_unit_test(springs_of_no_length_are_smooth_and_never_nan),
      cmocka_unit_test(momentum_and_torque_are_zero),
      cmocka_unit_test(undamped_force_is_minus_the_gradient_of_the_energy),
      cmocka_unit_test(no_memory_is_an_error_at_every_allocation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
