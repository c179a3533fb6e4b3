/* Arrays of a plugin that are filled anew every time and grow, by half at least, when they have to. */
#ifndef HK_RESERVE_H
#define HK_RESERVE_H

#include "core/plugin.h"

#include <string.h>

/* Makes room for count items of `size` bytes, for one at least, since memset of nothing wants an address too, in the array
 * whose address is `array`; what it held is lost when it grows.
 * HK_NO_MEMORY, with a message; the array is empty then. */
static inline hk_status hk_reserve(const hk_host *host, void *array, size_t *room, size_t count, size_t size) {
  void *memory;
  if (*room > 0 && count <= *room) return HK_OK;
  memcpy(&memory, array, sizeof memory);
  host->release(host, memory);
  *room = count + count / 2 + 1;
  memory = host->allocate(host, *room * size);
  memcpy(array, &memory, sizeof memory);
  if (memory) return HK_OK;
  *room = 0;
  return host->fail(host, HK_NO_MEMORY, "no memory for an array of %zu bytes", count * size);
}

/* The same for an array of the host's, which keeps its content. */
static inline hk_status hk_reserve_array(const hk_host *host, hk_array *array, size_t count) {
  return count <= array->count ? HK_OK : host->resize(host, array, count + count / 2);
}

#endif
