/* Rows are eliminated in the reverse of the order in which a search by breadth from the middle of the component reaches
 * them (Cuthill and McKee 1969; George and Liu 1981, Computer solution of large sparse positive definite systems,
 * chapters 4 and 5). On a tree every row then comes before the one that is left of its neighbours, so L has no fill; on
 * a band its columns are as long as the band is wide. From the middle, and not from an end as usual, because the two
 * halves of a chain do not depend on each other, and a processor works on both while it waits for the divisions of one.
 * A search from an end comes first, rows with few neighbours first, as usual; that from the middle reaches those first
 * which are nearest in it, so that both halves of a band are in order.
 *
 * The blocks of L are those of A and of the eliminated columns: column j passes its rows on to the first of them, its
 * parent in the elimination tree. */
#include "plugins/common/elimination/elimination.h"

#include <stdlib.h>
#include <string.h>

enum { NEAR = 64 };

typedef struct graph {
  const hk_matrix *A;
  const hk_components *c;
  const uint32_t *row; /* n: rows of the component */
  size_t n;
} graph;

static size_t degree(const graph *g, uint32_t p) {
  size_t r = g->row[p];
  return g->A->row_start[r + 1] - g->A->row_start[r];
}

/* What a position that is reached from p is sorted by: its neighbours, or how far it is from p by `rank`. */
static size_t key(const graph *g, const uint32_t *rank, uint32_t p, uint32_t q) {
  if (!rank) return degree(g, q);
  return rank[q] > rank[p] ? rank[q] - rank[p] : rank[p] - rank[q];
}

/* Appends the neighbours of p that have no level to the queue, sorted by their key; where they are more than a band
 * has, each goes at most `NEAR` places forward, so that the time stays linear. */
static size_t reach(const graph *g, const uint32_t *rank, uint32_t p, uint32_t *level, uint32_t *queue, size_t tail) {
  size_t r = g->row[p], from = tail;
  for (size_t e = g->A->row_start[r]; e < g->A->row_start[r + 1]; e++) {
    uint32_t q = g->c->local[g->A->column[e]];
    if (level[q] != UINT32_MAX) continue;
    level[q] = level[p] + 1;
    size_t at = tail++, own = key(g, rank, p, q);
    for (; at > from && at + NEAR > tail && key(g, rank, p, queue[at - 1]) > own; at--) queue[at] = queue[at - 1];
    queue[at] = q;
  }
  return tail;
}

/* Search by breadth from p: the queue is the order in which positions are reached. */
static void search(const graph *g, const uint32_t *rank, uint32_t p, uint32_t *level, uint32_t *queue) {
  memset(level, 0xff, g->n * sizeof *level);
  level[p] = 0;
  queue[0] = p;
  for (size_t head = 0, tail = 1; head < tail; head++) tail = reach(g, rank, queue[head], level, queue, tail);
}

/* The position half way from p to the start of the search that found its level. */
static uint32_t half_way(const graph *g, uint32_t p, const uint32_t *level) {
  uint32_t half = level[p] / 2;
  while (level[p] > half) {
    size_t e = g->A->row_start[g->row[p]];
    while (level[g->c->local[g->A->column[e]]] + 1 != level[p]) e++;
    p = g->c->local[g->A->column[e]];
  }
  return p;
}

/* The position that a search reaches last is at an end, and the way from there to the last one of the next search is a
 * longest one or nearly so. */
static void find_order(const graph *g, uint32_t *order, uint32_t *level, uint32_t *rank) {
  search(g, NULL, 0, level, order);
  search(g, NULL, order[g->n - 1], level, order);
  for (size_t k = 0; k < g->n; k++) rank[order[k]] = (uint32_t)k;
  search(g, rank, half_way(g, order[g->n - 1], level), level, order);
  for (size_t k = 0; k < g->n / 2; k++) {
    uint32_t p = order[k];
    order[k] = order[g->n - 1 - k];
    order[g->n - 1 - k] = p;
  }
}

/* ---- the blocks of L ---- */

typedef struct builder {
  graph g;
  hk_elimination *s;
  uint32_t *place;        /* n: when a position is eliminated */
  uint32_t *mark;         /* n: the last column that has the row */
  uint32_t *child, *next; /* n: lists of the children in the elimination tree; UINT32_MAX: the end */
  size_t capacity, limit; /* of s->row; most updates */
  const hk_host *host;
} builder;

static int rising(const void *a, const void *b) {
  uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

static bool append(builder *b, uint32_t row, size_t *at) {
  hk_elimination *s = b->s;
  if (*at == b->capacity) {
    uint32_t *longer = b->host->allocate(b->host, 2 * b->capacity * sizeof *longer);
    if (!longer) return false;
    memcpy(longer, s->row, b->capacity * sizeof *longer);
    b->host->release(b->host, s->row);
    s->row = longer;
    b->capacity *= 2;
  }
  s->row[(*at)++] = row;
  return true;
}

/* Appends the rows of block row p that are eliminated after column j, and are not there yet. */
static bool append_row(builder *b, size_t j, size_t *at) {
  size_t r = b->g.row[b->s->order[j]];
  for (size_t e = b->g.A->row_start[r]; e < b->g.A->row_start[r + 1]; e++) {
    uint32_t i = b->place[b->g.c->local[b->g.A->column[e]]];
    if (i <= j || b->mark[i] == j) continue;
    b->mark[i] = (uint32_t)j;
    if (!append(b, i, at)) return false;
  }
  return true;
}

static bool append_child(builder *b, size_t j, uint32_t child, size_t *at) {
  for (uint32_t p = b->s->start[child] + 2; p < b->s->start[child + 1]; p++) {
    uint32_t i = b->s->row[p];
    if (b->mark[i] == j) continue;
    b->mark[i] = (uint32_t)j;
    if (!append(b, i, at)) return false;
  }
  return true;
}

static hk_status find_columns(builder *b) {
  hk_elimination *s = b->s;
  size_t at = 0;
  memset(b->mark, 0xff, s->n * sizeof *b->mark);
  memset(b->child, 0xff, s->n * sizeof *b->child);
  for (size_t j = 0; j < s->n; j++) {
    s->start[j] = (uint32_t)at;
    bool fine = append(b, (uint32_t)j, &at) && append_row(b, j, &at);
    for (uint32_t c = b->child[j]; fine && c != UINT32_MAX; c = b->next[c]) fine = append_child(b, j, c, &at);
    if (!fine) return HK_NO_MEMORY;
    size_t below = at - s->start[j] - 1;
    s->updates += below * (below + 1) / 2;
    if (s->updates > b->limit) return HK_FAILED;
    if (below == 0) continue;
    uint32_t *first = s->row + s->start[j] + 1, parent;
    qsort(first, below, sizeof *first, rising);
    parent = *first;
    b->next[j] = b->child[parent];
    b->child[parent] = (uint32_t)j;
  }
  s->start[s->n] = (uint32_t)at;
  return HK_OK;
}

/* The rows of column j below row k are rows of column k. */
static void find_targets(hk_elimination *s) {
  uint32_t *to = s->target;
  for (size_t j = 0; j < s->n; j++)
    for (uint32_t q = s->start[j] + 1; q < s->start[j + 1]; q++) {
      uint32_t at = s->start[s->row[q]];
      for (uint32_t p = q; p < s->start[j + 1]; p++) {
        while (s->row[at] != s->row[p]) at++;
        *to++ = at;
      }
    }
}

/* Of the two blocks of a pair, the one in the row that is eliminated later is read: it is that of L. */
static void find_sources(const builder *b) {
  hk_elimination *s = b->s;
  memset(s->origin, 0xff, s->start[s->n] * sizeof *s->origin);
  for (size_t p = 0; p < s->n; p++) {
    size_t r = b->g.row[p];
    for (size_t e = b->g.A->row_start[r]; e < b->g.A->row_start[r + 1]; e++) {
      uint32_t i = b->place[p], j = b->place[b->g.c->local[b->g.A->column[e]]], at = s->start[j];
      if (i < j) continue;
      while (s->row[at] != i) at++;
      s->origin[at] = (hk_origin){(uint32_t)p, (uint32_t)(e - b->g.A->row_start[r])};
    }
  }
}

static hk_status fill_in(builder *b) {
  hk_elimination *s = b->s;
  s->target = b->host->allocate(b->host, (s->updates + 1) * sizeof *s->target);
  s->origin = b->host->allocate(b->host, s->start[s->n] * sizeof *s->origin);
  if (!s->target || !s->origin) return HK_NO_MEMORY;
  find_targets(s);
  find_sources(b);
  return HK_OK;
}

hk_elimination hk_elimination_find(const hk_host *host, const hk_matrix *A, const hk_components *c, size_t k,
                                   size_t most) {
  size_t n = c->start[k + 1] - c->start[k];
  hk_elimination s = {.n = n, .status = HK_NO_MEMORY};
  builder b = {.g = {A, c, c->row + c->start[k], n}, .s = &s, .capacity = 4 * n, .limit = most, .host = host};
  uint32_t *scratch = host->allocate(host, 4 * n * sizeof *scratch);
  s.order = host->allocate(host, n * sizeof *s.order);
  s.start = host->allocate(host, (n + 1) * sizeof *s.start);
  s.row = host->allocate(host, b.capacity * sizeof *s.row);
  if (scratch && s.order && s.start && s.row) {
    b.place = scratch, b.mark = scratch + n, b.child = scratch + 2 * n, b.next = scratch + 3 * n;
    find_order(&b.g, s.order, b.mark, b.place);
    for (size_t j = 0; j < n; j++) b.place[s.order[j]] = (uint32_t)j;
    s.status = find_columns(&b);
    if (s.status == HK_OK) s.status = fill_in(&b);
  }
  host->release(host, scratch);
  return s;
}

void hk_elimination_free(hk_elimination *s, const hk_host *host) {
  void *arrays[] = {s->order, s->start, s->row, s->target, s->origin};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) host->release(host, arrays[k]);
  *s = (hk_elimination){0};
}
