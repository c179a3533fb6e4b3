/* Aggregates in three passes over the rows in their order, as Vanek, Mandel and Brezina have them (Computing 56 (1996),
 * algorithm 5.1): rows whose neighbours are all free, with these; what is left and has a neighbour in such an
 * aggregate, with the one to which it is joined most strongly; what is left then, with its free neighbours. */
#include "plugins/common/multigrid/transfer.h"

typedef struct joints {
  const hk_matrix *A;
  double limit;     /* the fourth power of the strength */
  double *diagonal; /* rows: |A_ii|^2 */
} joints;

static double square_norm(const hk_matrix *A, size_t e) {
  size_t bb = A->block * A->block;
  double sum = 0;
  for (size_t k = 0; k < bb; k++) sum += A->value[bb * e + k] * A->value[bb * e + k];
  return sum;
}

/* |A_ij|^2 relative to |A_ii| |A_jj|, squared; 0 where that is weak, and on the diagonal. */
static double joint(const joints *j, size_t row, size_t e) {
  uint32_t column = j->A->column[e];
  if (column == row) return 0;
  double norm = square_norm(j->A, e), strength = norm * norm, scale = j->diagonal[row] * j->diagonal[column];
  return strength > j->limit * scale ? strength / scale : 0;
}

enum { NO_NEIGHBOURS, FREE, TOUCHED };

static int neighbourhood(const joints *j, size_t row, const uint32_t *aggregate) {
  int state = NO_NEIGHBOURS;
  for (size_t e = j->A->row_start[row]; e < j->A->row_start[row + 1]; e++) {
    if (!(joint(j, row, e) > 0)) continue;
    if (aggregate[j->A->column[e]] != UINT32_MAX) return TOUCHED;
    state = FREE;
  }
  return state;
}

static void take_free(const joints *j, size_t row, uint32_t *aggregate, uint32_t name) {
  aggregate[row] = name;
  for (size_t e = j->A->row_start[row]; e < j->A->row_start[row + 1]; e++)
    if (joint(j, row, e) > 0 && aggregate[j->A->column[e]] == UINT32_MAX) aggregate[j->A->column[e]] = name;
}

/* That of the strongest neighbour with a name below `first`: marks are skipped, so that rows which join an aggregate
 * draw no others after them. UINT32_MAX: there is none. */
static uint32_t nearest(const joints *j, size_t row, const uint32_t *aggregate, uint32_t first) {
  uint32_t found = UINT32_MAX;
  double most = 0;
  for (size_t e = j->A->row_start[row]; e < j->A->row_start[row + 1]; e++) {
    double strength = joint(j, row, e);
    if (!(strength > most) || aggregate[j->A->column[e]] >= first) continue;
    most = strength;
    found = aggregate[j->A->column[e]];
  }
  return found;
}

static void find_diagonal(joints *j) {
  for (size_t r = 0; r < j->A->rows; r++) {
    j->diagonal[r] = 0;
    for (size_t e = j->A->row_start[r]; e < j->A->row_start[r + 1]; e++)
      if (j->A->column[e] == r) j->diagonal[r] = square_norm(j->A, e);
  }
}

size_t hk_aggregate(const hk_matrix *A, double strength, uint32_t *aggregate, double *work) {
  joints j = {A, strength * strength * strength * strength, work};
  uint32_t count = 0, first;
  find_diagonal(&j);
  for (size_t r = 0; r < A->rows; r++) aggregate[r] = UINT32_MAX;
  for (size_t r = 0; r < A->rows; r++)
    if (aggregate[r] == UINT32_MAX && neighbourhood(&j, r, aggregate) == FREE) take_free(&j, r, aggregate, count++);
  first = count;
  for (size_t r = 0; r < A->rows; r++) {
    uint32_t name = aggregate[r] == UINT32_MAX ? nearest(&j, r, aggregate, first) : UINT32_MAX;
    if (name != UINT32_MAX) aggregate[r] = first + name; /* a mark */
  }
  for (size_t r = 0; r < A->rows; r++)
    if (aggregate[r] != UINT32_MAX && aggregate[r] >= first) aggregate[r] -= first;
  for (size_t r = 0; r < A->rows; r++)
    if (aggregate[r] == UINT32_MAX && neighbourhood(&j, r, aggregate) != NO_NEIGHBOURS)
      take_free(&j, r, aggregate, count++);
  return count;
}
