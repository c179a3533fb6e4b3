/* Frees surfaces that intersect: looks, moves, looks again, and keeps a move only where intersections do not become
 * more. */
#ifndef HK_UNTANGLER_H
#define HK_UNTANGLER_H

#include "plugins/common/untangling/moves.h"
#include "plugins/common/untangling/prolong.h"

typedef struct hk_untangler {
  const hk_surfaces *surfaces;
  const hk_host *host;
  double clearance; /* m: how much further than their radii surfaces are moved apart */
  int64_t rounds;   /* moves at once, at most */
  hk_contours contours;
  hk_prolong prolong;
  hk_regions regions;
  hk_moves moves;
  double *trial, *from; /* n x 3, m */
  size_t trial_room, from_room;
  size_t intersections; /* at the last look */
  /* of the last hk_untangler_free: intersections and curves before it, particles that were moved, and by how much, m */
  size_t found, seen[HK_CONTOUR_KINDS], moved;
  double furthest;
} hk_untangler;

/* Finds what intersects at x, its curves, and what these enclose. HK_NO_MEMORY, HK_NOT_FINITE. */
hk_status hk_untangler_look(hk_untangler *, const hk_model *, const double *x);
/* Moves x (n x 3) until nothing intersects or all rounds are spent, and takes from v what drives surfaces further into
 * each other; *changed where it did either. Intersections do not become more. The last look is at x. `c` filters the
 * moves. */
hk_status hk_untangler_free(hk_untangler *, const hk_model *, hk_correction *c);
/* Sets mark[i] to 1 for particles of edges and triangles that intersect, and for what curves enclose. */
void hk_untangler_mark(const hk_untangler *, size_t n, double *mark);
void hk_untangler_close(hk_untangler *);

#endif
