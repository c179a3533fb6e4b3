/* One block of particles, or one part of the forces, in a pass or a wave (work.c). */
#ifndef HK_PARTS_WORK_H
#define HK_PARTS_WORK_H

#include "core/parts/parts.h"

typedef struct hk_part_work {
  hk_parts *parts;
  const hk_sweep *w;
  size_t first;             /* position in `cross` of the round */
  size_t slots;             /* in use: one for each domain; with parts across domains, two, and one for each of them */
  const hk_instance *outer; /* who asked for the pass */
} hk_part_work;

/* The particle after the last one of a block. */
static inline size_t hk_part_end(const hk_partition *p, size_t block) {
  size_t end = (block + 1) << p->bits;
  return end < p->n ? end : p->n;
}

/* The particles begin to end - 1 before the forces, and after them; `at`: the slot of their sums. */
void hk_part_prepare(const hk_part_work *, size_t begin, size_t end);
void hk_part_finish(const hk_part_work *, size_t begin, size_t end, size_t at);
/* One part of all forces. Those without `parts` have no elements across domains. */
void hk_part_add(const hk_part_work *, size_t part, size_t at);
/* The plugins of the slot are done; who is still at work in another thread is named now. */
void hk_part_leave(const hk_part_work *, size_t at);
bool hk_part_taken(const hk_parts *, size_t force); /* it adds by parts, acts, and is included */
double hk_part_clock(const hk_part_work *);         /* s, since when time is measured; 0: it is not */
/* The time since `begin` goes to force k, or, at the end of the list, to the host and the method. */
double hk_part_note_time(const hk_part_work *, size_t k, size_t at, double begin);

#endif
