/* The queue of messages of a run that is watched (plugins/common/live/queue.h) where there are no threads: what was
 * written under the lock goes to the page when the lock is given back. */
#include "plugins/common/live/queue.h"

#include <emscripten.h>
#include <stdlib.h>
#include <string.h>

/* Calls Module.message(letter, body), the bytes copied. */
EM_JS(void, hand_over, (int letter, const char *body, size_t size),
      { Module["message"](String.fromCharCode(letter), HEAPU8.slice(body, body + size)); });

bool hk_live_reserve(char **block, size_t *room, size_t size) {
  if (size <= *room) return true;
  char *more = realloc(*block, 2 * size);
  if (!more) return false;
  *block = more;
  *room = 2 * size;
  return true;
}

bool hk_live_queue_open(hk_live_queue *q, int fd) {
  *q = (hk_live_queue){.fd = fd, .open = true};
  return true;
}

void hk_live_queue_close(hk_live_queue *q) {
  free(q->queue);
  *q = (hk_live_queue){.fd = -1};
}

char *hk_live_begin(hk_live_queue *q, char letter, size_t size) {
  uint32_t head[2] = {(uint32_t)letter, (uint32_t)size};
  if (size > UINT32_MAX / 4 || !hk_live_reserve(&q->queue, &q->room, q->length + sizeof head + size)) return NULL;
  memcpy(q->queue + q->length, head, sizeof head);
  char *body = q->queue + q->length + sizeof head;
  q->length += sizeof head + size;
  return body;
}

void hk_live_put(char **at, const void *data, size_t bytes) {
  if (bytes) memcpy(*at, data, bytes);
  *at += bytes;
}

void hk_live_lock(hk_live_queue *q) { (void)q; }

void hk_live_unlock(hk_live_queue *q) {
  uint32_t head[2];
  for (size_t at = 0; at < q->length; at += sizeof head + head[1]) {
    memcpy(head, q->queue + at, sizeof head);
    hand_over((int)head[0], q->queue + at + sizeof head, head[1]);
  }
  q->length = 0;
}
