/* Smoothing of meshes: one round against its closed form, weights of particles against those of a lattice and of one by
 * itself, what it does to a liquid's face and volume, and the same bits for any number of threads. */
#include "plugins/common/particle_surface/mesh_smoothing.h"
#include "plugins/common/particle_surface/particle_surface.h"
#include "tests/plugins/common/isosurface/balls.h"

enum { MOST = 4000 };

static double place[MOST][3];

/* A lattice of 0.1 m from the origin, moved by up to a quarter of that in each direction where it is noisy. */
static size_t fill_block(size_t nx, size_t ny, size_t nz, bool noisy) {
  uint64_t seed = 9;
  size_t n = 0;
  assert_true(nx * ny * nz < MOST);
  for (; n < nx * ny * nz; n++) {
    size_t at[3] = {n % nx, n / nx % ny, n / nx / ny};
    for (int c = 0; c < 3; c++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      place[n][c] = 0.1 * ((double)at[c] + (noisy ? 0.5 : 0) * ((double)(seed >> 40) / (double)(1 << 24) - 0.5));
    }
  }
  return n;
}

/* In a regular tetrahedron about the origin the other three have the mean -x/3: a part w of the way leads to
 * (1 - 4 w/3) x, and normals are those of the corners. */
static void a_tetrahedron_shrinks_as_it_should(void **state) {
  (void)state;
  static const double corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  static uint32_t triangle[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  for (unsigned rounds = 0; rounds < 4; rounds++) {
    bench b;
    double x[4][3], normal[4][3], weight[4] = {0.3, 0.3, 0.3, 0.3};
    hk_isosurface s = {4, 4, x, normal, triangle};
    open_bench(&b, 1);
    memcpy(x, corner, sizeof x);
    assert_int_equal(hk_mesh_smooth(&s, &b.instance.host, weight, rounds), HK_OK);
    for (int e = 0; e < 12; e++) {
      assert_true(fabs(x[e / 3][e % 3] - pow(0.6, rounds) * corner[e / 3][e % 3]) < 1e-15);
      if (rounds > 0) assert_true(fabs(normal[e / 3][e % 3] - corner[e / 3][e % 3] / sqrt(3)) < 1e-15);
    }
    close_bench(&b);
  }
}

/* Vertices next to a particle inside a lattice have nearly its weight, of N = 6 3/4 + 12/2 + 8/4 = 12.5. */
static void weights_are_those_of_the_particles(void **state) {
  (void)state;
  bench b;
  double x[3][3] = {{0.4, 0.4, 0.4}, {5, 0, 0}, {5, 0.04, 0}}, weight[3], part = 12.5 / 13;
  hk_isosurface s = {.vertices = 3, .x = x};
  open_bench(&b, 2);
  size_t n = fill_block(9, 9, 9, false);
  place[n][0] = 5, place[n][1] = place[n][2] = 0;
  assert_int_equal(hk_smoothing_weights(&b.instance.host, (const double(*)[3])place, n + 1, 0.05, &s, weight), HK_OK);
  assert_true(fabs(weight[0] - part * part * (3 - 2 * part)) < 1e-12);
  assert_true(weight[1] == 0 && weight[2] == 0);
  close_bench(&b);
}

/* Of the facets of the upper face, at 0.55 m, far from the edges: the rms of the sine between them and the face. */
static double slopes(const hk_isosurface *s) {
  double sum = 0, across = 0;
  for (size_t k = 0; k < s->triangles; k++) {
    const double *a = s->x[s->triangle[k][0]], *b = s->x[s->triangle[k][1]], *c = s->x[s->triangle[k][2]];
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double area = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (fabs(a[0] - 0.9) > 0.4 || fabs(a[1] - 0.9) > 0.4 || a[2] < 0.3 || !(area > 0)) continue;
    sum += area, across += (n[0] * n[0] + n[1] * n[1]) / area;
  }
  return sqrt(across / sum);
}

/* By Zhu and Bridson's field in cells of a radius: slopes of 0.15, and a drop beside that stays as it was. */
static void bumps_go_and_the_volume_and_drops_stay(void **state) {
  (void)state;
  bench b[2];
  size_t n = fill_block(19, 19, 6, true), drops[2] = {0};
  place[n][0] = 4, place[n][1] = place[n][2] = 0;
  for (int k = 0; k < 2; k++) {
    open_bench(&b[k], 2);
    hk_particle_surface_options o = {.radius = 0.05, .cell = 0.04, .smoothing = k ? 25 : 0};
    assert_int_equal(hk_particle_surface_find(&b[k].surface, &b[k].instance.host, (const double(*)[3])place, n + 1, &o),
                     HK_OK);
    assert_int_equal(count_broken(&b[k].surface), 0);
  }
  double before = slopes(&b[0].surface), after = slopes(&b[1].surface);
  double change = surface_volume(&b[1].surface) / surface_volume(&b[0].surface) - 1;
  for (size_t v = 0; v < b[0].surface.vertices; v++) {
    const double *x = b[0].surface.x[v], *y = b[1].surface.x[v];
    if (x[0] < 3) continue;
    for (int c = 0; c < 3; c++) assert_true(x[c] == y[c]);
    drops[0]++;
  }
  assert_true(drops[0] > 20);
  if (!(before > 0.13 && after < 0.55 * before && fabs(change) < 0.03))
    fail_msg("slopes of %g and then %g, volume changed by %g", before, after, change);
  close_bench(&b[0]), close_bench(&b[1]);
}

static void threads_change_no_bit(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  bench b[3];
  size_t n = fill_block(8, 8, 8, true);
  for (int k = 0; k < 3; k++) {
    open_bench(&b[k], threads[k]);
    hk_particle_surface_options o = {.radius = 0.05, .smoothing = 9};
    assert_int_equal(hk_particle_surface_find(&b[k].surface, &b[k].instance.host, (const double(*)[3])place, n, &o),
                     HK_OK);
    assert_true(same(&b[k].surface, &b[0].surface));
  }
  for (int k = 0; k < 3; k++) close_bench(&b[k]);
}

static void too_many_rounds_are_refused(void **state) {
  (void)state;
  bench b;
  open_bench(&b, 1);
  hk_particle_surface_options o = {.radius = 0.05, .smoothing = 1001};
  assert_int_equal(hk_particle_surface_find(&b.surface, &b.instance.host, (const double(*)[3])place, 1, &o),
                   HK_BAD_PARAM);
  assert_non_null(strstr(b.error.text, "1001 rounds of smoothing: give at most 1000"));
  close_bench(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_tetrahedron_shrinks_as_it_should), cmocka_unit_test(weights_are_those_of_the_particles),
      cmocka_unit_test(bumps_go_and_the_volume_and_drops_stay), cmocka_unit_test(threads_change_no_bit),
      cmocka_unit_test(too_many_rounds_are_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
