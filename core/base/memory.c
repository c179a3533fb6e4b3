/* Each block begins with a header of one cache line, which keeps the 64-byte alignment of the memory after it. */
#include "core/base/base.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER = 64 };

struct hk_block {
  hk_block *next, *previous;
  void *start; /* as it was allocated: by calloc, so that pages that are never written take no memory */
};

void *hk_memory_get(hk_block **list, size_t bytes) {
  if (bytes > SIZE_MAX - 2 * HEADER) return NULL;
  char *start = calloc(1, bytes + 2 * HEADER);
  if (!start) return NULL;
  hk_block *block = (hk_block *)(void *)(start + (HEADER - (uintptr_t)start % HEADER) % HEADER);
  block->start = start;
  block->next = *list;
  if (*list) (*list)->previous = block;
  *list = block;
  return (char *)block + HEADER;
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

char *hk_string_copy(const char *text) {
  if (!text) return NULL;
  size_t bytes = strlen(text) + 1;
  char *copy = malloc(bytes);
  return copy ? memcpy(copy, text, bytes) : NULL;
}
