/* See supernodal.h. A supernode's front is the dense matrix of its columns and the rows below: the blocks of A there,
 * and what the updates of its children add. Its columns are factorized by dense loops (dense_loops.h), and the rest is
 * its own update for its parent. Branches of the tree (supernodes.h) are worked on by several threads, and so
 * are rows and columns of the fronts at the top; every front adds its children in their order: the same bits for any
 * number of threads.
 *
 * Where a matrix is not positive definite, none of the branches after the first bad one is needed, and that one has the
 * first turn of the next factorization: matrices of an implicit step lose their definiteness where a cloth is
 * compressed, and the next ones are likely to lose it there too. What has the first turn is known from the pattern and
 * the matrices so far, not from which thread was faster. Cloth of 64 x 64 of linear_bdf2, k = 1e8 N/m, 109 of 229
 * matrices: a factorization that fails takes 0.09 of one that does not; of all branches in a fixed order it took 0.40.
 *
 * Substitution goes forward through the branches, each with a vector of its own, from which the top takes the rows
 * above the branches in their order; and back from the top. Invariant: the rows of a branch's vector above it are zero
 * between calls. Duff and Reid, ACM TOMS 9 (1983); Liu, SIAM Review 34 (1992). */
#include "plugins/common/supernodal/supernodal.h"

#include <float.h>
#include <math.h>
#include <string.h>

hk_status hk_supernodal_open(hk_supernodal *s, const hk_host *host, bool single) {
  s->host = host;
  s->path = single ? hk_dense_single(host->lanes) : hk_dense_double(host->lanes);
  if (!cholmod_l_start(&s->common)) return host->fail(host, HK_FAILED, "CHOLMOD does not start");
  s->started = true;
  s->common.print = 0;
  s->common.error_handler = NULL;
  return HK_OK;
}

bool hk_supernodal_is_single(const hk_supernodal *s) { return s->path->number == sizeof(float); }

static void forget(hk_supernodal *s) {
  void **all[] = {&s->L, &s->inverse, &s->update, &s->vector, &s->front, &s->work};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    s->host->release(s->host, *all[k]);
    *all[k] = NULL;
  }
  s->host->release(s->host, s->bad);
  s->host->release(s->host, s->turn);
  s->host->release(s->host, s->work_at);
  s->bad = s->turn = s->work_at = NULL;
  hk_triangular_free(s->columns, s->host);
  s->columns = NULL;
  s->ready = false;
  hk_supernodes_free(&s->nodes, s->host);
}

void hk_supernodal_close(hk_supernodal *s) {
  if (!s->started) return;
  forget(s);
  cholmod_l_finish(&s->common);
  s->started = false;
}

static size_t unknowns(const hk_supernodal *s) { return s->nodes.rows * s->nodes.block; }

static const hk_supernode *nth(const hk_supernodal *s, size_t branch, uint32_t k) {
  return &s->nodes.node[branch + 1 == s->nodes.branches ? s->nodes.top[k] : k];
}

static void *at(const hk_supernodal *s, void *numbers, size_t position) {
  return (char *)numbers + position * s->path->number;
}

/* Where each branch has its memory for fronts; returns the numbers of all. */
static size_t lay_out_work(hk_supernodal *s) {
  size_t b = s->nodes.block, sum = 0;
  for (size_t k = 0; k < s->nodes.branches; k++) {
    size_t most = 0;
    for (uint32_t i = s->nodes.branch[k].begin; i < s->nodes.branch[k].end; i++) {
      const hk_supernode *n = nth(s, k, i);
      size_t work = hk_dense_front_work(b * n->columns, b * n->rows);
      if (work > most) most = work;
    }
    s->work_at[k] = sum;
    sum += most;
  }
  return sum;
}

static bool allocate(hk_supernodal *s) {
  const hk_host *host = s->host;
  size_t number = s->path->number, vector = HK_FRONT_VECTOR / number, branches = s->nodes.branches;
  s->stride = (unknowns(s) / vector + 2) * vector;
  s->front_stride = s->nodes.front + vector;
  s->L = host->allocate(host, (s->nodes.L_size + 1) * number);
  s->inverse = host->allocate(host, (unknowns(s) + 1) * number);
  s->update = host->allocate(host, (s->nodes.update_size + 1) * number);
  s->vector = host->allocate(host, branches * s->stride * number);
  s->front = host->allocate(host, branches * s->front_stride * number);
  s->bad = host->allocate(host, branches * sizeof *s->bad);
  s->turn = host->allocate(host, branches * sizeof *s->turn);
  s->work_at = host->allocate(host, branches * sizeof *s->work_at);
  if (!s->turn || !s->work_at) return false;
  for (size_t k = 0; k < branches; k++) s->turn[k] = k;
  s->work = host->allocate(host, (lay_out_work(s) + 1) * number);
  return s->work && s->L && s->inverse && s->update && s->vector && s->front && s->bad;
}

hk_status hk_supernodal_analyze(hk_supernodal *s, const hk_matrix *A, int ordering) {
  forget(s);
  hk_status status = hk_supernodes_analyze(&s->nodes, s->host, &s->common, A, ordering, s->path->number);
  if (status != HK_OK || allocate(s)) return status;
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory for a factor of %.3g numbers", s->nodes.entries);
}

/* ---- Factorization ---- */

static hk_dense_front front_at(const hk_supernodal *s, const hk_supernode *n, size_t branch) {
  size_t b = s->nodes.block;
  return (hk_dense_front){.host = s->host,
                          .path = s->path,
                          .panel = at(s, s->L, n->panel),
                          .inverse = at(s, s->inverse, b * n->first),
                          .update = at(s, s->update, n->update),
                          .work = at(s, s->work, s->work_at[branch]),
                          .ld = n->ld,
                          .top = n->top,
                          .columns = b * n->columns,
                          .outer = b * n->rows,
                          .ldu = n->ldu,
                          .on_all_threads = branch + 1 == s->nodes.branches};
}

/* The part of every child in the panel, or in the update. */
static void extend(const hk_supernodal *s, const hk_supernode *n, const hk_dense_front *f, bool panel) {
  const hk_supernodes *nodes = &s->nodes;
  for (size_t c = n->child; c < n->child_end; c++) {
    const hk_supernode *child = &nodes->node[nodes->child[c]];
    const void *from = at(s, s->update, child->update);
    if (panel)
      s->path->extend_panel(nodes, child, from, n, f->panel);
    else
      s->path->extend_update(nodes, child, from, n, f->update);
  }
}

/* Returns the row of the pivot that is not positive, or SIZE_MAX. */
static size_t factorize_front(const hk_supernodal *s, const hk_supernode *n, size_t branch) {
  hk_dense_front f = front_at(s, n, branch);
  size_t b = s->nodes.block;
  s->path->begin(&s->nodes, n, s->value, f.panel);
  extend(s, n, &f, true);
  size_t good = hk_dense_front_factorize(&f);
  if (good < f.columns) return b * s->nodes.order[n->first + good / b] + good % b;
  extend(s, n, &f, false);
  return SIZE_MAX;
}

static void factorize_branch(hk_supernodal *s, size_t branch) {
  hk_branch range = s->nodes.branch[branch];
  s->bad[branch] = SIZE_MAX;
  for (uint32_t k = range.begin; k < range.end && s->bad[branch] == SIZE_MAX; k++)
    s->bad[branch] = factorize_front(s, nth(s, branch, k), branch);
}

/* A turn that is left out comes after one that is bad, so the first bad one is always the same. */
static void take_turns(void *context, size_t begin, size_t end, size_t chunk) {
  hk_supernodal *s = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    size_t stop = atomic_load(&s->stop);
    if (k > stop) return;
    factorize_branch(s, s->turn[k]);
    if (s->bad[s->turn[k]] == SIZE_MAX) continue;
    while (k < stop && !atomic_compare_exchange_weak(&s->stop, &stop, k)) {
    }
  }
}

/* The branch of turn k has the first one from now on. */
static void bring_forward(hk_supernodal *s, size_t k) {
  size_t branch = s->turn[k];
  memmove(s->turn + 1, s->turn, k * sizeof *s->turn);
  s->turn[0] = branch;
}

static hk_status not_definite(const hk_supernodal *s, size_t row) {
  if (s->nodes.block != 3)
    return s->host->fail(s->host, HK_NOT_CONVERGED, "the matrix is not positive definite, seen at row %zu", row + 1);
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the matrix is not positive definite, seen at the %zuth particle's %c: the step is too long for "
                       "a force that pushes apart",
                       row / 3 + 1, "xyz"[row % 3]);
}

hk_status hk_supernodal_factorize(hk_supernodal *s, const hk_matrix *A) {
  const hk_supernodes *nodes = &s->nodes;
  size_t last = nodes->branches - 1;
  s->ready = s->copied = false;
  if (!s->L || A->rows != nodes->rows || A->block != nodes->block)
    return s->host->fail(s->host, HK_FAILED, "the pattern of the matrix was not analysed");
  s->value = A->value;
  atomic_store(&s->stop, SIZE_MAX);
  s->host->parallel_for(s->host, last, 1, take_turns, s);
  size_t stop = atomic_load(&s->stop);
  if (stop != SIZE_MAX) {
    bring_forward(s, stop);
    return not_definite(s, s->bad[s->turn[0]]);
  }
  factorize_branch(s, last);
  if (s->bad[last] != SIZE_MAX) return not_definite(s, s->bad[last]);
  s->ready = true;
  return HK_OK;
}

/* ---- Substitution ---- */

typedef struct substitution {
  hk_supernodal *s;
  const double *b;
  double *x;
  double scale; /* of b, so that floats hold it */
} substitution;

static void *vector_of(const hk_supernodal *s, size_t branch) { return at(s, s->vector, branch * s->stride); }
static void *front_of(const hk_supernodal *s, size_t branch) { return at(s, s->front, branch * s->front_stride); }

static void load(const substitution *t, size_t branch, void *vector) {
  const hk_supernodal *s = t->s;
  hk_branch range = s->nodes.branch[branch];
  for (uint32_t k = range.begin; k < range.end; k++)
    s->path->load(&s->nodes, nth(s, branch, k), t->b, t->scale, vector);
}

static void forward(const substitution *t, size_t branch) {
  hk_supernodal *s = t->s;
  hk_branch range = s->nodes.branch[branch];
  void *vector = vector_of(s, branch), *front = front_of(s, branch);
  for (uint32_t k = range.begin; k < range.end; k++) {
    const hk_supernode *n = nth(s, branch, k);
    s->path->forward(&s->nodes, n, at(s, s->L, n->panel), at(s, s->inverse, s->nodes.block * n->first), vector, front);
  }
}

static void backward(const substitution *t, size_t branch) {
  hk_supernodal *s = t->s;
  hk_branch range = s->nodes.branch[branch];
  void *vector = vector_of(s, s->nodes.branches - 1), *front = front_of(s, branch);
  for (uint32_t k = range.end; k-- > range.begin;) {
    const hk_supernode *n = nth(s, branch, k);
    s->path->backward(&s->nodes, n, at(s, s->L, n->panel), at(s, s->inverse, s->nodes.block * n->first), vector, front);
    s->path->store(&s->nodes, n, vector, 1 / t->scale, t->x);
  }
}

/* What a branch found goes to the top's vector, where its columns are its own. */
static void keep(const hk_supernodal *s, size_t branch) {
  hk_branch range = s->nodes.branch[branch];
  const hk_supernode *first = &s->nodes.node[range.begin], *last = &s->nodes.node[range.end - 1];
  size_t b = s->nodes.block, begin = b * first->first, count = b * (last->first + last->columns) - begin;
  memcpy(at(s, vector_of(s, s->nodes.branches - 1), begin), at(s, vector_of(s, branch), begin),
         count * s->path->number);
}

static void pass_on(const hk_supernodal *s, size_t branch) {
  hk_branch range = s->nodes.branch[branch];
  void *vector = vector_of(s, branch), *top = vector_of(s, s->nodes.branches - 1);
  for (uint32_t k = range.begin; k < range.end; k++) {
    const hk_supernode *n = &s->nodes.node[k];
    if (n->rows && n->parent >= range.end) s->path->pass_on(&s->nodes, n, vector, top);
  }
}

static void up(void *context, size_t begin, size_t end, size_t chunk) {
  const substitution *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    load(t, k, vector_of(t->s, k));
    forward(t, k);
    keep(t->s, k);
  }
}

static void down(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  for (size_t k = begin; k < end; k++) backward(context, k);
}

static double scale_of(const hk_supernodal *s, const double *b) {
  double most = 0;
  if (!hk_supernodal_is_single(s)) return 1;
  for (size_t k = 0; k < unknowns(s); k++) most = fmax(most, fabs(b[k]));
  return most > DBL_MIN ? 1 / most : 1;
}

void hk_supernodal_solve(hk_supernodal *s, const double *b, double *x) {
  substitution t = {s, b, x, scale_of(s, b)};
  size_t last = s->nodes.branches - 1;
  load(&t, last, vector_of(s, last));
  s->host->parallel_for(s->host, last, 1, up, &t);
  for (size_t k = 0; k < last; k++) pass_on(s, k);
  forward(&t, last);
  backward(&t, last);
  s->host->parallel_for(s->host, last, 1, down, &t);
}
