/* The equations of all constraints of a scene and their system A = S J W J^T S, which of them act, and the saddle point
 * of an implicit step; constraint.c moves particles by them. */
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
  double *full;                   /* equations: diagonal of S if all acted, 0 where no particle can move */
  double *scale;                  /* equations: diagonal of S, 0 where an equation rests or no particle can move */
  double *g, *c, *rhs, *solution; /* equations */
  double *speed;                  /* equations: dg/dt at fixed x, m/s; zeros where a constraint has none */
  double *residual, *correction;  /* equations: of a refinement */
  double *moved;                  /* n x 3: W J^T solution */
  double *lambda;                 /* equations: multipliers of the last evaluation */
  /* Which equations act (active_set.c). */
  size_t one_sided_count;
  bool *one_sided;   /* equations */
  bool *implied;     /* equations that follow from others at the states of this scene: their multiplier is 0 */
  bool *touches;     /* one-sided equations that were met with equality at the start of the step */
  bool *pushes;      /* one-sided equations whose multiplier was positive in the last evaluation of this step */
  bool *allowed;     /* one-sided equations that may act in the problem at hand */
  bool *held;        /* one-sided equations that are taken as equalities in the problem at hand */
  bool *rests;       /* equations that do not act in the problem at hand */
  bool soft;         /* the factors at hand are those of A + soft_shift I */
  bool has_speed;    /* a constraint has `speed` */
  bool jumped;       /* since it was last asked: contact began or ended, equations changed, velocities jumped */
  uint64_t revision; /* of the pattern */
  double (*path)[3]; /* pins: acceleration of scripted particles, m/s^2 */
  bool *path_used;   /* pins: a constraint holds a particle of it */
  hk_linear_system linear;
};

/* ---- constraint_matrix.c ---- */

hk_status hk_constraint_matrix_build(hk_dynamics *); /* the pattern, after every change of topology */
void hk_constraint_matrix_free(hk_constraints *);
hk_view hk_constraint_view(const hk_dynamics *, const hk_instance *, double t, const double *x, const double *v);
/* `status` of what a constraint was asked; the error has a message afterwards if it failed. */
hk_status hk_constraint_failed(hk_dynamics *, const hk_instance *, double t, hk_status status);
hk_status hk_constraint_jacobian(hk_dynamics *, double t, const double *x, const double *v, double (*J)[3]);
/* J, WJ, full, and scale for the equations that do not rest. */
hk_status hk_constraint_matrix_linearise(hk_dynamics *, double t, const double *x, const double *v);
void hk_constraint_matrix_rest(hk_constraints *); /* scale, after `rests` changed */
/* Of the equations that act; where A is singular, of A + shift I, and the solution is refined. */
hk_status hk_constraint_matrix_factorize(hk_dynamics *);
/* solution = (J W J^T)^-1 rhs, 0 where an equation rests or no particle can move; rhs is overwritten. Of equations that
 * depend on each other: the multipliers of minimal norm. */
hk_status hk_constraint_matrix_solve(hk_dynamics *);
/* Finds equations that follow from others at the linearised state: `implied`. */
hk_status hk_constraint_matrix_review(hk_dynamics *);
/* The instance of an equation, and its number in it, from 1. */
const hk_instance *hk_constraint_of(const hk_dynamics *, size_t equation, size_t *number);

/* ---- active_set.c ---- */

/* The multipliers with J W J^T lambda + q = 0 for equalities and lambda >= 0, J W J^T lambda + q >= 0, one of them 0,
 * for one-sided equations that are `allowed` and not `held`; into solution. `factorized`: the factors are those of the
 * equalities. q is c->g or c->c, or any other of `equations` numbers. */
hk_status hk_active_set_solve(hk_dynamics *, const double *q, bool factorized);
/* ---- saddle_point.c ---- */

hk_status hk_saddle_point_factorize(hk_dynamics *, const hk_matrix *A);
/* A x + J^T lambda = b, J x = J u; u NULL: M^-1 b. */
hk_status hk_saddle_point_solve(hk_dynamics *, const double *b, const double *u, double *x, hk_solve_info *info);
unsigned hk_saddle_point_flags(const hk_dynamics *);
/* The blocks of -d(J^T lambda)/dx, and their numbers for the multipliers of the last evaluation, added to K. */
hk_status hk_saddle_point_name(hk_dynamics *, hk_pattern *);
hk_status hk_saddle_point_stiffness(hk_dynamics *, double t, const double *x, const double *v, const size_t *slot,
                                    double *K);

#endif
