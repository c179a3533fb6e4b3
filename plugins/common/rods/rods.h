/* The evaluation of rods. */
#ifndef HK_RODS_H
#define HK_RODS_H

#include "plugins/common/rods/rod_set.h"

/* Frames, angles and forces on the rows, for all rods; the energy, J, unless it is NULL. HK_NOT_CONVERGED. */
hk_status hk_rods_evaluate(hk_rods *, const hk_view *view, double *energy);
void hk_rods_scatter(const hk_rods *, const hk_host *, double *F); /* F += the forces of the last evaluation */
/* Keeps the frames of an accepted state; HK_FAILED where a rod is folded or an edge has no length. */
hk_status hk_rods_accept(hk_rods *, const hk_view *view);

#endif
