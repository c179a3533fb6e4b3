/* Untangling in rounds: global intersection analysis, displacements of the vertices, and analysis again. A round is
 * kept only if the number of intersections does not rise. */
#ifndef HK_UNTANGLER_H
#define HK_UNTANGLER_H

#include "plugins/common/contact/untangling/displacements.h"
#include "plugins/common/contact/untangling/prolong.h"

typedef struct hk_untangler {
  const hk_surfaces *surfaces;
  const hk_host *host;
  double clearance; /* m: the gap that displacements aim at */
  int64_t rounds;   /* of a call, at most */
  hk_contours contours;
  hk_prolong prolong;
  hk_regions regions;
  hk_displacements moves;
  double *trial, *from; /* n x 3, m */
  size_t trial_room, from_room;
  size_t intersections; /* of the last analysis */
  /* Of the last hk_untangler_free: intersections and curves before it, particles moved, the longest displacement, m. */
  size_t found, seen[HK_CONTOUR_KINDS], moved;
  double furthest;
} hk_untangler;

/* The intersections at x (n x 3), their curves, and the regions that these enclose. HK_NO_MEMORY, HK_NOT_FINITE. */
hk_status hk_untangler_analyse(hk_untangler *, const hk_model *, const double *x);
/* Moves c->x until there are no intersections or all rounds are spent, removes from c->v the velocities that drive
 * surfaces further into each other, and sets c->changed where it did either. The number of intersections does not rise.
 * The last analysis is that of the final x. */
hk_status hk_untangler_free(hk_untangler *, const hk_model *, hk_correction *c);
/* Sets mark[i] to 1 for particles of intersecting edges and triangles and of enclosed regions, else to 0. */
void hk_untangler_mark(const hk_untangler *, size_t n, double *mark);
void hk_untangler_close(hk_untangler *);

#endif
