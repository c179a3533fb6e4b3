/* The equations of all constraints of a scene and their system A = S J W J^T S; constraint.c moves particles by it. */
#ifndef HK_CONSTRAINT_MATRIX_H
#define HK_CONSTRAINT_MATRIX_H

#include "core/dynamics/block_matrix.h"
#include "core/dynamics/linear_system.h"

struct hk_constraints {
  size_t equations, blocks, terms;
  size_t *equation_first;         /* one per instance, and the end */
  size_t *block_first;            /* the same for blocks */
  hk_block_matrix list;           /* pair[b]: equation and particle of block b; not built */
  double (*J)[3], (*WJ)[3];       /* blocks: dg/dx, and what the pins leave of it divided by the mass */
  uint32_t *pin;                  /* blocks: position in d->pins->item, UINT32_MAX: never pinned */
  hk_block_matrix matrix;         /* of A: 1 x 1 blocks; the diagonal is named first */
  uint32_t (*term)[2];            /* terms: the blocks whose product is added to matrix.slot[equations + term] */
  double *value;                  /* of A */
  double *scale;                  /* equations: diagonal of S, 0 where no particle can move */
  double *g, *c, *rhs, *solution; /* equations */
  double (*path)[3];              /* pins: acceleration of scripted particles, m/s^2 */
  bool *path_used;                /* pins: a constraint holds a particle of it */
  hk_linear_system linear;
};

hk_status hk_constraint_matrix_build(hk_dynamics *); /* the pattern, after every change of topology */
void hk_constraint_matrix_free(hk_constraints *);
hk_view hk_constraint_view(const hk_dynamics *, const hk_instance *, double t, const double *x, const double *v);
void hk_constraint_matrix_linearise(hk_dynamics *, double t, const double *x, const double *v); /* J, WJ, scale */
hk_status hk_constraint_matrix_factorize(hk_dynamics *);
/* solution = (J W J^T)^-1 rhs, 0 where no particle can move; rhs is overwritten. */
hk_status hk_constraint_matrix_solve(hk_dynamics *);
/* Refuses (with `status`) equations that depend on each other; `known`: they do, find out which. */
hk_status hk_constraint_matrix_check(hk_dynamics *, bool known, hk_status status);
/* The instance of an equation, and its number in it, from 1. */
const hk_instance *hk_constraint_of(const hk_dynamics *, size_t equation, size_t *number);

#endif
