/* What bodies add to the pressure's matrix: the product is that of rho V G M^-1 G^T written out, symmetric and
 * positive, and with it the pressure of a cell between a wall and a piston is that of a closed form. */
#include "plugins/common/mac_grid/pressure.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { ROWS = 20, WALLS = 9 };

static const double inverse_inertia[9] = {2, 0.3, 0.1, 0.3, 1.5, -0.2, 0.1, -0.2, 3};

static void fill(hk_moving_walls *s, const hk_host *host, hk_moving_body body[2]) {
  s->bodies = 2;
  s->body = body;
  for (int b = 0; b < 2; b++) {
    body[b].mass = 0.5 + b;
    memcpy(body[b].inverse_inertia, inverse_inertia, sizeof inverse_inertia);
  }
  hk_moving_walls_clear(s);
  for (uint32_t k = 0; k < WALLS; k++) {
    hk_moving_wall w = {(7 * k) % ROWS, k % 2, {0}};
    for (int c = 0; c < 6; c++) w.flux[c] = test_noise();
    assert_int_equal(hk_moving_walls_add(s, host, &w), HK_OK);
  }
}

static void the_product_is_that_of_the_matrix(void **state) {
  (void)state;
  test_solver s;
  test_solver_open(&s, "pcg", 1);
  hk_moving_walls walls = {0};
  hk_moving_body body[2];
  double in[ROWS], out[ROWS] = {0}, wanted[ROWS] = {0}, product = 0;
  fill(&walls, &s.solver->host, body);
  for (int i = 0; i < ROWS; i++) in[i] = test_noise();
  double found = hk_moving_walls_multiply(&walls, in, out);
  for (size_t i = 0; i < WALLS; i++)
    for (size_t j = 0; j < WALLS; j++) {
      const hk_moving_wall *a = &walls.wall[i], *b = &walls.wall[j];
      double entry = 0;
      for (int c = 0; c < 3 && a->body == b->body; c++) {
        entry += a->flux[c] * b->flux[c] / body[a->body].mass;
        for (int d = 0; d < 3; d++) entry += a->flux[3 + c] * inverse_inertia[3 * c + d] * b->flux[3 + d];
      }
      wanted[a->row] += entry * in[b->row];
    }
  for (int i = 0; i < ROWS; i++) {
    assert_true(fabs(out[i] - wanted[i]) < 1e-14);
    product += in[i] * wanted[i];
  }
  assert_true(found > 0 && fabs(found - product) < 1e-14);
  test_solver_close(&s);
}

/* A row of n cells of 1 m, free above: u* = -1 everywhere, and below a piston that stands and has the mass m of the
 * liquid in m cells. All move as one, and the momentum of the N faces above the piston is shared: v = -N/(N + m), and q
 * in the lowest cell is the momentum -m v that it loses. */
static void a_piston_takes_its_part_of_the_momentum(void **state) {
  (void)state;
  enum { N = 12 };
  test_solver s;
  test_solver_open(&s, "pcg", 1);
  const hk_liquid_grid grid = {.cells = {1, 1, N}, .slab = 2};
  hk_pressure p;
  assert_int_equal(hk_pressure_open(&p, &s.solver->host, &grid), HK_OK);
  const double mass = 3;
  p.rows = N;
  for (uint32_t k = 0; k < N; k++) {
    p.cell[k] = 4 + 9 * (k + 1);
    for (int c = 0; c < 2; c++) p.prior[c][k] = p.next[c][k] = N;
    for (int c = 0; c < 2; c++) p.side[c][k] = 0;
    p.prior[2][k] = k > 0 ? k - 1 : N;
    p.next[2][k] = k + 1 < N ? k + 1 : N;
    p.side[2][k] = k + 1 < N;
    p.diagonal[k] = k == 0 ? 1 : 2; /* the surface is one cell above the last centre */
    p.b[k] = k == 0 ? 1 : 0;        /* of the divergence: -1 - 0 in the lowest cell */
    p.x[k] = 0;
  }
  hk_moving_wall w = {0, 0, {0, 0, -1}};
  p.walls.bodies = 1;
  p.walls.body = s.solver->host.allocate(&s.solver->host, sizeof *p.walls.body);
  p.walls.body->mass = mass;
  assert_int_equal(hk_moving_walls_add(&p.walls, &s.solver->host, &w), HK_OK);
  for (int way = HK_PRESSURE_FACTORS; way <= HK_PRESSURE_VCYCLE; way++) {
    p.way = (hk_pressure_way)way;
    memset(p.x, 0, N * sizeof *p.x);
    hk_pressure_prepare(&p);
    assert_true(hk_pressure_solve(&p, 1e-12, 0));
    hk_moving_walls_reply(&p.walls, p.x);
    double v = -(double)N / (N + mass); /* N faces between the piston and the surface carry the liquid */
    assert_true(fabs(p.walls.body->reply[2] - v) < 1e-10);
    assert_true(fabs(p.x[0] + mass * v) < 1e-10);
  }
  hk_pressure_close(&p);
  test_solver_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_product_is_that_of_the_matrix),
      cmocka_unit_test(a_piston_takes_its_part_of_the_momentum),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
