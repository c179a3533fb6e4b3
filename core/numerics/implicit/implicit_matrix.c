/* The matrix of an implicit step, A = m M + d D + k K, with the pins in it, and its solution by the scene's solver.
 *
 * Pins are a projection S, so A becomes S A S + s (I - S): a forbidden direction gets the equation s x = 0, with s of
 * the size of the diagonal to preserve the conditioning. Rows and columns of fixed and scripted particles have no other
 * entries, so their part of the solution is exactly 0 (Baraff and Witkin 1998, section 5, as a matrix instead of a
 * filter in the iteration). Each row is computed by one thread, so the values do not depend on the number of
 * threads. */

#include "core/numerics/implicit/implicit.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS_GRAIN = 1024 };

static hk_dynamics *dynamics_of(hk_system *s) { return (hk_dynamics *)(void *)s; }

hk_implicit_matrix *hk_implicit_matrix_of(hk_dynamics *d) {
  if (!d->matrix) d->matrix = calloc(1, sizeof *d->matrix);
  if (!d->matrix) hk_error_set(d->error, HK_NO_MEMORY, "no memory for the Jacobian");
  return d->matrix;
}

typedef struct combination {
  const hk_dynamics *dynamics;
  hk_implicit_matrix *s;
  double m, d, k;
} combination;

/* P = S of a sliding particle, symmetric. */
static void projection(const hk_pin_spec *spec, double P[9]) {
  for (int c = 0; c < 3; c++) {
    double unit[3] = {c == 0, c == 1, c == 2};
    hk_pin_project(spec, unit);
    memcpy(P + 3 * c, unit, sizeof unit);
  }
}

static void multiply(const double A[9], const double B[9], double C[9]) {
  for (int p = 0; p < 9; p++) {
    const double *a = A + p / 3 * 3, *b = B + p % 3;
    C[p] = a[0] * b[0] + a[1] * b[3] + a[2] * b[6];
  }
}

static void slide_block(double *A, const hk_pin_spec *row, const hk_pin_spec *column) {
  double P[9], B[9];
  if (row) {
    projection(row, P);
    multiply(P, A, B);
    memcpy(A, B, sizeof B);
  }
  if (column) {
    projection(column, P);
    multiply(A, P, B);
    memcpy(A, B, sizeof B);
  }
}

static bool is_fixed(const hk_dynamics *d, size_t i) {
  return d->state->pin[i] == HK_PIN_FIXED || d->state->pin[i] == HK_PIN_PATH || d->state->pin[i] == HK_PIN_RIDES;
}

/* A := S A S + s (I - S) on a diagonal block. */
static void pin_diagonal(double *A, const hk_pin_spec *slide, bool fixed) {
  double scale = fmax(fabs(A[0]), fmax(fabs(A[4]), fabs(A[8]))), P[9] = {0};
  if (!(scale > 0)) scale = 1;
  if (fixed)
    memset(A, 0, 9 * sizeof *A);
  else {
    slide_block(A, slide, slide);
    projection(slide, P);
  }
  for (int p = 0; p < 9; p++) A[p] += scale * ((p % 4 == 0) - P[p]);
}

static void combine_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const combination *c = context;
  const hk_implicit_matrix *s = c->s;
  (void)chunk;
  for (size_t r = begin; r < end; r++) {
    bool row_held = is_fixed(c->dynamics, r);
    for (size_t e = s->matrix.row_start[r]; e < s->matrix.row_start[r + 1]; e++) {
      size_t column = s->matrix.column[e];
      const double *K = s->K + 9 * e, *D = s->D + 9 * e;
      double *A = s->A + 9 * e;
      for (int p = 0; p < 9; p++) A[p] = c->d * D[p] + c->k * K[p];
      if (column == r) {
        for (int p = 0; p < 9; p += 4) A[p] += c->m * c->dynamics->state->mass[r];
        if (row_held || (s->slide && s->slide[r])) pin_diagonal(A, s->slide ? s->slide[r] : NULL, row_held);
      } else if (row_held || is_fixed(c->dynamics, column))
        memset(A, 0, 9 * sizeof *A);
      else if (s->slide)
        slide_block(A, s->slide[r], s->slide[column]);
    }
  }
}

static hk_status find_slides(hk_dynamics *d, hk_implicit_matrix *s) {
  if (!d->pins->has_slides) {
    free(s->slide);
    s->slide = NULL;
    return HK_OK;
  }
  if (!s->slide) s->slide = malloc((d->state->model.n + 1) * sizeof *s->slide);
  if (!s->slide) return HK_NO_MEMORY;
  for (size_t i = 0; i < d->state->model.n; i++) s->slide[i] = NULL;
  for (size_t k = 0; k < d->pins->count; k++) {
    const hk_pin_state *pin = &d->pins->item[k];
    bool slides = pin->spec->kind == HK_PIN_LINE || pin->spec->kind == HK_PIN_PLANE;
    for (size_t j = 0; slides && !pin->released && j < pin->count; j++) s->slide[pin->index[j]] = pin->spec;
  }
  return HK_OK;
}

hk_status hk_implicit_combine(hk_system *system, double m, double d, double k, hk_matrix *A) {
  hk_dynamics *dynamics = dynamics_of(system);
  hk_implicit_matrix *s = dynamics->matrix;
  if (!s || !s->K) return hk_error_set(dynamics->error, HK_FAILED, "a matrix was combined before its Jacobian");
  if (!s->A) s->A = malloc((9 * s->matrix.row_start[s->matrix.rows] + 1) * sizeof *s->A);
  if (!s->A || find_slides(dynamics, s) != HK_OK)
    return hk_error_set(dynamics->error, HK_NO_MEMORY, "no memory for the matrix of %zu particles",
                        dynamics->state->model.n);
  combination c = {dynamics, s, m, d, k};
  hk_threads_for(dynamics->shared->threads, s->matrix.rows, ROWS_GRAIN, combine_rows, &c);
  *A = (hk_matrix){s->matrix.rows, 3, s->matrix.row_start, s->matrix.column, s->A, s->symmetric, s->matrix.number};
  return HK_OK;
}

/* ---- factorization and solution ---- */

hk_status hk_implicit_linear_system(hk_dynamics *d, hk_linear_system **linear) {
  hk_implicit_matrix *s = hk_implicit_matrix_of(d);
  if (!s) return HK_NO_MEMORY;
  if (!d->solver && !d->special)
    return hk_error_set(d->error, HK_FAILED, "%s solves linear systems but does not declare it (HK_NEEDS_SOLVER)",
                        hk_plugins_one(d->plugins, HK_INTEGRATOR)->plugin->name);
  s->linear.any = d->solver;
  s->linear.special = d->special;
  if (!s->linear.solver) s->linear.solver = d->solver;
  *linear = &s->linear;
  return HK_OK;
}

const hk_instance *hk_solver_in_use(const hk_dynamics *d) {
  const hk_instance *saddle = hk_saddle_point_solver(d);
  if (saddle) return saddle;
  if (d->matrix && d->matrix->linear.solver) return d->matrix->linear.solver;
  return d->constraints ? d->constraints->linear.solver : d->solver;
}

bool hk_implicit_constrained(const hk_dynamics *d) { return d->saddle && d->constraints->equations > 0; }

hk_status hk_implicit_factorize(hk_system *system, const hk_matrix *A) {
  hk_linear_system *linear = NULL;
  hk_status status = hk_implicit_linear_system(dynamics_of(system), &linear);
  if (status == HK_OK && hk_implicit_constrained(dynamics_of(system)))
    return hk_saddle_point_factorize(dynamics_of(system), A);
  hk_matrix rows;
  if (status == HK_OK)
    status = hk_coupled_rows_of(&dynamics_of(system)->matrix->coupled, dynamics_of(system), A, &rows);
  return status == HK_OK ? hk_linear_system_factorize(dynamics_of(system), linear, &rows) : status;
}

static hk_status ready(hk_dynamics *d, hk_linear_system **linear) {
  if (!d->matrix || !d->matrix->linear.analyzed)
    return hk_error_set(d->error, HK_FAILED, "a system was solved before its factorization");
  *linear = &d->matrix->linear;
  return HK_OK;
}

hk_status hk_implicit_solve(hk_system *system, const double *b, double *x, hk_solve_info *info) {
  return hk_implicit_solve_along(system, b, NULL, x, info);
}

hk_status hk_implicit_solve_along(hk_system *system, const double *b, const double *u, double *x, hk_solve_info *info) {
  hk_linear_system *linear = NULL;
  if (hk_implicit_constrained(dynamics_of(system))) return hk_saddle_point_solve(dynamics_of(system), b, u, x, info);
  hk_status status = ready(dynamics_of(system), &linear);
  if (status != HK_OK) return status;
  return hk_coupled_rows_solve(&dynamics_of(system)->matrix->coupled, dynamics_of(system), linear, b, x, 1, info);
}

hk_status hk_implicit_solve_columns(hk_system *system, const double *b, double *x, size_t columns) {
  hk_linear_system *linear = NULL;
  if (hk_implicit_constrained(dynamics_of(system)))
    return hk_error_set(dynamics_of(system)->error, HK_FAILED,
                        "several right-hand sides at once are not solved in a scene with constraints");
  hk_status status = ready(dynamics_of(system), &linear);
  if (status != HK_OK) return status;
  return hk_coupled_rows_solve(&dynamics_of(system)->matrix->coupled, dynamics_of(system), linear, b, x, columns, NULL);
}
