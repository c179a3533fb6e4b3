#include "plugins/common/film/conveyor.h"

#include <signal.h>
#include <string.h>
#include <time.h>

enum { PATIENCE = 100000000 }; /* ns between two looks whether to stop */

typedef struct hk_conveyor_line line;

/* The next picture of this line once there is one; NULL: there will be none. */
static const hk_still *next_still(line *l) {
  hk_conveyor *c = l->owner;
  pthread_mutex_lock(&c->lock);
  while (!c->ended && l->taken == c->put) pthread_cond_wait(&c->changed, &c->lock);
  const hk_still *still = c->ended ? NULL : c->still + l->taken % HK_CONVEYOR_ROOM;
  pthread_mutex_unlock(&c->lock);
  return still;
}

static void count_taken(line *l, bool fine) {
  pthread_mutex_lock(&l->owner->lock);
  l->taken++, l->failed |= !fine;
  pthread_cond_broadcast(&l->owner->changed);
  pthread_mutex_unlock(&l->owner->lock);
}

/* A line that failed lets the pictures pass, so that the others go on. */
static void *work(void *self) {
  line *l = self;
  const hk_still *still;
  while ((still = next_still(l))) count_taken(l, !l->failed && l->outlet.take(l->outlet.self, still));
  return NULL;
}

/* Signals are for the first thread; that a reader of the pictures has gone is told by an error. */
static bool start(line *l) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  l->started = pthread_create(&l->thread, NULL, work, l) == 0;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  return l->started;
}

hk_status hk_conveyor_open(hk_conveyor *c, const hk_host *host, size_t bytes, const hk_film_outlet *outlet,
                           size_t count) {
  *c = (hk_conveyor){.host = host, .bytes = bytes, .count = count};
  pthread_mutex_init(&c->lock, NULL);
  pthread_condattr_t attributes;
  pthread_condattr_init(&attributes);
  pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
  pthread_cond_init(&c->changed, &attributes);
  pthread_condattr_destroy(&attributes);
  for (size_t k = 0; k < HK_CONVEYOR_ROOM; k++)
    if (!(c->still[k].rgba = host->allocate(host, bytes)))
      return host->fail(host, HK_NO_MEMORY, "no memory for pictures");
  for (size_t k = 0; k < count; k++) {
    c->line[k] = (line){.owner = c, .outlet = outlet[k]};
    if (!start(c->line + k)) return host->fail(host, HK_FAILED, "the system has no further thread to write pictures");
  }
  return HK_OK;
}

/* Waits, with the lock, for a change; no longer than the patience. */
static void wait_a_little(hk_conveyor *c) {
  struct timespec end;
  clock_gettime(CLOCK_MONOTONIC, &end);
  end.tv_nsec += PATIENCE;
  if (end.tv_nsec >= 1000000000) end.tv_nsec -= 1000000000, end.tv_sec++;
  pthread_cond_timedwait(&c->changed, &c->lock, &end);
}

/* Waits until no line has more than this many pictures before it. */
static bool wait_for(hk_conveyor *c, size_t most, const hk_stop *stop) {
  bool asked = false;
  pthread_mutex_lock(&c->lock);
  for (size_t k = 0; k < c->count && !asked;) {
    if (c->put - c->line[k].taken <= most) {
      k++;
      continue;
    }
    wait_a_little(c);
    asked = stop->asked(stop->context);
  }
  pthread_mutex_unlock(&c->lock);
  return !asked;
}

bool hk_conveyor_put(hk_conveyor *c, const unsigned char *rgba, const char *path, const hk_stop *stop) {
  if (!wait_for(c, HK_CONVEYOR_ROOM - 1, stop)) return false;
  hk_still *still = c->still + c->put % HK_CONVEYOR_ROOM;
  memcpy(still->rgba, rgba, c->bytes);
  memcpy(still->path, path, strlen(path) + 1);
  pthread_mutex_lock(&c->lock);
  c->put++;
  pthread_cond_broadcast(&c->changed);
  pthread_mutex_unlock(&c->lock);
  return true;
}

bool hk_conveyor_drain(hk_conveyor *c, const hk_stop *stop) { return wait_for(c, 0, stop); }

bool hk_conveyor_failed(hk_conveyor *c, size_t outlet) {
  pthread_mutex_lock(&c->lock);
  bool failed = c->line[outlet].failed;
  pthread_mutex_unlock(&c->lock);
  return failed;
}

void hk_conveyor_close(hk_conveyor *c) {
  if (!c->host) return;
  pthread_mutex_lock(&c->lock);
  c->ended = true;
  pthread_cond_broadcast(&c->changed);
  pthread_mutex_unlock(&c->lock);
  for (size_t k = 0; k < c->count; k++)
    if (c->line[k].started) pthread_join(c->line[k].thread, NULL);
  for (size_t k = 0; k < HK_CONVEYOR_ROOM; k++) c->host->release(c->host, c->still[k].rgba);
  pthread_cond_destroy(&c->changed);
  pthread_mutex_destroy(&c->lock);
  *c = (hk_conveyor){0};
}
