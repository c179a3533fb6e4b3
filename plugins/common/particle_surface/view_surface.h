/* The surface of the particles of a view that are drawn as a liquid, for pictures. */
#ifndef HK_VIEW_SURFACE_H
#define HK_VIEW_SURFACE_H

#include "plugins/common/obstacles/obstacle.h"
#include "plugins/common/frame_data/solid.h"
#include "plugins/common/particle_surface/particle_options.h"

typedef struct hk_surface_wanted { /* as a script says it */
  double radius, cell, reach;      /* m, of hk_particle_surface_options; NAN: left out, and no radius: no surface */
  const char *of;                  /* name of a group, NULL: all that are in no edge, triangle or element */
  int field;                       /* hk_particle_field_kind */
  int64_t smoothing;               /* rounds */
  bool cut;                        /* by obstacles */
  int clear;                       /* 1: the surface has normals, and is drawn with these two */
  double index, absorption[3];     /* as in hk_water_optics */
} hk_surface_wanted;

typedef struct hk_view_surface {
  hk_particle_surface_options options;
  uint32_t group;               /* of the model; UINT32_MAX: all that are in no edge, triangle or element */
  bool smooth;                  /* with normals */
  const hk_obstacle_set *walls; /* to be set: what cuts the surface; NULL: nothing */
  hk_frame_solid solid;         /* a mesh, valid until the next call; without faces where there is no liquid */
  hk_isosurface surface;
  bool *bound; /* particles of the view: in an element */
  double (*x)[3];
  size_t room;
} hk_view_surface;

/* Sets what is wanted. HK_BAD_PARAM: there is no such group, or something is wanted of a surface without a radius. */
hk_status hk_view_surface_choose(hk_view_surface *, const hk_host *, const hk_model *, const hk_surface_wanted *);
/* In coordinates with z up. The status of hk_particle_surface_find. */
hk_status hk_view_surface_take(hk_view_surface *, const hk_view *, bool y_up);
void hk_view_surface_free(hk_view_surface *, const hk_host *); /* a zeroed one is allowed */

#endif
