/* How a surface of particles is asked for (particle_surface.h). */
#ifndef HK_PARTICLE_OPTIONS_H
#define HK_PARTICLE_OPTIONS_H

#include "plugins/common/isosurface/surface_parts.h"

typedef enum hk_particle_field_kind { HK_ZHU_BRIDSON, HK_PARTICLE_DENSITY } hk_particle_field_kind;

typedef struct hk_particle_surface_options {
  hk_particle_field_kind kind;
  double radius;    /* m: half the distance of neighbours in a full liquid */
  double reach;     /* m; 0: 4 radius */
  double cell;      /* m; 0: radius / 2 */
  double threshold; /* of the density; 0: 0.6 */
  hk_isosurface_method method;
  bool without_normals;
  size_t most_bytes; /* an error before more than this is allocated; 0: no limit */
} hk_particle_surface_options;

#endif
