/* The order of a step, and which blocks are complete when. A part never touches a block above its own, so a block is
 * complete once no later part reaches down to it.
 *
 * A tile of one step takes the blocks of each domain from the lowest to the highest, all domains at the same time, and
 * then interface blocks in rounds: one of domains p and q goes to the first round without either of them.
 *
 * A tile of several steps takes all blocks one after the other, and the interface blocks of p < q after the last block
 * of q with elements between domains. A step may take a part when the step before has completed the part's own block:
 * all blocks below it are then complete, too, and what the step before has still to add touches none of them. */
#include "core/engine/blocks/blocks.h"

#include <stdlib.h>
#include <string.h>

/* ---- tiles of one step ---- */

bool hk_front_begin(hk_front *f, const hk_partition *p) {
  hk_front_close(f);
  f->partition = *p;
  f->lowest = malloc(p->parts * sizeof *f->lowest);
  f->deferred = calloc(p->blocks, sizeof *f->deferred);
  f->complete = malloc(p->blocks * sizeof *f->complete);
  if (!f->lowest || !f->deferred || !f->complete) return false;
  memset(f->lowest, 0xff, p->parts * sizeof *f->lowest);
  return true;
}

hk_part_use hk_front_use(hk_front *f) { return (hk_part_use){&f->partition, f->lowest, f->deferred}; }

static void order_domain(hk_front *f, size_t begin, size_t end) {
  size_t reach = end;
  for (size_t b = end; b-- > begin;) {
    f->complete[b] = reach < b + 1 ? reach : b + 1;
    if (f->lowest[b] < reach) reach = f->lowest[b];
  }
}

/* The round of every interface block that has elements, or HK_ROUNDS. */
static void choose_rounds(hk_front *f, size_t round_of[HK_INTERFACES]) {
  const hk_partition *p = &f->partition;
  uint32_t busy[HK_DOMAINS] = {0}; /* a bit for each round; a domain has at most 15 others, a pair thus one of 29 */
  const uint32_t *lowest = f->lowest + p->blocks;
  size_t part = 0;
  for (size_t high = 1; high < p->domains; high++)
    for (size_t low = 0; low < high; low++, part++) {
      round_of[part] = HK_ROUNDS;
      if (lowest[part] == UINT32_MAX) continue;
      size_t round = 0;
      while ((busy[low] | busy[high]) >> round & 1) round++;
      busy[low] |= (uint32_t)1 << round;
      busy[high] |= (uint32_t)1 << round;
      round_of[part] = round;
      if (f->rounds <= round) f->rounds = round + 1;
    }
  round_of[part] = lowest[part] == UINT32_MAX ? HK_ROUNDS : f->rounds++; /* elements of more than two domains */
}

void hk_front_end(hk_front *f) {
  const hk_partition *p = &f->partition;
  size_t round_of[HK_INTERFACES], count = 0;
  for (size_t begin = 0; begin < p->blocks; begin += p->width)
    order_domain(f, begin, begin + p->width < p->blocks ? begin + p->width : p->blocks);
  f->rounds = 0;
  choose_rounds(f, round_of);
  for (size_t r = 0; r < f->rounds; r++) {
    f->round[r] = count;
    for (size_t part = 0; part < p->parts - p->blocks; part++)
      if (round_of[part] == r) f->interface[count++] = p->blocks + part;
  }
  f->round[f->rounds] = count;
}

void hk_front_close(hk_front *f) {
  free(f->lowest);
  free(f->deferred);
  free(f->complete);
  *f = (hk_front){0};
}

/* ---- tiles of several steps ---- */

/* The highest block of a domain with an element that reaches below `first`; `first` where there is none. */
static size_t highest_between(const hk_front *reach, size_t first, size_t last) {
  size_t b = last;
  while (b-- > first)
    if (reach->lowest[b] < first) return b;
  return first;
}

/* The interface blocks of domains p < q. */
static void list_interfaces(hk_tile_order *o, const hk_front *f, size_t q, size_t block) {
  for (size_t p = 0; p < q; p++) {
    size_t part = f->partition.blocks + q * (q - 1) / 2 + p;
    if (f->lowest[part] != UINT32_MAX)
      o->item[o->items++] = (hk_tile_item){.part = (uint32_t)part, .block = (uint32_t)block};
  }
}

static void list_items(hk_tile_order *o, const hk_front *f, const hk_front *reach) {
  const hk_partition *p = &f->partition;
  for (size_t q = 0; q < p->domains; q++) {
    size_t first = q * p->width, last = first + p->width < p->blocks ? first + p->width : p->blocks;
    size_t between = highest_between(reach, first, last);
    for (size_t b = first; b < last; b++) {
      o->item[o->items++] = (hk_tile_item){.part = (uint32_t)b, .block = (uint32_t)b};
      if (b == between) list_interfaces(o, f, q, b);
    }
  }
}

/* How many blocks are complete after each item. */
static void find_complete(hk_tile_order *o, const hk_front *f) {
  uint32_t reach = UINT32_MAX;
  for (size_t i = o->items; i-- > 0;) {
    hk_tile_item *item = &o->item[i];
    item->complete = reach < item->block + 1 ? reach : item->block + 1;
    if (f->lowest[item->part] < reach) reach = f->lowest[item->part];
  }
}

/* Which item of the step before has to be done before each. */
static void find_after(hk_tile_order *o) {
  size_t most = 0;
  for (size_t i = 0, j = 0; j < o->items; j++) {
    while (o->item[i].complete <= o->item[j].block) i++;
    o->item[j].after = (uint32_t)i;
    if (i - j > most) most = i - j;
  }
  o->depth = o->items / (most + 1);
}

bool hk_tile_order_make(hk_tile_order *o, const hk_front *f, const hk_front *reach) {
  const hk_partition *p = &f->partition;
  free(o->item);
  *o = (hk_tile_order){0};
  if (f->lowest[p->parts - 1] != UINT32_MAX) return true; /* elements of more than two domains: one step */
  o->item = malloc(p->parts * sizeof *o->item);
  if (!o->item) return false;
  list_items(o, f, reach);
  find_complete(o, f);
  find_after(o);
  return true;
}
