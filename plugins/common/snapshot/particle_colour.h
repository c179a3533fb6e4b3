/* The quantities of the scene's state that a picture shows as colour, radius, opacity and streak of each particle. */
#ifndef HK_PARTICLE_COLOUR_H
#define HK_PARTICLE_COLOUR_H

#include "plugins/common/snapshot/snapshot3d.h"

/* Fills the snapshot's colour and extra. `birth`: the time of each particle's birth, s; NULL: they were there from t =
 * 0. The status of hk_particle_stresses. */
hk_status hk_particle_colours_take(hk_snapshot3d *, const hk_view *view, const hk_frame *frame, const double *birth);

#endif
