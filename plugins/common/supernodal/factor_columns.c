/* Several right-hand sides: the factor as plugins/common/linear/triangular.h reads it, which solves four at a time. */
#include "plugins/common/supernodal/supernodal.h"

/* Index arrays of a view of L, in numbers. */
typedef struct shape {
  int64_t *first, *list, *rows; /* supernodes, and one more of `first` */
  int64_t *column, *order;      /* unknowns */
  int64_t *row;
} shape;

static size_t rows_of(const hk_supernode *n) { return (size_t)n->columns + n->rows; }

/* One block of memory for all of them, or NULL. */
static int64_t *allocate(const hk_supernodal *s, shape *t) {
  const hk_supernodes *nodes = &s->nodes;
  size_t n = nodes->rows * nodes->block, rows = 0;
  for (size_t k = 0; k < nodes->count; k++) rows += nodes->block * rows_of(&nodes->node[k]);
  int64_t *all = s->host->allocate(s->host, (3 * nodes->count + 1 + 2 * n + rows) * sizeof *all);
  if (!all) return NULL;
  t->first = all;
  t->list = t->first + nodes->count + 1;
  t->rows = t->list + nodes->count;
  t->column = t->rows + nodes->count;
  t->order = t->column + n;
  t->row = t->order + n;
  return all;
}

/* Lists a supernode's columns and the rows below, from position `at` on; returns the position after them. */
static int64_t list_node(const hk_supernodes *nodes, size_t k, const shape *t, int64_t at) {
  const hk_supernode *n = &nodes->node[k];
  size_t b = nodes->block, begin = b * n->first, count = b * n->columns;
  t->first[k] = (int64_t)begin;
  t->list[k] = at;
  t->rows[k] = (int64_t)(b * rows_of(n));
  for (size_t c = 0; c < count; c++) {
    t->column[begin + c] = (int64_t)(n->panel + n->ld * c + n->top);
    t->row[at++] = (int64_t)(begin + c);
  }
  for (size_t r = 0; r < b * n->rows; r++) t->row[at++] = (int64_t)(b * nodes->row[n->list + r / b] + r % b);
  return at;
}

static hk_factor_view view_of(const hk_supernodal *s, const shape *t) {
  const hk_supernodes *nodes = &s->nodes;
  size_t b = nodes->block, n = nodes->rows * b;
  int64_t at = 0;
  for (size_t k = 0; k < nodes->count; k++) at = list_node(nodes, k, t, at);
  t->first[nodes->count] = (int64_t)n;
  for (size_t k = 0; k < n; k++) t->order[k] = (int64_t)(b * nodes->order[k / b] + k % b);
  return (hk_factor_view){n, nodes->count, t->first, t->list, t->rows, t->row, t->column, s->L, t->order};
}

static hk_status copy(hk_supernodal *s) {
  shape t;
  int64_t *memory = allocate(s, &t);
  if (memory) {
    hk_factor_view view = view_of(s, &t);
    if (!s->columns) s->columns = hk_triangular_create(s->host, &view);
    if (s->columns) hk_triangular_fill(s->columns, &view);
    s->host->release(s->host, memory);
  }
  s->copied = memory && s->columns;
  if (s->copied) return HK_OK;
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory to copy a factor of %zu rows", s->nodes.rows * s->nodes.block);
}

hk_status hk_supernodal_solve_columns(hk_supernodal *s, const double *b, double *x, size_t columns) {
  hk_status status = s->copied ? HK_OK : copy(s);
  if (status == HK_OK) hk_triangular_solve(s->columns, b, x, columns);
  return status;
}
