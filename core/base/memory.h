/* Memory of an instance: zeroed, 64-byte aligned, in a list, so that nothing a plugin asked for outlives it. */
#ifndef HK_MEMORY_H
#define HK_MEMORY_H

#include <stddef.h>

typedef struct hk_block hk_block;

void *hk_memory_get(hk_block **list, size_t bytes); /* NULL: none left */
void hk_memory_put(hk_block **list, void *memory);  /* NULL is fine */
void hk_memory_clear(hk_block **list);

/* Grows an array to hold at least `wanted` items of `size` bytes, doubling. 0, or -1 with the array as it was. */
int hk_array_reserve(void **array, size_t *capacity, size_t wanted, size_t size);
char *hk_string_copy(const char *text); /* NULL for NULL or without memory */

#endif
