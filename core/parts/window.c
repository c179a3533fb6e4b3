/* The order of an evaluation. Within a domain the parts follow each other from the lowest block to the highest. As a
 * part never touches a block above its own, block c is complete once no later part of its domain reaches down to it.
 * Parts across domains come afterwards, in rounds: a pair of domains goes to the first round without either of them. */
#include "core/parts/parts.h"

#include <stdlib.h>
#include <string.h>

bool hk_window_begin(hk_window *w, const hk_partition *p) {
  hk_window_close(w);
  w->partition = *p;
  w->lowest = malloc(p->parts * sizeof *w->lowest);
  w->late = calloc(p->blocks, sizeof *w->late);
  w->done = malloc(p->blocks * sizeof *w->done);
  if (!w->lowest || !w->late || !w->done) return false;
  memset(w->lowest, 0xff, p->parts * sizeof *w->lowest);
  return true;
}

hk_part_use hk_window_use(hk_window *w) { return (hk_part_use){&w->partition, w->lowest, w->late}; }

static void order_domain(hk_window *w, size_t begin, size_t end) {
  size_t reach = end;
  for (size_t b = end; b-- > begin;) {
    w->done[b] = reach < b + 1 ? reach : b + 1;
    if (w->lowest[b] < reach) reach = w->lowest[b];
  }
}

/* The round of every part across domains that has elements, or HK_ROUNDS. */
static void choose_rounds(hk_window *w, size_t round_of[HK_CROSS_PARTS]) {
  const hk_partition *p = &w->partition;
  uint32_t busy[HK_DOMAINS] = {0}; /* a bit for each round; a domain has at most 15 others, a pair thus one of 29 */
  const uint32_t *lowest = w->lowest + p->blocks;
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
      if (w->rounds <= round) w->rounds = round + 1;
    }
  round_of[part] = lowest[part] == UINT32_MAX ? HK_ROUNDS : w->rounds++; /* elements of more than two domains */
}

void hk_window_end(hk_window *w) {
  const hk_partition *p = &w->partition;
  size_t round_of[HK_CROSS_PARTS], count = 0;
  for (size_t begin = 0; begin < p->blocks; begin += p->width)
    order_domain(w, begin, begin + p->width < p->blocks ? begin + p->width : p->blocks);
  w->rounds = 0;
  choose_rounds(w, round_of);
  for (size_t r = 0; r < w->rounds; r++) {
    w->round[r] = count;
    for (size_t part = 0; part < p->parts - p->blocks; part++)
      if (round_of[part] == r) w->cross[count++] = p->blocks + part;
  }
  w->round[w->rounds] = count;
}

void hk_window_close(hk_window *w) {
  free(w->lowest);
  free(w->late);
  free(w->done);
  *w = (hk_window){0};
}
