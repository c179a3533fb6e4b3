/* Viscosity of a liquid, implicitly and in the variational form of Batty and Bridson 2008 (Accurate viscous free
 * surfaces for buckling, coiling, and rotating liquids, eq. 10): of all velocities on the faces those that make
 *     sum over faces of rho V |u - u*|^2 / 2 + h sum over cells and edges of mu V (2 e_aa^2 or g_ab^2) / 2
 * least, with the strains e_aa = d u_a/d a in cells and g_ab = d u_a/d b + d u_b/d a at edges, and V the liquid's parts
 * of their volumes. So nothing pulls at the free surface, a liquid that turns as a rigid body keeps doing so, momentum
 * is kept where no wall takes it, and any viscosity is stable. Order 1 in time, 2 in space. Rigid bodies that the
 * liquid moves are unknowns beside the faces (viscous_bodies.h): it drags them, and they drag it. */
#ifndef HK_LIQUID_VISCOSITY_H
#define HK_LIQUID_VISCOSITY_H

#include "plugins/common/gradients/conjugate_gradients.h"
#include "plugins/common/linear/incomplete_cholesky.h"
#include "plugins/common/liquid/liquid.h"
#include "plugins/common/liquid_viscosity/viscous_bodies.h"
#include "plugins/common/liquid_viscosity/viscous_coarse.h"

enum {
  HK_VISCOUS_ROW = 15,                                        /* faces that share a strain with one, and itself */
  HK_VISCOUS_MOST = HK_VISCOUS_ROW + 6 * (HK_VISCOUS_ROW - 1) /* if a body of its own covered each of the others */
};

typedef struct hk_liquid_viscosity {
  double viscosity; /* Pa s; where `cell` has none */
  double *cell;     /* size, Pa s, mac_grid/cell_viscosity.h; NULL: it is the same everywhere */
  double tolerance; /* of what is left of the equations, relative */
  bool slip;        /* walls do not hold the liquid back */
  uint32_t *row[3]; /* of faces: number of the unknown, HK_LIQUID_NONE where there is none */
  uint32_t *face;   /* rows: its place in arrays */
  uint8_t *axis;    /* rows */
  size_t faces;     /* rows that are those of faces */
  hk_viscous_bodies bodies;
  size_t most, room; /* rows, and numbers of them, that there is memory for */
  size_t *start;     /* rows + 1 */
  uint32_t *column;  /* of faces each as many as a row may have, then without gaps */
  double *value;
  double *power; /* size, W, of dissipation; NULL: nobody asked for it */
  double *b, *x; /* rows: what the strains of u* ask for; the change of the velocity, m/s and rad/s */
  hk_gradients gradients;
  hk_incomplete factors;
  hk_viscous_coarse coarse;
  double *lists, *guess; /* of viscous_flow.h: m/s and rad/s, and size, m^2/s */
  size_t listed;
} hk_liquid_viscosity;

/* Bytes that it takes beside the grid, at most: every face of it may be in the liquid. by_cell: the viscosity differs.
 */
double hk_liquid_viscosity_bytes(const hk_liquid_grid *, bool by_cell);
/* Applies it to the velocities for a step of h, s; after hk_liquid_walls and hk_liquid_find_surface, and between two
 * projections: what is to be sheared has no divergence, and what comes of it has little. HK_NO_MEMORY,
 * HK_NOT_CONVERGED: with a message. */
hk_status hk_liquid_shear(hk_liquid *, hk_liquid_viscosity *, double h);
/* W/kg, of the listed particles: what the viscosity takes from the motion by the strains of the velocities that
 * hk_liquid_shear has left, sum of mu V (2 e_aa^2 + g_ab^2), in equal shares by mass in a cell; that of an edge goes to
 * the cells about it. HK_NO_MEMORY: with a message. */
hk_status hk_liquid_dissipation(const hk_liquid *, hk_liquid_viscosity *, const hk_liquid_particles *,
                                double *specific);
void hk_liquid_viscosity_close(hk_liquid_viscosity *, const hk_host *);

#endif
