/* One block of particles, or one part of the forces, of a step in a tile. */
#ifndef HK_STEP_IN_TILE_H
#define HK_STEP_IN_TILE_H

#include "core/engine/blocks/blocks.h"

/* The particles from `begin` to end - 1, or one block, before the forces, and one block after them; `at`: the sums to
 * which they belong. */
void hk_step_prepare(const hk_tiles *, const hk_step_in_tile *, size_t begin, size_t end);
void hk_step_prepare_block(const hk_tiles *, const hk_step_in_tile *, size_t block, size_t at);
void hk_step_finish(const hk_tiles *, const hk_step_in_tile *, size_t block, size_t at);
/* hk_step_power of a block, to its sum, where it is counted so. */
void hk_step_count(const hk_tiles *, const hk_step_in_tile *, size_t block, size_t at);
/* One part of all forces. */
void hk_step_add(const hk_tiles *, const hk_step_in_tile *, size_t part, size_t at);
/* The plugins of these sums are done; who is still at work in another thread is named now. */
void hk_tile_leave(const hk_tiles *, size_t at);
bool hk_tile_takes(const hk_tiles *, size_t force); /* it adds by parts, acts, and is included */
double hk_step_clock(const hk_step_in_tile *);      /* s, since when time is measured; 0: it is not */
/* The time since `begin` goes to force k, or, at the end of the list, to the host and the method. */
double hk_step_note_time(const hk_tiles *, const hk_step_in_tile *, size_t k, size_t at, double begin);

/* strips.c: several steps in a tile. */
void hk_tile_by_strips(hk_tiles *, const hk_step_in_tile *, size_t steps);

#endif
