/* The pairs of a run's surfaces that may meet in a step, for contact. Searches are rare: a list of the pairs that were
 * nearer than a skin at the last search is complete until two patches that are near have come nearer to each other by
 * that much, and of a pair in the list the distance is not even computed while its patches have not come nearer, on
 * all their way since, than its last gap. That is the budget of displacements of Chen and others (2025, Offset
 * geometric contact, section 3.4), kept for the motion of patches relative to each other instead of that of particles:
 * cloth that falls or slides as a whole spends nothing on itself. Patches are measured now and then; between, the
 * largest move of a particle stands for all. Neither changes what is found: every pair whose gap may come below `reach`
 * on the step's straight moves is looked at.
 *
 * A step goes: hk_nearby_begin, then hk_nearby_reach for every end that is tried, then hk_nearby_end. */
#ifndef HK_NEARBY_H
#define HK_NEARBY_H

#include "plugins/common/impacts/patches.h"

/* What a run that goes on has to search again, so that its list has the order of the run that did not stop. */
typedef struct hk_nearby_found {
  double *from, *to; /* n x 3, m: the moves of the last search */
  int64_t good;      /* 1: there was one with the present particles */
} hk_nearby_found;

#define HK_NEARBY_FIELD_ROWS(TYPE, MEMBER)                                                                             \
  {"found_from", HK_FIELD_PER_PARTICLE, 3, offsetof(TYPE, MEMBER.from), 0},                                            \
      {"found_to", HK_FIELD_PER_PARTICLE, 3, offsetof(TYPE, MEMBER.to), 0}, {                                          \
    "found", HK_FIELD_INTEGER, 1, offsetof(TYPE, MEMBER.good), 0                                                       \
  }

/* Pairs of the same two patches. */
typedef struct hk_near_group {
  uint32_t a, b; /* patches */
  size_t start;  /* of its pairs, in hk_nearby.in_group; they end where the next group's start */
  double path;   /* m: by how much the two may have come nearer since the search, up to hk_nearby.at */
  double due;    /* m: the least of its pairs' */
} hk_near_group;

typedef struct hk_nearby {
  const hk_host *host;
  const hk_surfaces *surfaces;
  hk_nearby_found *found;
  double reach; /* m: pairs are near whose gap is less; 0: contact itself */
  double skin;  /* m */
  size_t n;
  size_t count, room;    /* pairs; that fit the memory */
  hk_surface_pair *pair; /* count */
  double *due;           /* count, m: the path of its group from which on a pair is looked at */
  uint32_t *group_of, *in_group, *sorted;
  hk_near_group *group; /* groups + 1 */
  size_t groups;
  uint64_t *marks; /* a bit for each pair */
  size_t dues;
  uint32_t *index; /* dues: the pairs that are to be looked at now, rising */
  hk_patches patches;
  hk_patch_move *moves; /* of each patch */
  struct hk_patch_box *box;
  uint32_t *seen;  /* of each patch: room */
  size_t *by_home; /* patches + 1: room */
  double *last;    /* n x 3, m: positions of the last step's end, or of this one's start */
  double *at;      /* n x 3, m: positions at which patches were measured last */
  double slack;    /* m: pairs that are not listed were, at `at`, so much above the reach at least */
  double loose;    /* m: twice the sum of the largest moves of a particle from `at` to `last` */
  double step;     /* m: the same of the step to the end that is tried */
  double *chunk;   /* results of loops over particles */
  bool listed;     /* the list is that of `found` */
  bool fresh;      /* it was found in this step */
  size_t searches;
} hk_nearby;

/* In `create` and `topology`, with `reach` set. HK_NO_MEMORY. */
hk_status hk_nearby_open(hk_nearby *, const hk_host *, const hk_view *, const hk_surfaces *, hk_nearby_found *,
                         double skin);
void hk_nearby_begin(hk_nearby *, const double *x_from);
/* Completes the list for straight moves from x_from to x_to, both n x 3, and fills `index`. HK_NO_MEMORY, and what the
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
