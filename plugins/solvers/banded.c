/* Direct factorization A = P^T L D L^T P of symmetric positive definite matrices whose graph is one of chains, strands,
 * trees, or narrow bands: then L has few blocks beside those of A, and the time per row is constant.
 *
 * Each connected component is ordered by itself (plugins/common/elimination/elimination.c: reverse Cuthill-McKee from
 * its middle, which is without fill on trees). Components with the same graph, such as the strands of a head of hair,
 * are factorized four at a time, a lane of the processor's registers for each; the rest one by one. Lanes and threads
 * have components of their own, so the bits do not depend on them.
 *
 * A matrix whose factor would take more than `most_updates` products of blocks per row, such as that of a large cloth,
 * is refused when it is analysed. The residual is not computed: it is that of a Cholesky factorization, rounding times
 * the size of A and x (Higham 2002, Accuracy and stability of numerical algorithms, theorem 10.4).
 *
 * Hair of 40 strands in six steps: 0.016 s in the solver, 0.23 by supernodal, 0.22 by cholmod (hooke run
 * scripts/scenes/hair.lua strands=40 --until 0.1 --solver NAME).
 */
#include "core/plugin.h"
#include "plugins/common/elimination/factor.h"

#include <string.h>

/* A band of b blocks beside the diagonal takes b (b + 1) / 2. */
static const size_t most_updates = 2000;
/* Up to this band it is the faster one (tests/bench/banded.c). */
static const size_t fitting_updates = 150;
/* A chunk of threads' work has some 1e5 operations, 50 us. */
static const size_t chunk_updates = 4000;

typedef struct banded {
  const hk_host *host;
  size_t rows, block; /* sizes of the analysed matrix */
  hk_components components;
  hk_elimination *elimination; /* components.classes */
  hk_bundle *bundle;
  size_t bundles, grain;
  bool *fault; /* bundles: whether A is not positive definite, or a solution is not finite */
  bool ready;  /* L is that of the last factorized values */
  const double *from;
  double *to;
} banded;

static void free_bundles(banded *s) {
  for (size_t k = 0; s->bundle && k < s->bundles; k++) {
    hk_bundle *b = &s->bundle[k];
    void *arrays[] = {b->row, b->origin, b->value, b->solution};
    for (size_t a = 0; a < sizeof arrays / sizeof *arrays; a++) s->host->release(s->host, arrays[a]);
  }
  s->host->release(s->host, s->bundle);
  s->host->release(s->host, s->fault);
  s->bundle = NULL;
  s->fault = NULL;
  s->bundles = 0;
}

static void drop(banded *s) {
  free_bundles(s);
  for (size_t k = 0; s->elimination && k < s->components.classes; k++) hk_elimination_free(&s->elimination[k], s->host);
  s->host->release(s->host, s->elimination);
  s->elimination = NULL;
  hk_components_free(&s->components, s->host);
  s->ready = false;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  (void)view;
  ((banded *)self)->host = host;
  return HK_OK;
}

static void destroy(void *self, const hk_host *host) {
  (void)host;
  if (((banded *)self)->host) drop(self);
}

/* ---- analysis ---- */

static hk_status no_memory(banded *s, const hk_matrix *A) {
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory for the factor of a matrix of %zu rows", A->rows * A->block);
}

static hk_status too_wide(banded *s, size_t n) {
  return s->host->fail(s->host, HK_FAILED,
                       "the matrix is no band: a part of %zu connected block rows takes more than %zu products of "
                       "blocks per row, which is for chains, strands and trees; choose another solver, such as cholmod",
                       n, most_updates);
}

static hk_status eliminate(banded *s, const hk_matrix *A) {
  const hk_components *c = &s->components;
  s->elimination = s->host->allocate(s->host, c->classes * sizeof *s->elimination);
  if (!s->elimination) return no_memory(s, A);
  for (size_t k = 0; k < c->classes; k++) {
    size_t n = c->start[c->first[k] + 1] - c->start[c->first[k]];
    s->elimination[k] = hk_elimination_find(s->host, A, c, c->first[k], most_updates * n);
    if (s->elimination[k].status == HK_FAILED) return too_wide(s, n);
    if (s->elimination[k].status != HK_OK) return no_memory(s, A);
  }
  return HK_OK;
}

/* Fills lane l with component k. */
static void take_component(const banded *s, const hk_matrix *A, hk_bundle *b, size_t l, size_t k) {
  const hk_elimination *e = b->elimination;
  const uint32_t *rows = s->components.row + s->components.start[k];
  for (size_t j = 0; j < e->n; j++) b->row[b->lanes * j + l] = rows[e->order[j]];
  for (size_t at = 0; at < e->start[e->n]; at++) {
    hk_origin from = e->origin[at];
    bool fill = from.position == UINT32_MAX;
    b->origin[b->lanes * at + l] = fill ? UINT32_MAX : (uint32_t)(A->row_start[rows[from.position]] + from.entry);
  }
}

static bool allocate_bundle(const banded *s, hk_bundle *b, size_t block) {
  size_t n = b->elimination->n * b->lanes, blocks = b->elimination->start[b->elimination->n] * b->lanes;
  b->row = s->host->allocate(s->host, n * sizeof *b->row);
  b->origin = s->host->allocate(s->host, blocks * sizeof *b->origin);
  b->value = s->host->allocate(s->host, blocks * block * block * sizeof *b->value);
  b->solution = s->host->allocate(s->host, n * block * sizeof *b->solution);
  return b->row && b->origin && b->value && b->solution;
}

/* Members of a class: list[start[kind]..start[kind + 1]], rising. On entry `start` is classes + 2 zeros. */
static void sort_by_class(const hk_components *c, size_t *start, uint32_t *list) {
  for (size_t k = 0; k < c->count; k++) start[c->kind[k] + 2]++;
  for (size_t k = 0; k < c->classes; k++) start[k + 2] += start[k + 1];
  for (size_t k = 0; k < c->count; k++) list[start[c->kind[k] + 1]++] = (uint32_t)k;
}

/* Packs `count` components of one class into bundles; a lone one has one lane. */
static bool pack(banded *s, const hk_matrix *A, const hk_elimination *e, const uint32_t *list, size_t count) {
  size_t lanes = count > 1 ? HK_LANES : 1;
  for (size_t k = 0; k < count; k += lanes) {
    hk_bundle *b = &s->bundle[s->bundles++];
    *b = (hk_bundle){.elimination = e, .lanes = lanes};
    if (!allocate_bundle(s, b, A->block)) return false;
    for (size_t l = 0; l < lanes; l++) take_component(s, A, b, l, list[k + l < count ? k + l : count - 1]);
  }
  return true;
}

static void choose_grain(banded *s) {
  size_t updates = 1;
  for (size_t k = 0; k < s->bundles; k++) {
    const hk_elimination *e = s->bundle[k].elimination;
    updates += (e->updates + e->start[e->n]) * s->bundle[k].lanes;
  }
  s->grain = 1 + chunk_updates * s->bundles / updates;
}

static bool bundle_up(banded *s, const hk_matrix *A) {
  const hk_components *c = &s->components;
  size_t *start = s->host->allocate(s->host, (c->classes + 2) * sizeof *start);
  uint32_t *list = s->host->allocate(s->host, c->count * sizeof *list);
  s->bundle = s->host->allocate(s->host, c->count * sizeof *s->bundle);
  s->fault = s->host->allocate(s->host, c->count * sizeof *s->fault);
  bool fine = start && list && s->bundle && s->fault;
  if (fine) sort_by_class(c, start, list);
  for (size_t k = 0; fine && k < c->classes; k++)
    fine = pack(s, A, &s->elimination[k], list + start[k], start[k + 1] - start[k]);
  s->host->release(s->host, start);
  s->host->release(s->host, list);
  choose_grain(s);
  return fine;
}

/* Finds the elimination of every class, until one takes too much, and forgets it again. */
static bool fits(void *self, const hk_matrix *A) {
  const banded *s = self;
  if (A->rows == 0 || A->row_start[A->rows] >= UINT32_MAX) return false;
  hk_components c = hk_components_find(s->host, A);
  bool fine = c.status == HK_OK;
  for (size_t k = 0; fine && k < c.classes; k++) {
    size_t n = c.start[c.first[k] + 1] - c.start[c.first[k]];
    hk_elimination e = hk_elimination_find(s->host, A, &c, c.first[k], fitting_updates * n);
    fine = e.status == HK_OK;
    hk_elimination_free(&e, s->host);
  }
  hk_components_free(&c, s->host);
  return fine;
}

static hk_status analyze(void *self, const hk_matrix *A) {
  banded *s = self;
  drop(s);
  s->rows = s->block = 0;
  if (A->row_start[A->rows] >= UINT32_MAX)
    return s->host->fail(s->host, HK_FAILED, "a matrix of %zu blocks is too large", A->row_start[A->rows]);
  if (A->rows > 0) {
    s->components = hk_components_find(s->host, A);
    if (s->components.status != HK_OK) return no_memory(s, A);
    hk_status status = eliminate(s, A);
    if (status != HK_OK) return status;
    if (!bundle_up(s, A)) return no_memory(s, A);
  }
  s->rows = A->rows;
  s->block = A->block;
  return HK_OK;
}

/* ---- factorization and solution ---- */

static void factorize_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  banded *s = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++)
    s->fault[k] = !hk_bundle_factorize(&s->bundle[k], s->host->lanes, s->block, s->from);
}

static const hk_bundle *first_fault(const banded *s) {
  for (size_t k = 0; k < s->bundles; k++)
    if (s->fault[k]) return &s->bundle[k];
  return NULL;
}

static hk_status refuse(banded *s, const hk_bundle *at) {
  bool finite;
  size_t row = hk_bundle_fault(at, s->block, &finite);
  if (!finite)
    return s->host->fail(s->host, HK_NOT_FINITE, "the matrix is not finite, seen at %s %zu",
                         s->block == 3 ? "particle" : "row", row / s->block + 1);
  if (s->block != 3)
    return s->host->fail(s->host, HK_NOT_CONVERGED, "the matrix is not positive definite, seen at row %zu", row + 1);
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the matrix is not positive definite, seen at the %zuth particle's %c: the step is too long for "
                       "a force that pushes apart",
                       row / 3 + 1, "xyz"[row % 3]);
}

static hk_status factorize(void *self, const hk_matrix *A) {
  banded *s = self;
  s->ready = false;
  if (A->rows != s->rows || A->block != s->block)
    return s->host->fail(s->host, HK_FAILED, "the pattern of the matrix was not analysed");
  s->from = A->value;
  s->host->parallel_for(s->host, s->bundles, s->grain, factorize_chunk, s);
  const hk_bundle *fault = first_fault(s);
  if (fault) return refuse(s, fault);
  s->ready = true;
  return HK_OK;
}

static void solve_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  banded *s = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++)
    s->fault[k] = !hk_bundle_solve(&s->bundle[k], s->host->lanes, s->block, s->from, s->to);
}

static hk_status solve(void *self, const double *b, double *x, hk_solve_info *info) {
  banded *s = self;
  if (!s->ready) return s->host->fail(s->host, HK_FAILED, "there is no factorization to solve with");
  s->from = b;
  s->to = x;
  s->host->parallel_for(s->host, s->bundles, s->grain, solve_chunk, s);
  if (first_fault(s)) return s->host->fail(s->host, HK_NOT_FINITE, "the solution of a linear system is not finite");
  if (info) info->iterations = 0;
  return HK_OK;
}

static const hk_solver solver = {
    .size = sizeof(hk_solver), .flags = 0, .analyze = analyze, .factorize = factorize, .solve = solve, .fits = fits};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SOLVER,
    .name = "banded",
    .summary = "A = P^T L D L^T P, component by component, for positive definite matrices of chains, strands and trees",
    .reference = "George and Liu 1981, Computer solution of large sparse positive definite systems, chapters 4 and 5; "
                 "Cuthill and McKee 1969",
    .instance_size = sizeof(banded),
    .create = create,
    .destroy = destroy,
    .solver = &solver,
};
