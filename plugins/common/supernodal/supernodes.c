/* See supernodes.h. Order and supernodes are CHOLMOD's, of the graph of blocks; what follows is here.
 *
 * Branches are independent, so they can be worked on at the same time: a supernode whose subtree takes more than a
 * SHARE of all operations is at the top; the subtrees between are collected until they are a share. The pattern alone
 * decides.
 *
 * Updates live from their supernode until its parent has added them. In an order that has children before parents those
 * of one parity of depth form a stack, as Liu has it, so each branch has two. */
#include "plugins/common/supernodal/supernodes.h"
#include "plugins/common/cholesky/block_order.h"

#include <string.h>

enum { SHARE = 16 };

static size_t in_vectors(size_t numbers, size_t vector) { return (numbers + vector - 1) / vector * vector; }

/* An odd number of vectors, so that neighbouring columns do not fall on the same place of a cache. */
static size_t column_length(size_t numbers, size_t vector) {
  return (in_vectors(numbers, vector) / vector | 1) * vector;
}

static hk_status no_memory(const hk_host *host, size_t rows) {
  return host->fail(host, HK_NO_MEMORY, "no memory to analyse a matrix of %zu rows", rows);
}

/* ---- the tree ---- */

static void take_nodes(hk_supernodes *s, const cholmod_factor *L) {
  const int64_t *first = L->super, *list = L->pi, *row = L->s;
  size_t below = 0;
  for (size_t k = 0; k < s->count; k++) {
    hk_supernode *n = &s->node[k];
    n->first = (uint32_t)first[k];
    n->columns = (uint32_t)(first[k + 1] - first[k]);
    n->rows = (uint32_t)(list[k + 1] - list[k]) - n->columns;
    n->list = below;
    for (uint32_t r = 0; r < n->rows; r++) s->row[below++] = (uint32_t)row[list[k] + n->columns + r];
  }
  for (size_t k = 0; k < s->rows; k++) s->order[k] = (uint32_t)((int64_t *)L->Perm)[k];
}

/* holder[r]: the supernode with column r. */
static void find_parents(hk_supernodes *s, uint32_t *holder) {
  for (uint32_t k = 0; k < s->count; k++)
    for (uint32_t c = 0; c < s->node[k].columns; c++) holder[s->node[k].first + c] = k;
  for (uint32_t k = 0; k < s->count; k++) {
    hk_supernode *n = &s->node[k];
    n->parent = n->rows ? holder[s->row[n->list]] : HK_NO_PARENT;
    if (n->rows) s->node[n->parent].child_end++;
  }
  size_t at = 0;
  for (uint32_t k = 0; k < s->count; k++) {
    hk_supernode *n = &s->node[k];
    n->child = at;
    at += n->child_end;
    n->child_end = n->child;
  }
  for (uint32_t k = 0; k < s->count; k++)
    if (s->node[k].rows) s->child[s->node[s->node[k].parent].child_end++] = k;
}

/* ---- branches ---- */

static double operations(const hk_supernode *n, double b) {
  double c = b * n->columns, r = b * n->rows;
  return c * c * c / 3 + c * c * r + c * r * r;
}

static bool is_top(const double *work, double whole, size_t k) { return SHARE * work[k] > whole; }

static void sum_up(hk_supernodes *s, double *work) {
  for (size_t k = 0; k < s->count; k++) {
    double own = operations(&s->node[k], (double)s->block);
    s->flops += own;
    work[k] += own;
    if (s->node[k].rows) work[s->node[k].parent] += work[k];
  }
}

static void close_branch(hk_supernodes *s, uint32_t *begin, uint32_t end) {
  if (*begin < end) s->branch[s->branches++] = (hk_branch){*begin, end};
  *begin = end;
}

/* work: of each subtree. */
static void find_branches(hk_supernodes *s, double *work) {
  double sum = 0;
  uint32_t top = 0, begin = 0;
  sum_up(s, work);
  for (uint32_t k = 0; k < s->count; k++) {
    if (is_top(work, s->flops, k)) {
      close_branch(s, &begin, k);
      s->top[top++] = k;
      begin = k + 1;
      sum = 0;
    } else if (!s->node[k].rows || is_top(work, s->flops, s->node[k].parent)) {
      sum += work[k];
      if (!(SHARE * sum > s->flops)) continue;
      close_branch(s, &begin, k + 1);
      sum = 0;
    }
  }
  close_branch(s, &begin, (uint32_t)s->count);
  s->branch[s->branches++] = (hk_branch){0, top};
}

/* ---- places ---- */

static void lay_out_panels(hk_supernodes *s, size_t vector) {
  for (size_t k = 0; k < s->count; k++) {
    hk_supernode *n = &s->node[k];
    size_t c = s->block * n->columns, r = s->block * n->rows;
    n->panel = s->L_size;
    n->top = (vector - c % vector) % vector;
    n->ld = column_length(n->top + c + r, vector);
    n->ldu = r ? column_length(r, vector) : 0;
    s->L_size += n->ld * c;
    s->entries += (double)c * (double)r + (double)c * (double)(c + 1) / 2;
    if (n->ld > s->front) s->front = n->ld;
  }
}

typedef struct stacks {
  size_t height[2], most[2];
} stacks;

static size_t update_numbers(const hk_supernodes *s, const hk_supernode *n) { return n->ldu * s->block * n->rows; }

/* Puts the update of k, in its stack, and takes away those of its children in [begin, k). */
static void stack_up(hk_supernodes *s, stacks *st, const uint8_t *parity, uint32_t k, const uint8_t *member) {
  hk_supernode *n = &s->node[k];
  int own = parity[k];
  n->update = st->height[own];
  st->height[own] += update_numbers(s, n);
  if (st->height[own] > st->most[own]) st->most[own] = st->height[own];
  for (size_t c = n->child; c < n->child_end; c++)
    if (member[s->child[c]] == member[k]) st->height[!own] -= update_numbers(s, &s->node[s->child[c]]);
}

static uint32_t nth(const hk_supernodes *s, size_t branch, uint32_t k) {
  return branch + 1 == s->branches ? s->top[k] : k;
}

static void lay_out_updates(hk_supernodes *s, uint8_t *parity, uint8_t *member) {
  for (size_t k = s->count; k-- > 0;) parity[k] = s->node[k].rows ? !parity[s->node[k].parent] : 0;
  for (uint32_t k = 0; k < s->branch[s->branches - 1].end; k++) member[s->top[k]] = 1;
  for (size_t b = 0; b < s->branches; b++) {
    stacks st = {{0}, {0}};
    hk_branch range = s->branch[b];
    for (uint32_t k = range.begin; k < range.end; k++) stack_up(s, &st, parity, nth(s, b, k), member);
    for (uint32_t k = range.begin; k < range.end; k++) {
      uint32_t at = nth(s, b, k);
      s->node[at].update += s->update_size + (parity[at] ? st.most[0] : 0);
    }
    s->update_size += st.most[0] + st.most[1];
  }
}

/* ---- where things go ---- */

/* Position of block row `row` in n's front, by binary search. */
static uint32_t place_in(const hk_supernodes *s, const hk_supernode *n, uint32_t row) {
  if (row < n->first + n->columns) return row - n->first;
  uint32_t low = 0, high = n->rows;
  while (low + 1 < high) {
    uint32_t middle = low + (high - low) / 2;
    if (s->row[n->list + middle] <= row)
      low = middle;
    else
      high = middle;
  }
  return n->columns + low;
}

/* At most one run per row. */
static void find_runs(hk_supernodes *s) {
  size_t at = 0;
  for (size_t k = 0; k < s->count; k++) {
    hk_supernode *n = &s->node[k];
    n->run = at;
    for (uint32_t r = 0; r < n->rows; r++) {
      uint32_t to = place_in(s, &s->node[n->parent], s->row[n->list + r]);
      hk_row_run *last = at > n->run ? &s->run[at - 1] : NULL;
      bool border = to == s->node[n->parent].columns; /* from panel to update */
      if (last && last->to + last->count == to && !border)
        last->count++;
      else
        s->run[at++] = (hk_row_run){r, to, 1};
    }
    n->run_end = at;
  }
}

/* Blocks on and below the diagonal of the permuted matrix; place: of A's rows in the factor. */
static void find_entries(hk_supernodes *s, const hk_matrix *A, const uint32_t *place) {
  size_t at = 0, b = s->block;
  for (size_t k = 0; k < s->count; k++) {
    hk_supernode *n = &s->node[k];
    n->entry = at;
    for (uint32_t c = 0; c < n->columns; c++) {
      uint32_t i = s->order[n->first + c];
      for (size_t e = A->row_start[i]; e < A->row_start[i + 1]; e++) {
        uint32_t row = place[A->column[e]];
        if (row < n->first + c) continue;
        s->entry[at++] = (hk_entry){e, n->ld * b * c + n->top + b * place_in(s, n, row)};
      }
    }
    n->entry_end = at;
  }
}

/* ---- memory ---- */

void hk_supernodes_free(hk_supernodes *s, const hk_host *host) {
  void *all[] = {s->node, s->branch, s->top, s->order, s->row, s->child, s->run, s->entry};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) host->release(host, all[k]);
  memset(s, 0, sizeof *s);
}

static bool allocate(hk_supernodes *s, const hk_host *host, const cholmod_factor *L, const hk_matrix *A) {
  size_t rows = A->rows + 1, nodes = L->nsuper + 1, list = (size_t)((int64_t *)L->pi)[L->nsuper] + 1;
  s->node = host->allocate(host, nodes * sizeof *s->node);
  s->branch = host->allocate(host, (nodes + 1) * sizeof *s->branch);
  s->top = host->allocate(host, nodes * sizeof *s->top);
  s->order = host->allocate(host, rows * sizeof *s->order);
  s->row = host->allocate(host, list * sizeof *s->row);
  s->child = host->allocate(host, nodes * sizeof *s->child);
  s->run = host->allocate(host, list * sizeof *s->run);
  s->entry = host->allocate(host, (A->row_start[A->rows] + 1) * sizeof *s->entry);
  return s->node && s->branch && s->top && s->order && s->row && s->child && s->run && s->entry;
}

static hk_status build(hk_supernodes *s, const hk_host *host, const cholmod_factor *L, const hk_matrix *A,
                       size_t number) {
  uint32_t *place = host->allocate(host, (A->rows + 1) * sizeof *place);
  double *work = host->allocate(host, (L->nsuper + 1) * sizeof *work);
  uint8_t *marks = host->allocate(host, 2 * L->nsuper + 1);
  bool fine = allocate(s, host, L, A) && place && work && marks;
  if (fine) {
    s->rows = A->rows;
    s->block = A->block;
    s->count = L->nsuper;
    take_nodes(s, L);
    find_parents(s, place);
    find_branches(s, work);
    lay_out_panels(s, HK_FRONT_VECTOR / number);
    lay_out_updates(s, marks, marks + s->count);
    find_runs(s);
    for (uint32_t k = 0; k < s->rows; k++) place[s->order[k]] = k;
    find_entries(s, A, place);
  }
  host->release(host, place);
  host->release(host, work);
  host->release(host, marks);
  return fine ? HK_OK : no_memory(host, A->rows * A->block);
}

hk_status hk_supernodes_analyze(hk_supernodes *s, const hk_host *host, cholmod_common *common, const hk_matrix *A,
                                int ordering, size_t number) {
  hk_supernodes_free(s, host);
  common->supernodal = CHOLMOD_SUPERNODAL;
  cholmod_factor *L = hk_block_order(common, A, ordering);
  if (!L && common->status == CHOLMOD_OUT_OF_MEMORY) return no_memory(host, A->rows * A->block);
  if (!L)
    return host->fail(host, HK_FAILED, "cannot analyse a matrix of %zu rows (CHOLMOD status %d)", A->rows * A->block,
                      common->status);
  hk_status status = build(s, host, L, A, number);
  cholmod_l_free_factor(&L, common);
  return status;
}
