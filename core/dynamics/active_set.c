/* Which equations act. One-sided ones push or rest: their multipliers solve the linear complementarity problem
 *     w = J W J^T lambda + q,   lambda >= 0,   w >= 0,   lambda w = 0,
 * by principal pivoting: solve for the equations that act, let all go that pull and take all that are broken, and from
 * some rounds on only the first of them, which ends for any positive definite matrix (Murty 1974; Judice and Pires
 * 1994). Equalities that follow from others at all states of a scene, a bar given twice or a loop that closes, are
 * found by an up-looking Cholesky factorization: a row whose pivot vanishes depends on the rows before it and is left
 * out (Davis, Direct Methods for Sparse Linear Systems, 4.7). Leaving out keeps accelerations a smooth function off the
 * constraints too, where stages of a method evaluate them; the singular system of all equations is not. */
#include "core/dynamics/constraint_matrix.h"

#include <stdlib.h>
#include <string.h>

enum { ROUNDS_OF_ALL = 10, MOST_ROUNDS = 400 };

static const double rounding = 1e-11; /* of the terms of a sum, after a solution with refinement */
static const double no_pivot = 1e-10; /* of a matrix with a unit diagonal: dependent but for 1e-5 of a direction */

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* moved = W J^T solution, at the particles that have equations. */
static void find_moved(hk_constraints *c) {
  for (size_t b = 0; b < c->blocks; b++) memset(c->moved + 3 * (size_t)c->list.pair[b][1], 0, 3 * sizeof *c->moved);
  for (size_t b = 0; b < c->blocks; b++)
    for (int a = 0; a < 3; a++)
      c->moved[3 * (size_t)c->list.pair[b][1] + a] += c->solution[c->list.pair[b][0]] * c->WJ[b][a];
}

/* residual = w of every equation, correction = the sum of the sizes of its terms. */
static void find_slack(hk_constraints *c, const double *q) {
  find_moved(c);
  for (size_t k = 0; k < c->equations; k++) {
    c->residual[k] = q[k];
    c->correction[k] = fabs(q[k]);
  }
  for (size_t b = 0; b < c->blocks; b++) {
    const double *at = c->moved + 3 * (size_t)c->list.pair[b][1];
    c->residual[c->list.pair[b][0]] += dot(c->J[b], at);
    c->correction[c->list.pair[b][0]] += sqrt(dot(c->J[b], c->J[b]) * dot(at, at));
  }
}

static double largest_multiplier(const hk_constraints *c) {
  double most = 0;
  for (size_t k = 0; k < c->equations; k++)
    if (c->scale[k] > 0) most = fmax(most, fabs(c->solution[k]) / c->scale[k]);
  return most;
}

/* Changes the part of equations that pull or are broken; false: there are none. */
static bool exchange(hk_constraints *c, const double *q, bool all) {
  double least = -rounding * largest_multiplier(c);
  bool any = false;
  find_slack(c, q);
  for (size_t k = 0; k < c->equations && (all || !any); k++) {
    if (!c->allowed[k] || c->held[k] || c->full[k] == 0) continue;
    bool wrong = c->rests[k] ? c->residual[k] < -rounding * c->correction[k] : c->solution[k] < least * c->scale[k];
    if (wrong) c->rests[k] = !c->rests[k];
    any |= wrong;
  }
  return any;
}

static hk_status solve_acting(hk_dynamics *d, const double *q, bool factorized) {
  hk_constraints *c = d->constraints;
  hk_status status = factorized ? HK_OK : hk_constraint_matrix_factorize(d);
  for (size_t k = 0; k < c->equations; k++) c->rhs[k] = -q[k];
  return status == HK_OK ? hk_constraint_matrix_solve(d) : status;
}

hk_status hk_active_set_solve(hk_dynamics *d, const double *q, bool factorized) {
  hk_constraints *c = d->constraints;
  if (c->one_sided_count == 0) return solve_acting(d, q, factorized);
  for (size_t k = 0; k < c->equations; k++)
    c->rests[k] = c->one_sided[k] ? !c->held[k] && !(c->allowed[k] && q[k] < 0) : c->implied[k];
  for (int round = 0; round < MOST_ROUNDS; round++) {
    hk_constraint_matrix_rest(c);
    hk_status status = solve_acting(d, q, false);
    if (status != HK_OK || !exchange(c, q, round < ROUNDS_OF_ALL)) return status;
  }
  return hk_error_set(d->error, HK_NOT_CONVERGED,
                      "which of %zu one-sided constraints push cannot be found in %d rounds", c->one_sided_count,
                      MOST_ROUNDS);
}

/* ---- equalities that follow from others ---- */

typedef struct column {
  size_t count, capacity;
  struct {
    uint32_t row;
    double value;
  } * entry;
} column;

typedef struct factor {
  size_t rows;
  column *column;
  double *pivot, *x;
  uint32_t *parent, *mark, *stack;
  bool no_memory;
} factor;

/* The columns of row r of L, as they have to be taken: rising from stack[top]. */
static size_t reach(factor *f, const hk_matrix *A, uint32_t r) {
  size_t top = f->rows;
  f->mark[r] = r;
  for (size_t e = A->row_start[r]; e < A->row_start[r + 1] && A->column[e] < r; e++) {
    size_t length = 0;
    f->x[A->column[e]] = A->value[e];
    for (uint32_t j = A->column[e]; f->mark[j] != r; j = f->parent[j]) {
      f->stack[length++] = j;
      f->mark[j] = r;
      if (f->parent[j] == UINT32_MAX) f->parent[j] = r;
    }
    while (length > 0) f->stack[--top] = f->stack[--length];
  }
  return top;
}

static void append(factor *f, column *to, uint32_t row, double value) {
  void *entry = to->entry;
  f->no_memory |= hk_array_reserve(&entry, &to->capacity, to->count + 1, sizeof *to->entry) != 0;
  to->entry = entry;
  if (f->no_memory) return;
  to->entry[to->count].row = row;
  to->entry[to->count++].value = value;
}

/* The pivot of row r without the rows that are implied. */
static double eliminate(factor *f, const hk_matrix *A, uint32_t r, const bool *implied) {
  double pivot = 0;
  for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
    if (A->column[e] == r) pivot = A->value[e];
  for (size_t p = reach(f, A, r); p < f->rows && !f->no_memory; p++) {
    uint32_t j = f->stack[p];
    double value = f->x[j];
    f->x[j] = 0;
    if (implied[j]) continue;
    value /= f->pivot[j];
    for (size_t e = 0; e < f->column[j].count; e++)
      f->x[f->column[j].entry[e].row] -= f->column[j].entry[e].value * value;
    pivot -= value * value;
    append(f, &f->column[j], r, value);
  }
  return pivot;
}

hk_status hk_active_set_independent(hk_dynamics *d, const hk_matrix *A, bool *implied) {
  size_t m = A->rows;
  factor f = {m,
              calloc(m + 1, sizeof *f.column),
              calloc(m + 1, sizeof(double)),
              calloc(m + 1, sizeof(double)),
              malloc((m + 1) * sizeof(uint32_t)),
              malloc((m + 1) * sizeof(uint32_t)),
              malloc((m + 1) * sizeof(uint32_t)),
              false};
  f.no_memory = !f.column || !f.pivot || !f.x || !f.parent || !f.mark || !f.stack;
  for (size_t k = 0; k < m && !f.no_memory; k++) f.parent[k] = f.mark[k] = UINT32_MAX;
  for (uint32_t r = 0; r < m && !f.no_memory; r++) {
    double pivot = eliminate(&f, A, r, implied);
    implied[r] = pivot <= no_pivot;
    f.pivot[r] = implied[r] ? 1 : sqrt(pivot);
  }
  for (size_t k = 0; k < m && f.column; k++) free(f.column[k].entry);
  void *arrays[] = {f.column, f.pivot, f.x, f.parent, f.mark, f.stack};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  return f.no_memory ? hk_error_set(d->error, HK_NO_MEMORY, "no memory to compare %zu constraints", m) : HK_OK;
}
