/* Forces and blocks of many hinges against hinges one by one. */
#include "core/engine/contract/contract.h"
#include "plugins/common/shells/hinge_kernel.h"
#include "tests/support/force_check.h"
#include "tests/support/sheets.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A crumpled sheet that moves. */
static hk_plugin_spec *open_crumpled(test_engine *e, sheet *s) {
  uint64_t seed = 3;
  *s = sheet_make(SHEET_IRREGULAR, 3, (double[]){0.8, 0.3, -0.5});
  test_engine_open(e);
  hk_plugin_spec *spec = sheet_add(e, s, "hinges");
  for (size_t k = 0; k < 3 * s->particles; k++) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    double noise = (double)(seed >> 11) / 9007199254740992.0 - 0.5;
    e->scene->particles.velocity[k] = noise;
    e->scene->particles.position[k] += k % 3 == 2 ? 0.5 * noise : 0;
  }
  test_number(e, spec, "rigidity", 2);
  test_number(e, spec, "rest", 0.2);
  test_number(e, spec, "damping", 0.7);
  return spec;
}

typedef struct instance {
  hk_bending bending;
  hk_bending_params given;
  double *rest;
  hk_array turned;
} instance; /* as the plugin has it */

/* The sums of hinge_kernel.c against hinges one by one, and on every processor; in blocks that are not full. */
static void many_hinges_are_each_of_them(void **state) {
  (void)state;
  test_engine e;
  sheet s;
  hk_plugin_spec *spec = open_crumpled(&e, &s);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  const instance *h = force->self;
  hk_view view = force_view(&e, force);
  double F[48], G[48] = {0}, largest = 0;
  force_evaluate(force, &view, F);
  hk_bending_add(force->self, &view, G);
  for (int k = 0; k < 48; k++) largest = fmax(largest, fabs(F[k]));
  for (int k = 0; k < 48; k++) assert_true(fabs(F[k] - G[k]) <= 1e-14 * largest);
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
    double P[48] = {0};
    force->host.lanes = lanes;
    hk_hinge_forces(&h->bending, h->rest, h->turned.item, &view, HK_ALL_PARTS, P);
    assert_memory_equal(F, P, sizeof F);
  }
  sheet_free(&s);
  test_engine_close(&e);
}

typedef struct names {
  hk_pattern pattern; /* first member */
  size_t count;
} names;

static void count_block(hk_pattern *pattern, uint32_t row, uint32_t column) {
  (void)row, (void)column;
  ((names *)(void *)pattern)->count++;
}

/* hinge_blocks.c in the frames of triangles against the product rule of hinge.c. Heights of 0.2 of the sides and less
 * make rounding some ten times that of the numbers. */
static void blocks_are_the_hessian_in_other_frames(void **state) {
  (void)state;
  static const unsigned want[] = {HK_WANT_SYMMETRIC, HK_WANT_DEFINITE};
  test_engine e;
  sheet s;
  hk_plugin_spec *spec = open_crumpled(&e, &s);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  names list = {.pattern = {count_block}};
  hk_bending_pattern(force->self, &view, &list.pattern);
  double *K = calloc(36 * list.count, sizeof *K), *D = K + 9 * list.count, *L = D + 9 * list.count,
         *E = L + 9 * list.count;
  size_t *slot = malloc(list.count * sizeof *slot);
  for (size_t k = 0; k < list.count; k++) slot[k] = k;
  for (int w = 0; w < 2; w++) {
    double largest = 0;
    memset(K, 0, 36 * list.count * sizeof *K);
    assert_int_equal(
        hk_bending_jacobian(force->self, &view, &(hk_blocks){.slot = slot, .K = K, .D = D, .want = want[w]}), HK_OK);
    assert_int_equal(
        hk_force_of(force->plugin)
            ->implicit.jacobian(force->self, &view, &(hk_blocks){.slot = slot, .K = L, .D = E, .want = want[w]}),
        HK_OK);
    for (size_t k = 0; k < 9 * list.count; k++) largest = fmax(largest, fabs(K[k]));
    assert_true(largest > 10);
    for (size_t k = 0; k < 9 * list.count; k++)
      assert_true(fabs(K[k] - L[k]) < 1e-13 * largest && fabs(D[k] - E[k]) < 1e-13 * largest);
  }
  free(K);
  free(slot);
  sheet_free(&s);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(many_hinges_are_each_of_them),
      cmocka_unit_test(blocks_are_the_hessian_in_other_frames),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
