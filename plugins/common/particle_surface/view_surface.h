/* The surface of the particles of a view that are drawn as a liquid, for pictures. */
#ifndef HK_VIEW_SURFACE_H
#define HK_VIEW_SURFACE_H

#include "plugins/common/frame_data/solid.h"
#include "plugins/common/particle_surface/particle_options.h"

typedef struct hk_view_surface {
  hk_particle_surface_options options; /* to be set */
  uint32_t group;       /* to be set: of the model; UINT32_MAX: all that are in no edge, triangle or element */
  bool smooth;          /* to be set: with normals */
  hk_frame_solid solid; /* a mesh, valid until the next call; without faces where there is no liquid */
  hk_isosurface surface;
  bool *bound; /* particles of the view: in an element */
  double (*x)[3];
  size_t room;
} hk_view_surface;

/* The group of that name, NULL: none is named. HK_BAD_PARAM. */
hk_status hk_view_surface_choose(hk_view_surface *, const hk_host *, const hk_model *, const char *group);
/* In coordinates with z up. The status of hk_particle_surface_find. */
hk_status hk_view_surface_take(hk_view_surface *, const hk_view *, bool y_up);
void hk_view_surface_free(hk_view_surface *, const hk_host *); /* a zeroed one is allowed */

#endif
