/* Marching cubes and marching tetrahedra on random values: whatever they are, the surface is closed and manifold. Small
 * fields of 3 x 3 x 3 values, apart by a layer of outside, fill one large grid. */
#include "tests/plugins/common/isosurface/random_fields.h"
#include "plugins/common/isosurface/cell_cases.h"

static void random_fields_have_manifold_surfaces(void **state) {
  (void)state;
  for (int method = 0; method < 2; method++)
    for (int integers = 0; integers < 2; integers++) check_random_fields((hk_isosurface_method)method, integers, 22, 1);
}

/* A cube and the one with inside and outside exchanged; every case has its triangles on the edges that it crosses. */
static void triangles_lie_on_crossed_edges(void **state) {
  (void)state;
  hk_cell_case cases[256];
  for (int method = 0; method < 2; method++) {
    method ? hk_cell_cases_cubes(cases) : hk_cell_cases_tetrahedra(cases);
    for (unsigned mask = 0; mask < 256; mask++) {
      assert_int_equal(cases[mask].triangles > 0, mask != 0 && mask != 255);
      for (unsigned k = 0; k < 3U * cases[mask].triangles; k++) {
        unsigned edge = cases[mask].edge[k / 3][k % 3], low = edge & 7, high = low | edge >> 3;
        assert_true(edge >> 3 && !(low & edge >> 3) && (mask >> low & 1) != (mask >> high & 1));
      }
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_fields_have_manifold_surfaces),
      cmocka_unit_test(triangles_lie_on_crossed_edges),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
