/* Which impacts a move wakes: those of the particles that it has moved, later ones in this sweep, earlier ones in the
 * next; and none by what is pinned, or where there is nothing to move. */
#include "plugins/common/contact/impulses/awake.h"
#include "tests/support/plain_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static hk_status refuse(const hk_host *host, hk_status status, const char *format, ...) {
  (void)host, (void)format;
  return status;
}

static const hk_host host = {.allocate = test_allocate, .release = test_release, .fail = refuse};
static hk_awake awake;

enum { PINNED = 0, N = 9, COUNT = 5 };

/* Edges that share particles; the last one is of pinned particles. */
static const hk_impact impact[COUNT] = {
    {.pair = {.vertex = {1, 5, 2, 6}}, .frame = {.w = {1, 0, -1, 0}}, .mobility = 2},
    {.pair = {.vertex = {2, 6, 3, 7}}, .frame = {.w = {1, 0, -1, 0}}, .mobility = 2},
    {.pair = {.vertex = {1, 5, PINNED, PINNED}}, .frame = {.w = {1, 0, -1, 0}}, .mobility = 1},
    {.pair = {.vertex = {4, 8, PINNED, PINNED}}, .frame = {.w = {1, 0, -1, 0}}, .mobility = 1},
    {.pair = {.vertex = {PINNED, PINNED, PINNED, PINNED}}, .frame = {.w = {1, 0, -1, 0}}},
};

/* Those from `from` on, as a number: bit e for impact e. */
static unsigned taken(uint32_t from) {
  unsigned all = 0;
  for (uint32_t e; hk_awake_next(&awake, &from, &e);) all |= 1u << e;
  return all;
}

/* In the sweep that impact e is solved in, and in the next one. */
static void assert_wakes(uint32_t e, unsigned now, unsigned next) {
  hk_awake_wake(&awake, impact[e].pair.vertex, e);
  assert_int_equal(taken(e + 1), now);
  assert_int_equal(taken(0), next);
}

static void a_move_wakes_what_it_moves(void **state) {
  (void)state;
  double inverse_mass[N];
  for (int i = 0; i < N; i++) inverse_mass[i] = i == PINNED ? 0 : 1;
  assert_int_equal(hk_awake_open(&awake, &host, N), HK_OK);
  assert_int_equal(hk_awake_list(&awake, impact, COUNT, inverse_mass), HK_OK);
  assert_int_equal(taken(0), 0);
  assert_wakes(0, 1u << 1 | 1u << 2, 0);
  assert_wakes(1, 0, 1u << 0);
  assert_wakes(2, 0, 1u << 0);
  assert_wakes(3, 0, 0);
  hk_awake_wake(&awake, impact[1].pair.vertex, 1);
  hk_awake_none(&awake);
  assert_int_equal(taken(0), 0);
}

static void more_than_can_be_numbered_is_refused(void **state) {
  (void)state;
  assert_int_equal(hk_awake_list(&awake, NULL, UINT32_MAX / 4, NULL), HK_FAILED);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_move_wakes_what_it_moves),
      cmocka_unit_test(more_than_can_be_numbered_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
