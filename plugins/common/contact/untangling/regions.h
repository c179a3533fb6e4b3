/* What closed intersection paths enclose: the vertices of each of the two surfaces that have gone through the other
 * (Baraff, Witkin and Kass 2003, section 3.2, the flood fill). */
#ifndef HK_REGIONS_H
#define HK_REGIONS_H

#include "plugins/common/contact/untangling/contours.h"

typedef struct hk_enclosed {
  size_t first, count; /* of `vertex` */
  bool known;          /* the curve divides its surface in two */
} hk_enclosed;

typedef struct hk_regions {
  size_t vertices;
  uint32_t *vertex;           /* what all closed curves enclose, one after the other */
  hk_enclosed (*enclosed)[2]; /* contours: on its two sides; of a twisted one both are on side 0 */
  size_t vertex_room, memory_room;
  void *memory; /* of all that follows, for the search */
  size_t crossed, seen_count;
  uint32_t *root, *next, *head; /* n: union-find of what no curve divides; the vertices of a root as a list */
  uint32_t *start, *incident;   /* n + 2, 2 x crossed: the crossed edges at each root */
  uint32_t *edge, *place;       /* crossed edges; and of each edge its place there, from 1 */
  uint32_t *seen;               /* n: roots on the present surface */
  uint8_t *colour, *odd; /* n: 0 not seen, 1, 2; crossed edges: the present curve crosses it an odd number of times */
  double *area;          /* n, m^2, of roots */
} hk_regions;

/* Of each side of a closed curve the part of the smaller area, x n x 3. HK_NO_MEMORY. */
hk_status hk_regions_fill(hk_regions *, const hk_host *, const hk_surface_mesh *, const hk_contours *, size_t n,
                          const double *x);
void hk_regions_free(hk_regions *, const hk_host *);

#endif
