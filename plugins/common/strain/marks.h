/* Sets of numbers below `count`: a bit for each, and a bit for each word of bits that is not 0, so that few are found
 * quickly among many. */
#ifndef HK_MARKS_H
#define HK_MARKS_H

#include "core/plugin.h"

typedef struct hk_marks {
  size_t words, overviews;
  uint64_t *word, *overview;
} hk_marks;

static inline void hk_mark(hk_marks *m, uint32_t number) {
  m->word[number >> 6] |= 1ull << (number & 63);
  m->overview[number >> 12] |= 1ull << (number >> 6 & 63);
}

static inline bool hk_marks_empty(const hk_marks *m) {
  for (size_t k = 0; k < m->overviews; k++)
    if (m->overview[k]) return false;
  return true;
}

/* Takes the lowest, where none is in the overviews before *from, which moves on. False: there is none. */
static inline bool hk_marks_next(hk_marks *m, size_t *from, uint32_t *number) {
  while (*from < m->overviews && !m->overview[*from]) ++*from;
  if (*from == m->overviews) return false;
  uint64_t *overview = &m->overview[*from];
  size_t at = 64 * *from + (size_t)__builtin_ctzll(*overview);
  uint64_t *word = &m->word[at];
  *number = (uint32_t)(64 * at) + (uint32_t)__builtin_ctzll(*word);
  *word &= *word - 1;
  if (!*word) *overview &= *overview - 1;
  return true;
}

/* Empty, in the host's memory. False: there is none. */
static inline bool hk_marks_make(hk_marks *m, size_t count, const hk_host *host) {
  m->words = count / 64 + 1;
  m->overviews = m->words / 64 + 1;
  m->word = host->allocate(host, m->words * sizeof *m->word);
  m->overview = host->allocate(host, m->overviews * sizeof *m->overview);
  return m->word && m->overview;
}

#endif
