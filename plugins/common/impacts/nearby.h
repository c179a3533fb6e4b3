/* The pairs of a run's surfaces that may meet in a step, for contact. Searches are rare: a list of the pairs that were
 * nearer than a skin at the last search is complete until a particle has moved by half of it, and of a pair in the list
 * the distance is not even computed while no particle has moved by half of the pair's last gap (the budget of
 * displacements of Chen and others 2025, Offset geometric contact, section 3.4, kept for every pair). Neither
 * changes what is found: every pair whose gap may come below `reach` on the step's straight moves is looked at.
 *
 * A step goes: hk_nearby_begin, then hk_nearby_reach for every end that is tried, then hk_nearby_end. */
#ifndef HK_NEARBY_H
#define HK_NEARBY_H

#include "plugins/common/surfaces/surfaces.h"

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

typedef struct hk_nearby {
  const hk_host *host;
  const hk_surfaces *surfaces;
  hk_nearby_found *found;
  double reach; /* m: pairs are near whose gap is less; 0: contact itself */
  double skin;  /* m */
  size_t n;
  size_t count, room;    /* pairs; that fit the memory */
  hk_surface_pair *pair; /* count */
  double *due;           /* count, m: the pair is looked at once particles have travelled so far */
  size_t dues;
  uint32_t *index;  /* dues: the pairs that are to be looked at now */
  double *last;     /* n x 3, m: positions of the last step's end, or of this one's start */
  double travelled; /* m, up to `last`: the sum over the steps of the largest move of a particle */
  double reached;   /* m, the same at the end that is tried */
  bool listed;      /* the list is that of `found` */
  bool fresh;       /* it was found in this step */
  double *chunk;    /* results of loops over particles */
  size_t searches;
} hk_nearby;

/* In `create` and `topology`, with `reach` set. HK_NO_MEMORY. */
hk_status hk_nearby_open(hk_nearby *, const hk_host *, const hk_view *, const hk_surfaces *, hk_nearby_found *,
                         double skin);
void hk_nearby_begin(hk_nearby *, const double *x_from);
/* Completes the list for straight moves from x_from to x_to, both n x 3, and fills `index`. HK_NO_MEMORY, and what the
 * service says. */
hk_status hk_nearby_reach(hk_nearby *, const double *x_from, const double *x_to);
void hk_nearby_end(hk_nearby *, const double *x_to);

/* Says that pair k had this gap at the start of the step and need not be looked at before it may have closed. Called by
 * several threads at once, for different pairs. */
void hk_nearby_put_off(hk_nearby *, size_t k, double gap);

/* Puts off all pairs of `index` that are not near on the way that was reached, by their gaps at x, its start. */
void hk_nearby_sift(hk_nearby *, const double *x);

#endif
