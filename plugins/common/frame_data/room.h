/* Arrays that grow. */
#ifndef HK_FRAME_DATA_ROOM_H
#define HK_FRAME_DATA_ROOM_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

/* Makes room for `need` items of `size` bytes in *memory, which has `*room`; what was in it is kept. False: no memory.
 */
static inline bool hk_make_room(void *memory, size_t *room, size_t need, size_t size) {
  void **at = memory;
  if (*at && need <= *room) return true;
  size_t count = need + need / 4 + 1;
  void *grown = count < SIZE_MAX / size ? realloc(*at, count * size) : NULL;
  if (!grown) return false;
  *at = grown;
  *room = count;
  return true;
}

#endif
