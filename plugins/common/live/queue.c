/* The run appends to a queue under a lock; the thread takes the whole queue, and writes it while the next one grows. */
#include "plugins/common/live/queue.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool hk_live_reserve(char **block, size_t *room, size_t size) {
  if (size <= *room) return true;
  char *more = realloc(*block, 2 * size);
  if (!more) return false;
  *block = more;
  *room = 2 * size;
  return true;
}

static bool write_all(int fd, const char *bytes, size_t size) {
  while (size > 0) {
    ssize_t count = write(fd, bytes, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes += count;
    size -= (size_t)count;
  }
  return true;
}

static void *deliver(void *context) {
  hk_live_queue *q = context;
  pthread_mutex_lock(&q->lock);
  for (;;) {
    while (q->length == 0 && !q->ending) pthread_cond_wait(&q->more, &q->lock);
    if (q->length == 0) break;
    char *full = q->queue;
    size_t length = q->length, room = q->room;
    q->queue = q->spare;
    q->room = q->spare_room;
    q->length = 0;
    q->spare = full;
    q->spare_room = room;
    pthread_mutex_unlock(&q->lock);
    bool written = q->broken || write_all(q->fd, full, length);
    pthread_mutex_lock(&q->lock);
    q->broken |= !written;
  }
  pthread_mutex_unlock(&q->lock);
  return NULL;
}

/* Signals are for the run's thread, and a reader that has gone is no signal. */
bool hk_live_queue_open(hk_live_queue *q, int fd) {
  sigset_t all, before;
  *q = (hk_live_queue){.fd = fd};
  if (pthread_mutex_init(&q->lock, NULL) != 0) return false;
  if (pthread_cond_init(&q->more, NULL) != 0) {
    pthread_mutex_destroy(&q->lock);
    return false;
  }
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  q->open = pthread_create(&q->thread, NULL, deliver, q) == 0;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  if (!q->open) {
    pthread_mutex_destroy(&q->lock);
    pthread_cond_destroy(&q->more);
  }
  return q->open;
}

void hk_live_queue_close(hk_live_queue *q) {
  if (!q->open) return;
  pthread_mutex_lock(&q->lock);
  q->ending = true;
  pthread_cond_signal(&q->more);
  pthread_mutex_unlock(&q->lock);
  pthread_join(q->thread, NULL);
  pthread_mutex_destroy(&q->lock);
  pthread_cond_destroy(&q->more);
  free(q->queue);
  free(q->spare);
  *q = (hk_live_queue){.fd = -1};
}

char *hk_live_begin(hk_live_queue *q, char letter, size_t size) {
  uint32_t head[2] = {(uint32_t)letter, (uint32_t)size};
  if (size > UINT32_MAX || !hk_live_reserve(&q->queue, &q->room, q->length + sizeof head + size)) return NULL;
  memcpy(q->queue + q->length, head, sizeof head);
  char *body = q->queue + q->length + sizeof head;
  q->length += sizeof head + size;
  return body;
}

void hk_live_put(char **at, const void *data, size_t bytes) {
  if (bytes) memcpy(*at, data, bytes);
  *at += bytes;
}

void hk_live_lock(hk_live_queue *q) { pthread_mutex_lock(&q->lock); }

void hk_live_unlock(hk_live_queue *q) {
  pthread_cond_signal(&q->more);
  pthread_mutex_unlock(&q->lock);
}
