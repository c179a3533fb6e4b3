/* Products for adjoints of so many elements that they fill several blocks of lanes and a part of one: they are those of
 * the force's own blocks up to rounding (force_matrices compares them), and the same bits on every processor. */
#include "core/engine/contract/contract.h"
#include "tests/support/force_check.h"
#include "tests/support/sheets.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u; /* Knuth 1981, vol. 2, 3.3.4 */
  return (double)(*seed >> 11) / 9007199254740992.0 - 0.5;
}

static void shake(test_engine *e, size_t n) {
  uint64_t seed = 5;
  for (size_t k = 0; k < 3 * n; k++) {
    e->scene->particles.velocity[k] = noise(&seed);
    e->scene->particles.position[k] += 0.06 * noise(&seed);
  }
}

static void same_on_every_processor(hk_instance *force, const hk_view *view) {
  const hk_implicit_facet *f = &hk_force_of(force->plugin)->implicit;
  size_t size = 3 * view->n;
  double *u = calloc(5 * size, sizeof *u), *x = u + size, *y = x + 2 * size;
  int own = force->host.lanes;
  for (size_t e = 0; e < size; e++) u[e] = cos(0.7 * (double)e);
  assert_int_equal(f->transposed(force->self, view, u, &(hk_transposed){.x = x, .v = x + size}), HK_OK);
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
    memset(y, 0, 2 * size * sizeof *y);
    force->host.lanes = lanes;
    assert_int_equal(f->transposed(force->self, view, u, &(hk_transposed){.x = y, .v = y + size}), HK_OK);
    assert_memory_equal(x, y, 2 * size * sizeof *x);
  }
  force->host.lanes = own;
  free(u);
}

static void check(test_engine *e, const hk_plugin_spec *spec, size_t n) {
  double *K = malloc(18 * n * n * sizeof *K);
  test_run(e);
  hk_instance *force = test_instance(e, spec);
  hk_view view = force_view(e, force);
  force_matrices(force, &view, K, K + 9 * n * n);
  same_on_every_processor(force, &view);
  free(K);
}

static void of_sheets(void **state) {
  (void)state;
  static const char *const models[] = {"baraff_witkin", "stvk", "neo_hookean"};
  for (int k = 0; k < 12; k++) { /* three models of membranes, hinges; without damping, with it, with some damped */
    test_engine e;
    sheet s = sheet_make(SHEET_IRREGULAR, 9, (double[]){0.4, 0.3, -0.5});
    test_engine_open(&e);
    hk_plugin_spec *spec = sheet_add(&e, &s, k % 4 < 3 ? "membrane" : "hinges");
    test_number(&e, spec, k % 4 < 3 ? "stiffness" : "rigidity", 2);
    if (k % 4 < 3) test_text(&e, spec, "model", models[k % 4]);
    if (k % 4 == 3) test_number(&e, spec, "rest", 0.2);
    if (k >= 4) test_number(&e, spec, "damping", k < 8 ? 0.3 : 1e-3);
    shake(&e, s.particles);
    check(&e, spec, s.particles);
    sheet_free(&s);
    test_engine_close(&e);
  }
}

/* A chain of which a stretch is straight: joints without a direction among others. */
static void of_chains(void **state) {
  (void)state;
  enum { N = 150 };
  static uint32_t joint[N - 2][3];
  static double damping[N - 2];
  for (int k = 0; k < 4; k++) {
    test_engine e;
    test_engine_open(&e);
    for (uint32_t i = 0; i < N; i++) test_particle(&e, 0.1 * i, 0.3 * sin(0.5 * i), 0.2 * cos(0.7 * i), 1);
    shake(&e, N);
    for (size_t i = 40; i < 45; i++)
      memcpy(e.scene->particles.position + 3 * i, (double[]){0.25 * (double)i, 0.5, 0.125}, 3 * sizeof(double));
    for (uint32_t i = 0; i < N - 2; i++) {
      for (uint32_t c = 0; c < 3; c++) joint[i][c] = i + c + 1;
      damping[i] = i % 3 == 0 ? 0.2 : 0;
    }
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "angle_springs");
    test_tuples(&e, spec, "joints", 3, &joint[0][0], N - 2);
    test_number(&e, spec, "k", 3);
    test_number(&e, spec, "rest", 0);
    if (k % 2) test_list(&e, spec, "damping", damping, N - 2);
    if (k >= 2) test_vector(&e, spec, "normal", 0, 0.6, 0.8);
    check(&e, spec, N);
    test_engine_close(&e);
  }
}

static void of_pulls(void **state) {
  (void)state;
  enum { N = 150 };
  static const double powers[] = {1, -2, -1.5, 2};
  for (int k = 0; k < 16; k++) { /* to a point or a line, with a range that leaves some out, or none */
    test_engine e;
    test_engine_open(&e);
    for (int i = 0; i < N; i++) test_particle(&e, cos(i), sin(1.3 * i), cos(0.7 * i), 1 + 0.01 * i);
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "central");
    test_number(&e, spec, "strength", 2);
    test_number(&e, spec, "power", powers[k % 4]);
    test_number(&e, spec, "softening", 0.2);
    if (k / 4 % 2) test_vector(&e, spec, "axis", 0.3, -1, 0.5);
    if (k / 8) test_number(&e, spec, "range", 1.1);
    check(&e, spec, N);
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(of_sheets), cmocka_unit_test(of_chains),
                                     cmocka_unit_test(of_pulls)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
