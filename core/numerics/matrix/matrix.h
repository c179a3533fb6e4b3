/* Sparse matrices as patterns: where the blocks are that forces or constraints name, which rows follow from others, and
 * linear systems by solver plugins. */
#ifndef HK_MATRIX_H
#define HK_MATRIX_H

#include "core/engine/evaluate/evaluate.h"

/* ---- block_matrix.c: the pattern of a matrix from named blocks; a zeroed structure is an empty pattern ---- */

typedef struct hk_block_matrix {
  hk_pattern naming; /* first member: passed to the plugin that names blocks */
  size_t rows, columns;
  size_t named, capacity;
  uint32_t (*pair)[2]; /* named: row and column, in the order of naming; freed by the build */
  bool no_memory, out_of_range;
  size_t *slot;      /* named: position in `column` of the e-th named block */
  size_t *row_start; /* rows + 1 */
  uint32_t *column;  /* row_start[rows], rising within a row */
  uint64_t number;   /* of row_start and column, hk_matrix.pattern */
} hk_block_matrix;

void hk_block_matrix_begin(hk_block_matrix *, size_t rows, size_t columns); /* removes the old pattern */
/* Builds slot, row_start and column from the named blocks. HK_NO_MEMORY, or HK_FAILED: a block lies outside the
 * matrix. */
hk_status hk_block_matrix_build(hk_block_matrix *);
/* A hash of a pattern: equal patterns have equal numbers, different patterns have different ones (except one pair in
 * 2^64). */
uint64_t hk_pattern_number(size_t rows, size_t block, const size_t *row_start, const uint32_t *column);
void hk_block_matrix_free(hk_block_matrix *);

/* ---- independent_rows.c ---- */

/* implied[r]: row r of the symmetric matrix A with 1 x 1 blocks and a unit diagonal follows from the rows before it
 * that are not implied themselves. */
hk_status hk_independent_rows(const hk_matrix *A, bool *implied, hk_error *error);

/* ---- linear_system.c: the scene's solver, or one chosen by the forces, the size and the flags of the installed
 * solvers ---- */

/* Creates and starts the solver before the first step. `named` NULL: the solver is chosen. */
hk_status hk_solver_open(hk_dynamics *, const hk_plugin_spec *named);
/* One that takes indefinite matrices, for the saddle points of implicit steps with constraints; the caller destroys it
 * and then the spec, which is NULL where the scene's solver is of that kind. */
hk_status hk_solver_indefinite(hk_dynamics *, hk_instance **solver, hk_plugin_spec **spec);

/* A solver plugin together with the pattern it has analysed. Where the run has chosen the solvers, every new pattern
 * decides between two: one for matrices of a kind, which goes first where it fits, and one for any matrix. */
typedef struct hk_linear_system {
  hk_instance *solver;  /* the one in use */
  hk_instance *any;     /* takes every pattern; NULL until it is needed */
  hk_instance *special; /* takes those that it fits (hk_solver.fits), or NULL */
  bool apart;           /* these are instances of its own, not those of the run */
  uint64_t pattern;     /* number or hash of the analysed pattern */
  bool analyzed;
  size_t rows; /* length of a right-hand side */
} hk_linear_system;

/* The solver in use becomes the one for the pattern of A, which is not analysed yet. */
hk_status hk_linear_system_choose(hk_dynamics *, hk_linear_system *, const hk_matrix *A);
/* Second instances with the parameters of the run's, for the multipliers; the caller destroys them. */
hk_status hk_solver_twins(hk_dynamics *, hk_linear_system *);
/* Analyses A when its pattern differs from the last one, then factorizes it. */
hk_status hk_linear_system_factorize(hk_dynamics *, hk_linear_system *, const hk_matrix *A);
/* The same with the solver in use, for a pattern of that number. */
hk_status hk_linear_system_factors(hk_dynamics *, hk_linear_system *, const hk_matrix *A, uint64_t pattern);
/* Where the block of that row and column stands; SIZE_MAX: there is none. */
size_t hk_matrix_find(const hk_matrix *A, size_t row, uint32_t column);
/* Largest |A - A^T| relative to the largest |A|: more than hk_asymmetry_limit is more than rounding. NaN counts as 0.
 */
double hk_matrix_asymmetry(const hk_matrix *A);
extern const double hk_asymmetry_limit;
hk_status hk_linear_system_solve(hk_dynamics *, hk_linear_system *, const double *b, double *x,
                                 hk_solve_info *info); /* info: or NULL */
hk_status hk_linear_system_solve_columns(hk_dynamics *, hk_linear_system *, const double *b, double *x, size_t columns);

/* ---- asked_solvers.c: linear systems of other plugins, "solvers/1" (core/plugin/solver.h) ---- */

/* The table of the run; `scene`: the solver that was asked for, or NULL. NULL: no memory. */
const hk_solvers *hk_asked_solvers(hk_dynamics *, const hk_plugin_spec *scene);
void hk_asked_solvers_forget(
    hk_dynamics *); /* the next matrices are analysed anew, as by a run that goes on from here */
void hk_asked_solvers_close(hk_dynamics *);

#endif
