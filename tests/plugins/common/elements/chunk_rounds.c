/* Chunks of a round share no particle, all come once, and where everything touches everything they come one by one. */
#include "plugins/common/elements/chunk_rounds.h"
#include "tests/support/fake_system.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { COUNT = 100 * HK_CHUNK_ELEMENTS - 7, ARITY = 3 };

typedef struct seen {
  unsigned char *times;
} seen;

static void note(const void *context, size_t begin, size_t end) {
  const seen *s = context;
  for (size_t k = begin; k < end; k++) s->times[k]++;
}

/* Element k has the particles of `member`. */
static size_t rounds_of(uint32_t (*member)(size_t k, unsigned m), size_t n) {
  fake_system *f = fake_system_create(&(fake_problem){.n = 1});
  uint32_t *index = malloc(ARITY * COUNT * sizeof *index);
  for (size_t c = 0; c < ARITY * COUNT; c++) index[c] = member(c / ARITY, c % ARITY);
  hk_tuples node = {COUNT, ARITY, index};
  hk_chunk_rounds rounds = {0};
  assert_int_equal(hk_chunk_rounds_sort(&rounds, &f->host, n, &node), HK_OK);
  uint32_t *owner = malloc(n * sizeof *owner);
  for (size_t r = 0; r < rounds.rounds; r++) {
    for (size_t i = 0; i < n; i++) owner[i] = UINT32_MAX;
    for (size_t q = rounds.first[r]; q < rounds.first[r + 1]; q++)
      for (size_t c = ARITY * HK_CHUNK_ELEMENTS * (size_t)rounds.chunk[q];
           c < ARITY * HK_CHUNK_ELEMENTS * ((size_t)rounds.chunk[q] + 1) && c < ARITY * COUNT; c++) {
        assert_true(owner[index[c]] == UINT32_MAX || owner[index[c]] == rounds.chunk[q]);
        owner[index[c]] = rounds.chunk[q];
      }
  }
  seen s = {calloc(COUNT, 1)};
  hk_chunk_rounds_run(&rounds, &f->host, note, &s);
  for (size_t k = 0; k < COUNT; k++) assert_int_equal(s.times[k], 1);
  free(s.times), free(owner), free(index);
  fake_system_destroy(f);
  return rounds.rounds;
}

static uint32_t along(size_t k, unsigned m) { return (uint32_t)(k + m); }
static uint32_t star(size_t k, unsigned m) { return m == 0 ? 0 : (uint32_t)(2 * k + m); }

static void chunks_of_a_round_share_no_particle(void **state) {
  (void)state;
  assert_int_equal(rounds_of(along, COUNT + 3), 2);
  assert_int_equal(rounds_of(star, 2 * COUNT + 3), 100);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(chunks_of_a_round_share_no_particle)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
