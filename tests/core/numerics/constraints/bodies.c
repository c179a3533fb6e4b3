/* The service "bodies/1" against closed forms of rigid bodies: a rod's mobility is 1/m + (r x n)^2/I, a chain longer
 * than a dense factor takes responds as its parts do, what hangs on one nail is many bodies. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double mass = 0.3, L = 1.2, exact = 1e-12; /* kg, m; rounding */

static const hk_body_service *open_bodies(test_engine *e, size_t *count) {
  e->options.integrator = "leapfrog";
  e->options.dt = 1e-3;
  e->scene->duration = 1;
  test_run(e);
  const hk_body_service *bodies = hk_run_query(e->run, "bodies/1");
  assert_non_null(bodies);
  assert_int_equal(bodies->count(bodies->self, count), HK_OK);
  const hk_view *view = hk_run_view(e->run);
  assert_int_equal(bodies->linearise(bodies->self, view->t, view->x, view->v), HK_OK);
  return bodies;
}

/* Particles along the direction (c, 0, s), L apart, with bars between neighbours. */
static void add_chain(test_engine *e, size_t links, double angle) {
  uint32_t edge[256][2];
  for (size_t k = 0; k <= links; k++) {
    uint32_t id = test_particle(e, (double)k * L * cos(angle), 0, (double)k * L * sin(angle), mass);
    if (k) edge[k - 1][0] = id - 1, edge[k - 1][1] = id;
  }
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "bars"), (const uint32_t(*)[2])edge, links);
}

/* Two masses m, a rod of mass 2 m with I = m L^2/2: at its end, r = L/2, 1/(2 m) + (L/2 cos a)^2/I across a wall that
 * stands at the angle a, and half of that share at the middle of the arm. */
static void a_rod_has_the_mobility_of_a_rigid_body(void **state) {
  (void)state;
  for (double a = 0; a < 1.6; a += 0.4) {
    test_engine e;
    size_t count;
    test_engine_open(&e);
    add_chain(&e, 1, a);
    const hk_body_service *bodies = open_bodies(&e, &count);
    const double up[3] = {0, 0, 1}, impulse[3] = {0.4, 0.1, -0.2}, I = mass * L * L / 2;
    double m, v[6] = {0};
    assert_int_equal(count, 1);
    hk_weighted_point end = {{0, 0, 0, 0}, {1, 0, 0, 0}}, quarter = {{0, 1, 0, 0}, {0.75, 0.25, 0, 0}};
    assert_int_equal(bodies->mobility(bodies->self, &end, up, &m), HK_OK);
    assert_true(fabs(m - (1 / (2 * mass) + pow(L / 2 * cos(a), 2) / I)) < exact);
    assert_int_equal(bodies->mobility(bodies->self, &quarter, up, &m), HK_OK);
    assert_true(fabs(m - (1 / (2 * mass) + pow(L / 4 * cos(a), 2) / I)) < exact);
    assert_int_equal(bodies->push(bodies->self, &end, impulse, v), HK_OK);
    for (int c = 0; c < 3; c++) assert_true(fabs(mass * (v[c] + v[3 + c]) - impulse[c]) < exact); /* momentum */
    assert_true(fabs((v[3] - v[0]) * cos(a) + (v[5] - v[2]) * sin(a)) < exact);                   /* the bar's length */
    test_engine_close(&e);
  }
}

/* A dumb-bell of two masses with riders: one at a quarter, one beyond an end, as a point of the rod has it. */
static void a_rider_is_pushed_as_a_point_of_its_body(void **state) {
  (void)state;
  test_engine e;
  size_t count;
  const double at[2] = {0.25, 1.5}, up[3] = {0, 0, 1}, impulse[3] = {0.4, 0.1, -0.2}, I = mass * L * L / 2;
  test_engine_open(&e);
  add_chain(&e, 1, 0);
  for (int k = 0; k < 2; k++) {
    hk_rider r = {.particle = test_particle(&e, 0, 0, 0, 0), .carriers = 2, .carrier = {1, 2}};
    r.weight[0] = 1 - at[k], r.weight[1] = at[k];
    assert_int_equal(hk_scene_add_rider(e.scene, &r, &e.error), HK_OK);
  }
  const hk_body_service *bodies = open_bodies(&e, &count);
  const uint32_t *member;
  assert_int_equal(count, 1);
  assert_int_equal(bodies->members(bodies->self, 0, &member), 4);
  for (uint32_t k = 0; k < 2; k++) {
    hk_weighted_point point = {{2 + k}, {1}};
    double arm = (at[k] - 0.5) * L, m, v[12] = {0};
    assert_int_equal(bodies->mobility(bodies->self, &point, up, &m), HK_OK);
    assert_true(fabs(m - (1 / (2 * mass) + arm * arm / I)) < exact);
    assert_int_equal(bodies->push(bodies->self, &point, impulse, v), HK_OK);
    for (int c = 0; c < 3; c++) {
      assert_true(fabs(mass * (v[c] + v[3 + c]) - impulse[c]) < exact);
      assert_true(fabs(v[6 + 3 * k + (uint32_t)c] - (1 - at[k]) * v[c] - at[k] * v[3 + c]) < exact);
    }
    assert_true(fabs(v[5] - v[2] - L * arm * impulse[2] / I) < exact);
  }
  test_engine_close(&e);
}

/* A straight chain pushed across at its end: the bars do nothing. Pushed along it: all move together. 130 links are
 * more than a dense factor takes. */
static void a_long_chain_responds_as_a_short_one(void **state) {
  (void)state;
  static const size_t links[] = {5, 130};
  for (int k = 0; k < 2; k++) {
    test_engine e;
    size_t count;
    test_engine_open(&e);
    add_chain(&e, links[k], 0);
    const hk_body_service *bodies = open_bodies(&e, &count);
    const double along[3] = {1, 0, 0}, across[3] = {0, 0, 1};
    double m;
    hk_weighted_point end = {{0, 0, 0, 0}, {1, 0, 0, 0}};
    assert_int_equal(bodies->mobility(bodies->self, &end, along, &m), HK_OK);
    assert_true(fabs(m * mass * (double)(links[k] + 1) - 1) < 1e-9); /* the condition of a chain, (N/pi)^2 */
    assert_int_equal(bodies->mobility(bodies->self, &end, across, &m), HK_OK);
    assert_true(fabs(m * mass - 1) < exact);
    test_engine_close(&e);
  }
}

/* Three pendulums on a nail, beside a particle on its own: three bodies of one particle each. */
static void a_nail_joins_nothing(void **state) {
  test_engine e;
  size_t count;
  uint32_t edge[3][2];
  (void)state;
  test_engine_open(&e);
  uint32_t nail = test_particle(&e, 0, 0, 0, 1);
  test_pin(&e, HK_PIN_FIXED, nail, NULL);
  for (uint32_t k = 0; k < 3; k++) {
    edge[k][0] = nail;
    edge[k][1] = test_particle(&e, cos(k), 0, -sin(k), 2);
  }
  test_particle(&e, 5, 5, 5, 4);
  test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "bars"), (const uint32_t(*)[2])edge, 3);
  const hk_body_service *bodies = open_bodies(&e, &count);
  const uint32_t(*pair)[2], *member;
  const double n[3] = {1, 0, 0};
  double m;
  assert_int_equal(count, 3);
  assert_int_equal(bodies->edges(bodies->self, &pair), 3);
  assert_int_equal(bodies->members(bodies->self, bodies->of(bodies->self, 2), &member), 1);
  assert_int_equal(bodies->of(bodies->self, 0), UINT32_MAX);
  assert_int_equal(bodies->of(bodies->self, 4), UINT32_MAX);
  hk_weighted_point bob = {{1, 0, 0, 0}, {1, 0, 0, 0}}, free = {{4, 0, 0, 0}, {1, 0, 0, 0}};
  assert_int_equal(bodies->mobility(bodies->self, &bob, n, &m), HK_OK); /* along its bar */
  assert_true(fabs(m) < exact);
  assert_int_equal(bodies->mobility(bodies->self, &free, n, &m), HK_OK);
  assert_true(fabs(m - 0.25) < exact);
  test_engine_close(&e);
}

/* A triangle with a fourth bar beside one of the three: that follows from it, and the response is the triangle's. */
static void a_bar_that_follows_from_others_changes_nothing(void **state) {
  double m[2];
  (void)state;
  for (size_t more = 0; more < 2; more++) {
    test_engine e;
    size_t count;
    const uint32_t edge[4][2] = {{1, 2}, {2, 3}, {3, 1}, {2, 1}};
    const double n[3] = {0.6, 0.8, 0};
    test_engine_open(&e);
    test_particle(&e, 0, 0, 0, 1);
    test_particle(&e, 1, 0, 0, 2);
    test_particle(&e, 0.3, 0.7, 0, 3);
    test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "bars"), edge, 3 + more);
    const hk_body_service *bodies = open_bodies(&e, &count);
    hk_weighted_point corner = {{0, 0, 0, 0}, {1, 0, 0, 0}};
    assert_int_equal(bodies->mobility(bodies->self, &corner, n, &m[more]), HK_OK);
    test_engine_close(&e);
  }
  assert_true(fabs(m[0] - m[1]) < exact);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_rod_has_the_mobility_of_a_rigid_body),
      cmocka_unit_test(a_rider_is_pushed_as_a_point_of_its_body),
      cmocka_unit_test(a_long_chain_responds_as_a_short_one),
      cmocka_unit_test(a_nail_joins_nothing),
      cmocka_unit_test(a_bar_that_follows_from_others_changes_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
