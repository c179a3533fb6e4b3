/* Fillings of tetrahedra: their angles, whatever the field; a skin that is closed, and on the surface; a volume of
 * order 2; and what is refused. */
#include "plugins/common/isosurface/surface_fill.h"
#include "tests/plugins/common/isosurface/balls.h"
#include "tests/plugins/common/isosurface/shapes.h"

static hk_status fill(bench *b, hk_filling *f, hk_isosurface_grid grid, hk_isosurface_field field,
                      hk_isosurface_options options) {
  return hk_surface_fill(f, &b->instance.host, &grid, &field, &options);
}

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Outward normals of the faces, as long as twice their areas; face k is opposite to corner k. Returns the volume. */
static double face_normals(const hk_filling *f, size_t t, double n[4][3]) {
  static const int face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  const double *x[4];
  for (int k = 0; k < 4; k++) x[k] = f->x[f->tetrahedron[t][k]];
  for (int k = 0; k < 4; k++) {
    double u[3], v[3];
    for (int c = 0; c < 3; c++) u[c] = x[face[k][1]][c] - x[face[k][0]][c], v[c] = x[face[k][2]][c] - x[face[k][0]][c];
    for (int c = 0; c < 3; c++) n[k][c] = u[(c + 1) % 3] * v[(c + 2) % 3] - u[(c + 2) % 3] * v[(c + 1) % 3];
  }
  double e[3] = {x[1][0] - x[0][0], x[1][1] - x[0][1], x[1][2] - x[0][2]};
  return dot(e, n[0]) / 6;
}

typedef struct quality {
  double least, most, volume; /* dihedral angles in degrees; m^3 */
} quality;

static quality judge(const hk_filling *f) {
  quality q = {180, 0, 0};
  for (size_t t = 0; t < f->tetrahedra; t++) {
    double n[4][3], volume = face_normals(f, t, n);
    if (!(volume > 0)) fail_msg("tetrahedron %zu has the volume %g", t, volume);
    q.volume += volume;
    for (int a = 0; a < 4; a++)
      for (int b = 0; b < a; b++) {
        double angle = 180 - acos(dot(n[a], n[b]) / sqrt(dot(n[a], n[a]) * dot(n[b], n[b]))) * 180 / M_PI;
        q.least = fmin(q.least, angle), q.most = fmax(q.most, angle);
      }
  }
  return q;
}

/* ---- the skin ---- */

typedef struct face {
  uint32_t sorted[3], turned[3];
} face;

static int by_corners(const void *a, const void *b) { return memcmp(a, b, sizeof((face *)0)->sorted); }

static face face_of(uint32_t a, uint32_t b, uint32_t c) {
  face f = {{a, b, c}, {a, b, c}};
  for (int k = 0; k < 3; k++) {
    int j = k == 1 ? 1 : 0;
    if (f.sorted[j] <= f.sorted[j + 1]) continue;
    uint32_t swapped = f.sorted[j];
    f.sorted[j] = f.sorted[j + 1], f.sorted[j + 1] = swapped;
  }
  return f;
}

/* The faces of one tetrahedron alone, as a surface with the filling's places. */
static hk_isosurface skin_of(const hk_filling *f) {
  static const int at[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  face *list = malloc(4 * f->tetrahedra * sizeof *list);
  hk_isosurface s = {f->vertices, 0, f->x, NULL, malloc(4 * f->tetrahedra * sizeof *s.triangle)};
  assert_true(list && s.triangle);
  for (size_t k = 0; k < 4 * f->tetrahedra; k++) {
    const uint32_t *t = f->tetrahedron[k / 4];
    list[k] = face_of(t[at[k % 4][0]], t[at[k % 4][1]], t[at[k % 4][2]]);
  }
  qsort(list, 4 * f->tetrahedra, sizeof *list, by_corners);
  for (size_t k = 0; k < 4 * f->tetrahedra;) {
    size_t same = 1;
    while (k + same < 4 * f->tetrahedra && by_corners(&list[k], &list[k + same]) == 0) same++;
    assert_true(same <= 2);
    if (same == 1) memcpy(s.triangle[s.triangles++], list[k].turned, sizeof list[k].turned);
    k += same;
  }
  free(list);
  return s;
}

/* Each edge of the skin as often one way as the other, most once; where parts of a body touch in an edge, twice. */
static void check_skin(const shape *of, const hk_filling *f) {
  hk_isosurface s = skin_of(f);
  double off = 0, unused[3];
  rings r = find_rings(&s);
  for (size_t v = 0; v < s.vertices; v++)
    for (size_t k = r.begin[v]; k < r.begin[v + 1]; k++) {
      int out = 0;
      for (size_t j = r.begin[v]; j < r.begin[v + 1]; j++)
        out += (r.edge[j][0] == r.edge[k][0]) - (r.edge[j][1] == r.edge[k][0]);
      assert_int_equal(out, 0);
    }
  for (size_t k = 0; k < 3 * s.triangles && of; k++)
    off = fmax(off, fabs(of->value(s.x[s.triangle[k / 3][k % 3]], unused)));
  if (!(off < 1e-6)) fail_msg("%s: a vertex of the skin has the value %g", of ? of->name : "", off);
  free(r.begin);
  free(r.edge);
  free(s.triangle);
}

static void angles_and_volumes_of_smooth_shapes(void **state) {
  (void)state;
  shape shapes[SHAPES];
  fill_shapes(shapes);
  for (size_t k = 0; k < SHAPES; k++) {
    double error[2];
    for (int level = 0; level < 2; level++) {
      bench b;
      hk_filling f = {0};
      open_bench(&b, 1);
      hk_isosurface_field field = {.evaluate = shape_evaluate, .self = &shapes[k]};
      assert_int_equal(
          fill(&b, &f, shape_grid(&shapes[k], level ? 41 : 21), field, (hk_isosurface_options){.steps = 4}), HK_OK);
      quality q = judge(&f);
      check_skin(&shapes[k], &f);
      assert_true(q.least > 10.7 && q.most < 164.8);
      error[level] = fabs(q.volume / shapes[k].volume - 1);
      hk_filling_free(&f, &b.instance.host);
      close_bench(&b);
    }
    double order = log2(error[0] / error[1]);
    assert_true(order > 1.8 && order < 2.2);
  }
}

/* Any values at the points of the lattice: f is a sum of waves as short as a cell. */
typedef struct waves {
  double k[6][3], phase[6];
} waves;

static void rough(const void *self, const double (*x)[3], size_t count, double *value) {
  const waves *w = self;
  for (size_t i = 0; i < count; i++) {
    double most = fmax(fabs(x[i][0]), fmax(fabs(x[i][1]), fabs(x[i][2])));
    value[i] = 0;
    for (int j = 0; j < 6; j++) value[i] += sin(dot(w->k[j], x[i]) + w->phase[j]);
    if (most > 0.75) value[i] = -1 - most;
  }
}

static double draw(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) / 9007199254740992.0;
}

static void angles_are_good_for_any_field(void **state) {
  (void)state;
  uint64_t seed = 3;
  quality all = {180, 0, 0};
  for (int trial = 0; trial < 20; trial++) {
    bench b;
    hk_filling f = {0};
    waves w;
    for (int j = 0; j < 6; j++) {
      w.phase[j] = 6 * draw(&seed);
      for (int c = 0; c < 3; c++) w.k[j][c] = (draw(&seed) - 0.5) * 2 * 25;
    }
    open_bench(&b, 1);
    assert_int_equal(fill(&b, &f, box(17, 17, 17), (hk_isosurface_field){.evaluate = rough, .self = &w},
                          (hk_isosurface_options){.steps = 3}),
                     HK_OK);
    quality q = judge(&f);
    check_skin(NULL, &f);
    all.least = fmin(all.least, q.least), all.most = fmax(all.most, q.most);
    hk_filling_free(&f, &b.instance.host);
    close_bench(&b);
  }
  assert_true(all.least > 10.7 && all.most < 164.8);
}

static void any_number_of_threads_fills_alike(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  bench b[3];
  hk_filling f[3] = {{0}};
  for (int k = 0; k < 3; k++) {
    open_bench(&b[k], threads[k]);
    assert_int_equal(fill(&b[k], &f[k], box(30, 31, 32),
                          (hk_isosurface_field){.evaluate = counted_sphere, .self = &ball},
                          (hk_isosurface_options){.steps = 2}),
                     HK_OK);
    assert_true(f[k].vertices == f[0].vertices && f[k].tetrahedra == f[0].tetrahedra);
    assert_memory_equal(f[k].x, f[0].x, f[0].vertices * sizeof *f[0].x);
    assert_memory_equal(f[k].tetrahedron, f[0].tetrahedron, f[0].tetrahedra * sizeof *f[0].tetrahedron);
  }
  for (int k = 0; k < 3; k++) {
    hk_filling_free(&f[k], &b[k].instance.host);
    close_bench(&b[k]);
  }
}

static void refused(counted s, hk_isosurface_options options, hk_status expected, const char *text) {
  bench b;
  hk_filling f = {0};
  open_bench(&b, 1);
  hk_status status =
      fill(&b, &f, box(21, 21, 21), (hk_isosurface_field){.evaluate = counted_sphere, .self = &s}, options);
  if (status != expected || !strstr(b.error.text, text) || f.x) fail_msg("%d: %s", (int)status, b.error.text);
  close_bench(&b);
}

static void what_cannot_be_filled_is_said(void **state) {
  (void)state;
  counted wide = ball, far = ball, holed = ball;
  wide.radius = 1.2, far.place[0] = 9, holed.hole = 0.5;
  refused(wide, (hk_isosurface_options){.steps = 2}, HK_BAD_PARAM, "the surface leaves the box");
  refused(far, (hk_isosurface_options){.steps = 2}, HK_BAD_PARAM, "nothing is inside in the box: the field is from -");
  refused(holed, (hk_isosurface_options){.steps = 2}, HK_NOT_FINITE, "the field is nan at (0.6, -1, -1)");
  refused(ball, (hk_isosurface_options){.most_bytes = 200000}, HK_NO_MEMORY, "take a larger cell");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(angles_and_volumes_of_smooth_shapes), cmocka_unit_test(angles_are_good_for_any_field),
      cmocka_unit_test(any_number_of_threads_fills_alike), cmocka_unit_test(what_cannot_be_filled_is_said)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
