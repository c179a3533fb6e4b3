/* What contacts remember from step to step: for each particle the bodies that it touched at the end of the last
 * accepted step, and the slip since each contact began. A slip is kept as an anchor: the position r of the particle
 * against the other body less the slip. At a later position the slip is the part of r - anchor across the normal,
 * without any integration, whatever the method's stages are.
 *
 * Items name bodies by id and are saved in checkpoints; rows are found again from them. A plugin has the fields of
 * grain_tables.h. */
#ifndef HK_GRAIN_HISTORY_H
#define HK_GRAIN_HISTORY_H

#include "core/plugin.h"

typedef struct hk_grain_touch {
  uint32_t self, other; /* ids, or the number of a wall; in the order of the particles, then of the others */
  double anchor[3];     /* m */
} hk_grain_touch;

typedef struct hk_grain_history {
  hk_array touches, next; /* hk_grain_touch; `next` is where the following ones are written */
  int64_t count;          /* of touches that are used */
  double t;               /* s, when they were written */
  size_t *row, *next_row; /* n + 1: the first touch of each particle */
  const void *indexed;    /* the touches that the rows are those of; NULL: none */
  int64_t indexed_count;
  bool whole, others_die; /* whether the rows have all touches; whether others are particles as well */
} hk_grain_history;

/* To be called in `create` and `topology`: forgets touches of particles that are no more. `others_die`: the other
 * bodies are particles as well. */
hk_status hk_grain_history_adapt(hk_grain_history *, const hk_view *view, bool others_die);
/* To be called in `update`: HK_FAILED where touches are missing, or not of particles that are there, as a damaged
 * checkpoint may have it. It looks when they are others than those of the last step. */
hk_status hk_grain_history_check(hk_grain_history *, const hk_view *view);
/* To be called before the rows are read: a checkpoint may have been. */
void hk_grain_history_index(hk_grain_history *, const hk_view *view);

/* The touch of `other`. NULL: there was none. *at, from row[i] on, is where it is looked for first: others that come in
 * the order of the touches are found at once. */
static inline const hk_grain_touch *hk_grain_history_find(const hk_grain_history *h, size_t i, size_t *at,
                                                          uint32_t other) {
  const hk_grain_touch *touch = h->touches.item;
  size_t begin = h->row[i], end = h->row[i + 1], k = *at;
  for (size_t seen = begin; seen < end; seen++, k++) {
    if (k == end) k = begin;
    if (touch[k].other != other) continue;
    *at = k + 1;
    return &touch[k];
  }
  return NULL;
}

/* Writing: the caller sets next_row[i + 1] to the number of touches of particle i; hk_grain_history_reserve makes rows
 * of them and memory; the caller fills the rows of `next`; hk_grain_history_commit makes these the touches at time t.
 */
hk_status hk_grain_history_reserve(hk_grain_history *, const hk_view *view);
void hk_grain_history_commit(hk_grain_history *, size_t n, double t);

#endif
