/* The bound u.K u <= sum_i u_i.B_i u_i of forces along edges against the exact Jacobian of springs, as their plugin
 * assembles it: in random networks for random u, and for all u by eliminating B - K, whose pivots must be positive; for
 * pinned and chosen particles, for each part that can be asked for, and for what may be drawn out. On regular grids it
 * is reached, so it cannot be smaller. */
#include "core/engine/contract/contract.h"
#include "plugins/kit/springs/edge_stiffness.h"
#include "tests/support/force_check.h"

#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 25, S = 60, SIZE = 3 * N, NETWORKS = 40, SIDE = 5 };

typedef struct net {
  test_engine e;
  hk_plugin_spec *spec;
  hk_instance *springs;
  hk_view view;
  size_t n, edges;
  double x[SIZE], mass[N], k[S], damping[S], rest[S];
  uint32_t pair[S][2];
} net;

static uint64_t bits;

/* -1 to 1. */
static double noise(void) {
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-52 - 1;
}

static double length_of(const net *w, size_t e) {
  double sum = 0;
  for (size_t c = 0; c < 3; c++) sum += pow(w->x[3 * w->pair[e][1] + c] - w->x[3 * w->pair[e][0] + c], 2);
  return sqrt(sum);
}

/* Masses from 1e-2 to 1e2 kg, any two particles joined, some twice; half of the springs are pressed, half drawn. */
static void make_random(net *w) {
  memset(w, 0, sizeof *w);
  w->n = 10, w->edges = 30;
  for (size_t k = 0; k < 3 * w->n; k++) w->x[k] = noise();
  for (size_t i = 0; i < w->n; i++) w->mass[i] = pow(10, 2 * noise());
  for (size_t e = 0; e < w->edges; e++) {
    size_t i = (size_t)((noise() + 1) / 2 * (double)w->n), j = (size_t)((noise() + 1) / 2 * (double)(w->n - 1));
    w->pair[e][0] = (uint32_t)i, w->pair[e][1] = (uint32_t)(j < i ? j : j + 1);
    w->k[e] = 50 + 49 * noise();
    w->damping[e] = 3 + 3 * noise();
    w->rest[e] = e % 10 ? length_of(w, e) * (1 + noise()) : 0;
  }
}

/* SIDE x SIDE particles of two masses in turn, of a spacing of 1/4 m, joined along both axes; k = 40 N/m for all. */
static void make_grid(net *w, double rest, double ratio) {
  memset(w, 0, sizeof *w);
  w->n = N;
  for (uint32_t i = 0; i < N; i++) {
    w->x[3 * i] = 0.25 * (i % SIDE), w->x[3 * i + 1] = 0.25 * (i / SIDE);
    w->mass[i] = i % 2 ? ratio : 1; /* SIDE is odd: neighbours differ along both axes */
    if (i % SIDE + 1 < SIDE) w->pair[w->edges][0] = i, w->pair[w->edges++][1] = i + 1;
    if (i + SIDE < N) w->pair[w->edges][0] = i, w->pair[w->edges++][1] = i + SIDE;
  }
  for (size_t e = 0; e < w->edges; e++) w->k[e] = w->damping[e] = 40, w->rest[e] = rest;
}

static void describe(net *w, const char *plugin) {
  uint32_t ids[S][2];
  test_engine_open(&w->e);
  for (size_t i = 0; i < w->n; i++) test_particle(&w->e, w->x[3 * i], w->x[3 * i + 1], w->x[3 * i + 2], w->mass[i]);
  for (size_t e = 0; e < w->edges; e++) ids[e][0] = w->pair[e][0] + 1, ids[e][1] = w->pair[e][1] + 1;
  w->spec = test_plugin(&w->e, HK_FORCE, plugin);
  test_edges(&w->e, w->spec, (const uint32_t(*)[2])ids, w->edges);
  test_list(&w->e, w->spec, "k", w->k, w->edges);
  test_list(&w->e, w->spec, "damping", w->damping, w->edges);
  test_list(&w->e, w->spec, "rest", w->rest, w->edges);
  w->e.options.dt = 1e-3;
}

static void open_run(net *w) {
  test_run(&w->e);
  w->springs = test_instance(&w->e, w->spec);
  w->view = force_view(&w->e, w->springs); /* at rest: damping has no part in K */
}

static void start(net *w, const char *plugin) {
  describe(w, plugin);
  open_run(w);
}

static void bound(const net *w, hk_stiffness_part part, bool drawn, double (*block)[6]) {
  const hk_tuples edges = {w->edges, 2, &w->pair[0][0]};
  const hk_per_tuple k = {w->edges, (double *)(uintptr_t)w->k}, c = {w->edges, (double *)(uintptr_t)w->damping},
                     L = {w->edges, (double *)(uintptr_t)w->rest};
  memset(block, 0, w->n * sizeof *block);
  hk_edge_stiffness_bound(&(hk_edge_stiffness){&edges, &k, &c, &L, drawn}, &w->view, part, block);
}

static double entry(const double block[6], size_t r, size_t c) {
  return block[r < c ? r * (5 - r) / 2 + c : c * (5 - c) / 2 + r];
}

/* ---- u.K u, and all u at once ---- */

/* sum_i u_i.B_i u_i - u.K u, and how far rounding may have moved it: by 1.1e-16 for each of the terms. */
static double margin(const net *w, double (*block)[6], const double *K, const double *u, double *rounding) {
  size_t size = 3 * w->n;
  double sum = 0, scale = 0;
  for (size_t r = 0; r < size; r++)
    for (size_t c = 0; c < size; c++) {
      double whole = r / 3 == c / 3 ? entry(block[r / 3], r % 3, c % 3) : 0;
      sum += u[r] * (whole - K[size * r + c]) * u[c];
      scale += fabs(u[r] * u[c]) * (fabs(whole) + fabs(K[size * r + c]));
    }
  *rounding = (double)(size * size) * 1.1e-16 * scale;
  return sum;
}

static bool is_held(const net *w, size_t i) { return !(w->view.model->inverse_mass[i] > 0); }

/* B - K, of what can move, has no negative eigenvalue: the pivots of its elimination are positive once rounding is
 * added, which is size^2 times 1.1e-16 of the largest entry. */
static bool is_semidefinite(const net *w, double (*block)[6], const double *K) {
  static double A[SIZE][SIZE];
  size_t size = 3 * w->n;
  double largest = 0;
  for (size_t r = 0; r < size; r++)
    for (size_t c = 0; c < size; c++) {
      A[r][c] = (r / 3 == c / 3 ? entry(block[r / 3], r % 3, c % 3) : 0) - K[size * r + c];
      if (is_held(w, r / 3) || is_held(w, c / 3)) A[r][c] = r == c;
      largest = fmax(largest, fabs(A[r][c]));
    }
  for (size_t r = 0; r < size; r++) A[r][r] += (double)(size * size) * 1.1e-16 * largest;
  for (size_t p = 0; p < size; p++) {
    if (!(A[p][p] > 0)) return false;
    for (size_t r = p + 1; r < size; r++)
      for (size_t c = p + 1; c < size; c++) A[r][c] -= A[r][p] / A[p][p] * A[p][c];
  }
  return true;
}

static void must_bound(const net *w, double (*block)[6], const double *K, const char *what) {
  double u[SIZE], rounding;
  for (int k = 0; k < 20; k++) {
    for (size_t q = 0; q < 3 * w->n; q++) u[q] = is_held(w, q / 3) ? 0 : noise() / sqrt(w->mass[q / 3]);
    double left = margin(w, block, K, u, &rounding);
    if (!(left >= -rounding)) fail_msg("%s: u.K u is %g above the bound", what, -left);
  }
  if (!is_semidefinite(w, block, K)) fail_msg("%s: some u is above the bound", what);
}

/* ---- Random networks ---- */

static void bounds_hold_in_random_networks(void **state) {
  (void)state;
  static double K[SIZE * SIZE], D[SIZE * SIZE];
  bits = 1;
  for (int k = 0; k < NETWORKS; k++) {
    net w;
    double block[N][6];
    make_random(&w);
    start(&w, "springs");
    force_matrices(w.springs, &w.view, K, D);
    bound(&w, HK_STIFFNESS_WHOLE, false, block);
    must_bound(&w, block, K, "stiffness");
    bound(&w, HK_DAMPING_WHOLE, false, block);
    must_bound(&w, block, D, "damping");
    test_engine_close(&w.e);
  }
}

/* Springs with c = k: their D is the part of K that damping reaches, and K - D what it does not. The whole is the sum
 * of both parts, up to some roundings of sums of six numbers of up to 1e2 * 100 N/m. */
static void the_undamped_part_is_what_damping_does_not_reach(void **state) {
  (void)state;
  static double K[SIZE * SIZE], D[SIZE * SIZE];
  bits = 2;
  for (int k = 0; k < NETWORKS; k++) {
    net w;
    double whole[N][6], damped[N][6], undamped[N][6];
    make_random(&w);
    memcpy(w.damping, w.k, sizeof w.damping);
    start(&w, "springs");
    force_matrices(w.springs, &w.view, K, D);
    for (size_t q = 0; q < 9 * w.n * w.n; q++) K[q] -= D[q];
    bound(&w, HK_STIFFNESS_WHOLE, false, whole);
    bound(&w, HK_DAMPING_WHOLE, false, damped);
    bound(&w, HK_STIFFNESS_UNDAMPED, false, undamped);
    must_bound(&w, undamped, K, "what is not damped");
    for (size_t q = 0; q < 6 * w.n; q++)
      assert_true(fabs(whole[q / 6][q % 6] - damped[q / 6][q % 6] - undamped[q / 6][q % 6]) < 1e-10);
    test_engine_close(&w.e);
  }
}

/* Springs at rest are stiff along themselves alone, all of which their damping reaches. */
static void springs_at_rest_have_no_undamped_part(void **state) {
  (void)state;
  net w;
  double block[N][6];
  make_grid(&w, 0.25, 3);
  start(&w, "springs");
  bound(&w, HK_STIFFNESS_UNDAMPED, false, block);
  for (size_t q = 0; q < 6 * w.n; q++) assert_true(block[q / 6][q % 6] == 0);
  test_engine_close(&w.e);
}

/* What was bounded where it is now holds wherever the particles go: near, far, and anywhere between. */
static void what_may_be_drawn_is_bounded_in_every_state(void **state) {
  (void)state;
  static double K[SIZE * SIZE], D[SIZE * SIZE];
  bits = 3;
  for (int k = 0; k < NETWORKS; k++) {
    net w;
    double whole[N][6], damping[N][6], x[SIZE];
    make_random(&w);
    start(&w, "springs");
    bound(&w, HK_STIFFNESS_WHOLE, true, whole);
    bound(&w, HK_DAMPING_WHOLE, true, damping);
    for (double size = 0.01; size < 1e7; size *= 100) {
      hk_view moved = w.view;
      for (size_t q = 0; q < 3 * w.n; q++) x[q] = size * noise();
      moved.x = x;
      force_matrices(w.springs, &moved, K, D);
      must_bound(&w, whole, K, "stiffness elsewhere");
      must_bound(&w, damping, D, "damping elsewhere");
    }
    test_engine_close(&w.e);
  }
}

/* Ropes that are slack now may be taut later; tension is no part that damping of elements reaches, for they have none.
 */
static void ropes_bound_what_they_may_become(void **state) {
  (void)state;
  net w;
  double expected[N][6], block[N][6];
  const hk_stiffness_part part[] = {HK_STIFFNESS_WHOLE, HK_STIFFNESS_UNDAMPED, HK_DAMPING_WHOLE};
  bits = 4;
  make_random(&w);
  start(&w, "ropes");
  const hk_force_tables *force = hk_force_of(w.springs->plugin);
  assert_true(force->own.flags & HK_STIFFENS);
  for (int p = 0; p < 3; p++) {
    memset(block, 0, sizeof block);
    force->bounds.stiffness_bound(w.springs->self, &w.view, part[p], block);
    bound(&w, p == 1 ? HK_STIFFNESS_WHOLE : part[p], true, expected);
    assert_memory_equal(block, expected, w.n * sizeof *block);
  }
  test_engine_close(&w.e);
}

/* ---- Pins, chosen particles, coincidence ---- */

/* A pinned particle has no share of the bound, and its neighbours need none for it. */
static void pinned_particles_have_no_share(void **state) {
  (void)state;
  static double K[SIZE * SIZE], D[SIZE * SIZE];
  bits = 5;
  for (int k = 0; k < NETWORKS; k++) {
    net w;
    double block[N][6];
    make_random(&w);
    describe(&w, "springs");
    for (uint32_t id = 1; id <= 3; id++) test_pin(&w.e, HK_PIN_FIXED, id, NULL);
    open_run(&w);
    force_matrices(w.springs, &w.view, K, D);
    bound(&w, HK_STIFFNESS_WHOLE, false, block);
    for (size_t q = 0; q < 18; q++) assert_true(block[q / 6][q % 6] == 0);
    must_bound(&w, block, K, "beside pins");
    test_engine_close(&w.e);
  }
}

static void springs_that_do_not_act_have_no_share(void **state) {
  (void)state;
  static double K[SIZE * SIZE], D[SIZE * SIZE];
  net w;
  double block[N][6], own[N][6] = {{0}};
  bits = 6;
  make_random(&w);
  describe(&w, "springs");
  w.spec->only = calloc(5, sizeof *w.spec->only);
  for (uint32_t k = 0; k < 5; k++) w.spec->only[k] = k;
  w.spec->only_count = 5;
  open_run(&w);
  force_matrices(w.springs, &w.view, K, D);
  bound(&w, HK_STIFFNESS_WHOLE, false, block);
  must_bound(&w, block, K, "of the chosen");
  for (size_t q = 30; q < 6 * w.n; q++) assert_true(block[q / 6][q % 6] == 0);
  hk_force_of(w.springs->plugin)->bounds.stiffness_bound(w.springs->self, &w.view, HK_STIFFNESS_WHOLE, own);
  /* The force sums the same shares, positive in the diagonal, in another order: of up to `edges` of them. */
  for (size_t q = 0; q < 6 * w.n; q++) {
    const double *b = block[q / 6];
    assert_true(fabs(own[q / 6][q % 6] - b[q % 6]) <= (double)w.edges * DBL_EPSILON * (b[0] + b[3] + b[5]));
  }
  test_engine_close(&w.e);
}

/* Two particles on a slanted line, down to distances whose square underflows. The direction has its 1e-15 while the
 * square has all its digits; below there is none, or one of fewer. Without a rest length none is needed: it is k I. */
static void almost_coincident_ends_have_a_finite_share(void **state) {
  (void)state;
  const double near[] = {0, 4e-324, 1e-163, 1e-158, 1e-155, 1e-152, 1e-140, 1e-20};
  for (size_t d = 0; d < sizeof near / sizeof *near; d++)
    for (int rest = 0; rest < 2; rest++) {
      net w = {.n = 2, .edges = 1, .mass = {1, 1}, .k = {1000}, .damping = {1}, .rest = {rest}, .pair = {{0, 1}}};
      double block[N][6], K[36], D[36];
      w.x[3] = near[d], w.x[5] = 2 * near[d];
      start(&w, "springs");
      force_matrices(w.springs, &w.view, K, D);
      bound(&w, HK_STIFFNESS_WHOLE, false, block);
      for (size_t q = 0; q < 12; q++) assert_true(isfinite(block[q / 6][q % 6]));
      if (rest && near[d] >= 1e-152) { /* k (1 + s) n n^T */
        const double expected[6] = {400, 0, 800, 0, 0, 1600};
        for (size_t q = 0; q < 6; q++) assert_true(fabs(block[0][q] - expected[q]) < 1e-15 * 2000 * 4);
      }
      if (!rest) must_bound(&w, block, K, "without rest length");
      if (!rest) assert_true(fabs(block[1][0] + block[1][3] + block[1][5] - 6000) < 1e-15 * 6000 * 4);
      test_engine_close(&w.e);
    }
}

/* ---- Regular grids ---- */

/* Neighbours against each other, by 1/sqrt(m): then Young's inequality is an equality for every edge, at rest, drawn
 * and without rest lengths. The sum has 945 terms, which round to 1e-13 of it at worst. */
static void grids_reach_the_bound(void **state) {
  (void)state;
  static const double rest[] = {0.25, 0.2, 0}, ratio[] = {1, 7, 1e4};
  static double K[SIZE * SIZE], D[SIZE * SIZE];
  for (int k = 0; k < 9; k++) {
    net w;
    double block[N][6], u[SIZE], rounding, largest = 0;
    make_grid(&w, rest[k / 3], ratio[k % 3]);
    start(&w, "springs");
    force_matrices(w.springs, &w.view, K, D);
    bound(&w, HK_STIFFNESS_WHOLE, false, block);
    must_bound(&w, block, K, "grid");
    for (size_t q = 0; q < SIZE; q++) u[q] = (q / 3 % 2 ? -1 : 1) / sqrt(w.mass[q / 3]);
    double left = margin(&w, block, K, u, &rounding);
    for (size_t q = 0; q < SIZE; q++)
      for (size_t p = 0; p < 3; p++) largest += u[q] * entry(block[q / 3], q % 3, p) * u[q / 3 * 3 + p];
    if (!(fabs(left) <= 1e-13 * largest))
      fail_msg("rest %g, masses 1:%g: %g of %g are left", rest[k / 3], ratio[k % 3], left, largest);
    for (size_t q = 0; q < 6 * w.n; q++) block[q / 6][q % 6] *= 1 - 1e-6; /* so less would be no bound */
    assert_false(is_semidefinite(&w, block, K));
    test_engine_close(&w.e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bounds_hold_in_random_networks),
      cmocka_unit_test(the_undamped_part_is_what_damping_does_not_reach),
      cmocka_unit_test(springs_at_rest_have_no_undamped_part),
      cmocka_unit_test(what_may_be_drawn_is_bounded_in_every_state),
      cmocka_unit_test(ropes_bound_what_they_may_become),
      cmocka_unit_test(pinned_particles_have_no_share),
      cmocka_unit_test(springs_that_do_not_act_have_no_share),
      cmocka_unit_test(almost_coincident_ends_have_a_finite_share),
      cmocka_unit_test(grids_reach_the_bound),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
