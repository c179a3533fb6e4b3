/* Vertices between two pinned surfaces that leave no room for them: whatever contact did would push them into one of
 * the two, and back in the next step. They stick: each keeps its place between the two and moves as these do, on the
 * average (Baraff, Witkin and Kass 2003, section 5, "flypapering"). */
#ifndef HK_FLYPAPER_H
#define HK_FLYPAPER_H

#include "plugins/common/surfaces/surfaces.h"

typedef struct hk_hold { /* a vertex near a pinned triangle */
  uint32_t vertex, part; /* the second: the surface of the triangle */
  double normal[3];      /* from the triangle's nearest point to the vertex, before the step */
  double from[3], to[3]; /* m: that point before and after the step */
  double v[3];           /* m/s, its velocity after the step */
  double offset;         /* m: how far apart the two have to be */
} hk_hold;

typedef struct hk_flypaper {
  size_t holds, room;
  hk_hold *hold;
  size_t pinched; /* vertices that stick in this step */
} hk_flypaper;

/* Whether there are two surfaces that are pinned as a whole. */
bool hk_flypaper_needed(const hk_surface_mesh *, const hk_model *);
/* Moves what is pinched, from c->x_before on, and adds HK_MARK_PINCHED to its marks. HK_NO_MEMORY, HK_NOT_FINITE. */
hk_status hk_flypaper_hold(hk_flypaper *, const hk_host *, const hk_surfaces *, const hk_model *, hk_correction *c,
                           double *mark);
void hk_flypaper_free(hk_flypaper *, const hk_host *);

#endif
