/* The pair cache of contact: the feature pairs that may come into contact in a step, kept from step to step. Patches of
 * surfaces that are near each other (patch_motion.h) form a group. A group's list of the pairs that were nearer than a
 * skin at the last search is complete until its two patches have approached each other by the skin; only groups that
 * have are searched again. Each pair has a budget, its last known gap: while its patches have approached each other by
 * less, on all their way since, its distance is not computed. (Budgets of displacements, Chen and others 2025, Offset
 * geometric contact, section 3.4; here of the motion of patches relative to each other in place of that of particles:
 * cloth that falls or slides as a whole spends nothing on itself.) While the largest move of a particle shows that no
 * budget is spent, patches are not measured either.
 *
 * Invariant: every pair whose gap may come below `reach` on the step's straight moves is in `index`, and so is every
 * pair whose gap at the start exceeds neither hk_pair_motion nor the skin, in an order that the mesh determines. When
 * searches took place leaves no trace in the results.
 *
 * Calls of a step: hk_pair_cache_begin, hk_pair_cache_find for every end that is tried, hk_pair_cache_end. */
#ifndef HK_PAIR_CACHE_H
#define HK_PAIR_CACHE_H

#include "plugins/common/contact/candidates/patch_motion.h"

#include <time.h>

/* The pairs of two patches. */
typedef struct hk_pair_group {
  uint32_t a, b;        /* patches */
  uint32_t count, room; /* pairs; that fit */
  size_t start;         /* in hk_pair_cache.pair */
  double path;          /* m: the sum of the patches' approaches up to hk_pair_cache.at */
  double complete;      /* m: the path from which on the list may lack pairs */
  double budget;        /* m: the least of its pairs' */
  uint64_t end;         /* the move of the last search, if hk_pair_cache.end_number is the same */
} hk_pair_group;

typedef struct hk_pair_cache {
  const hk_host *host;
  const hk_surfaces *surfaces;
  const hk_model *model;
  double reach; /* m: pairs are near whose gap is less; 0: contact itself */
  double skin;  /* m */
  size_t n;
  size_t count, room;    /* pairs of all groups, with gaps between them; that fit the memory */
  hk_feature_pair *pair; /* count */
  double *budget;        /* count, m: the path of its group up to which the gap of a pair lasts */
  uint32_t *group_of;    /* count */
  size_t groups, group_room;
  hk_pair_group *group, *former; /* rising by patches; those before the last pairing */
  size_t active, index_room;
  uint32_t *index; /* active: the pairs whose budgets the present move may spend */
  hk_moving_patches patches;
  hk_patch_move *moves, *end_moves; /* of each patch: to the end that is tried; to it from `end` */
  bool *held;                       /* n: particles that cannot move */
  double *last;                     /* n x 3, m: positions of the last step's end, or of this one's start */
  double *at;                       /* n x 3, m: positions at which patches were measured last */
  double *end;                      /* n x 3, m: the end of the move of the last search */
  uint64_t end_number, paired_at;   /* of that move, which starts where this step does; when patches were paired */
  double pairing_skin, unpaired;    /* m: how far beyond reach patches are paired; what is left of that */
  double spare;                     /* m: no budget is spent before patches have come nearer by so much since `at` */
  double loose;                     /* m: twice the sum of the largest moves of a particle from `at` to `last` */
  double step;                      /* m: the same of the step to the end that is tried */
  double *chunk;                    /* results of loops over particles */
  hk_patch_pair *task;              /* group_room: patches to be searched, and their groups */
  uint32_t *task_group;
  bool paired, measured; /* measured: `moves` are from `at` to the end that was tried last */
  size_t searches;
  double seconds; /* processor time of the service's searches so far */
} hk_pair_cache;

/* s, of the process: of all its threads, but not of others on the machine */
static inline double hk_own_time(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* In `create` and `topology`, with `reach` set. HK_NO_MEMORY. */
hk_status hk_pair_cache_open(hk_pair_cache *, const hk_host *, const hk_view *, const hk_surfaces *, double skin);
void hk_pair_cache_begin(hk_pair_cache *, const double *x_from);
/* Completes the lists for straight moves from x_from to x_to, both n x 3, and fills `index`. HK_NO_MEMORY, and what the
 * service says. */
hk_status hk_pair_cache_find(hk_pair_cache *, const double *x_from, const double *x_to);
/* x_to: the end that was reached last. */
void hk_pair_cache_end(hk_pair_cache *, const double *x_to);

/* Sets the budget of pair k by its gap at the start of the step. Several threads may call it, for different pairs. */
void hk_pair_cache_set_gap(hk_pair_cache *, size_t k, double gap);

/* Sets the budgets of all pairs of `index` by their gaps at x, the start of the move, and drops from `index` those that
 * stay out of reach. */
void hk_pair_cache_filter(hk_pair_cache *, const double *x);

/* Adds the contact points, for pictures, of the pairs of `index` whose distance at x (n x 3) is at most 1 + slack of
 * their offset. */
void hk_pair_cache_points(const hk_pair_cache *, const double *x, double slack, const hk_contact_points *);

#endif
