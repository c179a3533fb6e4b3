/* The turn of bodies in a made-up field: that of a rigid rotation is found whatever it is, as far as pins allow it. */
#include "plugins/common/turns/body_turns.h"
#include "plugins/kit/vector3.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

enum { N = 9, EDGES = 7 };

static const double rounding = 1e-13;

/* Two bodies: a tetrahedron of 0 to 3, and 5 and 6; 4 is alone. 7 and 8 are pinned where a test says so, and joined to
 * the first. */
static double x[3 * N] = {0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 9, 9, 9, 5, 5, 5, 5, 6, 7, 0.5, -1, 0.25, -0.5, 1, 2};
static const double mass[N] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
static uint32_t pair[EDGES][2] = {{0, 1}, {1, 2}, {2, 3}, {5, 6}, {0, 7}, {3, 8}, {7, 8}};

typedef struct bodies {
  hk_turning_body body[N];
  uint32_t label[N], anchor[2 * EDGES][2];
  uint8_t pin[N];
  hk_element_edges edges;
  hk_body_turns turns;
} bodies;

static void arrange(bodies *b, int pinned) {
  *b = (bodies){.edges = {.n = N, .count = EDGES, .pair = pair}};
  for (int k = 0; k < pinned; k++) b->pin[N - 1 - k] = HK_PIN_FIXED;
  b->edges.pin = b->pin;
  b->turns = (hk_body_turns){.body = b->body, .label = b->label, .anchor = b->anchor};
  hk_body_turns_arrange(&b->turns, &b->edges);
}

/* The field of a rotation about a place. */
static void rotate(const double turn[3], const double about[3], double *a) {
  for (size_t i = 0; i < N; i++) {
    double r[3];
    hk_subtract(r, x + 3 * i, about);
    hk_cross(a + 3 * i, turn, r);
  }
}

static void assert_turn(const hk_turning_body *b, double p, double q, double r) {
  assert_true(fabs(b->turn[0] - p) < rounding && fabs(b->turn[1] - q) < rounding && fabs(b->turn[2] - r) < rounding);
}

static void bodies_are_what_edges_connect(void **state) {
  (void)state;
  bodies b;
  arrange(&b, 2);
  assert_int_equal(b.turns.bodies, 3);
  assert_true(b.label[0] == b.label[3] && b.label[4] != b.label[0] && b.label[5] == b.label[6]);
  assert_true(b.label[7] == HK_NO_BODY && b.turns.anchors == 2);
}

/* A drift of all is no turn; two particles do not turn about the line between them. */
static void a_free_body_has_the_turn_of_its_field(void **state) {
  (void)state;
  bodies b;
  double a[3 * N], length2 = 1 + 4, along = (0.2 + 2 * -0.7) / length2;
  arrange(&b, 0);
  rotate((const double[]){0.3, 0.2, -0.7}, (const double[]){7, 8, -2}, a);
  hk_body_turns_find(&b.turns, mass, x, a);
  assert_turn(&b.body[b.label[0]], 0.3, 0.2, -0.7);
  assert_turn(&b.body[b.label[4]], 0, 0, 0);
  assert_turn(&b.body[b.label[5]], 0.3, 0.2 - along, -0.7 - 2 * along);
  hk_body_turns_remove(&b.turns, mass, x, a);
  hk_body_turns_find(&b.turns, mass, x, a);
  for (size_t k = 0; k < b.turns.bodies; k++) assert_turn(&b.body[k], 0, 0, 0);
}

/* The field is no rotation about these pins; what is found is one, and none is left when it is removed. */
static void pins_leave_the_turns_about_them(void **state) {
  (void)state;
  bodies b;
  double a[3 * N], axis[3], across[3];
  arrange(&b, 2);
  rotate((const double[]){0.3, 0.2, -0.7}, x + 3 * 7, a);
  for (int c = 0; c < 3; c++) a[3 * 8 + c] = 0;
  hk_body_turns_find(&b.turns, mass, x, a);
  const double *turn = b.body[b.label[0]].turn;
  hk_subtract(axis, x + 3 * 8, x + 3 * 7);
  hk_cross(across, axis, turn);
  assert_true(hk_dot(turn, turn) > 1e-3 && hk_length(across) < rounding);
  arrange(&b, 1);
  rotate((const double[]){0.3, 0.2, -0.7}, x + 3 * 8, a);
  hk_body_turns_find(&b.turns, mass, x, a);
  assert_turn(&b.body[b.label[0]], 0.3, 0.2, -0.7);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bodies_are_what_edges_connect),
      cmocka_unit_test(a_free_body_has_the_turn_of_its_field),
      cmocka_unit_test(pins_leave_the_turns_about_them),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
