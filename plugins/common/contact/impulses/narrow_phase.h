/* The narrow phase of contact by impulses: what a feature pair does on the straight move of a step. A pair whose
 * distances at the two ends are d_0 and d_1, and whose points move by l relative to each other (hk_pair_motion), is
 * never nearer than d_0 - l and (d_0 + d_1 - l)/2; where that decides nothing, continuous collision detection does.
 * The frame of a pair that moves by a small part of its distance is that of the end, of a fast one that of the instant
 * of contact. */
#ifndef HK_NARROW_PHASE_H
#define HK_NARROW_PHASE_H

#include "plugins/common/contact/geometry/ccd.h"
#include "plugins/common/contact/impulses/impact.h"

#include <math.h>

typedef enum hk_pair_state {
  HK_PAIR_APART,
  HK_PAIR_MAY_CLOSE, /* by impulses on its particles */
  HK_PAIR_CLOSES,    /* on the way or at the end */
  HK_PAIR_OVERLAPS,  /* at the end, by more than the slack; where it was closed at the start, by more than half of that
                      */
  HK_PAIR_UNSAFE     /* its distance on the way may be less than hk_least_distance */
} hk_pair_state;

typedef struct hk_narrow_phase {
  double gap_from, gap_to; /* m */
  hk_pair_frame frame;
  hk_pair_state state;
  bool on_the_way; /* the gap closes before the end */
  bool enters;     /* its features go into each other by more than a slow pair moves */
} hk_narrow_phase;

/* slack: m, an overlap at the end that is accepted; reach: m, slow pairs with a gap of at most that, and of what they
 * move, may close. */
hk_narrow_phase hk_narrow_phase_of(const hk_feature_pair *, const hk_step_move *, double slack, double reach);

/* m: a move that brings a pair nearer is not safe: a tenth of its thickness, or half of its distance at the start. Half
 * leaves the next steps as much; above, rounding is far away and the normal of a pair well known. */
static inline double hk_least_distance(double offset, double distance) { return fmin(0.1 * offset, 0.5 * distance); }

/* Whether a pair comes nearer than a distance on its path, and when, to a hundredth of the distance. */
static inline bool hk_comes_within(hk_pair_kind kind, const hk_pair_path *path, double distance, double *when) {
  return hk_ccd(kind, path->from, path->to, distance, 0.01 * distance, when);
}

#endif
