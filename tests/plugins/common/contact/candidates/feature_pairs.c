/* Pairs and intersections against loops over all features, which know nothing of items, owners and trees: on random
 * sheets, folded, torn and flattened, with strands and isolated particles, some of them pinned, in random moves. */
#include "tests/support/surface_scenes.h"

#include "plugins/common/contact/geometry/exact.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- random surfaces ---- */

static void shake(test_surfaces *s, double *x, double by) {
  for (size_t k = 0; k < 3 * s->model.n; k++) x[k] += test_uniform(s, -by, by);
}

static void pin_some(test_surfaces *s, uint32_t first, uint32_t count, bool all) {
  for (uint32_t k = 0; k < count; k++)
    if (all || k % 7 < 3) test_surfaces_hold(s, first + k);
}

/* Two sheets, a third one that is pinned, strands, one of which hangs from a sheet, and isolated particles. */
static test_surfaces *random_surfaces(int threads, uint64_t seed) {
  test_surfaces *s = test_surfaces_open(threads, seed, 1000);
  uint32_t first = test_surfaces_sheet(s, 6, (double[]){0, 0, 0});
  test_surfaces_sheet(s, 5, (double[]){0.1, 0.1, 0.05});
  pin_some(s, first, 49, false);
  pin_some(s, test_surfaces_sheet(s, 4, (double[]){-0.2, 0.3, -0.05}), 25, true);
  for (int k = 0; k < 5; k++)
    test_surfaces_strand(s, 6, (double[]){test_uniform(s, 0, 1), test_uniform(s, 0, 1), -0.2},
                         (double[]){0.02, 0, 0.08});
  test_surfaces_edge(s, first, (uint32_t)s->model.n - 1);
  for (int k = 0; k < 20; k++) test_surfaces_particle(s, test_uniform(s, 0, 1), test_uniform(s, 0, 1), 0);
  s->left[first + 9] = s->left[s->model.n - 3] = s->left[s->model.n - 30] = true;
  test_surfaces_list(s);
  return s;
}

/* ---- loops over all ---- */

static bool share(const uint32_t *a, int na, const uint32_t *b, int nb) {
  for (int k = 0; k < na; k++)
    for (int l = 0; l < nb; l++)
      if (a[k] == b[l]) return true;
  return false;
}

static bool none_moves(const test_surfaces *s, const uint32_t *v, int count) {
  bool none = true;
  for (int k = 0; k < count; k++) none &= s->inverse_mass[v[k]] == 0;
  return none;
}

typedef struct loop {
  test_surfaces *s;
  const hk_surface_move *move;
  uint64_t *found; /* keys of the pairs that were found, rising */
  size_t seen, must;
} loop;

static uint64_t key(hk_pair_kind kind, const uint32_t v[4]) {
  uint64_t k = kind == HK_EDGE_EDGE ? 0x9e3779b97f4a7c15u : 1;
  uint64_t low = kind == HK_EDGE_EDGE ? ((uint64_t)v[0] << 32 | v[1]) : v[0],
           high = kind == HK_EDGE_EDGE ? ((uint64_t)v[2] << 32 | v[3]) : (uint64_t)v[1] * v[2] * v[3];
  if (kind == HK_EDGE_EDGE && low > high) low ^= high, high ^= low, low ^= high;
  k = (k ^ low) * 0xff51afd7ed558ccdu;
  k = (k ^ k >> 29 ^ high) * 0xc4ceb9fe1a85ec53u;
  return k ^ k >> 32;
}

/* Whether the gap is below the reach at one of some times of the move. */
static bool meets(const loop *l, hk_pair_kind kind, const uint32_t v[4], double offset) {
  for (double u = 0; u <= 1; u += 0.25) {
    double x[12];
    for (int k = 0; k < 12; k++) {
      size_t at = 3 * (size_t)v[k / 3] + (size_t)k % 3;
      x[k] = (1 - u) * l->move->x_from[at] + u * l->move->x_to[at];
    }
    if (sqrt(hk_nearest_of_pair(kind, x).squared) - offset < l->move->reach) return true;
  }
  return false;
}

static int rising(const void *a, const void *b) {
  uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
  return (p > q) - (p < q);
}

/* A pair that meets was found; one that was found is near by the test that the header names. */
static void consider(loop *l, hk_pair_kind kind, const uint32_t v[4]) {
  const test_surfaces *s = l->s;
  const hk_surface_mesh *m = &s->lists.mesh;
  int first = kind == HK_POINT_TRIANGLE ? 1 : 2;
  if (share(v, first, v + first, 4 - first) || none_moves(s, v, 4)) return;
  double offset = hk_feature_radius(m, v, first) + hk_feature_radius(m, v + first, 4 - first);
  uint64_t k = key(kind, v);
  bool found = bsearch(&k, l->found, s->pairs.count, sizeof k, rising);
  if (found) assert_true((first == 1 ? hk_point_is_near : hk_edges_are_near)(&s->search, v, offset));
  if (meets(l, kind, v, offset)) {
    assert_true(found);
    l->must++;
  }
  l->seen += found;
}

static void loop_over_all(loop *l) {
  const hk_surface_mesh *m = &l->s->lists.mesh;
  for (size_t p = 0; p < m->points; p++)
    for (size_t t = 0; t < m->triangles; t++)
      consider(l, HK_POINT_TRIANGLE,
               (uint32_t[]){m->point[p], m->triangle[t][0], m->triangle[t][1], m->triangle[t][2]});
  for (size_t e = 0; e < m->edges; e++)
    for (size_t f = 0; f < e; f++) {
      const uint32_t *a = m->edge[f], *b = m->edge[e];
      bool lone = a[0] == a[1] || b[0] == b[1],
           surface = f < l->s->lists.surface_edges || e < l->s->lists.surface_edges;
      if (!(lone && surface)) consider(l, HK_EDGE_EDGE, (uint32_t[]){a[0], a[1], b[0], b[1]});
    }
}

static void find(test_surfaces *s, const hk_surface_move *move) {
  if (hk_feature_pairs_find(&s->search, test_surfaces_host(s), move, &s->pairs) != HK_OK) fail_msg("%s", s->error.text);
}

static size_t compare_pairs(test_surfaces *s, const hk_surface_move *move) {
  loop l = {.s = s, .move = move};
  find(s, move);
  const hk_feature_pair *pair = s->pairs.record;
  l.found = malloc((s->pairs.count + 1) * sizeof *l.found);
  for (size_t k = 0; k < s->pairs.count; k++) l.found[k] = key(pair[k].kind, pair[k].vertex);
  qsort(l.found, s->pairs.count, sizeof *l.found, rising);
  for (size_t k = 1; k < s->pairs.count; k++) assert_true(l.found[k] != l.found[k - 1]); /* each once */
  loop_over_all(&l);
  assert_int_equal(l.seen, s->pairs.count);
  free(l.found);
  return l.must;
}

static void compare_crossings(test_surfaces *s, const double *x, bool some) {
  const hk_surface_mesh *m = &s->lists.mesh;
  if (hk_crossings_find(&s->search, test_surfaces_host(s), x, &s->crossings) != HK_OK) fail_msg("%s", s->error.text);
  const uint32_t(*found)[2] = (const uint32_t(*)[2])s->crossings.record;
  size_t k = 0;
  for (uint32_t e = 0; e < m->edges; e++)
    for (uint32_t t = 0; t < m->triangles; t++) {
      const uint32_t *a = m->edge[e], *b = m->triangle[t], both[5] = {a[0], a[1], b[0], b[1], b[2]};
      if (a[0] == a[1] || share(a, 2, b, 3) || none_moves(s, both, 5)) continue;
      if (!hk_segment_meets_triangle(x + 3 * (size_t)a[0], x + 3 * (size_t)a[1], x + 3 * (size_t)b[0],
                                     x + 3 * (size_t)b[1], x + 3 * (size_t)b[2]))
        continue;
      if (k == s->crossings.count || found[k][0] != e || found[k][1] != t) fail_msg("edge %u and triangle %u", e, t);
      k++;
    }
  assert_int_equal(k, s->crossings.count);
  assert_true(!some || k > 0);
}

/* ---- the tests ---- */

static void pairs_and_intersections_are_those_of_loops(void **state) {
  (void)state;
  static const double reach[] = {0, 0.01, 0.2}, by[] = {0, 0.02, 0.3};
  for (int k = 0; k < 9; k++) {
    test_surfaces *s = random_surfaces(2, (uint64_t)k + 1);
    double *to = malloc(3 * s->model.n * sizeof *to);
    shake(s, s->x, 0.03);
    for (int again = 0; again < 3; again++) { /* the tree is fitted, and built anew */
      memcpy(to, s->x, 3 * s->model.n * sizeof *to);
      shake(s, to, by[k / 3]);
      hk_surface_move move = {.x_from = s->x, .x_to = to, .reach = reach[k % 3]};
      size_t must = compare_pairs(s, &move);
      assert_true(must > 10 && s->pairs.count < 20 * must); /* of all pairs a few thousandths */
      compare_crossings(s, to, true);
      memcpy(s->x, to, 3 * s->model.n * sizeof *to);
      if (again == 0) test_surfaces_hold(s, 10); /* pins may change */
    }
    free(to);
    test_surfaces_close(s);
  }
}

/* All in one plane, on one line, in one point; and a tiny, a huge and a far one. */
static void degenerate_positions_are_no_exception(void **state) {
  (void)state;
  for (int k = 0; k < 6; k++) {
    test_surfaces *s = random_surfaces(2, 77);
    static const double scale[6][3] = {{1, 1, 0}, {1, 0, 0}, {0, 0, 0}, {1e-9, 1e-9, 1e-9}, {1e9, 1e9, 1e9}, {1, 1, 1}};
    shake(s, s->x, 0.03);
    for (size_t q = 0; q < 3 * s->model.n; q++) s->x[q] = s->x[q] * scale[k][q % 3] + (k == 5 ? 1e6 : 0);
    compare_pairs(s, &(hk_surface_move){.x_from = s->x, .x_to = s->x, .reach = k == 3 ? 1e-11 : 0.02});
    compare_crossings(s, s->x, true);
    test_surfaces_close(s);
  }
}

/* More than a walk through the tree keeps at a time. */
static void all_in_one_place_meet_all(void **state) {
  (void)state;
  enum { N = 700 };
  test_surfaces *s = test_surfaces_open(2, 1, N);
  for (int k = 0; k < N; k++) test_surfaces_particle(s, 1, 2, 3);
  for (uint32_t k = 0; k < 10; k++) test_surfaces_hold(s, k);
  test_surfaces_list(s);
  find(s, &(hk_surface_move){.x_from = s->x, .x_to = s->x});
  assert_int_equal(s->pairs.count, N * (N - 1) / 2 - 10 * 9 / 2);
  test_surfaces_close(s);
}

/* Bit by bit, without what lies between members. */
static void assert_same_pairs(const test_surfaces *s, const test_surfaces *t) {
  const hk_feature_pair *a = s->pairs.record, *b = t->pairs.record;
  assert_int_equal(s->pairs.count, t->pairs.count);
  for (size_t k = 0; k < s->pairs.count; k++) {
    assert_memory_equal(a[k].vertex, b[k].vertex, sizeof a->vertex);
    assert_int_equal(a[k].kind, b[k].kind);
    assert_memory_equal(&a[k].offset, &b[k].offset, sizeof a->offset);
    assert_memory_equal(&a[k].gap, &b[k].gap, sizeof a->gap);
  }
}

/* Neither the threads nor what was searched before leave a trace. */
static void the_bits_depend_on_the_positions_alone(void **state) {
  (void)state;
  test_surfaces *first = random_surfaces(1, 5);
  shake(first, first->x, 0.05);
  hk_surface_move move = {.x_from = first->x, .x_to = first->x, .reach = 0.05};
  find(first, &move);
  assert_true(first->pairs.count > 1000);
  for (int threads = 1; threads <= 3; threads++) {
    test_surfaces *s = random_surfaces(threads, 5);
    for (int k = 0; k < 3; k++) {
      shake(s, s->x, 0.1);
      find(s, &(hk_surface_move){.x_from = s->x, .x_to = s->x, .reach = 0.3});
    }
    find(s, &move);
    assert_same_pairs(s, first);
    test_surfaces_close(s);
  }
  test_surfaces_close(first);
}

static void a_position_that_is_not_finite_is_told(void **state) {
  (void)state;
  test_surfaces *s = random_surfaces(2, 6);
  hk_surface_move move = {.x_from = s->x, .x_to = s->x};
  s->x[3 * 40 + 1] = NAN;
  assert_int_equal(hk_feature_pairs_find(&s->search, test_surfaces_host(s), &move, &s->pairs), HK_NOT_FINITE);
  s->x[3 * 40 + 1] = -INFINITY;
  assert_int_equal(hk_crossings_find(&s->search, test_surfaces_host(s), s->x, &s->crossings), HK_NOT_FINITE);
  test_surfaces_close(s);
}

/* Every allocation may fail, and what is found afterwards is right. */
static void failed_allocations_are_told(void **state) {
  (void)state;
  test_surfaces *s = random_surfaces(2, 8);
  hk_surface_move move = {.x_from = s->x, .x_to = s->x, .reach = 0.05};
  int k = 0;
  for (hk_status status = HK_NO_MEMORY; status != HK_OK; k++) {
    s->shared.allocations_left = k;
    status = hk_feature_pairs_find(&s->search, test_surfaces_host(s), &move, &s->pairs);
    assert_true(status == HK_OK || status == HK_NO_MEMORY);
  }
  s->shared.allocations_left = -1;
  assert_true(k > 5);
  compare_pairs(s, &move);
  test_surfaces_close(s);
}

/* ---- constructed cases ---- */

static size_t crossings_of(const double x[18], bool shared) {
  test_surfaces *s = test_surfaces_open(1, 1, 6);
  for (int k = 0; k < 6; k++) test_surfaces_particle(s, x[3 * k], x[3 * k + 1], x[3 * k + 2]);
  test_surfaces_triangle(s, 0, 1, 2);
  test_surfaces_triangle(s, shared ? 0 : 3, 4, 5);
  test_surfaces_list(s);
  compare_crossings(s, s->x, false);
  size_t count = s->crossings.count;
  test_surfaces_close(s);
  return count;
}

static void constructed_triangles_intersect_as_often_as_they_should(void **state) {
  (void)state;
  /* One side of the second pierces the first, another one passes beside it, and a side of the first pierces the second.
   */
  assert_int_equal(crossings_of((double[]){0, 0, 0, 1, 0, 0, 0, 1, 0, 0.2, 0.2, -1, 0.2, 0.2, 1, 3, 3, 1}, false), 2);
  /* In one plane, one in the other: its three sides. */
  assert_int_equal(crossings_of((double[]){0, 0, 0, 8, 0, 0, 0, 8, 0, 1, 1, 0, 2, 1, 0, 1, 2, 0}, false), 3);
  /* A corner on a face: the two sides that have it. */
  assert_int_equal(crossings_of((double[]){0, 0, 0, 8, 0, 0, 0, 8, 0, 1, 1, 0, 2, 1, 1, 1, 2, 1}, false), 2);
  /* Just above it. */
  assert_int_equal(crossings_of((double[]){0, 0, 0, 8, 0, 0, 0, 8, 0, 1, 1, 5e-324, 2, 1, 1, 1, 2, 1}, false), 0);
  /* A corner in common is no intersection; a side that pierces the other triangle elsewhere is one, for both. */
  assert_int_equal(crossings_of((double[]){0, 0, 0, 8, 0, 0, 0, 8, 0, 9, 9, 9, 1, 1, 1, 1, 2, 1}, true), 0);
  assert_int_equal(crossings_of((double[]){0, 0, 0, 8, 0, 0, 0, 8, 0, 9, 9, 9, 1, 1, 1, 1, 2, -1}, true), 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pairs_and_intersections_are_those_of_loops),
      cmocka_unit_test(degenerate_positions_are_no_exception),
      cmocka_unit_test(all_in_one_place_meet_all),
      cmocka_unit_test(the_bits_depend_on_the_positions_alone),
      cmocka_unit_test(a_position_that_is_not_finite_is_told),
      cmocka_unit_test(failed_allocations_are_told),
      cmocka_unit_test(constructed_triangles_intersect_as_often_as_they_should),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
