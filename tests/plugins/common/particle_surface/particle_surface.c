/* Surfaces of particles against closed forms: one particle, a ball of a lattice, a full lattice's density; the same
 * bits for any number of threads and width of vectors; and a sentence for each thing that cannot be. */
#include "plugins/common/particle_surface/particle_kernels.h"
#include "plugins/common/particle_surface/particle_surface.h"
#include "tests/plugins/common/isosurface/balls.h"

enum { MOST = 40000 };

static double place[MOST][3];

static hk_status surface(bench *b, size_t n, hk_particle_surface_options options) {
  return hk_particle_surface_find(&b->surface, &b->instance.host, (const double(*)[3])place, n, &options);
}

/* The points of a cubic lattice of that spacing within a ball about the origin. */
static size_t fill_ball(double radius, double spacing) {
  size_t n = 0;
  long most = (long)(radius / spacing) + 1;
  for (long k = -most; k <= most; k++)
    for (long j = -most; j <= most; j++)
      for (long i = -most; i <= most; i++) {
        double x[3] = {(double)i * spacing, (double)j * spacing, (double)k * spacing};
        if (x[0] * x[0] + x[1] * x[1] + x[2] * x[2] > radius * radius) continue;
        assert_true(n < MOST);
        memcpy(place[n++], x, sizeof x);
      }
  return n;
}

/* The field is linear along each radius, so that vertices are off by the square of an edge, volume of order 2. */
static void one_particle_is_a_ball_of_its_radius(void **state) {
  (void)state;
  double error[2];
  for (int k = 0; k < 2; k++) {
    bench b;
    long euler[1] = {0};
    open_bench(&b, 1);
    place[0][0] = 0.3, place[0][1] = -0.71, place[0][2] = 5.2;
    assert_int_equal(surface(&b, 1, (hk_particle_surface_options){.radius = 0.2, .cell = k ? 0.02 : 0.04}), HK_OK);
    assert_true(count_broken(&b.surface) == 0 && find_components(&b.surface, euler, 1) == 1 && euler[0] == 2);
    for (size_t v = 0; v < b.surface.vertices; v++) {
      double square = 0;
      for (int c = 0; c < 3; c++) square += pow(b.surface.x[v][c] - place[0][c], 2);
      assert_true(fabs(sqrt(square) - 0.2) < (k ? 7.5e-4 : 3e-3)); /* (sqrt(3) cell)^2 / (8 radius) */
    }
    error[k] = 1 - surface_volume(&b.surface) / (4 * M_PI / 3 * 0.008);
    close_bench(&b);
  }
  assert_true(error[1] > 0 && error[1] < 0.02 && log2(error[0] / error[1]) > 1.8 && log2(error[0] / error[1]) < 2.2);
}

/* Steps of the lattice leave bumps in the surface: its volume is that of the particles' cubes, its area that of a ball
 * of that volume, to some percent. The density is 0.6 somewhat within a flat face, where it is 0.5. */
static void a_ball_of_a_lattice_has_its_volume_and_area(void **state) {
  (void)state;
  const double r = 0.05;
  size_t n = fill_ball(1, 2 * r);
  for (int kind = 0; kind < 2; kind++) {
    bench b;
    long euler[1] = {0};
    open_bench(&b, 2);
    assert_int_equal(surface(&b, n,
                             (hk_particle_surface_options){
                                 .kind = (hk_particle_field_kind)kind, .radius = r, .without_normals = true}),
                     HK_OK);
    assert_true(count_broken(&b.surface) == 0 && find_components(&b.surface, euler, 1) == 1 && euler[0] == 2);
    double volume = surface_volume(&b.surface) / ((double)n * 8 * r * r * r);
    double size = cbrt(3 * surface_volume(&b.surface) / (4 * M_PI));
    double area = surface_area(&b.surface) / (4 * M_PI * size * size);
    if (!(fabs(volume - 1) < (kind ? 0.07 : 0.05) && area > 1 && area < 1.06))
      fail_msg("kind %d: volume %g, area %g", kind, volume, area);
    close_bench(&b);
  }
}

static void a_full_lattice_has_the_density_one(void **state) {
  (void)state;
  bench b;
  size_t n = fill_ball(0.75, 0.1);
  hk_particle_field f = {.x = (const double(*)[3])place, .n = n};
  double at[4][3] = {{0}, {0.05, 0.05, 0.05}, {0.03, 0.01, -0.02}, {0.05, 0, 0}}, value[4];
  f.host = open_bench(&b, 1);
  f.o =
      (hk_particle_surface_options){HK_PARTICLE_DENSITY, .radius = 0.05, .reach = 0.2, .cell = 0.025, .threshold = 0.6};
  assert_int_equal(hk_particle_field_open(&f), HK_OK);
  hk_particle_field_evaluate(&f, (const double(*)[3])at, 4, value);
  for (int k = 0; k < 4; k++) assert_true(fabs(value[k] + 0.6 - 1) < 0.02); /* a sum for an integral over 33 points */
  hk_particle_field_close(&f);
  close_bench(&b);
}

/* A block of sums and the values of its places, in another order of operations: to rounding. */
static void blocks_and_places_agree(void **state) {
  (void)state;
  size_t n = fill_ball(0.5, 0.1);
  for (int kind = 0; kind < 3; kind++) {
    bench b;
    hk_particle_field f = {.x = (const double(*)[3])place, .n = n};
    hk_particle_kernels kernels = {0};
    double axis[3][9], value[729], each[1];
    f.host = open_bench(&b, 1);
    f.o = (hk_particle_surface_options){(hk_particle_field_kind)kind, .radius = 0.05, .reach = 0.2, .cell = 0.025,
                                        .threshold = 0.6};
    assert_int_equal(hk_particle_options_complete(&f.o, f.host), HK_OK);
    if (kind == HK_ANISOTROPIC) {
      assert_int_equal(hk_particle_kernels_make(&kernels, f.host, f.x, n, &f.o), HK_OK);
      f.x = (const double(*)[3])kernels.centre, f.kernel = kernels.kernel;
    }
    assert_int_equal(hk_particle_field_open(&f), HK_OK);
    for (size_t block = 0; block < f.blocks[0] * f.blocks[1] * f.blocks[2]; block += 7) {
      size_t at[3] = {block % f.blocks[0], block / f.blocks[0] % f.blocks[1], block / f.blocks[0] / f.blocks[1]};
      for (int c = 0; c < 3; c++)
        for (int k = 0; k < 9; k++) axis[c][k] = f.grid.origin[c] + (8.0 * (double)at[c] + k - 1) * f.o.cell;
      hk_particle_field_lattice(&f, axis[0], axis[1], axis[2], value);
      for (int k = 0; k < 729; k += 5) {
        double x[1][3] = {{axis[0][k % 9], axis[1][k / 9 % 9], axis[2][k / 81]}};
        hk_particle_field_evaluate(&f, (const double(*)[3])x, 1, each);
        if (!(fabs(each[0] - value[k]) < 1e-9)) fail_msg("kind %d: %g and %g", kind, each[0], value[k]);
      }
    }
    hk_particle_field_close(&f);
    hk_particle_kernels_free(&kernels, f.host);
    close_bench(&b);
  }
}

static void threads_and_vectors_change_no_bit(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7, 1};
  uint64_t seed = 9;
  size_t n = fill_ball(0.4, 0.1);
  for (size_t k = 0; k < 3 * n; k++) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    place[k / 3][k % 3] += 0.08 * ((double)(seed >> 40) / (double)(1 << 24) - 0.5);
  }
  for (int kind = 0; kind < 3; kind++) {
    bench b[4];
    for (int k = 0; k < 4; k++) {
      open_bench(&b[k], threads[k]);
      b[k].instance.host.lanes = k == 3 ? 2 : hk_processor_lanes();
      assert_int_equal(
          surface(&b[k], n, (hk_particle_surface_options){.kind = (hk_particle_field_kind)kind, .radius = 0.05}),
          HK_OK);
      assert_true(same(&b[k].surface, &b[0].surface));
    }
    assert_true(count_broken(&b[0].surface) == 0 && b[0].surface.vertices > 3000);
    for (int k = 0; k < 4; k++) close_bench(&b[k]);
  }
}

static void refused(size_t n, hk_particle_surface_options options, hk_status expected, const char *text) {
  bench b;
  open_bench(&b, 1);
  hk_status status = surface(&b, n, options);
  if (status != expected || !strstr(b.error.text, text)) fail_msg("%d: %s", (int)status, b.error.text);
  close_bench(&b);
}

static void what_cannot_be_is_said(void **state) {
  (void)state;
  memset(place, 0, sizeof place);
  refused(0, (hk_particle_surface_options){.radius = 1}, HK_BAD_PARAM, "there are none");
  refused(1, (hk_particle_surface_options){.radius = 0}, HK_BAD_PARAM, "a radius of 0 m: give one above 0");
  refused(1, (hk_particle_surface_options){.radius = 1, .reach = 0.5}, HK_BAD_PARAM, "a reach of 0.5 m");
  refused(1, (hk_particle_surface_options){HK_PARTICLE_DENSITY, .radius = 1}, HK_BAD_PARAM, "no surface in the box");
  hk_particle_surface_options empty = {HK_PARTICLE_DENSITY, .radius = 1, .smoothing = 3, .may_be_empty = true};
  bench b;
  open_bench(&b, 1);
  assert_true(surface(&b, 1, empty) == HK_OK && b.surface.vertices == 0 && b.surface.triangles == 0);
  close_bench(&b);
  place[1][0] = 1e12;
  refused(2, (hk_particle_surface_options){.radius = 1}, HK_BAD_PARAM,
          "are too many cells: take larger ones, or leave");
  place[1][0] = 1e5, place[1][1] = 1e5, place[1][2] = 1e5;
  refused(2, (hk_particle_surface_options){.radius = 1}, HK_NO_MEMORY, "or leave out what has flown away");
  place[1][0] = NAN;
  refused(2, (hk_particle_surface_options){.radius = 1}, HK_NOT_FINITE, "particle 2 is at (nan, ");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(one_particle_is_a_ball_of_its_radius),
                                     cmocka_unit_test(a_ball_of_a_lattice_has_its_volume_and_area),
                                     cmocka_unit_test(a_full_lattice_has_the_density_one),
                                     cmocka_unit_test(blocks_and_places_agree),
                                     cmocka_unit_test(threads_and_vectors_change_no_bit),
                                     cmocka_unit_test(what_cannot_be_is_said)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
