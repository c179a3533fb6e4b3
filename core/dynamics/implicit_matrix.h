/* The Jacobian of a run and the system that an implicit step solves with it: jacobian.c fills K and D,
 * implicit_matrix.c combines them to A and passes it to the scene's solver. */
#ifndef HK_IMPLICIT_MATRIX_H
#define HK_IMPLICIT_MATRIX_H

#include "core/matrix/matrix.h"
#include "core/dynamics/linear_system.h"

struct hk_implicit_matrix {
  hk_block_matrix matrix;
  size_t *first;             /* one per force: position in matrix.slot */
  size_t first_constraint;   /* position of the stiffness of constraint forces in matrix.slot */
  double *K, *D;             /* blocks x 9; NULL: the pattern must be built again */
  bool stale;                /* the blocks of a force changed: the next assembly builds a new pattern */
  double *X;                 /* state->size, scratch of products; NULL until needed */
  double *A;                 /* blocks x 9; NULL until the first combination */
  const hk_pin_spec **slide; /* one per particle: its sliding pin or NULL; the array is NULL until needed */
  bool symmetric;            /* K and D of the last assembly */
  hk_linear_system linear;
};

hk_implicit_matrix *
hk_implicit_matrix_of(hk_dynamics *); /* made at the first request; NULL: no memory, the error is set */

/* The system of a method without constraints; fails where the run has no solver. */
hk_status hk_implicit_linear_system(hk_dynamics *, hk_linear_system **);
/* Whether there are constraints, acting at present or not: a step has one solver. */
bool hk_implicit_constrained(const hk_dynamics *);

#endif
