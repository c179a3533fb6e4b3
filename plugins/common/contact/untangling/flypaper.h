/* Flypapering (Baraff, Witkin and Kass 2003, section 5): vertices pinched between two pinned surfaces that are closer
 * than the cloth is thick. A contact response would push them to and fro between the two. Instead each keeps its
 * position relative to both and moves with the mean of their motions. */
#ifndef HK_FLYPAPER_H
#define HK_FLYPAPER_H

#include "plugins/common/contact/surfaces/surfaces.h"

typedef struct hk_hold { /* a vertex near a pinned triangle */
  uint32_t vertex, part; /* part: the connected surface of the triangle */
  double normal[3];      /* from the triangle's nearest point to the vertex, before the step */
  double from[3], to[3]; /* m: that point before and after the step */
  double v[3];           /* m/s, its velocity after the step */
  double offset;         /* m, the required distance */
} hk_hold;

typedef struct hk_flypaper {
  size_t holds, room;
  hk_hold *hold;
  size_t pinched; /* vertices held in this step */
} hk_flypaper;

/* Whether at least two surfaces are pinned as a whole. */
bool hk_flypaper_needed(const hk_surface_mesh *, const hk_model *);
/* Moves pinched vertices from their positions in c->x_before and adds HK_MARK_PINCHED to their marks. HK_NO_MEMORY,
 * HK_NOT_FINITE. */
hk_status hk_flypaper_hold(hk_flypaper *, const hk_host *, const hk_surfaces *, const hk_model *, hk_correction *c,
                           double *mark);
void hk_flypaper_free(hk_flypaper *, const hk_host *);

#endif
