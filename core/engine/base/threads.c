/* A pool for parallel_for. The chunks of a loop that nobody has taken are a number, which threads lower by one to take
 * one; the loop is over when all are finished. So a thread that comes late, or that another process keeps from its
 * processor, delays a loop only by the one chunk that it may hold. Who finds nothing to take looks again for some
 * microseconds, because the loops of one step follow each other closely, and then sleeps: a processor without work gets
 * one of the threads that wait for theirs. A worker that looks for work gives way to other processes: who is taken from
 * the processor then holds no chunk, and the loop goes on without it. Workers that sleep are woken less often while
 * they come too late to take a chunk, which is counted in loops. A loop that is asked for while the pool is at work, by
 * a body or by another thread, runs in the caller, chunk by chunk in order. Invariant: when hk_threads_for returns, no
 * thread touches the body or its context. */
#include "core/engine/base/base.h"

#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <time.h>

enum { SPIN = 4000, YIELD = 64, NAP = 50000 /* ns */, LINE = 64 /* bytes */, IN_VAIN_MOST = 15 /* loops */ };

typedef void (*loop_body)(void *context, size_t begin, size_t end, size_t chunk);

struct hk_threads {
  size_t count; /* with the caller */
  pthread_t *thread;
  sem_t wake;
  atomic_int asleep; /* workers */
  atomic_bool stop;
  atomic_bool taken; /* a loop is under way */
  void (*after)(void);
  loop_body body; /* of that loop, as what follows: written while no chunk of it is taken */
  void *context;
  size_t total, grain, chunks;
  size_t calls, in_vain; /* loops since sleeping workers were woken; how many go by, as these came too late */
  char apart[LINE];
  atomic_size_t left; /* chunks that no thread has taken */
  char further[LINE];
  atomic_size_t unfinished; /* chunks */
};

static void relax(void) {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

static void run_chunk(size_t count, size_t grain, size_t chunk, loop_body body, void *context) {
  size_t begin = chunk * grain;
  body(context, begin, count - begin < grain ? count : begin + grain, chunk);
}

static size_t take_chunks(hk_threads *t) {
  size_t taken = 0, left = atomic_load(&t->left);
  while (left > 0)
    if (atomic_compare_exchange_weak(&t->left, &left, left - 1)) {
      run_chunk(t->total, t->grain, t->chunks - left, t->body, t->context);
      taken++, left = atomic_load(&t->left);
    }
  return taken;
}

static void wake(hk_threads *t) {
  for (int asleep = atomic_exchange(&t->asleep, 0); asleep > 0; asleep--) sem_post(&t->wake);
}

static bool has_work(hk_threads *t) { return atomic_load(&t->left) > 0 || atomic_load(&t->stop); }

static void wait_for_work(hk_threads *t) {
  for (int i = 0; i < SPIN && !has_work(t); i++) i % YIELD ? relax() : (void)sched_yield();
  if (has_work(t)) return;
  atomic_fetch_add(&t->asleep, 1);
  if (has_work(t)) wake(t); /* it came before this thread was seen to sleep */
  while (sem_wait(&t->wake) != 0) {
  }
}

/* Each nap lets the system move a thread that is held up to this processor. */
static void wait_for_end(hk_threads *t) {
  for (int i = 0; i < SPIN && atomic_load(&t->unfinished) > 0; i++) relax();
  while (atomic_load(&t->unfinished) > 0) nanosleep(&(struct timespec){0, NAP}, NULL);
}

static void *worker(void *argument) {
  hk_threads *t = argument;
  while (!atomic_load(&t->stop)) {
    size_t finished = take_chunks(t);
    if (finished > 0 && t->after) t->after();
    atomic_fetch_sub(&t->unfinished, finished);
    if (finished == 0) wait_for_work(t);
  }
  return NULL;
}

hk_threads *hk_threads_create(int threads) {
  hk_threads *t = calloc(1, sizeof *t);
  if (!t) return NULL;
  sem_init(&t->wake, 0, 0);
  t->thread = calloc(threads > 1 ? (size_t)threads : 1, sizeof *t->thread);
  t->count = 1;
  if (!t->thread) {
    hk_threads_destroy(t);
    return NULL;
  }
  while (t->count < (size_t)threads) {
    if (pthread_create(&t->thread[t->count - 1], NULL, worker, t) != 0) {
      hk_threads_destroy(t);
      return NULL;
    }
    t->count++;
  }
  return t;
}

void hk_threads_destroy(hk_threads *t) {
  if (!t) return;
  atomic_store(&t->stop, true);
  wake(t);
  for (size_t i = 0; i + 1 < t->count; i++) pthread_join(t->thread[i], NULL);
  sem_destroy(&t->wake);
  free(t->thread);
  free(t);
}

void hk_threads_watch(hk_threads *t, void (*after)(void)) { t->after = after; }

int hk_threads_count(const hk_threads *t) { return t ? (int)t->count : 1; }

static void share(hk_threads *t) {
  if (t->calls++ >= t->in_vain) wake(t), t->calls = 0;
  size_t own = take_chunks(t);
  if (atomic_fetch_sub(&t->unfinished, own) > own) wait_for_end(t);
  if (own < t->chunks)
    t->in_vain = 0;
  else if (t->calls == 0 && t->in_vain < IN_VAIN_MOST)
    t->in_vain = 2 * t->in_vain + 1;
}

void hk_threads_for(hk_threads *t, size_t count, size_t grain, loop_body body, void *context) {
  if (count == 0) return;
  if (grain == 0) grain = 1;
  size_t chunks = (count - 1) / grain + 1;
  if (chunks == 1 || !t || t->count == 1 || atomic_exchange(&t->taken, true)) {
    for (size_t chunk = 0; chunk < chunks; chunk++) run_chunk(count, grain, chunk, body, context);
    return;
  }
  t->body = body, t->context = context;
  t->total = count, t->grain = grain, t->chunks = chunks;
  atomic_store(&t->unfinished, chunks);
  atomic_store(&t->left, chunks);
  share(t);
  atomic_store(&t->taken, false);
}
