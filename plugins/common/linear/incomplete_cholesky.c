/* Incomplete Cholesky factorization without fill, IC(0), on 3x3 or 1x1 blocks: M = (I + W)^T D (I + W), where updates
 * outside of A's pattern are dropped. Where a pivot block is not safely positive, the diagonal is raised by a factor 1
 * + shift and the domain is factorized again (Manteuffel 1980, An incomplete factorization technique for positive
 * definite linear systems, Math. Comp. 34). Domains are factorized and solved independently of each other, so that
 * several threads can be used; the division into domains depends on the number of rows only. W is kept in single
 * precision: M is symmetric and positive definite for any rounding of W, and half as much memory is read. */
#include "plugins/common/linear/incomplete_cholesky.h"
#include "plugins/common/linear/block_vector.h"
#include "plugins/common/linear/upper_matrix.h"

#include <string.h>

enum { DOMAIN_LEAST = 8192, DOMAINS_MOST = 16 };

static const double least_pivot = 1e-3; /* relative to the diagonal; smaller pivots make M a useless preconditioner */
static const double first_shift = 1e-3, last_shift = 1e3; /* doubled in between */

typedef float single __attribute__((vector_size(16), aligned(4), may_alias));

size_t hk_invert_definite(size_t b, const double *A, const double *scale, double least, double *inverse) {
  double d0 = A[0];
  if (!(d0 > least * scale[0] && isfinite(1 / d0))) return 0;
  if (b == 1) {
    inverse[0] = 1 / d0;
    return b;
  }
  double l10 = A[1] / d0, l20 = A[2] / d0, d1 = A[4] - l10 * A[1];
  if (!(d1 > least * scale[4] && isfinite(1 / d1))) return 1;
  double u12 = A[5] - l10 * A[2], l21 = u12 / d1, d2 = A[8] - l20 * A[2] - l21 * u12;
  if (!(d2 > least * scale[8] && isfinite(1 / d2))) return 2;
  double m20 = l10 * l21 - l20, e0 = 1 / d0, e1 = 1 / d1,
         e2 = 1 / d2; /* rows of L^-1: (1), (-l10, 1), (m20, -l21, 1) */
  inverse[0] = e0 + l10 * l10 * e1 + m20 * m20 * e2;
  inverse[1] = inverse[3] = -l10 * e1 - m20 * l21 * e2;
  inverse[2] = inverse[6] = m20 * e2;
  inverse[4] = e1 + l21 * l21 * e2;
  inverse[5] = inverse[7] = -l21 * e2;
  inverse[8] = e2;
  return b;
}

/* ---- Factorization --------------------------------------------------------------------------------------------- */

typedef struct incomplete_task {
  hk_incomplete *m;
  const hk_matrix *A;
  const double *r;
  double *z;
  int lanes;
} incomplete_task;

/* C = A B, blocks of b. */
static void multiply(size_t b, const double *A, const double *B, double *C) {
  for (size_t i = 0; i < b; i++)
    for (size_t j = 0; j < b; j++) {
      double sum = 0;
      for (size_t k = 0; k < b; k++) sum += A[b * i + k] * B[b * k + j];
      C[b * i + j] = sum;
    }
}

/* C -= A^T B. */
static void subtract(size_t b, const double *A, const double *B, double *C) {
  for (size_t i = 0; i < b; i++)
    for (size_t j = 0; j < b; j++) {
      double sum = 0;
      for (size_t k = 0; k < b; k++) sum += A[b * k + i] * B[b * k + j];
      C[b * i + j] -= sum;
    }
}

/* The elimination of row i: S_jk -= U_ij^T D_i^-1 U_ik where (j, k) is in the pattern. */
static void eliminate(hk_incomplete *m, size_t i) {
  size_t b = m->block, bb = b * b, last = m->start[i + 1];
  double product[9];
  for (size_t e = m->start[i]; e < last; e++) {
    multiply(b, m->inverse + bb * i, m->work + bb * e, product); /* W of this block */
    for (size_t k = 0; k < bb; k++) m->W[bb * e + k] = (float)product[k];
    subtract(b, m->work + bb * e, product, m->D + bb * m->column[e]);
    for (size_t f = m->start[i]; f < e; f++) {
      size_t j = m->column[f], t = m->start[j], end = m->start[j + 1];
      while (t < end && m->column[t] < m->column[e]) t++;
      if (t < end && m->column[t] == m->column[e]) subtract(b, m->work + bb * f, product, m->work + bb * t);
    }
  }
}

static size_t diagonal_of(const hk_matrix *A, size_t r) {
  size_t e = hk_upper_first(A, r);
  return e < A->row_start[r + 1] && A->column[e] == r ? e : SIZE_MAX;
}

static void load_domain(const incomplete_task *t, size_t begin, size_t end, double shift) {
  hk_incomplete *m = t->m;
  size_t bb = m->block * m->block;
  for (size_t r = begin; r < end; r++) {
    size_t d = diagonal_of(t->A, r);
    for (size_t k = 0; k < bb; k++) {
      double value = d == SIZE_MAX ? 0 : t->A->value[bb * d + k];
      m->D[bb * r + k] = k % (m->block + 1) == 0 ? value * (1 + shift) : value;
    }
    for (size_t e = m->start[r]; e < m->start[r + 1]; e++)
      memcpy(m->work + bb * e, t->A->value + bb * m->source[e], bb * sizeof *m->work);
  }
}

static bool factorize_domain(const incomplete_task *t, size_t begin, size_t end, double shift) {
  hk_incomplete *m = t->m;
  size_t bb = m->block * m->block;
  load_domain(t, begin, end, shift);
  for (size_t r = begin; r < end; r++) {
    size_t d = diagonal_of(t->A, r);
    if (d == SIZE_MAX) return false;
    double *inverse = m->inverse + bb * r;
    if (hk_invert_definite(m->block, m->D + bb * r, t->A->value + bb * d, least_pivot, inverse) < m->block)
      return false;
    eliminate(m, r);
  }
  return true;
}

static void factorize_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const incomplete_task *t = context;
  double shift = 0;
  while (shift <= last_shift && !factorize_domain(t, begin, end, shift)) shift = shift > 0 ? 2 * shift : first_shift;
  t->m->shift[chunk] = shift <= last_shift ? shift : -1;
}

bool hk_incomplete_factorize(hk_incomplete *m, const hk_host *host, const hk_matrix *A) {
  incomplete_task task = {.m = m, .A = A};
  bool fine = true;
  host->parallel_for(host, m->rows, m->domain, factorize_chunk, &task);
  for (size_t k = 0; k < m->domains; k++) fine = fine && m->shift[k] >= 0;
  return fine;
}

/* ---- Solution -------------------------------------------------------------------------------------------------- */

/* Loads two numbers and one, like the stores: rows follow each other so closely that a load must have the shape of the
 * store before it. */
#define LOAD3(p)                                                                                                       \
  { (p)[0], (p)[1], (p)[2], 0 }
#define WIDEN(p) __builtin_convertvector(*(const single *)(p), vector)

HK_INLINE void solve_triples(const hk_incomplete *m, double *z, size_t begin, size_t end) {
  const size_t *restrict start = m->start;
  const uint32_t *restrict column = m->column;
  const float *restrict W = m->W;
  for (size_t r = begin; r < end; r++) {
    const double *t = z + 3 * r;
    vector x = {-t[0], -t[0], -t[0], -t[0]}, y = {-t[1], -t[1], -t[1], -t[1]}, w = {-t[2], -t[2], -t[2], -t[2]};
    for (size_t e = start[r]; e < start[r + 1]; e++) {
      const float *B = W + 9 * e;
      double *to = z + 3 * (size_t)column[e];
      vector sum = WIDEN(B) * x + WIDEN(B + 3) * y + WIDEN(B + 6) * w;
      ADD3(to, sum);
    }
  }
  for (size_t r = end; r-- > begin;) {
    vector a = {0}, b = {0}, c = {0};
    /* the row just solved is used last, so that the other terms need not wait for it */
    for (size_t e = start[r + 1]; e-- > start[r];) {
      const float *B = W + 9 * e;
      const double *from = z + 3 * (size_t)column[e];
      vector v = LOAD3(from);
      a += WIDEN(B) * v;
      b += WIDEN(B + 3) * v;
      c += WIDEN(B + 6) * v;
    }
    const double *I = m->inverse + 9 * r;
    double *t = z + 3 * r, x = t[0], y = t[1], w = t[2];
    half two = {I[0] * x + I[1] * y + I[2] * w - (a[0] + a[1] + a[2]),
                I[3] * x + I[4] * y + I[5] * w - (b[0] + b[1] + b[2])};
    *(half *)t = two;
    t[2] = I[6] * x + I[7] * y + I[8] * w - (c[0] + c[1] + c[2]);
  }
}

HK_VERSIONS(static void, solve_blocks, (const hk_incomplete *m, double *z, size_t begin, size_t end),
            solve_triples(m, z, begin, end))

static void solve_singles(const hk_incomplete *m, double *z, size_t begin, size_t end) {
  for (size_t r = begin; r < end; r++)
    for (size_t e = m->start[r]; e < m->start[r + 1]; e++) z[m->column[e]] -= (double)m->W[e] * z[r];
  for (size_t r = end; r-- > begin;) {
    double sum = 0;
    for (size_t e = m->start[r]; e < m->start[r + 1]; e++) sum += (double)m->W[e] * z[m->column[e]];
    z[r] = m->inverse[r] * z[r] - sum;
  }
}

static void apply_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const incomplete_task *t = context;
  const hk_incomplete *m = t->m;
  size_t b = m->block;
  memcpy(t->z + b * begin, t->r + b * begin, b * (end - begin) * sizeof *t->z);
  if (b == 1)
    solve_singles(m, t->z, begin, end);
  else
    HK_WIDEST(t->lanes, solve_blocks)(m, t->z, begin, end);
  double sum[4] = {0};
  for (size_t k = b * begin; k < b * end; k++) sum[k % 4] += t->r[k] * t->z[k];
  m->part[chunk] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

double hk_incomplete_apply(const hk_incomplete *m, const hk_host *host, const double *r, double *z) {
  hk_incomplete copy = *m;
  incomplete_task task = {.m = &copy, .r = r, .z = z, .lanes = host->lanes};
  double sum = 0;
  host->parallel_for(host, m->rows, m->domain, apply_chunk, &task);
  for (size_t k = 0; k < m->domains; k++) sum += m->part[k];
  return sum;
}

/* ---- Pattern --------------------------------------------------------------------------------------------------- */

/* Counts the blocks, or lists them when there is memory for them. */
static void list_blocks(hk_incomplete *m, const hk_matrix *A) {
  size_t count = 0;
  for (size_t r = 0; r < m->rows; r++) {
    size_t end = (r / m->domain + 1) * m->domain, e = hk_upper_first(A, r);
    m->start[r] = count;
    for (; e < A->row_start[r + 1] && A->column[e] < end; e++) {
      if (A->column[e] == r) continue;
      if (m->column) m->column[count] = A->column[e];
      if (m->source) m->source[count] = (uint32_t)e;
      count++;
    }
  }
  m->start[m->rows] = count;
}

hk_status hk_incomplete_analyze(hk_incomplete *m, const hk_host *host, const hk_matrix *A) {
  size_t n = A->rows, b = A->block, bb = b * b;
  *m = (hk_incomplete){.rows = n, .block = b, .domain = n / DOMAINS_MOST};
  if (m->domain < DOMAIN_LEAST) m->domain = DOMAIN_LEAST;
  m->domains = (n + m->domain - 1) / m->domain;
  m->start = host->allocate(host, (n + 1) * sizeof *m->start);
  if (!m->start) return HK_NO_MEMORY;
  list_blocks(m, A);
  size_t blocks = m->start[n];
  m->column = host->allocate(host, (blocks + 1) * sizeof *m->column);
  m->source = host->allocate(host, (blocks + 1) * sizeof *m->source);
  m->work = host->allocate(host, (blocks * bb + 1) * sizeof *m->work);
  m->W = host->allocate(host, (blocks * bb + 4) * sizeof *m->W);
  m->D = host->allocate(host, (n * bb + 1) * sizeof *m->D);
  m->inverse = host->allocate(host, (n * bb + 1) * sizeof *m->inverse);
  m->shift = host->allocate(host, (m->domains + 1) * sizeof *m->shift);
  m->part = host->allocate(host, (m->domains + 1) * sizeof *m->part);
  if (!m->column || !m->source || !m->work || !m->W || !m->D || !m->inverse || !m->shift || !m->part)
    return HK_NO_MEMORY;
  list_blocks(m, A);
  return HK_OK;
}

void hk_incomplete_free(hk_incomplete *m, const hk_host *host) {
  void *list[] = {m->start, m->column, m->source, m->work, m->W, m->D, m->inverse, m->shift, m->part};
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) host->release(host, list[k]);
  *m = (hk_incomplete){0};
}
