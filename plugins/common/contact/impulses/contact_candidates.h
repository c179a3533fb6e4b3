/* The contact candidates of a step: the narrow phase of the active pairs in the cache; the certificate that no pair has
 * passed through a surface (`unsafe` = 0); and the impacts for the solver. Within a step the narrow phase is repeated
 * only for pairs with a particle that the solver has moved since. */
#ifndef HK_CONTACT_CANDIDATES_H
#define HK_CONTACT_CANDIDATES_H

#include "plugins/common/contact/candidates/pair_cache.h"
#include "plugins/common/contact/impulses/gauss_seidel.h"
#include "plugins/common/contact/impulses/narrow_phase.h"

typedef struct hk_contact_candidates {
  hk_pair_cache *cache;
  double restitution;
  /* n: the count of the solver (hk_contact_solver.now) when it last moved each particle, and `since`, that of the last
   * narrow phase; NULL, as after hk_contact_candidates_begin: all pairs are examined. */
  const uint64_t *touched;
  uint64_t since;
  double slack; /* m, the largest accepted overlap at the end of a step */
  /* Results of hk_contact_candidates_find */
  size_t unsafe;   /* pairs in the state HK_PAIR_UNSAFE */
  size_t first;    /* the first unsafe pair, as an index into the cache */
  size_t unsolved; /* pairs that overlap at the end, or close without an impulse of this step */
  double closest;  /* m, the least gap at the start; INFINITY: no pair is active */
  /* Room */
  hk_narrow_phase *result, *before;   /* one per entry of cache->index; the results of the previous narrow phase */
  uint32_t *before_index, *before_at; /* the pairs of `before`; for each pair its position in `before` */
  size_t befores, examined;           /* of `before`; pairs of the last narrow phase */
  uint32_t *candidate;                /* positions in `result` of pairs that may touch in the step */
  uint32_t *chosen;                   /* those of the last hk_contact_candidates_impacts */
  bool *pushed_before;                /* of each pair: an impulse has pushed it apart in this step */
  hk_feature_pair *pushed; /* the same pairs by their features: a search within the step renumbers the cache */
  size_t pushes, pushed_room;
  size_t room, count, chosen_count, searches, impacts_room;
  bool solved; /* impacts of this step were solved */
  hk_impact *impact;
} hk_contact_candidates;

/* Resets the list before the first narrow phase of a step. */
void hk_contact_candidates_begin(hk_contact_candidates *);
/* The narrow phase of the active pairs. HK_NO_MEMORY. */
hk_status hk_contact_candidates_find(hk_contact_candidates *, const hk_step_move *);

typedef enum hk_candidate_kind {
  HK_CANDIDATES_ALL,
  HK_CANDIDATES_CLOSED, /* overlapping at the start of the step */
  HK_CANDIDATES_UNSAFE
} hk_candidate_kind;

/* Gives the solver one impact per candidate of this kind, in the order of the list; valid until the next call.
 * HK_NO_MEMORY. */
hk_status hk_contact_candidates_impacts(hk_contact_candidates *, const hk_step_move *, hk_candidate_kind,
                                        hk_contact_solver *);
/* After the solution for HK_CANDIDATES_ALL: records the pairs with a positive impulse, and those beyond the solver's
 * count, which others have stood for (contact/faces/face_contacts.h). */
void hk_contact_candidates_remember(hk_contact_candidates *, const hk_contact_solver *);
/* Whether a candidate enters its gap (narrow_phase.h) on the present move after the solver moved one of its particles,
 * later than the count `since` of hk_contact_solver.now: a second impact in the step, which a straight move misses. */
bool hk_contact_candidates_return(const hk_contact_candidates *, const uint64_t *moved, uint64_t since);

/* Pairs that overlap by more than the slack at the start of the step. */
typedef struct hk_closed_candidates {
  size_t count;
  double depth;                /* m, the largest overlap */
  const hk_feature_pair *pair; /* of it; NULL: none */
} hk_closed_candidates;

hk_closed_candidates hk_contact_candidates_closed(const hk_contact_candidates *);
void hk_contact_candidates_free(hk_contact_candidates *);

#endif
