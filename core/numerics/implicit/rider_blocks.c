/* Jacobians of forces on riders: with all riders T x of the others, K of the others gets T^T K T, so the block (i, j)
 * goes to the blocks of the carriers of i and of j, times both weights (a congruence: what is symmetric or definite
 * stays so). Forces name and fill blocks of riders; these are carried over, in order, and riders keep none. */
#include "core/numerics/implicit/implicit.h"

#include <stdlib.h>
#include <string.h>

/* The carriers of a particle and their weights: of what is no rider, itself. */
static hk_rider carriers_of(const hk_model *m, uint32_t i) {
  const hk_rider *r = hk_model_rider(m, i);
  return r ? *r : (hk_rider){.particle = i, .carriers = 1, .carrier = {i}, .weight = {1}};
}

void hk_implicit_name_carriers(const hk_dynamics *d, hk_implicit_matrix *s) {
  const hk_model *m = &d->state->model;
  size_t named = m->riders ? s->matrix.named : 0;
  for (size_t e = 0; e < named && !s->matrix.no_memory; e++) {
    uint32_t i = s->matrix.pair[e][0], j = s->matrix.pair[e][1];
    if (m->pin[i] != HK_PIN_RIDES && m->pin[j] != HK_PIN_RIDES) continue;
    hk_rider row = carriers_of(m, i), column = carriers_of(m, j);
    for (uint32_t p = 0; p < row.carriers; p++)
      for (uint32_t q = 0; q < column.carriers; q++)
        s->matrix.naming.block(&s->matrix.naming, row.carrier[p], column.carrier[q]);
  }
}

/* The position of a block that is there. */
static size_t find(const hk_block_matrix *m, uint32_t row, uint32_t column) {
  size_t low = m->row_start[row], high = m->row_start[row + 1];
  while (low + 1 < high) {
    size_t middle = (low + high) / 2;
    if (m->column[middle] <= column)
      low = middle;
    else
      high = middle;
  }
  return low;
}

static void carry_block(const hk_model *m, hk_implicit_matrix *s, uint32_t i, size_t e) {
  hk_rider row = carriers_of(m, i), column = carriers_of(m, s->matrix.column[e]);
  for (uint32_t p = 0; p < row.carriers; p++)
    for (uint32_t q = 0; q < column.carriers; q++) {
      size_t to = find(&s->matrix, row.carrier[p], column.carrier[q]);
      double weight = row.weight[p] * column.weight[q];
      for (size_t a = 0; a < 9; a++) s->K[9 * to + a] += weight * s->K[9 * e + a];
      for (size_t a = 0; a < 9; a++) s->D[9 * to + a] += weight * s->D[9 * e + a];
    }
  memset(s->K + 9 * e, 0, 9 * sizeof *s->K);
  memset(s->D + 9 * e, 0, 9 * sizeof *s->D);
}

void hk_implicit_carry_over(const hk_dynamics *d, hk_implicit_matrix *s) {
  const hk_model *m = &d->state->model;
  for (uint32_t i = 0; m->riders && i < s->matrix.rows; i++)
    for (size_t e = s->matrix.row_start[i]; e < s->matrix.row_start[i + 1]; e++)
      if (m->pin[i] == HK_PIN_RIDES || m->pin[s->matrix.column[e]] == HK_PIN_RIDES) carry_block(m, s, i, e);
}
