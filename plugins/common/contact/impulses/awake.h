/* The impacts that sweeps have yet to solve (gauss_seidel.h): a bit for each, in their order, and for each particle the
 * impacts that its moves wake, so that a sweep costs what it solves and not what there is. A move wakes the other
 * impacts of its particles: those that come later are solved in this sweep, those that came before in the next. What
 * cannot move wakes nothing: all that lies on a floor would wake each other. */
#ifndef HK_AWAKE_H
#define HK_AWAKE_H

#include "core/plugin.h"
#include "plugins/common/contact/impulses/impact.h"

typedef struct hk_awake {
  const hk_host *host;
  size_t n, room, word_room; /* particles; of `impact`; of `word` */
  uint32_t *start;           /* n + 2: the impacts of a particle, in `impact` */
  uint32_t *impact;
  size_t words;
  uint64_t *word; /* bit e of all: impact e is awake */
} hk_awake;

/* For n particles. HK_NO_MEMORY. */
hk_status hk_awake_open(hk_awake *, const hk_host *, size_t n);
/* The impacts of each particle, by mobilities and inverse masses. None is awake. HK_NO_MEMORY. */
hk_status hk_awake_list(hk_awake *, const hk_impact *, size_t count, const double *inverse_mass);
void hk_awake_none(hk_awake *);

static inline void hk_awake_set(hk_awake *a, uint32_t e) { a->word[e >> 6] |= 1ull << (e & 63); }

/* Impact e has moved its particles. */
static inline void hk_awake_wake(hk_awake *a, const uint32_t vertex[4], uint32_t e) {
  for (int i = 0; i < 4; i++) {
    const uint32_t *end = a->impact + a->start[vertex[i] + 1];
    for (const uint32_t *f = a->impact + a->start[vertex[i]]; f < end; f++) hk_awake_set(a, *f);
  }
  a->word[e >> 6] &= ~(1ull << (e & 63));
}

/* Takes the lowest that is awake from *from on, which moves behind it: one sweep is from 0 to the end. False: there is
 * none. */
static inline bool hk_awake_next(hk_awake *a, uint32_t *from, uint32_t *e) {
  uint64_t behind = ~0ull << (*from & 63);
  for (size_t k = *from >> 6; k < a->words; k++, behind = ~0ull) {
    uint64_t left = a->word[k] & behind;
    if (!left) continue;
    *e = (uint32_t)(64 * k) + (uint32_t)__builtin_ctzll(left);
    *from = *e + 1;
    a->word[k] &= ~(left & -left);
    return true;
  }
  return false;
}

#endif
