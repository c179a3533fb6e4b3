/* Intersection paths, what they enclose, and how it is drawn back: surfaces whose intersections are known, the gradient
 * of a curve's length against differences, and momenta. */
#include "plugins/common/contact/untangling/displacements.h"
#include "plugins/common/contact/untangling/prolong.h"
#include "plugins/common/contact/geometry/distance.h"
#include "plugins/kit/vector3.h"
#include "plugins/common/contact/untangling/shortening.h"
#include "tests/support/surface_scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct bench {
  test_surfaces *s;
  hk_surface_intersections found;
  hk_contours contours;
  hk_prolong prolong;
  hk_regions regions;
  hk_displacements moves;
} bench;

static void look(bench *b) {
  const hk_host *host = test_surfaces_host(b->s);
  const hk_surface_mesh *m = &b->s->lists.mesh;
  assert_int_equal(hk_crossings_find(&b->s->search, host, b->s->x, &b->s->crossings), HK_OK);
  b->found = (hk_surface_intersections){b->s->crossings.count, b->s->crossings.record};
  assert_int_equal(hk_contours_trace(&b->contours, host, m, &b->found), HK_OK);
  assert_int_equal(hk_contours_prolong(&b->prolong, &b->contours, host, m), HK_OK);
  assert_int_equal(hk_regions_fill(&b->regions, host, m, &b->contours, b->s->model.n, b->s->x), HK_OK);
}

static void list_and_look(bench *b) {
  test_surfaces_list(b->s);
  b->s->lists.mesh.number = 1;
  look(b);
}

static void find_moves(bench *b, const double *v) {
  hk_tangle tangle = {.mesh = &b->s->lists.mesh,
                      .contours = &b->contours,
                      .regions = &b->regions,
                      .model = &b->s->model,
                      .x = b->s->x,
                      .v = v,
                      .beyond = 1e-4};
  assert_int_equal(hk_displacements_find(&b->moves, test_surfaces_host(b->s), &tangle), HK_OK);
}

static void close_bench(bench *b) {
  const hk_host *host = test_surfaces_host(b->s);
  hk_contours_free(&b->contours, host);
  hk_prolong_free(&b->prolong, host);
  hk_regions_free(&b->regions, host);
  hk_displacements_free(&b->moves, host);
  test_surfaces_close(b->s);
}

/* Every intersection is a point of one curve, and neighbours on a curve have two triangles in common. */
static void check_curves(const bench *b) {
  const hk_contours *c = &b->contours;
  size_t points = 0;
  for (size_t k = 0; k < c->count; k++) points += c->contour[k].count;
  assert_int_equal(points, b->found.count);
  assert_int_equal(c->points, b->found.count);
  for (size_t k = 0; k < c->count; k++) {
    const hk_contour *one = &c->contour[k];
    size_t pieces = one->kind == HK_CONTOUR_CLOSED ? one->count : one->count - 1;
    for (size_t j = 0; j < pieces; j++) {
      const hk_contour_point *p = &c->point[one->first + j], *q = &c->point[one->first + (j + 1) % one->count];
      const uint32_t *f = b->s->lists.mesh.edge_faces[p->edge], *g = b->s->lists.mesh.edge_faces[q->edge];
      bool same = p->triangle == q->triangle && (f[0] == g[0] || f[0] == g[1] || f[1] == g[0] || f[1] == g[1]);
      bool across = (p->triangle == g[0] || p->triangle == g[1]) && (q->triangle == f[0] || q->triangle == f[1]);
      assert_true(same || across);
    }
  }
}

/* ---- a bump through a sheet ---- */

enum { CELLS = 20 };

static const double bump_place[3] = {0.013, 0.007, 0.03};

static double bump(double x, double y) {
  return -0.12 * exp(-((x - 0.52) * (x - 0.52) + (y - 0.49) * (y - 0.49)) / 0.03);
}

/* The sheet z = 0, and above it one whose middle hangs through it; the second one's first particle. */
static uint32_t bump_through_sheet(bench *b) {
  memset(b, 0, sizeof *b);
  b->s = test_surfaces_open(1, 5, 2000);
  b->s->request = (hk_surface_request){.thickness = 1e-3, .body_thickness = 1e-3, .radius = 5e-4};
  test_surfaces_sheet(b->s, CELLS, (double[]){0, 0, 0});
  uint32_t second = test_surfaces_sheet(b->s, CELLS, bump_place);
  for (size_t i = second; i < b->s->model.n; i++) b->s->x[3 * i + 2] += bump(b->s->x[3 * i], b->s->x[3 * i + 1]);
  return second;
}

/* The height of the second sheet above (x, y), by its triangles: the cell's diagonal runs from its right to its left.
 */
static double height(const bench *b, uint32_t second, double x, double y) {
  double u = (x - bump_place[0]) * CELLS, v = (y - bump_place[1]) * CELLS, i = floor(u), j = floor(v);
  if (i < 0 || j < 0 || i >= CELLS || j >= CELLS) return 1;
  uint32_t at = second + (uint32_t)j * (CELLS + 1) + (uint32_t)i;
  const double *z = b->s->x + 2;
  double a = z[3 * at], right = z[3 * (at + 1)], up = z[3 * (at + CELLS + 1)], last = z[3 * (at + CELLS + 2)];
  u -= i, v -= j;
  return u + v <= 1 ? a + u * (right - a) + v * (up - a) : last + (1 - u) * (up - last) + (1 - v) * (right - last);
}

static void a_bump_makes_one_curve_and_two_known_regions(void **state) {
  (void)state;
  bench b;
  uint32_t second = bump_through_sheet(&b);
  list_and_look(&b);
  check_curves(&b);
  assert_int_equal(b.contours.count, 1);
  const hk_contour *c = &b.contours.contour[0];
  assert_true(c->kind == HK_CONTOUR_CLOSED && !c->twisted && b.contours.kinds[HK_CONTOUR_CLOSED] == 1);
  bool inside[2000] = {false};
  for (int side = 0; side < 2; side++) {
    const hk_enclosed *e = &b.regions.enclosed[0][side];
    assert_true(e->known && e->count > 10);
    for (size_t k = e->first; k < e->first + e->count; k++) inside[b.regions.vertex[k]] = true;
  }
  for (uint32_t i = 0; i < b.s->model.n; i++) {
    const double *x = b.s->x + 3 * (size_t)i;
    assert_true(inside[i] == (i < second ? height(&b, second, x[0], x[1]) < 0 : x[2] < 0));
  }
  close_bench(&b);
}

/* Each round draws the parts through each other; the sum of m x stays, to the rounding of sums of 900 terms of 1 m. */
static void a_bump_is_drawn_back(void **state) {
  (void)state;
  bench b;
  bump_through_sheet(&b);
  list_and_look(&b);
  double sum[3] = {0};
  int rounds = 0;
  for (size_t i = 0; i < b.s->model.n; i++) b.s->mass[i] = 1 + (double)(i % 7), b.s->inverse_mass[i] = 1 / b.s->mass[i];
  for (; b.found.count > 0 && rounds < 20; rounds++) {
    find_moves(&b, NULL);
    for (size_t k = 0; k < 3 * b.s->model.n; k++) {
      b.s->x[k] += b.moves.move[k];
      sum[k % 3] += b.s->mass[k / 3] * b.moves.move[k];
    }
    look(&b);
  }
  assert_int_equal(b.found.count, 0);
  for (int c = 0; c < 3; c++) assert_true(fabs(sum[c]) < 1e-12);
  close_bench(&b);
}

/* To push apart what is nearer than it should be keeps the bump where it is. */
static void plain_repulsion_does_not_free_it(void **state) {
  (void)state;
  bench b;
  bump_through_sheet(&b);
  list_and_look(&b);
  size_t least = b.found.count;
  for (int round = 0; round < 200; round++) {
    hk_surface_move still = {b.s->x, b.s->x, 0.01, false};
    assert_int_equal(hk_feature_pairs_find(&b.s->search, test_surfaces_host(b.s), &still, &b.s->pairs), HK_OK);
    const hk_feature_pair *pair = b.s->pairs.record;
    for (size_t k = 0; k < b.s->pairs.count; k++) {
      double x[12];
      for (int j = 0; j < 4; j++) hk_copy(x + 3 * j, b.s->x + 3 * (size_t)pair[k].vertex[j]);
      hk_nearest n = hk_nearest_of_pair((hk_pair_kind)pair[k].kind, x);
      double d = sqrt(n.squared), weight = 0;
      if (!(d > 0 && d < 0.005)) continue;
      for (int j = 0; j < 4; j++) weight += n.w[j] * n.w[j];
      for (int j = 0; j < 4; j++)
        hk_add_scaled(b.s->x + 3 * (size_t)pair[k].vertex[j], 0.2 * n.w[j] * (0.005 - d) / (d * weight), n.d);
    }
    look(&b);
    least = b.found.count < least ? b.found.count : least;
  }
  assert_true(least > 20);
  close_bench(&b);
}

/* The lower sheet rises and the bump sinks, by 1 m/s: what drives them further into each other is taken. */
static void velocities_lose_what_goes_further_in(void **state) {
  (void)state;
  bench b;
  uint32_t second = bump_through_sheet(&b);
  list_and_look(&b);
  double *v = calloc(3 * b.s->model.n, sizeof *v), before = 0, after = 0;
  for (size_t i = 0; i < b.s->model.n; i++) v[3 * i + 2] = i < second ? 1 : -1;
  find_moves(&b, v);
  for (size_t k = 0; k < b.moves.pulls; k++)
    for (int j = 0; j < HK_UNTANGLING_PULL; j++) {
      const hk_untangling_pull *p = &b.moves.pull[k];
      size_t i = 3 * (size_t)p->vertex[j];
      before += fmin(0, p->w[j] * hk_dot(v + i, p->way));
      double next[3] = {v[i] + b.moves.kick[i], v[i + 1] + b.moves.kick[i + 1], v[i + 2] + b.moves.kick[i + 2]};
      after += fmin(0, p->w[j] * hk_dot(next, p->way));
    }
  assert_true(after > 0.6 * before); /* both are below 0; the middle of several pulls takes a part of each */
  for (size_t k = 0; k < 3 * b.s->model.n; k++) v[k] = -v[k];
  find_moves(&b, v);
  for (size_t k = 0; k < 3 * b.s->model.n; k++) assert_true(b.moves.kick[k] == 0);
  free(v);
  close_bench(&b);
}

/* ---- other curves ---- */

/* A strip in the plane z = 0 and one upright through its middle. */
static void crossed_strips_have_a_curve_from_border_to_border(void **state) {
  (void)state;
  bench b = {.s = test_surfaces_open(1, 5, 2000)};
  b.s->request = (hk_surface_request){.thickness = 1e-3, .body_thickness = 1e-3, .radius = 5e-4};
  uint32_t first = test_surfaces_sheet(b.s, 10, (double[]){0, 0, 0});
  uint32_t second = test_surfaces_sheet(b.s, 10, (double[]){0, 0, 0});
  for (uint32_t i = first; i < b.s->model.n; i++) {
    double *x = b.s->x + 3 * (size_t)i, u = x[0], v = x[1];
    if (i < second)
      x[0] = u, x[1] = 0.3 + 0.2 * v;
    else
      x[0] = 0.511, x[1] = u - 0.0137, x[2] = 0.2 * v - 0.0913;
  }
  list_and_look(&b);
  check_curves(&b);
  assert_int_equal(b.contours.count, 1);
  const hk_contour *c = &b.contours.contour[0];
  assert_int_equal(c->kind, HK_CONTOUR_BORDER);
  assert_true(c->cuts[0] && !c->cuts[1]); /* the flat strip is cut in two, into 5 of its 11 rows and 6 */
  const hk_enclosed *e = b.regions.enclosed[0];
  assert_true(e[0].known && e[0].count == 55 && e[1].count == 0);
  for (size_t k = 0; k < 55; k++) assert_true(b.regions.vertex[k] < second && b.s->x[3 * b.regions.vertex[k]] > 0.511);
  close_bench(&b);
}

/* Two sheets that cross at a right angle, one moved along the curve by 0.4 of a cell: it begins on the border of one
 * and ends on that of the other, and nearly cuts both. */
static void curves_that_nearly_cut_are_prolonged(void **state) {
  (void)state;
  bench b = {.s = test_surfaces_open(1, 5, 2000)};
  b.s->request = (hk_surface_request){.thickness = 1e-3, .body_thickness = 1e-3, .radius = 5e-4};
  test_surfaces_sheet(b.s, 10, (double[]){0, 0, 0});
  uint32_t second = test_surfaces_sheet(b.s, 10, (double[]){0, 0, 0});
  for (uint32_t i = second; i < b.s->model.n; i++) {
    double *x = b.s->x + 3 * (size_t)i, u = x[0], v = x[1];
    x[0] = 0.511, x[1] = u + 0.0437, x[2] = v - 0.633;
  }
  list_and_look(&b);
  check_curves(&b);
  assert_int_equal(b.contours.count, 1);
  const hk_contour *c = &b.contours.contour[0];
  assert_true(c->kind == HK_CONTOUR_BORDER && c->cuts[0] && c->cuts[1]);
  for (int side = 0; side < 2; side++) {
    const hk_enclosed *e = &b.regions.enclosed[0][side];
    assert_true(c->beyond[side].count >= 1 && c->beyond[side].count <= 2 && e->known);
    bool flat = b.regions.vertex[e->first] < second;
    size_t wrong = 0;
    for (size_t k = e->first; k < e->first + e->count; k++) {
      const double *x = b.s->x + 3 * (size_t)b.regions.vertex[k];
      wrong += flat ? x[0] < 0.511 : x[2] < 0;
    }
    assert_true(wrong <= 1);                            /* beside the way to the border */
    assert_int_equal(e->count - wrong, flat ? 55 : 44); /* columns beyond x = 0.511, rows above z = 0 */
  }
  close_bench(&b);
}

/* A fan around a corner of which two triangles that are no neighbours pass through each other: the curve ends at the
 * corner that they share. */
static void a_folded_fan_ends_at_its_tip(void **state) {
  (void)state;
  bench b = {.s = test_surfaces_open(1, 5, 100)};
  b.s->request = (hk_surface_request){.thickness = 1e-6, .body_thickness = 1e-6, .radius = 5e-7};
  uint32_t tip = test_surfaces_particle(b.s, 0, 0, 0), rim[4];
  const double place[4][3] = {{1, 1, 0.1}, {1, -1, -0.1}, {1.2, -1, 0.4}, {1.1, 0.9, -0.3}};
  for (int k = 0; k < 4; k++) rim[k] = test_surfaces_particle(b.s, place[k][0], place[k][1], place[k][2]);
  for (int k = 0; k < 3; k++) test_surfaces_triangle(b.s, tip, rim[k], rim[k + 1]);
  list_and_look(&b);
  check_curves(&b);
  assert_true(b.found.count > 0);
  assert_int_equal(b.contours.count, 1);
  assert_int_equal(b.contours.contour[0].kind, HK_CONTOUR_LOOP);
  close_bench(&b);
}

/* Many triangles in a cube, each by itself, and large sheets with noise through each other. */
static void any_mess_is_traced(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed <= 20; seed++) {
    bench b = {.s = test_surfaces_open(1, seed, 2000)};
    b.s->request = (hk_surface_request){.thickness = 1e-9, .body_thickness = 1e-9, .radius = 5e-10};
    for (int k = 0; k < 60; k++) {
      uint32_t v[3];
      for (int j = 0; j < 3; j++)
        v[j] = test_surfaces_particle(b.s, test_uniform(b.s, 0, 1), test_uniform(b.s, 0, 1), test_uniform(b.s, 0, 1));
      test_surfaces_triangle(b.s, v[0], v[1], v[2]);
    }
    for (int k = 0; k < 3; k++) test_surfaces_sheet(b.s, 8, (double[]){0.01 * k, 0.02 * k, 0.5});
    for (size_t i = 180; i < b.s->model.n; i++) b.s->x[3 * i + 2] += test_uniform(b.s, -0.2, 0.2);
    list_and_look(&b);
    check_curves(&b);
    assert_true(b.contours.kinds[HK_CONTOUR_BROKEN] == 0); /* in general position curves end at borders and tips */
    find_moves(&b, NULL);
    for (size_t k = 0; k < 3 * b.s->model.n; k++) assert_true(isfinite(b.moves.move[k]));
    close_bench(&b);
  }
}

/* ---- the gradient of a curve's length ---- */

static void point_of(const bench *b, const hk_contour_point *p, const double *x, double at[3]) {
  const uint32_t *e = b->s->lists.mesh.edge[p->edge], *f = b->s->lists.mesh.triangle[p->triangle];
  const double *o = x + 3 * (size_t)f[0], *a = x + 3 * (size_t)e[0];
  double u[3], v[3], n[3], along[3], from[3];
  hk_subtract(u, x + 3 * (size_t)f[1], o);
  hk_subtract(v, x + 3 * (size_t)f[2], o);
  hk_cross(n, u, v);
  hk_subtract(along, x + 3 * (size_t)e[1], a);
  hk_subtract(from, o, a);
  hk_copy(at, a);
  hk_add_scaled(at, hk_dot(n, from) / hk_dot(n, along), along);
}

static double length_of_curve(const bench *b, const double *x) {
  double sum = 0;
  const hk_contour *c = &b->contours.contour[0];
  for (size_t k = 0; k < c->count; k++) {
    double p[3], q[3], d[3];
    point_of(b, &b->contours.point[c->first + k], x, p);
    point_of(b, &b->contours.point[c->first + (k + 1) % c->count], x, q);
    hk_subtract(d, p, q);
    sum += hk_length(d);
  }
  return sum;
}

/* A tent through one large triangle that rests: central differences over 1e-6 of lengths of 1, off by 1e-10. */
static void curves_become_shorter_along_their_gradient(void **state) {
  (void)state;
  bench b = {.s = test_surfaces_open(1, 9, 100)};
  b.s->request = (hk_surface_request){.thickness = 1e-9, .body_thickness = 1e-9, .radius = 5e-10};
  uint32_t floor[3];
  const double corner[3][3] = {{-9, -8, 0.1}, {9, -7, -0.1}, {0, 11, 0.05}};
  for (int k = 0; k < 3; k++) floor[k] = test_surfaces_particle(b.s, corner[k][0], corner[k][1], corner[k][2]);
  test_surfaces_triangle(b.s, floor[0], floor[1], floor[2]);
  uint32_t tip = test_surfaces_particle(b.s, 0.1, 0.2, -0.7);
  for (int k = 0; k < 7; k++)
    test_surfaces_particle(b.s, cos(0.9 * k) + 0.1 * (k % 2), 1.3 * sin(0.9 * k), 0.8 + 0.2 * (k % 3));
  for (uint32_t k = 0; k < 7; k++) test_surfaces_triangle(b.s, tip, tip + 1 + k, tip + 1 + (k + 1) % 7);
  list_and_look(&b);
  assert_true(b.contours.count == 1 && b.contours.contour[0].kind == HK_CONTOUR_CLOSED && b.contours.points == 7);
  double gradient[33] = {0}, x[33];
  for (size_t k = 0; k < 7; k++) {
    double w[HK_UNTANGLING_PULL], direction[3];
    const uint32_t *e = b.s->lists.mesh.edge[b.contours.point[k].edge];
    assert_true(hk_shortening(&b.s->lists.mesh, b.s->x, &b.contours.point[k], w, direction));
    for (int j = 0; j < 2; j++) hk_add_scaled(gradient + 3 * e[j], -w[j], direction);
  }
  for (size_t k = 9; k < 33; k++) {
    memcpy(x, b.s->x, sizeof x);
    x[k] += 1e-6;
    double more = length_of_curve(&b, x);
    x[k] -= 2e-6;
    double slope = (more - length_of_curve(&b, x)) / 2e-6;
    assert_true(fabs(slope - gradient[k]) < 1e-8);
  }
  close_bench(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_bump_makes_one_curve_and_two_known_regions),
      cmocka_unit_test(a_bump_is_drawn_back),
      cmocka_unit_test(plain_repulsion_does_not_free_it),
      cmocka_unit_test(velocities_lose_what_goes_further_in),
      cmocka_unit_test(crossed_strips_have_a_curve_from_border_to_border),
      cmocka_unit_test(curves_that_nearly_cut_are_prolonged),
      cmocka_unit_test(a_folded_fan_ends_at_its_tip),
      cmocka_unit_test(any_mess_is_traced),
      cmocka_unit_test(curves_become_shorter_along_their_gradient),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
