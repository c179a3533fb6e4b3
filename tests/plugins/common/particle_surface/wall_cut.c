/* Liquids cut by walls: a pool in a box is flat along its walls, drops stay drops, and nothing is within a wall. */
#include "plugins/common/frame_data/solid.h"
#include "plugins/common/particle_surface/particle_surface.h"
#include "tests/plugins/common/isosurface/balls.h"

enum { MOST = 3000 };

static double place[MOST][3];

/* side x side x 7 particles of spacing 0.1 m from `first`, up to a quarter of that off their lattice, but not outwards.
 */
static size_t fill_pool(size_t side, double first) {
  uint64_t seed = 9;
  size_t n = 0;
  for (; n < 7 * side * side; n++) {
    size_t at[3] = {n % side, n / side % side, n / side / side};
    for (int c = 0; c < 3; c++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      double off = 0.05 * ((double)(seed >> 40) / (double)(1 << 24) - 0.5);
      if (at[c] == 0) off = fabs(off);
      if (at[c] == (c == 2 ? 6 : side - 1)) off = -fabs(off);
      place[n][c] = first + 0.1 * (double)at[c] + off;
    }
  }
  return n;
}

/* A hollow box from 0 to 1 m, to 2 m along z, turned about z by `angle` with all that is in it. */
static hk_frame_solid box_of(double angle) {
  double c = cos(angle), s = sin(angle);
  return (hk_frame_solid){.kind = HK_SHAPE_BOX,
                          .hollow = true,
                          .centre = {0.5 * c - 0.5 * s, 0.5 * s + 0.5 * c, 1},
                          .axis = {{0.5 * c, 0.5 * s, 0}, {-0.5 * s, 0.5 * c, 0}, {0, 0, 1}}};
}

static hk_status find_walled(bench *b, size_t n, const hk_frame_solid *solid, hk_particle_surface_options o) {
  hk_solid_list list = {1, solid};
  hk_particle_walls walls = {hk_solids_distance, &list};
  o.radius = 0.05, o.walls = &walls;
  return hk_particle_surface_find(&b->surface, &b->instance.host, (const double(*)[3])place, n, &o);
}

/* Particles are a radius off the walls, or at them. Vertices below the surface of the liquid, at 0.65 m or 0.6 m, lie
 * on the walls to 1e-3 of the spacing but along the edges of the box, where two walls meet within a cell. */
static void a_pool_is_flat_along_its_walls(void **state) {
  (void)state;
  for (int k = 0; k < 6; k++) {
    bench b;
    bool touching = k % 2;
    size_t n = touching ? fill_pool(11, 0) : fill_pool(10, 0.05), checked = 0;
    hk_frame_solid solid = box_of(0);
    open_bench(&b, 2);
    assert_int_equal(find_walled(&b, n, &solid,
                                 (hk_particle_surface_options){.kind = (hk_particle_field_kind)(k / 2), .cell = 0.035}),
                     HK_OK);
    assert_int_equal(count_broken(&b.surface), 0);
    for (size_t v = 0; v < b.surface.vertices; v++) {
      const double *x = b.surface.x[v];
      double off[3] = {fmin(x[0], 1 - x[0]), fmin(x[1], 1 - x[1]), x[2]}, least = fmin(off[0], fmin(off[1], off[2]));
      int near = (off[0] < 0.05) + (off[1] < 0.05) + (off[2] < 0.05);
      if (near > 1 || x[2] > 0.5) continue;
      checked++;
      if (!(fabs(least) < 1e-4))
        fail_msg("kind %d: %g spacings off the wall at (%g, %g, %g)", k / 2, least / 0.1, x[0], x[1], x[2]);
    }
    double volume = surface_volume(&b.surface), full = touching ? 0.65 : 0.7;
    assert_true(checked > 1000);
    if (!(fabs(volume / full - 1) < 0.06)) fail_msg("kind %d: a volume of %g of %g", k / 2, volume, full);
    close_bench(&b);
  }
}

/* Planes that are oblique to the grid are met to rounding as well, by the same bits for any number of threads. */
static void a_turned_box_is_as_flat_and_threads_change_no_bit(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  bench b[3];
  size_t n = fill_pool(10, 0.05), checked = 0;
  hk_frame_solid solid = box_of(0.4);
  for (size_t i = 0; i < n; i++) {
    double x = place[i][0], y = place[i][1];
    place[i][0] = cos(0.4) * x - sin(0.4) * y, place[i][1] = sin(0.4) * x + cos(0.4) * y;
  }
  for (int k = 0; k < 3; k++) {
    open_bench(&b[k], threads[k]);
    assert_int_equal(find_walled(&b[k], n, &solid, (hk_particle_surface_options){.cell = 0.04, .smoothing = 5}), HK_OK);
    assert_true(same(&b[k].surface, &b[0].surface));
  }
  for (size_t v = 0; v < b[0].surface.vertices; v++) {
    const double *y = b[0].surface.x[v];
    double x[2] = {cos(0.4) * y[0] + sin(0.4) * y[1], cos(0.4) * y[1] - sin(0.4) * y[0]};
    if (y[2] < 0.1 || y[2] > 0.5 || fabs(x[1] - 0.5) > 0.4) continue;
    checked++;
    assert_true(fabs(fmin(x[0], 1 - x[0])) < 1e-4);
  }
  assert_true(checked > 100);
  for (int k = 0; k < 3; k++) close_bench(&b[k]);
}

/* Above a floor: one that is farther than a spacing is the ball that it is without; one that is sunk in it is a cap,
 * without h^2 (3 r - h)/(4 r^3) = 0.216 of the ball at h = 0.03 m, from the floor on to the thousandth of a cell that
 * vertices keep from points of the grid. */
static void drops_are_cut_where_they_touch(void **state) {
  (void)state;
  hk_frame_solid floor = {.kind = HK_SHAPE_PLANE, .axis = {{0}, {0}, {0, 0, 1}}};
  for (int k = 0; k < 2; k++) {
    bench b;
    double low = 1, whole = 4 * M_PI / 3 * 1.25e-4;
    memset(place, 0, sizeof place[0]);
    place[0][2] = k ? 0.02 : 0.2;
    open_bench(&b, 1);
    assert_int_equal(find_walled(&b, 1, &floor, (hk_particle_surface_options){.cell = 0.01}), HK_OK);
    for (size_t v = 0; v < b.surface.vertices; v++) low = fmin(low, b.surface.x[v][2]);
    double volume = surface_volume(&b.surface) / whole;
    if (k == 0 && !(fabs(volume - 1) < 0.03 && fabs(low - 0.15) < 2e-3)) fail_msg("%g, from %g m", volume, low);
    if (k == 1 && !(fabs(volume - 0.784) < 0.02 && fabs(low) < 2e-5)) fail_msg("%g, from %g m", volume, low);
    close_bench(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_pool_is_flat_along_its_walls),
                                     cmocka_unit_test(a_turned_box_is_as_flat_and_threads_change_no_bit),
                                     cmocka_unit_test(drops_are_cut_where_they_touch)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
