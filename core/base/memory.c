/* Each block begins with a header of one cache line, which keeps the 64-byte alignment of the memory after it. */
#include "core/base/base.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER = 64 };

struct hk_block {
  hk_block *next, *previous;
};

void *hk_memory_get(hk_block **list, size_t bytes) {
  if (bytes > SIZE_MAX - 2 * HEADER) return NULL;
  size_t total = (HEADER + bytes + 63) / 64 * 64;
  hk_block *block = aligned_alloc(64, total);
  if (!block) return NULL;
  memset(block, 0, total);
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
  free(block);
}

void hk_memory_clear(hk_block **list) {
  while (*list) {
    hk_block *block = *list;
    *list = block->next;
    free(block);
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
