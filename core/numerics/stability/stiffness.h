/* The bound of a scene's highest frequency that its forces state, without an evaluation: see stiffness.c. */
#ifndef HK_STIFFNESS_H
#define HK_STIFFNESS_H

#include "core/engine/base/base.h"

typedef struct hk_stiffness {
  bool covered;              /* every force that acts and depends on x states a bound */
  double whole;              /* no w^2 is larger than what the forces state, 1/s^2 */
  double undamped;           /* the part of it that their damping does not reach, 1/s^2 */
  double stiffening;         /* of those forces that may become stiffer than they are, 1/s^2 ... */
  double stiffening_damping; /* ... and of their damping, 1/s */
  bool damps_alone;          /* no other force depends on v */
  double beta;               /* least damping over stiffness of the elements, s; 0 when one has none */
  double length; /* m, the shortest distance within an element or edge; INFINITY: there is none longer than 0 */
} hk_stiffness;

/* Sets *largest to the bound of one part at system->X; false: there are constraints, whose part is not in it, or a
 * force that depends on x states none, or, of the damping, one that depends on v. It is 0 then, but of the damping that
 * of the forces that state one. scratch: 6n doubles. */
bool hk_stiffness_part_of(hk_system *, hk_stiffness_part, double (*scratch)[6], double *largest);

/* Sets *largest to the bound of the damping rates that the forces state, 1/s; false: one that depends on v states none,
 * or becomes stiffer than it is, or there are constraints. scratch: 6n doubles. */
bool hk_stated_damping(hk_system *, double (*scratch)[6], double *largest);

/* At system->X; scratch: 6n doubles. */
hk_stiffness hk_stiffness_of(hk_system *, double (*scratch)[6]);

/* Eigenvalues of a symmetric 3x3 matrix (xx, xy, xz, yy, yz, zz), in rising order. */
void hk_symmetric_eigenvalues(const double a[6], double value[3]);

#endif
