/* The sum by parts beside the forces' own sums, on a random net whose elements lie in one domain, across two and across
 * more, with pins, a force on a group, and after deaths; and the order of a pass. */
#include "core/numerics/population/population.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 18000, NEAR = 30, FAR_EVERY = 50 };

static uint64_t seed;

static double noise(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) * 0x1.0p-52 - 1;
}

static size_t below(size_t n) { return (size_t)((noise() + 1) / 2 * (double)n) % n; }

/* Every particle is joined to one of the next NEAR, one in FAR_EVERY to any. */
static size_t make_edges(uint32_t (*edge)[2]) {
  size_t count = 0;
  for (size_t i = 0; i < N; i++) {
    size_t j = i % FAR_EVERY ? i + 1 + below(NEAR) : below(N);
    if (j >= N || i == j) continue;
    edge[count][0] = (uint32_t)i + 1, edge[count++][1] = (uint32_t)j + 1;
  }
  return count;
}

static size_t make_triples(uint32_t (*triple)[3]) {
  size_t count = 0;
  for (size_t i = 0; i + 4 < N; i += 27) {
    size_t third = i % 60 ? i + 2 : below(N), second = i % 120 ? i + 1 : below(N);
    if (third == i || second == i || third == second) continue;
    triple[count][0] = (uint32_t)i + 1, triple[count][1] = (uint32_t)second + 1,
    triple[count++][2] = (uint32_t)third + 1;
  }
  return count;
}

static void add_pins(test_engine *e) {
  const double axis[3] = {0.6, 0, 0.8};
  for (uint32_t k = 1; k < N; k += 700) {
    test_pin(e, HK_PIN_FIXED, k, NULL);
    test_pin(e, HK_PIN_LINE, k + 1, axis);
    test_pin(e, HK_PIN_PLANE, k + 2, axis);
  }
}

static void open_net(test_engine *e, int threads, const char *integrator) {
  uint32_t(*edge)[2] = malloc(N * sizeof *edge), (*triple)[3] = malloc(N * sizeof *triple), first;
  double *x = malloc(3 * N * sizeof *x);
  seed = 7;
  test_engine_open(e);
  e->scene->threads = threads;
  e->options.dt = 1e-4;
  for (size_t k = 0; k < 3 * N; k++) x[k] = noise();
  assert_int_equal(hk_scene_add_particles(e->scene, N, x, NULL, NULL, 1, 0, &first, &e->error), HK_OK);
  add_pins(e);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, make_edges(edge));
  test_number(e, springs, "k", 10);
  test_number(e, springs, "damping", 0.3);
  hk_plugin_spec *triples = test_plugin(e, HK_FORCE, "fixture:triples");
  test_tuples(e, triples, "triangles", 3, &triple[0][0], make_triples(triple));
  test_plugin(e, HK_FORCE, "gravity");
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 0.4);
  if (integrator) test_plugin(e, HK_INTEGRATOR, integrator);
  test_run(e);
  free(edge);
  free(triple);
  free(x);
}

/* W (the sum of the forces' own `add`) with the directions that pins forbid taken out. */
static void plain(test_engine *e, double *a, double *F) {
  hk_dynamics *d = &e->run->dynamics;
  memset(a, 0, 3 * d->system.n * sizeof *a);
  for (size_t k = 0; k < d->system.split->forces; k++) {
    assert_true(hk_query_force(d, k, d->system.X, d->system.n, F));
    for (size_t q = 0; q < 3 * d->system.n; q++) a[q] += F[q] * d->system.model->inverse_mass[q / 3];
  }
  d->system.filter(&d->system, a);
}

static void compare(test_engine *e) {
  hk_system *s = &e->run->dynamics.system;
  size_t n = s->n;
  double *a = malloc((3 * n + 8) * sizeof *a), *b = malloc(3 * n * sizeof *b), *F = malloc(3 * n * sizeof *F);
  double largest = 0, off = 0;
  assert_int_equal(s->accelerations(s, s->t, s->X, s->X + 3 * n, s->X + 6 * n, a, a + 3 * n), HK_OK);
  plain(e, b, F);
  for (size_t q = 0; q < 3 * n; q++) largest = fmax(largest, fabs(b[q])), off = fmax(off, fabs(a[q] - b[q]));
  print_message("%zu particles, %zu blocks in %zu domains: off by %.1e of the largest\n", n,
                s->model->partition->blocks, s->model->partition->domains, off / largest);
  assert_true(largest > 1 && off < 1e-14 * largest); /* some ten terms in another order */
  free(a);
  free(b);
  free(F);
}

static void sum_by_parts_is_the_sum_of_forces(void **state) {
  (void)state;
  test_engine e;
  open_net(&e, 2, NULL);
  for (size_t k = 0; k < 3 * N; k++) e.run->state.X[3 * N + k] = noise();
  assert_true(e.run->dynamics.tiles.front.rounds > 3 && e.run->state.partition.domains > 2);
  for (int k = 0; k < 4; k++) assert_true(e.run->dynamics.tiles.chosen[k]);
  compare(&e);
  e.run->dynamics.takes[0] = false;
  hk_system *s = &e.run->dynamics.system;
  double *a = calloc(3 * N + 8, sizeof *a), *F = calloc(3 * N, sizeof *F), off = 0;
  assert_int_equal(s->accelerations(s, s->t, s->X, s->X + 3 * N, s->X + 6 * N, a, a + 3 * N), HK_OK);
  assert_true(hk_query_force(&e.run->dynamics, 0, s->X, N, F));
  for (size_t i = 0; i < N; i++) off = fmax(off, s->model->pin[i] == HK_FREE ? fabs(a[3 * i]) : 0);
  hk_dynamics_take_all(&e.run->dynamics);
  double with = 0;
  assert_int_equal(s->accelerations(s, s->t, s->X, s->X + 3 * N, s->X + 6 * N, a, a + 3 * N), HK_OK);
  for (size_t i = 0; i < N; i++) with = fmax(with, fabs(a[3 * i]));
  assert_true(with > off); /* the springs had been left out */
  free(a);
  free(F);
  test_engine_close(&e);
}

static void parts_follow_deaths(void **state) {
  (void)state;
  test_engine e;
  open_net(&e, 3, NULL);
  uint32_t *map = malloc(N * sizeof *map), kept = 0;
  for (uint32_t i = 0; i < N; i++) map[i] = i % 5 == 3 ? UINT32_MAX : kept++;
  hk_state_move(&e.run->state, map, kept);
  assert_int_equal(hk_dynamics_remap(&e.run->dynamics, map, N), HK_OK);
  compare(&e);
  free(map);
  test_engine_close(&e);
}

/* Two threads have something to share from two blocks on; every block is in a domain. */
static void particles_are_divided_by_their_number(void **state) {
  (void)state;
  static const struct {
    size_t n, blocks, domains;
  } expected[] = {{1, 1, 1},    {1024, 1, 1}, {1025, 2, 2},    {4096, 4, 2},
                  {4097, 5, 2}, {8192, 8, 4}, {32768, 32, 16}, {40000, 79, 14}};
  double *x = calloc(3 * 40000, sizeof *x);
  for (size_t k = 0; k < sizeof expected / sizeof *expected; k++) {
    test_engine e;
    uint32_t first;
    test_engine_open(&e);
    assert_int_equal(hk_scene_add_particles(e.scene, expected[k].n, x, NULL, NULL, 1, 0, &first, &e.error), HK_OK);
    e.options.dt = 1;
    test_run(&e);
    const hk_partition *p = &e.run->state.partition;
    assert_int_equal(p->n, expected[k].n);
    assert_int_equal(p->blocks, expected[k].blocks);
    assert_int_equal(p->domains, expected[k].domains);
    assert_true(p->width * p->domains >= p->blocks && p->width * (p->domains - 1) < p->blocks);
    test_engine_close(&e);
  }
  free(x);
}

/* The bits of a run do not depend on the number of threads. */
static void threads_leave_no_trace(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 3, 7};
  static const char *const methods[] = {"leapfrog", "stoermer", "symplectic_euler", "blanes_moan", "rk4"};
  for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
    double *X = NULL;
    for (size_t k = 0; k < sizeof threads / sizeof *threads; k++) {
      test_engine e;
      open_net(&e, threads[k], methods[m]);
      test_advance(&e, 4e-4);
      size_t bytes = e.run->state.size * sizeof *X;
      if (!X) X = memcpy(malloc(bytes), e.run->state.X, bytes);
      assert_memory_equal(X, e.run->state.X, bytes);
      test_engine_close(&e);
    }
    free(X);
  }
}

/* ---- the pass ---- */

typedef struct record {
  uint8_t *prepared, *finished; /* how often each particle was */
  bool late;                    /* one was finished before it was prepared */
} record;

static void prepare(void *context, size_t begin, size_t end) {
  record *r = context;
  for (size_t i = begin; i < end; i++) r->prepared[i]++;
}

static void finish(void *context, size_t begin, size_t end) {
  record *r = context;
  for (size_t i = begin; i < end; i++) r->late |= r->prepared[i]++ != 1, r->finished[i]++;
}

/* With a force that has no parts as well: every particle is prepared and finished once. */
static void every_particle_is_prepared_and_finished_once(void **state) {
  (void)state;
  for (int whole = 0; whole < 2; whole++) {
    test_engine e;
    record r = {calloc(N, 1), calloc(N, 1), false};
    open_net(&e, 2, NULL);
    e.run->dynamics.tiles.chosen[0] &= !whole;
    hk_system *s = &e.run->dynamics.system;
    double *a = calloc(3 * N + 8, sizeof *a);
    assert_int_equal(
        s->fused(s, s->t, s->X, s->X + 3 * N, s->X + 6 * N, a, a + 3 * N, &(hk_fused){&r, prepare, finish}), HK_OK);
    for (size_t i = 0; i < N; i++) assert_true(r.prepared[i] == 2 && r.finished[i] == 1);
    assert_false(r.late);
    free(a);
    free(r.prepared);
    free(r.finished);
    test_engine_close(&e);
  }
}

/* What is not finite is found in whatever block it is, and X stays. */
static void a_force_that_is_not_finite_fails_the_pass(void **state) {
  (void)state;
  for (size_t at = 0; at < N; at += N / 4) {
    test_engine e;
    open_net(&e, 2, NULL);
    hk_system *s = &e.run->dynamics.system;
    double *a = calloc(3 * N + 8, sizeof *a);
    s->X[3 * N + 3 * at + 1] = NAN;
    assert_int_equal(s->accelerations(s, s->t, s->X, s->X + 3 * N, s->X + 6 * N, a, a + 3 * N), HK_NOT_FINITE);
    free(a);
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sum_by_parts_is_the_sum_of_forces),
      cmocka_unit_test(parts_follow_deaths),
      cmocka_unit_test(particles_are_divided_by_their_number),
      cmocka_unit_test(threads_leave_no_trace),
      cmocka_unit_test(every_particle_is_prepared_and_finished_once),
      cmocka_unit_test(a_force_that_is_not_finite_fails_the_pass),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
