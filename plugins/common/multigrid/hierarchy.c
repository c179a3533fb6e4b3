/* See hierarchy.h. Each level is the Galerkin product of the one before, by smoothed aggregation with a translation of
 * every aggregate in each direction as near-null space (Vanek, Mandel and Brezina, Computing 56 (1996)); a solver knows
 * no positions, so there are no rotations. The last level of some hundred rows is factorized.
 *
 * The smoother is Chebyshev's polynomial of D^-1 A with D the diagonal blocks, before and behind the coarse correction
 * the same, so that the cycle is symmetric; it is positive definite as long as `most` bounds the eigenvalues of D^-1 A
 * (Adams, Brezina, Hu and Tuminaro, J. Comput. Phys. 188 (2003)). It is made of products and sums of vectors alone,
 * which have the same bits for any number of threads. Rows that are joined to none (fixed particles) are solved by D
 * alone: nothing reaches them from another row. */
#include "plugins/common/multigrid/hierarchy.h"
#include "plugins/common/cholesky/block_order.h"
#include "plugins/common/linear/incomplete_cholesky.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 4096, SPARE = 8, DEGREE = 2, LOOKS = 12, DIRECT = 1000, MOST_DIRECT = 20000 };

/* strength: of joints within aggregates on the finest level, half of it on each further one; lowest: of the eigenvalues
 * that the smoother damps, as part of `most`. Iterations to 1e-6 and the time with set-up for a cloth of 256 x 256 and
 * of 512 x 512 (tests/bench/multigrid.c): strength 0.03 21, 1.25 s and 29, 7.3 s; 0.14 17, 1.2 s and 16, 5.0 s;
 * polynomials of degree 1 take 22 and 22 in the same time, of degree 3 one less than of 2 and a quarter longer. */
static const double strength = 0.14, lowest = 0.15, margin = 1.1, worth = 0.7;

hk_status hk_hierarchy_open(hk_hierarchy *h, const hk_host *host) {
  h->host = host;
  return hk_supernodal_open(&h->coarsest, host, false);
}

static void free_level(hk_hierarchy *h, size_t k) {
  hk_level *l = &h->level[k];
  if (k > 0) hk_coarse_free(&l->A, h->host);
  hk_upper_free(&l->upper, h->host);
  hk_transfer_free(&l->P, h->host);
  h->host->release(h->host, l->inverse);
  h->host->release(h->host, l->vectors);
  *l = (hk_level){0};
}

static void forget(hk_hierarchy *h) {
  for (size_t k = 0; k < HK_LEVELS; k++) free_level(h, k);
  h->host->release(h->host, h->part);
  h->part = NULL;
  h->levels = 0;
  h->direct = false;
}

void hk_hierarchy_close(hk_hierarchy *h) {
  if (!h->host) return;
  forget(h);
  hk_supernodal_close(&h->coarsest);
}

/* ---- vectors of a level ---- */

static size_t numbers(const hk_level *l) { return l->A.rows * l->A.block; }

typedef struct task {
  const hk_level *l;
  double a, b;
  const double *from;
  double *to, *part;
} task;

/* d = a d + b D^-1 r, x += d, by rows */
static void step_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_level *l = t->l;
  size_t w = l->A.block;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    const double *D = l->inverse + w * w * k, *r = l->r + w * k;
    for (size_t i = 0; i < w; i++) {
      double sum = 0;
      for (size_t j = 0; j < w; j++) sum += D[w * i + j] * r[j];
      l->d[w * k + i] = t->a * l->d[w * k + i] + t->b * sum;
      l->x[w * k + i] += l->d[w * k + i];
    }
  }
}

/* to = from - to */
static void subtract(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) t->to[k] = t->from[k] - t->to[k];
}

static void multiply_add(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  double sum = 0;
  for (size_t k = begin; k < end; k++) sum += t->from[k] * t->to[k];
  t->part[chunk] = sum;
}

static double inner_product(const hk_hierarchy *h, const double *x, const double *y, size_t count) {
  task t = {.from = x, .to = (double *)y, .part = h->part};
  double sum = 0;
  h->host->parallel_for(h->host, count, CHUNK, multiply_add, &t);
  for (size_t k = 0; k < (count + CHUNK - 1) / CHUNK; k++) sum += h->part[k];
  return sum;
}

/* r = b - A x */
static void find_residual(const hk_hierarchy *h, const hk_level *l) {
  task t = {.from = l->b, .to = l->r};
  hk_upper_product(l->use, h->host, l->x, l->r);
  h->host->parallel_for(h->host, numbers(l), CHUNK, subtract, &t);
}

/* ---- the cycle ---- */

/* Saad, Iterative methods, algorithm 12.1, preconditioned by D. `zero`: x is zero. */
static void smooth(const hk_hierarchy *h, const hk_level *l, bool zero) {
  double high = margin * l->most, low = lowest * l->most, center = (high + low) / 2, radius = (high - low) / 2;
  double sigma = center / radius, rho = 1 / sigma;
  task t = {.l = l, .a = 0, .b = 1 / center};
  for (int k = 0; k < DEGREE; k++) {
    if (k > 0) {
      double next = 1 / (2 * sigma - rho);
      t.a = next * rho;
      t.b = 2 * next / radius;
      rho = next;
    }
    if (k == 0 && zero)
      memcpy(l->r, l->b, numbers(l) * sizeof *l->r);
    else
      find_residual(h, l);
    h->host->parallel_for(h->host, l->A.rows, CHUNK / 4, step_rows, &t);
  }
}

static void cycle(hk_hierarchy *h, size_t k) {
  hk_level *l = &h->level[k];
  if (k + 1 == h->levels && h->direct) {
    hk_supernodal_solve(&h->coarsest, l->b, l->x);
    return;
  }
  memset(l->x, 0, numbers(l) * sizeof *l->x);
  smooth(h, l, true);
  if (k + 1 < h->levels) {
    find_residual(h, l);
    hk_transfer_restrict(&l->P, h->host, l->r, h->level[k + 1].b);
    cycle(h, k + 1);
    hk_transfer_prolong(&l->P, h->host, h->level[k + 1].x, l->x);
  }
  smooth(h, l, false);
}

double hk_hierarchy_apply(hk_hierarchy *h, const double *r, double *z) {
  hk_level *l = &h->level[0];
  size_t count = numbers(l);
  memcpy(l->b, r, count * sizeof *r);
  cycle(h, 0);
  memcpy(z, l->x, count * sizeof *z);
  return inner_product(h, r, z, count);
}

/* ---- levels ---- */

static hk_status no_memory(const hk_hierarchy *h) {
  return h->host->fail(h->host, HK_NO_MEMORY, "no memory for the levels of a matrix of %zu rows",
                       numbers(&h->level[0]));
}

static hk_status not_definite(const hk_hierarchy *h, size_t level, size_t row) {
  if (level > 0 || h->level[0].A.block != 3)
    return h->host->fail(h->host, HK_NOT_CONVERGED, "the matrix is not positive definite, seen at row %zu of level %zu",
                         row + 1, level + 1);
  return h->host->fail(h->host, HK_NOT_CONVERGED,
                       "the matrix is not positive definite, seen at the %zuth particle's %c: the step is too long for "
                       "a force that pushes apart",
                       row / 3 + 1, "xyz"[row % 3]);
}

static hk_status invert_diagonal(hk_hierarchy *h, size_t k) {
  hk_level *l = &h->level[k];
  size_t b = l->A.block, bb = b * b;
  for (size_t r = 0; r < l->A.rows; r++) {
    size_t e = hk_upper_first(&l->A, r);
    if (e == l->A.row_start[r + 1] || l->A.column[e] != r) return not_definite(h, k, b * r);
    const double *D = l->A.value + bb * e;
    size_t done = hk_invert_definite(b, D, D, 0, l->inverse + bb * r);
    if (done < b) return not_definite(h, k, b * r + done);
  }
  return HK_OK;
}

/* Numbers in [-1/2, 1/2) that depend on k alone. */
static double noise(size_t k) {
  uint64_t bits = ((uint64_t)k + 1) * 6364136223846793005u;
  bits = (bits ^ (bits >> 32)) * 0x9E3779B97F4A7C15u;
  return (double)(bits >> 11) * 0x1p-53 - 0.5;
}

/* The largest eigenvalue of D^-1 A by the power method: Rayleigh quotients x.A x / x.D x, from below. x and D x are
 * x and b of the level; D^-1 A x comes by the smoother's step. */
static void find_most(hk_hierarchy *h, hk_level *l) {
  size_t count = numbers(l);
  l->most = 1;
  for (size_t k = 0; k < count; k++) l->x[k] = noise(k);
  for (int look = 0; look < LOOKS; look++) {
    task t = {.l = l, .a = 0, .b = 1};
    double whole = inner_product(h, l->x, l->x, count), scale = whole > 0 ? 1 / sqrt(whole) : 0;
    for (size_t k = 0; k < count; k++) l->b[k] = scale * l->x[k];
    hk_upper_product(l->use, h->host, l->b, l->r);
    memset(l->x, 0, count * sizeof *l->x);
    h->host->parallel_for(h->host, l->A.rows, CHUNK / 4, step_rows, &t);
    double norm = sqrt(inner_product(h, l->x, l->x, count));
    if (norm > l->most) l->most = norm;
  }
}

static hk_status prepare(hk_hierarchy *h, size_t k) {
  hk_level *l = &h->level[k];
  size_t count = numbers(l) + SPARE;
  l->inverse = h->host->allocate(h->host, (numbers(l) * l->A.block + 1) * sizeof *l->inverse);
  l->vectors = h->host->allocate(h->host, 4 * count * sizeof *l->vectors);
  if (!l->inverse || !l->vectors) return no_memory(h);
  l->x = l->vectors;
  l->b = l->x + count;
  l->r = l->b + count;
  l->d = l->r + count;
  if (!l->use) {
    if (hk_upper_analyze(&l->upper, h->host, &l->A) != HK_OK) return no_memory(h);
    hk_upper_fill(&l->upper, h->host, &l->A);
    l->use = &l->upper;
  }
  hk_status status = invert_diagonal(h, k);
  if (status == HK_OK) find_most(h, l);
  return status;
}

/* The next level; *more: there is one. */
static hk_status coarsen(hk_hierarchy *h, size_t k, bool *more) {
  hk_level *l = &h->level[k], *next = &h->level[k + 1];
  const hk_host *host = h->host;
  uint32_t *aggregate = host->allocate(host, (l->A.rows + 1) * sizeof *aggregate);
  hk_status status = aggregate ? HK_OK : no_memory(h);
  size_t count = aggregate ? hk_aggregate(&l->A, strength / (double)(1 << k), aggregate, l->x) : 0;
  *more = count > 0 && (double)count < worth * (double)l->A.rows;
  if (*more && status == HK_OK &&
      (hk_transfer_build(&l->P, host, &l->A, l->inverse, 4 / (3 * margin * l->most), aggregate, count) != HK_OK ||
       hk_transfer_galerkin(&l->P, host, &l->A, &next->A) != HK_OK))
    status = no_memory(h);
  host->release(host, aggregate);
  return status;
}

static hk_status factorize_last(hk_hierarchy *h) {
  hk_level *l = &h->level[h->levels - 1];
  if (l->A.rows > MOST_DIRECT) return HK_OK;
  hk_status status = hk_supernodal_analyze(&h->coarsest, &l->A, HK_ORDER_AMD);
  if (status == HK_OK) status = hk_supernodal_factorize(&h->coarsest, &l->A);
  h->direct = status == HK_OK;
  return status;
}

hk_status hk_hierarchy_build(hk_hierarchy *h, const hk_matrix *A, const hk_upper *upper) {
  forget(h);
  h->level[0].A = *A;
  h->level[0].use = upper;
  h->part = h->host->allocate(h->host, (numbers(&h->level[0]) / CHUNK + 1) * sizeof *h->part);
  hk_status status = h->part ? HK_OK : no_memory(h);
  bool more = true;
  for (size_t k = 0; more && status == HK_OK; k++) {
    status = prepare(h, k);
    h->levels = k + 1;
    more = status == HK_OK && h->level[k].A.rows > DIRECT && k + 1 < HK_LEVELS;
    if (more) status = coarsen(h, k, &more);
  }
  return status == HK_OK ? factorize_last(h) : status;
}
