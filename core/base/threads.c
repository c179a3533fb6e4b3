/* A pool for parallel_for. The chunks of a loop that nobody has taken are a number, which threads lower by one to take
 * one; the loop is over when all are finished. So a thread that comes late, or that another process keeps from its
 * processor, delays a loop only by the one chunk that it may hold. Who finds nothing to take, or waits for a chunk,
 * looks again for some microseconds, because the loops of one step follow each other closely, and then sleeps: a
 * processor without work gets one of the threads that wait for theirs. A loop that is asked for while the pool is at
 * work, by a body or by another thread, runs in the caller, chunk by chunk in order. Invariant: when hk_threads_for
 * returns, no thread touches the body or its context. */
#include "core/base/base.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

enum { SPIN = 4000, LINE = 64 /* bytes that processors pass on together */ };

typedef void (*loop_body)(void *context, size_t begin, size_t end, size_t chunk);

typedef struct bell {
  atomic_int asleep; /* threads that wait for it to ring */
  pthread_cond_t rings;
} bell;

struct hk_threads {
  int count; /* with the caller */
  pthread_t *thread;
  pthread_mutex_t lock;
  bell work, end; /* for workers, for the caller */
  atomic_bool stop;
  atomic_bool taken; /* a loop is under way */
  loop_body body;    /* of that loop, as what follows: written while no chunk of it is taken */
  void *context;
  size_t total, grain, chunks;
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
  size_t taken = 0;
  for (size_t left = atomic_load(&t->left); left > 0;)
    if (atomic_compare_exchange_weak(&t->left, &left, left - 1)) {
      run_chunk(t->total, t->grain, t->chunks - left, t->body, t->context);
      taken++;
      left = atomic_load(&t->left);
    }
  return taken;
}

static bool has_work(hk_threads *t) { return atomic_load(&t->left) > 0 || atomic_load(&t->stop); }

static bool has_ended(hk_threads *t) { return atomic_load(&t->unfinished) == 0; }

static void wait_for(hk_threads *t, bell *b, bool (*here)(hk_threads *)) {
  for (int i = 0; i < SPIN; i++) {
    if (here(t)) return;
    relax();
  }
  pthread_mutex_lock(&t->lock);
  atomic_fetch_add(&b->asleep, 1);
  while (!here(t)) pthread_cond_wait(&b->rings, &t->lock);
  atomic_fetch_sub(&b->asleep, 1);
  pthread_mutex_unlock(&t->lock);
}

/* After the change that is waited for: either a thread that goes to sleep sees the change, or this one that it sleeps.
 */
static void ring(hk_threads *t, bell *b) {
  if (atomic_load(&b->asleep) == 0) return;
  pthread_mutex_lock(&t->lock);
  pthread_cond_broadcast(&b->rings);
  pthread_mutex_unlock(&t->lock);
}

static void *worker(void *argument) {
  hk_threads *t = argument;
  while (!atomic_load(&t->stop)) {
    size_t finished = take_chunks(t);
    if (finished == 0)
      wait_for(t, &t->work, has_work);
    else if (atomic_fetch_sub(&t->unfinished, finished) == finished)
      ring(t, &t->end);
  }
  return NULL;
}

hk_threads *hk_threads_create(int threads) {
  hk_threads *t = calloc(1, sizeof *t);
  if (!t) return NULL;
  pthread_mutex_init(&t->lock, NULL);
  pthread_cond_init(&t->work.rings, NULL);
  pthread_cond_init(&t->end.rings, NULL);
  t->thread = calloc(threads > 1 ? (size_t)threads : 1, sizeof *t->thread);
  t->count = 1;
  if (!t->thread) {
    hk_threads_destroy(t);
    return NULL;
  }
  while (t->count < threads) {
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
  ring(t, &t->work);
  for (int i = 0; i + 1 < t->count; i++) pthread_join(t->thread[i], NULL);
  pthread_cond_destroy(&t->work.rings);
  pthread_cond_destroy(&t->end.rings);
  pthread_mutex_destroy(&t->lock);
  free(t->thread);
  free(t);
}

int hk_threads_count(const hk_threads *t) { return t ? t->count : 1; }

void hk_threads_for(hk_threads *t, size_t count, size_t grain, loop_body body, void *context) {
  if (count == 0) return;
  if (grain == 0) grain = 1;
  size_t chunks = (count - 1) / grain + 1;
  if (chunks == 1 || !t || t->count == 1 || atomic_exchange(&t->taken, true)) {
    for (size_t chunk = 0; chunk < chunks; chunk++) run_chunk(count, grain, chunk, body, context);
    return;
  }
  t->body = body;
  t->context = context;
  t->total = count;
  t->grain = grain;
  t->chunks = chunks;
  atomic_store(&t->unfinished, chunks);
  atomic_store(&t->left, chunks);
  ring(t, &t->work);
  size_t finished = take_chunks(t);
  if (atomic_fetch_sub(&t->unfinished, finished) > finished) wait_for(t, &t->end, has_ended);
  atomic_store(&t->taken, false);
}
