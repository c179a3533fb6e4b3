/* A pool for parallel_for. Work is published under a lock as a generation; threads then take chunks from an atomic
 * counter. Between two loops a thread spins for some microseconds before it sleeps, because the loops of one step
 * follow each other closely. A loop that is asked for while the pool is at work, by a body or by another thread, runs
 * in the caller, chunk by chunk in order. Invariant: when hk_threads_for returns, no thread touches the body or its
 * context. */
#include "core/base/base.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

enum { SPIN = 4000 };

struct hk_threads {
  int count; /* with the caller */
  pthread_t *thread;
  pthread_mutex_t lock;
  pthread_cond_t wake;
  atomic_uint generation; /* of the published loop */
  atomic_int busy;        /* threads that have not finished it */
  atomic_bool stop;
  atomic_bool taken; /* a loop is under way */
  void (*body)(void *context, size_t begin, size_t end, size_t chunk);
  void *context;
  size_t total, grain, chunks;
  atomic_size_t next; /* chunk to take */
};

static void relax(void) {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

static void take_chunks(hk_threads *t) {
  for (;;) {
    size_t chunk = atomic_fetch_add_explicit(&t->next, 1, memory_order_relaxed);
    if (chunk >= t->chunks) return;
    size_t begin = chunk * t->grain;
    size_t end = t->total - begin < t->grain ? t->total : begin + t->grain;
    t->body(t->context, begin, end, chunk);
  }
}

static void wait_for_work(hk_threads *t, unsigned seen) {
  for (int i = 0; i < SPIN; i++) {
    if (atomic_load_explicit(&t->generation, memory_order_acquire) != seen) return;
    relax();
  }
  pthread_mutex_lock(&t->lock);
  while (atomic_load(&t->generation) == seen) pthread_cond_wait(&t->wake, &t->lock);
  pthread_mutex_unlock(&t->lock);
}

static void *worker(void *argument) {
  hk_threads *t = argument;
  for (unsigned seen = 0;; seen++) {
    wait_for_work(t, seen);
    if (atomic_load(&t->stop)) return NULL;
    take_chunks(t);
    atomic_fetch_sub_explicit(&t->busy, 1, memory_order_release);
  }
}

static void publish(hk_threads *t) {
  pthread_mutex_lock(&t->lock);
  atomic_fetch_add_explicit(&t->generation, 1, memory_order_release);
  pthread_cond_broadcast(&t->wake);
  pthread_mutex_unlock(&t->lock);
}

hk_threads *hk_threads_create(int threads) {
  hk_threads *t = calloc(1, sizeof *t);
  if (!t) return NULL;
  pthread_mutex_init(&t->lock, NULL);
  pthread_cond_init(&t->wake, NULL);
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
  publish(t);
  for (int i = 0; i + 1 < t->count; i++) pthread_join(t->thread[i], NULL);
  pthread_cond_destroy(&t->wake);
  pthread_mutex_destroy(&t->lock);
  free(t->thread);
  free(t);
}

int hk_threads_count(const hk_threads *t) { return t ? t->count : 1; }

static void run_in_order(size_t count, size_t grain, size_t chunks,
                         void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context) {
  for (size_t chunk = 0; chunk < chunks; chunk++) {
    size_t begin = chunk * grain;
    body(context, begin, count - begin < grain ? count : begin + grain, chunk);
  }
}

static void wait_for_others(hk_threads *t) {
  for (int i = 0; atomic_load_explicit(&t->busy, memory_order_acquire) > 0; i++) {
    if (i < SPIN)
      relax();
    else
      sched_yield(); /* another process has the processor that the last thread needs */
  }
}

void hk_threads_for(hk_threads *t, size_t count, size_t grain,
                    void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context) {
  if (count == 0) return;
  if (grain == 0) grain = 1;
  size_t chunks = (count - 1) / grain + 1;
  if (chunks == 1 || !t || t->count == 1 || atomic_exchange_explicit(&t->taken, true, memory_order_acquire)) {
    run_in_order(count, grain, chunks, body, context);
    return;
  }
  t->body = body;
  t->context = context;
  t->total = count;
  t->grain = grain;
  t->chunks = chunks;
  atomic_store_explicit(&t->next, 0, memory_order_relaxed);
  atomic_store_explicit(&t->busy, t->count - 1, memory_order_relaxed);
  publish(t);
  take_chunks(t);
  wait_for_others(t);
  atomic_store_explicit(&t->taken, false, memory_order_release);
}
