/* The coarse half of the preconditioner of a liquid's viscosity: M^-1 = (L L^T)^-1 + Z (Z^T A Z)^-1 Z^T, with
 * incomplete factors for what differs from face to face, and for the rest the rigid motions Z of pieces of the liquid,
 * six of each, whose small matrix is factorized. A rigid motion has no strain: those are the velocities that viscosity
 * changes least, which incomplete factors are slow to find, and the slower the more cells or the larger the viscosity.
 * The pieces: Nicolaides 1987, SIAM J. Numer. Anal. 24, 355; rigid motions of stiff parts: Jonsthovel, van Gijzen,
 * MacLachlan, Vuik, Scarpas 2012, Comput. Mech. 50, 321; added rather than deflated: Dryja and Widlund 1990, so that M
 * is symmetric and positive definite whatever rounding does. */
#ifndef HK_VISCOUS_COARSE_H
#define HK_VISCOUS_COARSE_H

#include "plugins/common/liquid/liquid.h"
#include "plugins/common/supernodal/supernodal.h"

enum { HK_RIGID_MODES = 6, HK_VISCOUS_PIECE = 6 /* cells along an axis, at most */ };

/* Zeroed before `build`. Without pieces it adds nothing. */
typedef struct hk_viscous_coarse {
  const hk_host *host;
  size_t faces, pieces;
  uint32_t *piece;  /* faces: the piece that it is part of */
  size_t *start;    /* pieces + 1: positions in `member` */
  uint32_t *member; /* faces, by pieces, rising in each */
  double *mode;     /* faces x 6: what a piece's motions, an orthonormal set, are at the face */
  hk_matrix matrix; /* Z^T A Z: for each piece two rows of blocks of three */
  uint32_t *column; /* of the matrix */
  double *b, *x;    /* pieces x 6 */
  double *part;     /* pieces: of r.z */
  hk_supernodal factors;
} hk_viscous_coarse;

/* Where unknowns are, and what they are made of. */
typedef struct hk_viscous_faces {
  const hk_liquid_grid *grid;
  const uint32_t *face; /* faces: the place in arrays of the grid */
  const uint8_t *axis;
  size_t count;
  const double *cell; /* Pa s, of cells; NULL: it is the same everywhere */
} hk_viscous_faces;

/* A: the equations, of which those of faces are the first rows. HK_NO_MEMORY, HK_NOT_CONVERGED: with a message. */
hk_status hk_viscous_coarse_build(hk_viscous_coarse *, const hk_host *, const hk_viscous_faces *, const hk_matrix *A);
/* z += Z (Z^T A Z)^-1 Z^T r; returns r.(what it added). */
double hk_viscous_coarse_add(hk_viscous_coarse *, const double *r, double *z);
void hk_viscous_coarse_close(hk_viscous_coarse *);

#endif
