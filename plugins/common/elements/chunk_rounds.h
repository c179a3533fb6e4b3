/* Which chunks of elements may add to blocks at the same time: those of a round have no particle in common. */
#ifndef HK_CHUNK_ROUNDS_H
#define HK_CHUNK_ROUNDS_H

#include "core/plugin.h"

enum { HK_CHUNK_ELEMENTS = 256 }; /* of a chunk, some 30 us of blocks */

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_chunk_rounds {
  size_t rounds, elements;
  size_t *first;   /* rounds + 1: the chunks of round r are chunk[first[r]] ... chunk[first[r + 1] - 1] */
  uint32_t *chunk; /* rising in each round: the elements from HK_CHUNK_ELEMENTS times it on */
} hk_chunk_rounds;

/* To be called in `create` and `topology`. HK_NO_MEMORY. */
hk_status hk_chunk_rounds_sort(hk_chunk_rounds *, const hk_host *host, size_t n, const hk_tuples *node);
/* Calls body(context, begin, end) for the elements of every chunk, round after round. Sums of what bodies add to the
 * blocks of their particles have the same order for any number of threads. */
void hk_chunk_rounds_run(const hk_chunk_rounds *, const hk_host *host,
                         void (*body)(const void *context, size_t begin, size_t end), const void *context);

#endif
