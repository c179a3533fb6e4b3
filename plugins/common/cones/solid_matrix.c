/* See solid_matrix.h. Bodies that touch are neighbours: they are counted, listed and sorted, and what stands twice is
 * closed up. */
#include "plugins/common/cones/solid_matrix.h"
#include "plugins/common/space/reserve.h"

#include <stdlib.h>
#include <string.h>

static const hk_solid_sides *sides_of(const void *first, size_t k, size_t stride) {
  return (const hk_solid_sides *)(const void *)((const char *)first + k * stride);
}

static bool joins(const hk_solid_sides *s) {
  return s->solid[0] != UINT32_MAX && s->solid[1] != UINT32_MAX && s->solid[0] != s->solid[1];
}

static int rising(const void *a, const void *b) {
  uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
  return (p > q) - (p < q);
}

static hk_status make_room(hk_solid_matrix *m, size_t solids, size_t most) {
  const hk_host *host = m->host;
  hk_status status = hk_reserve(host, &m->start, &m->start_room, solids + 1, sizeof *m->start);
  if (status == HK_OK) status = hk_reserve(host, &m->next, &m->next_room, solids + 1, sizeof *m->next);
  if (status == HK_OK) status = hk_reserve(host, &m->neighbour, &m->neighbour_room, most, sizeof *m->neighbour);
  if (status == HK_OK) status = hk_reserve(host, &m->row_start, &m->row_room, 2 * solids + 1, sizeof *m->row_start);
  if (status == HK_OK) status = hk_reserve(host, &m->column, &m->column_room, 4 * most, sizeof *m->column);
  return status == HK_OK ? hk_reserve(host, &m->value, &m->value_room, 36 * most, sizeof *m->value) : status;
}

/* Sorts the neighbours of each body and takes out what stands twice. */
static void close_up(hk_solid_matrix *m) {
  size_t to = 0;
  for (size_t a = 0, from = 0; a < m->solids; a++) {
    size_t end = m->start[a + 1];
    qsort(m->neighbour + from, end - from, sizeof *m->neighbour, rising);
    m->start[a] = to;
    for (size_t e = from; e < end; e++)
      if (e == from || m->neighbour[e] != m->neighbour[e - 1]) m->neighbour[to++] = m->neighbour[e];
    from = end;
  }
  m->start[m->solids] = to;
}

static void list_neighbours(hk_solid_matrix *m, const void *first, size_t count, size_t stride) {
  memset(m->start, 0, (m->solids + 1) * sizeof *m->start);
  for (size_t a = 0; a < m->solids; a++) m->start[a + 1] = 1;
  for (size_t k = 0; k < count; k++) {
    const hk_solid_sides *s = sides_of(first, k, stride);
    for (int side = 0; joins(s) && side < 2; side++) m->start[s->solid[side] + 1]++;
  }
  for (size_t a = 0; a < m->solids; a++) m->start[a + 1] += m->start[a];
  for (size_t a = 0; a < m->solids; a++) m->neighbour[m->start[a]] = (uint32_t)a, m->next[a] = 1;
  for (size_t k = 0; k < count; k++) {
    const hk_solid_sides *s = sides_of(first, k, stride);
    for (int side = 0; joins(s) && side < 2; side++) {
      uint32_t a = s->solid[side];
      m->neighbour[m->start[a] + m->next[a]++] = s->solid[1 - side];
    }
  }
  close_up(m);
}

hk_status hk_solid_matrix_shape(hk_solid_matrix *m, size_t solids, const void *first, size_t count, size_t stride) {
  hk_status status = make_room(m, solids, solids + 2 * count);
  if (status != HK_OK) return status;
  m->solids = solids;
  list_neighbours(m, first, count, stride);
  size_t at = 0;
  for (size_t r = 0; r < 2 * solids; r++) {
    m->row_start[r] = at;
    for (size_t e = m->start[r / 2]; e < m->start[r / 2 + 1]; e++)
      for (uint32_t j = 0; j < 2; j++) m->column[at++] = 2 * m->neighbour[e] + j;
  }
  m->row_start[2 * solids] = at;
  m->A = (hk_matrix){2 * solids, 3, m->row_start, m->column, m->value, true, 0};
  return HK_OK;
}

/* The place of the neighbour b in the rows of a. */
static size_t place_of(const hk_solid_matrix *m, uint32_t a, uint32_t b) {
  size_t low = m->start[a], high = m->start[a + 1];
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (m->neighbour[middle] < b)
      low = middle + 1;
    else
      high = middle;
  }
  return low - m->start[a];
}

/* block += A^T B, of the columns of A from i and those of B from j. */
static void add_product(double *block, const double (*A)[HK_SOLID_ROWS], size_t i, const double (*B)[HK_SOLID_ROWS],
                        size_t j) {
  double sum[9];
  memcpy(sum, block, sizeof sum);
  for (size_t r = 0; r < 3; r++)
    for (size_t p = 0; p < 3; p++)
      for (size_t q = 0; q < 3; q++) sum[3 * p + q] += A[r][i + p] * B[r][j + q];
  memcpy(block, sum, sizeof sum);
}

/* The 3 x 3 block in row 2 a + i and column 2 b + j. */
static double *block_at(hk_solid_matrix *m, uint32_t a, uint32_t b, size_t i, size_t j) {
  return m->value + 9 * (m->row_start[2 * (size_t)a + i] + 2 * place_of(m, a, b) + j);
}

void hk_solid_matrix_clear(hk_solid_matrix *m) {
  memset(m->value, 0, 9 * m->row_start[2 * m->solids] * sizeof *m->value);
  for (uint32_t a = 0; a < m->solids; a++)
    for (size_t i = 0; i < 2; i++)
      for (int c = 0; c < 9; c += 4) block_at(m, a, a, i, i)[c] = 1;
}

void hk_solid_matrix_add(hk_solid_matrix *m, const hk_solid_sides *s, const double C[9]) {
  for (int t = 0; t < 2; t++) {
    double CJ[3][HK_SOLID_ROWS];
    if (s->solid[t] == UINT32_MAX) continue;
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < HK_SOLID_ROWS; c++)
        CJ[r][c] = C[3 * r] * s->J[t][0][c] + C[3 * r + 1] * s->J[t][1][c] + C[3 * r + 2] * s->J[t][2][c];
    for (int u = 0; u < 2; u++)
      for (size_t i = 0; i < 2 && s->solid[u] != UINT32_MAX; i++) {
        double *block = block_at(m, s->solid[u], s->solid[t], i, 0);
        for (size_t j = 0; j < 2; j++)
          add_product(block + 9 * j, s->J[u], 3 * i, (const double(*)[HK_SOLID_ROWS])CJ, 3 * j);
      }
  }
}
