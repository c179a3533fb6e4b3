/* Each block begins with a header of one cache line, which keeps the 64-byte alignment of the memory after it. */
#include "core/engine/base/base.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER = 64 };

struct hk_block {
  hk_block *next, *previous;
  size_t bytes;
  void *start; /* as it was allocated: by calloc, so that pages that are never written take no memory */
};

void *hk_memory_get(hk_block **list, size_t bytes) {
  if (bytes > SIZE_MAX - 2 * HEADER) return NULL;
  char *start = calloc(1, bytes + 2 * HEADER);
  if (!start) return NULL;
  hk_block *block = (hk_block *)(void *)(start + (HEADER - (uintptr_t)start % HEADER) % HEADER);
  block->start = start;
  block->bytes = bytes;
  block->next = *list;
  if (*list) (*list)->previous = block;
  *list = block;
  return (char *)block + HEADER;
}

size_t hk_memory_size(const void *memory) {
  return memory ? ((const hk_block *)(const void *)((const char *)memory - HEADER))->bytes : 0;
}

void hk_memory_put(hk_block **list, void *memory) {
  if (!memory) return;
  hk_block *block = (hk_block *)(void *)((char *)memory - HEADER);
  if (block->next) block->next->previous = block->previous;
  if (block->previous)
    block->previous->next = block->next;
  else
    *list = block->next;
  free(block->start);
}

void hk_memory_clear(hk_block **list) {
  while (*list) {
    hk_block *block = *list;
    *list = block->next;
    free(block->start);
  }
}

int hk_array_reserve(void **array, size_t *capacity, size_t wanted, size_t size) {
  if (wanted <= *capacity) return 0;
  size_t grown = *capacity > SIZE_MAX / 2 / size ? wanted : 2 * *capacity;
  if (grown < wanted) grown = wanted;
  if (grown > SIZE_MAX / size) return -1;
  void *bigger = realloc(*array, grown * size);
  if (!bigger) return -1;
  *array = bigger;
  *capacity = grown;
  return 0;
}

/* The number of items from i on that stay beside each other: along them the map rises by one an item. */
static size_t run_length(const uint32_t *map, size_t i, size_t n) {
  size_t within = 0, beyond = 1;
  for (; i + beyond < n && map[i + beyond] == map[i] + beyond; beyond *= 2) within = beyond;
  if (beyond > n - i) beyond = n - i;
  while (within + 1 < beyond) {
    size_t middle = (within + beyond) / 2;
    if (map[i + middle] == map[i] + middle)
      within = middle;
    else
      beyond = middle;
  }
  return beyond;
}

/* Items that move up are the first ones. They are closed up where they are, and moved as one when the others have left
 * their places. */
size_t hk_array_move(void *to, void *from, size_t size, const uint32_t *map, size_t n) {
  size_t kept_up = 0, kept = 0;
  for (size_t i = 0, length; i < n; i += length) {
    char *source = (char *)from + size * i;
    length = 1;
    if (map[i] == UINT32_MAX) continue;
    length = run_length(map, i, n);
    kept = map[i] + length;
    if ((char *)to + size * map[i] > source) {
      memmove((char *)from + size * map[i], source, size * length);
      kept_up = kept;
    } else
      memmove((char *)to + size * map[i], source, size * length);
  }
  if (kept_up) memmove(to, from, size * kept_up);
  return kept;
}

char *hk_string_copy(const char *text) {
  if (!text) return NULL;
  size_t bytes = strlen(text) + 1;
  char *copy = malloc(bytes);
  return copy ? memcpy(copy, text, bytes) : NULL;
}
