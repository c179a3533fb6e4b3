/* Rods: joints and rest shapes, evaluation, damping, second derivatives. */
#ifndef HK_RODS_H
#define HK_RODS_H

#include "plugins/common/rods/rod_set.h"

/* ---- rod_shape.c: `create` and `topology` of a force of rods. HK_BAD_PARAM, HK_NO_MEMORY ---- */

hk_status hk_rods_open(hk_rods *, const hk_host *, const hk_view *view);
hk_status hk_rods_follow(hk_rods *, const hk_view *view);

/* ---- rods.c ---- */

/* Frames, angles and forces on the rows, for all rods; the energy, J, unless it is NULL. HK_NOT_CONVERGED. */
hk_status hk_rods_evaluate(hk_rods *, const hk_view *view, double *energy);
void hk_rods_scatter(const hk_rods *, const hk_host *, double *F); /* F += the forces of the last evaluation */
/* Keeps the frames of an accepted state; HK_FAILED where a rod is folded or an edge has no length. */
hk_status hk_rods_accept(hk_rods *, const hk_view *view);

/* ---- rod_damping.c ---- */

/* Adds to the forces on the rows, which are those of an evaluation at `view`; returns the power, W. */
double hk_rod_damping_add(hk_rods *, const hk_view *view);
/* F += what the last call of it found on the particles that are angles. */
void hk_rod_damping_turn(const hk_rods *, double *F);

/* ---- rod_blocks.c: second derivatives at the last hk_rods_evaluate, with the sections' angles as they are ---- */

void hk_rod_blocks_pattern(const hk_rods *, hk_pattern *);
/* With HK_WANT_DEFINITE without the terms that may be negative. */
void hk_rod_blocks_add(const hk_rods *, const hk_host *, const hk_blocks *into);
/* As hk_force.stiffness_bound, of all of K or of D. */
void hk_rod_blocks_bound(const hk_rods *, const hk_view *, hk_stiffness_part, double (*block)[6]);

#endif
