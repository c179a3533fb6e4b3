/* A frame in which the particles that belong to no edge and no triangle are replaced by their surface: its vertices are
 * points of the frame like particles, behind those that stay, with the velocities and channels of the particles around
 * (particle_average.h), mass 0 and the ids that follow. */
#ifndef HK_SURFACE_FRAME_H
#define HK_SURFACE_FRAME_H

#include "plugins/common/frame_data/frame_data.h"
#include "plugins/common/particle_surface/particle_surface.h"

typedef struct hk_surface_frame { /* a zeroed one is empty; memory is the host's */
  hk_frame_data data;             /* solids and marks are those of the frame that it was made of */
} hk_surface_frame;

/* Replaces the frame. It is cut by walls that are no meshes; NULL: there are none. Forces and strains of vertices are
 * 0. Where no particle is loose there are no triangles beside the frame's own. The status of hk_particle_surface_find.
 */
hk_status hk_surface_frame_make(hk_surface_frame *, const hk_host *, const hk_frame_data *of,
                                const hk_particle_surface_options *, const hk_solid_list *walls);
void hk_surface_frame_free(hk_surface_frame *, const hk_host *);

#endif
