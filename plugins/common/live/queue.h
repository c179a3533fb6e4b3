/* Bytes that a thread of its own writes, so that who has them never waits for the reader. A message is its letter and
 * the number of bytes that follow, two uint32_t, and these. */
#ifndef HK_LIVE_QUEUE_H
#define HK_LIVE_QUEUE_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct hk_live_queue {
  int fd;
  pthread_t thread;
  pthread_mutex_t lock;
  pthread_cond_t more;
  bool open, ending, broken; /* the thread runs; it ends when all is written; the reader has gone */
  char *queue, *spare;       /* what is to be written, and what the thread writes */
  size_t length, room, spare_room;
} hk_live_queue;

bool hk_live_queue_open(hk_live_queue *, int fd); /* false: no memory, or no thread */
void hk_live_queue_close(hk_live_queue *); /* all is written, or the reader has gone; a second call does nothing */
void hk_live_lock(hk_live_queue *);
void hk_live_unlock(hk_live_queue *);
/* Room for a message of `size` bytes behind its head, under the lock, or NULL. */
char *hk_live_begin(hk_live_queue *, char letter, size_t size);
void hk_live_put(char **at, const void *data, size_t bytes);
bool hk_live_reserve(char **block, size_t *room, size_t size);

#endif
