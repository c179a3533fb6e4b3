/* The rows of an implicit step's matrix that a solver gets. A pinned particle that no force joins to others, such as
 * each of a pinned body's surface, has a row and a column with nothing but its diagonal, s x = b: its solution is b/s.
 * With it in the matrix, such rows make solvers slower in proportion to the body, and the order of elimination, so that
 * the motion's last digits, depend on what nothing touches.
 *
 * Invariant: after hk_coupled_rows_of the map is that of the pattern `of` with the pins `held`. */
#include "core/numerics/implicit/implicit.h"

#include <stdlib.h>
#include <string.h>

static bool is_held(const hk_dynamics *d, size_t i) {
  unsigned pin = d->state->pin[i];
  return pin == HK_PIN_FIXED || pin == HK_PIN_PATH || pin == HK_PIN_RIDES;
}

void hk_coupled_rows_free(hk_coupled_rows *s) {
  free(s->row);
  free(s->place);
  free(s->held);
  free(s->row_start);
  free(s->column);
  free(s->value);
  free(s->scale);
  free(s->b);
  *s = (hk_coupled_rows){0};
}

static bool is_known(const hk_coupled_rows *s, const hk_dynamics *d, const hk_matrix *A, uint64_t number) {
  if (s->of != number || s->rows != A->rows || s->block != A->block || !s->held) return false;
  for (size_t r = 0; r < A->rows; r++)
    if (s->held[r] != is_held(d, r)) return false;
  return true;
}

/* place[r]: 1 where row r is joined to another one, or free. */
static void mark(hk_coupled_rows *s, const hk_dynamics *d, const hk_matrix *A) {
  for (size_t r = 0; r < A->rows; r++) {
    s->held[r] = is_held(d, r);
    s->place[r] = !s->held[r];
  }
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
      if (A->column[e] != r) s->place[r] = s->place[A->column[e]] = 1;
}

static void number_rows(hk_coupled_rows *s, const hk_matrix *A) {
  for (size_t r = 0; r < A->rows; r++) {
    if (!s->place[r]) continue;
    s->place[r] = (uint32_t)s->count;
    s->row[s->count++] = (uint32_t)r;
  }
  for (size_t k = 0; k < s->count; k++) {
    const uint32_t *column = A->column + A->row_start[s->row[k]];
    size_t entries = A->row_start[s->row[k] + 1] - A->row_start[s->row[k]];
    for (size_t e = 0; e < entries; e++) s->column[s->row_start[k] + e] = s->place[column[e]];
    s->row_start[k + 1] = s->row_start[k] + entries;
  }
}

static hk_status build(hk_coupled_rows *s, hk_dynamics *d, const hk_matrix *A, uint64_t number) {
  size_t rows = A->rows, entries = A->row_start[rows];
  hk_coupled_rows_free(s);
  s->rows = rows;
  s->block = A->block;
  s->row = malloc((rows + 1) * sizeof *s->row);
  s->place = malloc((rows + 1) * sizeof *s->place);
  s->held = malloc(rows + 1);
  s->row_start = calloc(rows + 2, sizeof *s->row_start);
  s->column = malloc((entries + 1) * sizeof *s->column);
  if (!s->row || !s->place || !s->held || !s->row_start || !s->column) {
    hk_coupled_rows_free(s);
    return hk_error_set(d->error, HK_NO_MEMORY, "no memory for the matrix of %zu particles", rows);
  }
  mark(s, d, A);
  number_rows(s, A);
  s->of = number;
  s->number = hk_pattern_number(s->count, A->block, s->row_start, s->column);
  return HK_OK;
}

static hk_status copy_values(hk_coupled_rows *s, hk_dynamics *d, const hk_matrix *A) {
  size_t bb = A->block * A->block;
  if (!s->value) s->value = malloc((bb * s->row_start[s->count] + 1) * sizeof *s->value);
  if (!s->scale) s->scale = malloc((s->rows + 1) * sizeof *s->scale);
  if (!s->value || !s->scale)
    return hk_error_set(d->error, HK_NO_MEMORY, "no memory for the matrix of %zu particles", s->rows);
  for (size_t k = 0; k < s->count; k++)
    memcpy(s->value + bb * s->row_start[k], A->value + bb * A->row_start[s->row[k]],
           bb * (s->row_start[k + 1] - s->row_start[k]) * sizeof *s->value);
  for (size_t r = 0, k = 0; r < s->rows; r++) {
    bool kept = k < s->count && s->row[k] == r;
    k += kept;
    if (!kept) s->scale[r] = A->value[bb * A->row_start[r]];
  }
  return HK_OK;
}

hk_status hk_coupled_rows_of(hk_coupled_rows *s, hk_dynamics *d, const hk_matrix *A, hk_matrix *out) {
  uint64_t number = A->pattern ? A->pattern : hk_pattern_number(A->rows, A->block, A->row_start, A->column);
  hk_status status = HK_OK;
  if (!is_known(s, d, A, number)) status = build(s, d, A, number);
  if (status != HK_OK) return status;
  *out = *A;
  if (s->count == s->rows) return HK_OK;
  if (A->value) status = copy_values(s, d, A);
  *out = (hk_matrix){s->count, A->block, s->row_start, s->column, s->value, A->symmetric, s->number};
  return status;
}

hk_status hk_coupled_rows_solve(hk_coupled_rows *s, hk_dynamics *d, hk_linear_system *linear, const double *b,
                                double *x, size_t columns, hk_solve_info *info) {
  bool one = columns == 1, all = s->count == s->rows;
  size_t width = s->block * columns, room = width * s->count;
  if (all && one) return hk_linear_system_solve(d, linear, b, x, info);
  if (all) return hk_linear_system_solve_columns(d, linear, b, x, columns);
  if (s->room < room) {
    free(s->b);
    s->b = malloc((2 * room + 1) * sizeof *s->b);
    s->room = s->b ? room : 0;
    if (!s->b) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for %zu right-hand sides", columns);
  }
  double *solution = s->b + room;
  for (size_t k = 0; k < s->count; k++) memcpy(s->b + width * k, b + width * s->row[k], width * sizeof *b);
  hk_status status = one ? hk_linear_system_solve(d, linear, s->b, solution, info)
                         : hk_linear_system_solve_columns(d, linear, s->b, solution, columns);
  for (size_t r = 0, k = 0; r < s->rows && status == HK_OK; r++) {
    bool kept = k < s->count && s->row[k] == r;
    for (size_t e = 0; e < width; e++)
      x[width * r + e] = kept ? solution[width * k + e] : b[width * r + e] / s->scale[r];
    k += kept;
  }
  return status;
}
