/* The pairs of a run's surfaces that may meet in a step, for contact. Searches are rare and local: for two patches that
 * are near each other (patches.h), the list of the pairs that were nearer than a skin at the last search is complete
 * until the two have come nearer to each other by that much, and only the patches for which it is not are searched
 * again. Of a pair in a list the distance is not even computed while its patches have not come nearer, on all their way
 * since, than its last gap. That is the budget of displacements of Chen and others (2025, Offset geometric contact,
 * section 3.4), kept for the motion of patches relative to each other instead of that of particles: cloth that falls or
 * slides as a whole spends nothing on itself, and a fold that moves fast costs where it is. While the largest move of a
 * particle says that no budget is spent, not even patches are looked at.
 *
 * Neither changes what is found: every pair whose gap may come below `reach` on the step's straight moves, and every
 * pair whose gap at the start is not above hk_pair_motion (impact.h), is in `index`, in an order that the mesh says. So
 * what rests on these does not depend on when was searched.
 *
 * A step goes: hk_nearby_begin, then hk_nearby_reach for every end that is tried, then hk_nearby_end. */
#ifndef HK_NEARBY_H
#define HK_NEARBY_H

#include "plugins/common/impacts/patches.h"

#include <time.h>

/* The pairs of two patches. */
typedef struct hk_near_group {
  uint32_t a, b;        /* patches */
  uint32_t count, room; /* pairs; that fit */
  size_t start;         /* in hk_nearby.pair */
  double path;          /* m: by how much the two may have come nearer up to hk_nearby.at */
  double complete;      /* m: the path from which on there may be more pairs */
  double due;           /* m: the least of its pairs' */
  uint64_t end;         /* the move of the last search, if hk_nearby.end_number is the same */
} hk_near_group;

typedef struct hk_nearby {
  const hk_host *host;
  const hk_surfaces *surfaces;
  const hk_model *model;
  double reach; /* m: pairs are near whose gap is less; 0: contact itself */
  double skin;  /* m */
  size_t n;
  size_t count, room;    /* pairs of all groups, with gaps between them; that fit the memory */
  hk_surface_pair *pair; /* count */
  double *due;           /* count, m: the path of its group from which on a pair is looked at */
  uint32_t *group_of;    /* count */
  size_t groups, group_room;
  hk_near_group *group, *former; /* rising by patches; those before the last pairing */
  size_t dues, index_room;
  uint32_t *index; /* dues: the pairs that are to be looked at now */
  hk_patches patches;
  hk_patch_move *moves, *aside;   /* of each patch: to the end that is tried; to it from `end` */
  bool *held;                     /* n: particles that cannot move */
  double *last;                   /* n x 3, m: positions of the last step's end, or of this one's start */
  double *at;                     /* n x 3, m: positions at which patches were measured last */
  double *end;                    /* n x 3, m: the end of the move of the last search */
  uint64_t end_number, paired_at; /* of that move, which starts where this step does; when patches were paired */
  double pairing_skin, unpaired;  /* m: how far beyond reach patches are paired; what is left of that */
  double spare;                   /* m: no budget is spent before patches have come nearer by so much since `at` */
  double loose;                   /* m: twice the sum of the largest moves of a particle from `at` to `last` */
  double step;                    /* m: the same of the step to the end that is tried */
  double *chunk;                  /* results of loops over particles */
  hk_patch_pair *task;            /* group_room: patches to be searched, and their groups */
  uint32_t *task_group;
  bool paired;
  size_t searches;
  double seconds; /* processor time of the service's searches so far */
} hk_nearby;

/* s, of the process: of all its threads, but not of others on the machine */
static inline double hk_own_time(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* In `create` and `topology`, with `reach` set. HK_NO_MEMORY. */
hk_status hk_nearby_open(hk_nearby *, const hk_host *, const hk_view *, const hk_surfaces *, double skin);
void hk_nearby_begin(hk_nearby *, const double *x_from);
/* Completes the lists for straight moves from x_from to x_to, both n x 3, and fills `index`. HK_NO_MEMORY, and what the
 * service says. */
hk_status hk_nearby_reach(hk_nearby *, const double *x_from, const double *x_to);
/* x_to: the end that was reached last. */
void hk_nearby_end(hk_nearby *, const double *x_to);

/* Says that pair k had this gap at the start of the step and need not be looked at before it may have closed. Called by
 * several threads at once, for different pairs. */
void hk_nearby_put_off(hk_nearby *, size_t k, double gap);

/* Puts off all pairs of `index` that are not near on the way that was reached, by their gaps at x, its start. */
void hk_nearby_sift(hk_nearby *, const double *x);

#endif
