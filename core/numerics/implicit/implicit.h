/* The Jacobian of a run and the system that an implicit step solves with it: jacobian.c fills K and D,
 * implicit_matrix.c combines them to A and passes it to the scene's solver, without rows that concern nobody else. */
#ifndef HK_IMPLICIT_H
#define HK_IMPLICIT_H

#include "core/numerics/constraints/constraints.h"

/* ---- coupled_rows.c: the rows that solvers get ---- */

typedef struct hk_coupled_rows {
  size_t rows, count; /* of the whole matrix; of those that solvers get. Equal: they get it as it is */
  size_t block;
  uint64_t of, number; /* of the patterns: the whole one; that of the rows */
  uint32_t *row;       /* count: their places in the whole matrix */
  uint32_t *place;     /* rows: scratch, and the way back */
  bool *held;          /* rows: the pins that the map is for */
  size_t *row_start;   /* count + 1 */
  uint32_t *column;
  double *value, *scale; /* the blocks; rows: s of those that are left out */
  double *b;             /* 2 x room: a right-hand side and its solution */
  size_t room;
} hk_coupled_rows;

void hk_coupled_rows_free(hk_coupled_rows *);
/* The rows of A, n x n blocks with the pins in them, that are joined to others or free; without values where A has
 * none. `out` is valid until the next call. HK_NO_MEMORY. */
hk_status hk_coupled_rows_of(hk_coupled_rows *, hk_dynamics *, const hk_matrix *A, hk_matrix *out);
/* Solves with the factors of the last `out`, for right-hand sides of all rows, n x block x columns. */
hk_status hk_coupled_rows_solve(hk_coupled_rows *, hk_dynamics *, hk_linear_system *, const double *b, double *x,
                                size_t columns, hk_solve_info *info);

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
  hk_coupled_rows coupled;
  hk_linear_system linear;
};

hk_implicit_matrix *
hk_implicit_matrix_of(hk_dynamics *); /* made at the first request; NULL: no memory, the error is set */

/* The system of a method without constraints; fails where the run has no solver. */
hk_status hk_implicit_linear_system(hk_dynamics *, hk_linear_system **);
/* Whether there are constraints, acting at present or not: a step has one solver. */
bool hk_implicit_constrained(const hk_dynamics *);

/* ---- rider_blocks.c ---- */

/* Names the blocks of the carriers, for those of riders that are named; after a fill, moves what riders have to them.
 */
void hk_implicit_name_carriers(const hk_dynamics *, hk_implicit_matrix *);
void hk_implicit_carry_over(const hk_dynamics *, hk_implicit_matrix *);

/* ---- jacobian.c, implicit_matrix.c, product.c, saddle_point.c ---- */

hk_status hk_saddle_point_open(hk_dynamics *); /* in a scene with constraints, whose method solves linear systems */
void hk_saddle_point_close(hk_dynamics *);
const hk_instance *hk_saddle_point_solver(const hk_dynamics *); /* NULL: it is the scene's own kind, or not needed */

/* Lets the pattern of the Jacobian decide on the solver, before the first step. */
hk_status hk_solver_choose(hk_dynamics *);
/* The solver of the last systems; NULL: there were none. */
const hk_instance *hk_solver_in_use(const hk_dynamics *);

/* The functions of the system that need a Jacobian, and hk_dynamics.blocks_changed. */
void hk_implicit_install(hk_dynamics *);
hk_status hk_jacobian_assemble(hk_system *, double t, double *X, unsigned want, hk_matrix *K, hk_matrix *D);
/* Other particles: makes the pattern and the factors invalid. */
void hk_jacobian_topology(hk_dynamics *);
void hk_jacobian_close(hk_dynamics *);
/* product.c, see hk_system */
hk_status hk_implicit_product(hk_system *, double t, const double *X, const double *dx, const double *dv, double *dF);
hk_status hk_implicit_combine(hk_system *, double m, double d, double k, hk_matrix *A);
hk_status hk_implicit_solver_flags(hk_system *, unsigned *flags);
hk_status hk_implicit_factorize(hk_system *, const hk_matrix *A);
hk_status hk_implicit_solve(hk_system *, const double *b, double *x, hk_solve_info *info);
hk_status hk_implicit_solve_along(hk_system *, const double *b, const double *u, double *x, hk_solve_info *info);
hk_status hk_implicit_solve_columns(hk_system *, const double *b, double *x, size_t columns);

hk_status hk_saddle_point_factorize(hk_dynamics *, const hk_matrix *A);
/* Solves A x + J^T lambda = b, J x = J u; where u is NULL, u = M^-1 b. */
hk_status hk_saddle_point_solve(hk_dynamics *, const double *b, const double *u, double *x, hk_solve_info *info);
unsigned hk_saddle_point_flags(const hk_dynamics *);
/* Names the blocks of -d(J^T lambda)/dx, and adds their values for the multipliers of the last evaluation to K. */
hk_status hk_saddle_point_name(hk_dynamics *, hk_pattern *);
hk_status hk_saddle_point_stiffness(hk_dynamics *, double t, const double *x, const double *v, const size_t *slot,
                                    double *K);

#endif
