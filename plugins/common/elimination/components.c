/* Components are found by a search from each row that has not been reached, and rows are sorted by component, which
 * keeps them rising. The graph of a component is that of the positions of its rows, so that strands which were made in
 * the same way are equal wherever their rows are; equal ones are found by a hash and then compared with the first of
 * their class. Time and memory are linear in the blocks of A. */
#include "plugins/common/elimination/components.h"

#include <string.h>

static const uint32_t unknown = UINT32_MAX;

/* Numbers the component of every row; `queue` has A->rows entries. */
static size_t number_rows(const hk_matrix *A, uint32_t *component, uint32_t *queue) {
  size_t count = 0;
  for (size_t r = 0; r < A->rows; r++) component[r] = unknown;
  for (size_t r = 0; r < A->rows; r++) {
    if (component[r] != unknown) continue;
    size_t head = 0, tail = 0;
    component[r] = (uint32_t)count;
    queue[tail++] = (uint32_t)r;
    while (head < tail) {
      uint32_t from = queue[head++];
      for (size_t e = A->row_start[from]; e < A->row_start[from + 1]; e++) {
        uint32_t to = A->column[e];
        if (component[to] != unknown) continue;
        component[to] = (uint32_t)count;
        queue[tail++] = to;
      }
    }
    count++;
  }
  return count;
}

/* `start` has count + 2 entries, of which the last is used here alone. */
static void sort_rows(hk_components *c, size_t rows, const uint32_t *component) {
  memset(c->start, 0, (c->count + 2) * sizeof *c->start);
  for (size_t r = 0; r < rows; r++) c->start[component[r] + 2]++;
  for (size_t k = 0; k < c->count; k++) c->start[k + 2] += c->start[k + 1];
  for (size_t r = 0; r < rows; r++) c->row[c->start[component[r] + 1]++] = (uint32_t)r;
  for (size_t k = 0; k < c->count; k++)
    for (size_t p = c->start[k]; p < c->start[k + 1]; p++) c->local[c->row[p]] = (uint32_t)(p - c->start[k]);
}

static uint64_t hash_of(const hk_components *c, const hk_matrix *A, size_t k) {
  uint64_t hash = 1469598103934665603u;
  for (size_t p = c->start[k]; p < c->start[k + 1]; p++) {
    size_t r = c->row[p];
    hash = (hash ^ (A->row_start[r + 1] - A->row_start[r])) * 0x9E3779B97F4A7C15u + (hash >> 29);
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
      hash = (hash ^ c->local[A->column[e]]) * 0x9E3779B97F4A7C15u + (hash >> 29);
  }
  return hash;
}

static bool equal(const hk_components *c, const hk_matrix *A, size_t a, size_t b) {
  size_t n = c->start[a + 1] - c->start[a];
  if (c->start[b + 1] - c->start[b] != n) return false;
  for (size_t p = 0; p < n; p++) {
    size_t r = c->row[c->start[a] + p], s = c->row[c->start[b] + p], i = A->row_start[r], j = A->row_start[s];
    if (A->row_start[r + 1] - i != A->row_start[s + 1] - j) return false;
    for (; i < A->row_start[r + 1]; i++, j++)
      if (c->local[A->column[i]] != c->local[A->column[j]]) return false;
  }
  return true;
}

/* Finds the classes with a table of `size` (a power of 2 above `count`) heads of classes, searched by open addressing.
 */
static void classify(hk_components *c, const hk_matrix *A, uint32_t *table, size_t size) {
  memset(table, 0xff, size * sizeof *table);
  for (size_t k = 0; k < c->count; k++) {
    size_t at = hash_of(c, A, k) % size;
    while (table[at] != unknown && !equal(c, A, c->first[table[at]], k)) at = (at + 1) % size;
    if (table[at] == unknown) {
      table[at] = (uint32_t)c->classes;
      c->first[c->classes++] = (uint32_t)k;
    }
    c->kind[k] = table[at];
  }
}

hk_components hk_components_find(const hk_host *host, const hk_matrix *A) {
  hk_components c = {.status = HK_NO_MEMORY};
  uint32_t *component = host->allocate(host, A->rows * sizeof *component), *table = NULL;
  size_t size = 2;
  c.row = host->allocate(host, A->rows * sizeof *c.row);
  c.local = host->allocate(host, A->rows * sizeof *c.local);
  if (component && c.row && c.local) {
    c.count = number_rows(A, component, c.row);
    while (size <= c.count) size *= 2;
    c.start = host->allocate(host, (c.count + 2) * sizeof *c.start);
    c.kind = host->allocate(host, c.count * sizeof *c.kind);
    c.first = host->allocate(host, c.count * sizeof *c.first);
    table = host->allocate(host, size * sizeof *table);
  }
  if (c.start && c.kind && c.first && table) {
    sort_rows(&c, A->rows, component);
    classify(&c, A, table, size);
    c.status = HK_OK;
  }
  host->release(host, component);
  host->release(host, table);
  return c;
}

void hk_components_free(hk_components *c, const hk_host *host) {
  void *arrays[] = {c->start, c->row, c->local, c->kind, c->first};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) host->release(host, arrays[k]);
  *c = (hk_components){0};
}
