/* The impulses of the last step as a first guess: a column of particles that rests on a pinned one is solved again in a
 * few sweeps, with the same answer, also in a step of another length and where the list has the pairs in another order
 * and with their features exchanged. */
#include "plugins/common/contact/impulses/warm_start.h"
#include "tests/support/plain_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 12, PAIRS = N - 1 };
static const double distance = 0.01, gravity = 9.81, mass = 0.1, tolerance = 1e-12;

static hk_status resize(const hk_host *host, hk_array *field, size_t count) {
  (void)host;
  field->item = realloc(field->item, (count + 1) * sizeof(hk_warm_pair));
  field->count = count;
  return field->item ? HK_OK : HK_NO_MEMORY;
}

static const hk_host host = {.resize = resize, .allocate = test_allocate, .release = test_release};
static hk_awake awake;

typedef struct column {
  double x_from[3 * N], v_from[3 * N], x[3 * N], v[3 * N], inverse_mass[N];
  uint64_t moved[N], touched[N];
  hk_impact impact[PAIRS];
} column;

/* A step of h under the weight and, on the uppermost one, a force along x that its friction holds; `other`: the list
 * from above, with the lower feature first. */
static hk_gauss_seidel_result solve(column *c, double h, bool other, hk_array *known) {
  memset(c, 0, sizeof *c);
  for (int i = 0; i < N; i++) {
    double a[3] = {i == N - 1 ? 0.1 * gravity : 0, 0, -gravity};
    c->x_from[3 * i + 2] = distance * i;
    c->inverse_mass[i] = i ? 1 / mass : 0;
    for (int k = 0; k < 3; k++) {
      c->v[3 * i + k] = i ? h * a[k] : 0;
      c->x[3 * i + k] = c->x_from[3 * i + k] + h * c->v[3 * i + k];
    }
  }
  hk_step_move move = {h, c->x_from, c->v_from, c->x, c->v, c->inverse_mass};
  hk_contact_solver s = {.count = PAIRS, .impact = c->impact, .friction = 0.5, .tolerance = tolerance, .most = 10000};
  s.moved = c->moved, s.touched = c->touched, s.awake = &awake;
  for (uint32_t e = 0; e < PAIRS; e++) {
    uint32_t low = other ? PAIRS - 1 - e : e, up = low + 1, a = other ? low : up, b = other ? up : low;
    hk_impact *k = &c->impact[e];
    *k = (hk_impact){.pair = {{a, a, b, b}, HK_EDGE_EDGE, distance, 0},
                     .frame = {{0.5, 0.5, -0.5, -0.5}, {0, 0, other ? -1 : 1}}};
    hk_impact_set(k, &move, 0, false);
    k->mobility = c->inverse_mass[a] + c->inverse_mass[b]; /* both ends of an edge are one particle */
  }
  if (known) hk_warm_start_give(known, &s, &move, false);
  assert_int_equal(hk_awake_open(&awake, &host, N), HK_OK);
  assert_int_equal(hk_awake_list(&awake, c->impact, PAIRS, c->inverse_mass), HK_OK);
  return hk_gauss_seidel(&s, &move);
}

static void check_rest(const column *c) {
  for (int i = 0; i < N; i++)
    for (int k = 0; k < 3; k++)
      assert_true(fabs(c->x[3 * i + k] - c->x_from[3 * i + k]) < 1e-9 && fabs(c->v[3 * i + k]) < 1e-6);
}

/* Nine tenths are given: the rest falls by a tenth as if it were all. */
static void a_column_at_rest_is_known(void **state) {
  (void)state;
  static column c;
  hk_array known = {0};
  hk_gauss_seidel_result first = solve(&c, 1e-3, false, NULL), again = first;
  hk_contact_solver solved = {.count = PAIRS, .impact = c.impact};
  check_rest(&c);
  assert_true(first.pushing == PAIRS);
  double slide = c.impact[PAIRS - 1].place.slide[0];
  assert_true(fabs(slide + 1e-6 * 0.1 * gravity * mass) < 1e-9 * gravity * mass);
  assert_int_equal(hk_warm_start_keep(&known, &host, &solved, 1e-3), HK_OK);
  for (int k = 0; k < 4; k++) {
    const double h = k % 2 ? 5e-4 : 1e-3;
    const bool other = k > 1;
    memset(&c, 0, sizeof c);
    again = solve(&c, h, other, &known);
    check_rest(&c);
    print_message("%zu sweeps, at first %zu\n", again.sweeps, first.sweeps);
    assert_true(again.sweeps < first.sweeps);
  }
  /* What is given, by itself. */
  solve(&c, 1e-3, true, NULL);
  for (int e = 0; e < PAIRS; e++) memset(&c.impact[e].place, 0, sizeof c.impact[e].place);
  hk_warm_start_give(&known, &solved, &(hk_step_move){.h = 2e-3}, false);
  assert_true(fabs(c.impact[0].place.push / (0.9 * 4e-6 * gravity * mass) - 1) < 1e-3);
  assert_true(fabs(c.impact[0].place.slide[0] + 4 * 0.9 * slide) < 1e-9 * fabs(slide)); /* on the lower one */
  free(known.item);
}

static void what_is_damaged_is_not_taken(void **state) {
  (void)state;
  static column c;
  hk_array known = {0};
  solve(&c, 1e-3, false, NULL);
  hk_contact_solver solved = {.count = PAIRS, .impact = c.impact};
  assert_int_equal(hk_warm_start_keep(&known, &host, &solved, 1e-3), HK_OK);
  hk_warm_pair *table = known.item;
  for (size_t k = 0; k < known.count; k++) {
    table[k].push[0] = NAN, table[k].push[1] = INFINITY;
    table[k].present = 1; /* no place is free */
  }
  solve(&c, 1e-3, false, &known);
  check_rest(&c);
  known.count--;
  solve(&c, 1e-3, false, &known);
  check_rest(&c);
  free(known.item);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_column_at_rest_is_known),
      cmocka_unit_test(what_is_damaged_is_not_taken),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
