/* Loops on several threads: every chunk once, the same cut for any number of threads, loops within loops, and a pool
 * that two threads share, and a thread that stands still. A loop that waits for itself would never return, so an alarm
 * ends the program. */
#include "tests/support/engine.h"

#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

enum { OUTER = 40, INNER = 1000, GRAIN = 7, CHUNKS = (INNER + GRAIN - 1) / GRAIN, PATIENCE = 60 };

typedef struct nest {
  hk_threads *threads;
  double sum[OUTER][CHUNKS];
  size_t order[OUTER]; /* chunks of the inner loop so far */
  bool in_order[OUTER];
  bool shared; /* another thread uses the pool, and leaves it at any time: order is not looked at */
} nest;

typedef struct inner {
  nest *nest;
  size_t row;
} inner;

static void add_up(void *context, size_t begin, size_t end, size_t chunk) {
  const inner *in = context;
  if (!in->nest->shared) in->nest->in_order[in->row] &= in->nest->order[in->row]++ == chunk;
  for (size_t k = begin; k < end; k++) in->nest->sum[in->row][chunk] += 1.0 / (double)(1 + k + in->row);
}

static void begin_inner(void *context, size_t begin, size_t end, size_t chunk) {
  nest *n = context;
  (void)chunk;
  for (size_t row = begin; row < end; row++) {
    inner in = {n, row};
    n->in_order[row] = true;
    hk_threads_for(n->threads, INNER, GRAIN, add_up, &in);
  }
}

static nest nested(int threads) {
  nest n = {.threads = hk_threads_create(threads)};
  assert_non_null(n.threads);
  hk_threads_for(n.threads, OUTER, 1, begin_inner, &n);
  hk_threads_destroy(n.threads);
  return n;
}

static void a_loop_within_a_loop_runs_in_order_and_ends(void **state) {
  (void)state;
  nest alone = nested(1), many = nested(4);
  for (size_t row = 0; row < OUTER; row++) {
    assert_int_equal(many.order[row], CHUNKS);
    assert_true(many.in_order[row]);
  }
  assert_memory_equal(alone.sum, many.sum, sizeof alone.sum); /* the same additions in the same order */
}

static void three_loops_deep(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  for (size_t k = begin; k < end; k++) begin_inner(context, k, k + 1, 0);
}

static void middle(void *context, size_t begin, size_t end, size_t chunk) {
  nest *n = context;
  (void)chunk;
  if (begin == 0) hk_threads_for(n->threads, OUTER, 3, three_loops_deep, n);
  (void)end;
}

static void loops_nest_to_any_depth(void **state) {
  (void)state;
  nest alone = nested(1), deep = {.threads = hk_threads_create(4)};
  hk_threads_for(deep.threads, 8, 1, middle, &deep);
  hk_threads_destroy(deep.threads);
  assert_memory_equal(alone.sum, deep.sum, sizeof alone.sum);
}

static void *again_and_again(void *argument) {
  nest *n = argument;
  for (int k = 0; k < 50; k++) {
    memset(n->sum, 0, sizeof n->sum);
    memset(n->order, 0, sizeof n->order);
    hk_threads_for(n->threads, OUTER, 1, begin_inner, n);
  }
  return NULL;
}

static void two_threads_may_use_one_pool(void **state) {
  (void)state;
  nest alone = nested(1), a = {.threads = hk_threads_create(3), .shared = true}, b = a;
  pthread_t other;
  assert_int_equal(pthread_create(&other, NULL, again_and_again, &a), 0);
  again_and_again(&b);
  pthread_join(other, NULL);
  hk_threads_destroy(a.threads);
  assert_memory_equal(alone.sum, a.sum, sizeof alone.sum);
  assert_memory_equal(alone.sum, b.sum, sizeof alone.sum);
}

/* ---- a worker that stands still, as when another process has its processor ---- */

typedef struct meeting {
  pthread_t caller, worker;
  atomic_int here; /* threads in the loop */
  double sum[INNER];
} meeting;

static atomic_bool held, let_go;

static void stand_still(int number) {
  const struct timespec a_while = {0, 100000};
  (void)number;
  atomic_store(&held, true);
  while (!atomic_load(&let_go)) nanosleep(&a_while, NULL);
}

static void nap(void) { nanosleep(&(struct timespec){0, 100000}, NULL); }

/* Two chunks, each of which waits for the other: one is the worker's. */
static void meet(void *context, size_t begin, size_t end, size_t chunk) {
  meeting *m = context;
  (void)begin, (void)end, (void)chunk;
  if (!pthread_equal(pthread_self(), m->caller)) m->worker = pthread_self();
  for (atomic_fetch_add(&m->here, 1); atomic_load(&m->here) < 2;) nap();
}

static void count_up(void *context, size_t begin, size_t end, size_t chunk) {
  meeting *m = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) m->sum[k] += 1;
}

static void a_loop_does_not_wait_for_a_thread_without_a_chunk(void **state) {
  (void)state;
  meeting m = {.caller = pthread_self()};
  hk_threads *threads = hk_threads_create(2);
  struct sigaction still = {.sa_handler = stand_still}, before;
  sigaction(SIGUSR1, &still, &before);
  hk_threads_for(threads, 2, 1, meet, &m);
  assert_int_equal(pthread_kill(m.worker, SIGUSR1), 0);
  while (!atomic_load(&held)) nap();
  for (int loop = 0; loop < 100; loop++) hk_threads_for(threads, INNER, GRAIN, count_up, &m);
  for (size_t k = 0; k < INNER; k++) assert_true(m.sum[k] == 100);
  atomic_store(&let_go, true);
  hk_threads_destroy(threads);
  sigaction(SIGUSR1, &before, NULL);
}

static void take_long(void *context, size_t begin, size_t end, size_t chunk) {
  count_up(context, begin, end, chunk);
  meeting *m = context;
  if (!pthread_equal(pthread_self(), m->caller)) atomic_fetch_add(&m->here, 1);
  for (int k = 0; k < 10; k++) nap();
}

/* While loops are short a worker that sleeps comes too late, and is called less and less; a long one gets it again. */
static void a_worker_that_comes_too_late_is_called_again(void **state) {
  (void)state;
  meeting m = {.caller = pthread_self()};
  hk_threads *threads = hk_threads_create(2);
  int loops = 300;
  for (int k = 0; k < loops; k++) {
    hk_threads_for(threads, INNER, INNER / 2, count_up, &m);
    nap(), nap();
  }
  for (; atomic_load(&m.here) == 0; loops++) hk_threads_for(threads, INNER, INNER / 2, take_long, &m);
  for (size_t k = 0; k < INNER; k++) assert_true(m.sum[k] == loops);
  hk_threads_destroy(threads);
}

static void end_of_nester(int threads, double x[90]) {
  test_engine e;
  test_engine_open(&e);
  for (int i = 0; i < 30; i++) test_particle(&e, i, sin(i), cos(2 * i), 1 + i % 3);
  test_plugin(&e, HK_FORCE, "fixture:nester");
  e.scene->threads = threads;
  e.scene->duration = 0.1;
  e.scene->fps = 10;
  e.options.dt = 0.01;
  test_run(&e);
  test_advance(&e, 0.1);
  for (uint32_t i = 0; i < 30; i++) memcpy(x + 3 * i, test_position(&e, i + 1), 3 * sizeof *x);
  test_engine_close(&e);
}

static void a_force_may_nest_its_loops(void **state) {
  (void)state;
  double alone[90], many[90];
  end_of_nester(1, alone);
  end_of_nester(4, many);
  assert_memory_equal(alone, many, sizeof alone);
  assert_true(fabs(alone[0]) > 1e-3); /* they were pulled */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_loop_within_a_loop_runs_in_order_and_ends),
      cmocka_unit_test(loops_nest_to_any_depth),
      cmocka_unit_test(two_threads_may_use_one_pool),
      cmocka_unit_test(a_loop_does_not_wait_for_a_thread_without_a_chunk),
      cmocka_unit_test(a_worker_that_comes_too_late_is_called_again),
      cmocka_unit_test(a_force_may_nest_its_loops),
  };
  alarm(PATIENCE);
  return cmocka_run_group_tests(tests, NULL, NULL);
}
