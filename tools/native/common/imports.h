/* What a plugin takes from the C library's heap: its calls of malloc, calloc, realloc, aligned_alloc, posix_memalign
 * and free go through functions that count, and that fill new memory, so that what reads it before it was written is
 * seen. Of this process alone, on systems with ELF files; elsewhere nothing is counted. */
#ifndef HK_TOOLS_IMPORTS_H
#define HK_TOOLS_IMPORTS_H

#include <stdbool.h>
#include <stddef.h>

typedef struct hk_heap {
  size_t allocated, freed; /* calls */
} hk_heap;

/* From now on for the shared object that contains `inside`. False: this system has no such tables. */
bool hk_imports_watch(const void *inside);
void hk_imports_fill(unsigned char byte); /* of new memory from now on */
hk_heap hk_imports_heap(void);

#endif
