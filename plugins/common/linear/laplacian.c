/* The matrix of a mass-spring network in which a spring is a weight between two particles, whatever its direction
 * (a weighted graph Laplacian plus masses). The pattern is made by listing both neighbours of every edge, sorting each
 * row and dropping what occurs twice; the edges keep where their entries are, so that new weights cost one pass. It is
 * symmetric, and positive definite when every component has a mass or a held particle. Sums run over the edges in their
 * order: results do not depend on threads. */
#include "plugins/common/linear/laplacian.h"

#include <stdlib.h>
#include <string.h>

static int rising(const void *a, const void *b) {
  uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
  return (p > q) - (p < q);
}

/* Rows with the diagonal and all neighbours, repeated ones too; then sorted, without what is twice. */
static void list_neighbours(hk_laplacian *l, size_t n, size_t edges, const uint32_t (*pair)[2]) {
  size_t *start = l->row_start, *at = l->diagonal, kept = 0;
  for (size_t i = 0; i < n; i++) start[i + 1] = 1;
  for (size_t e = 0; e < edges; e++)
    for (int k = 0; k < 2; k++) start[pair[e][k] + 1]++;
  for (size_t i = 0; i < n; i++) start[i + 1] += start[i];
  for (size_t i = 0; i < n; i++) {
    at[i] = start[i];
    l->column[at[i]++] = (uint32_t)i;
  }
  for (size_t e = 0; e < edges; e++)
    for (int k = 0; k < 2; k++) l->column[at[pair[e][k]]++] = pair[e][!k];
  for (size_t i = 0, begin = 0; i < n; i++) {
    size_t end = start[i + 1], first = kept;
    qsort(l->column + begin, end - begin, sizeof *l->column, rising);
    for (size_t e = begin; e < end; e++)
      if (kept == first || l->column[kept - 1] != l->column[e]) l->column[kept++] = l->column[e];
    begin = end;
    start[i + 1] = kept;
  }
}

static size_t find(const hk_laplacian *l, uint32_t row, uint32_t column) {
  size_t low = l->row_start[row], high = l->row_start[row + 1] - 1;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (l->column[middle] < column)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

hk_status hk_laplacian_build(hk_laplacian *l, const hk_host *host, size_t n, size_t edges, const uint32_t (*pair)[2]) {
  hk_laplacian_release(l, host);
  l->row_start = host->allocate(host, (n + 1) * sizeof *l->row_start);
  l->diagonal = host->allocate(host, (n + 1) * sizeof *l->diagonal);
  l->column = host->allocate(host, (n + 2 * edges + 1) * sizeof *l->column);
  l->slot = host->allocate(host, (edges + 1) * sizeof *l->slot);
  l->pair = host->allocate(host, (edges + 1) * sizeof *l->pair);
  if (!l->row_start || !l->diagonal || !l->column || !l->slot || !l->pair)
    return host->fail(host, HK_NO_MEMORY, "no memory for a matrix of %zu particles and %zu springs", n, edges);
  list_neighbours(l, n, edges, pair);
  double *value = host->allocate(host, (l->row_start[n] + 1) * sizeof *value);
  if (!value) return host->fail(host, HK_NO_MEMORY, "no memory for a matrix of %zu entries", l->row_start[n]);
  for (size_t i = 0; i < n; i++) l->diagonal[i] = find(l, (uint32_t)i, (uint32_t)i);
  for (size_t e = 0; e < edges; e++)
    for (int k = 0; k < 2; k++) {
      l->pair[e][k] = pair[e][k];
      l->slot[e][k] = find(l, pair[e][k], pair[e][!k]);
    }
  l->edges = edges;
  l->matrix = (hk_matrix){n, 1, l->row_start, l->column, value, true, 0};
  return HK_OK;
}

void hk_laplacian_release(hk_laplacian *l, const hk_host *host) {
  host->release(host, l->row_start);
  host->release(host, l->diagonal);
  host->release(host, l->column);
  host->release(host, l->slot);
  host->release(host, l->pair);
  host->release(host, l->matrix.value);
  *l = (hk_laplacian){0};
}

void hk_laplacian_fill(hk_laplacian *l, const double *mass, const double *inverse_mass, const double *weight) {
  double *value = l->matrix.value;
  memset(value, 0, l->row_start[l->matrix.rows] * sizeof *value);
  for (size_t i = 0; i < l->matrix.rows; i++) value[l->diagonal[i]] = inverse_mass[i] > 0 ? mass[i] : 1;
  for (size_t e = 0; e < l->edges; e++) {
    bool moves[2] = {inverse_mass[l->pair[e][0]] > 0, inverse_mass[l->pair[e][1]] > 0};
    for (int k = 0; k < 2; k++) {
      if (moves[k]) value[l->diagonal[l->pair[e][k]]] += weight[e];
      if (moves[0] && moves[1]) value[l->slot[e][k]] -= weight[e];
    }
  }
}
