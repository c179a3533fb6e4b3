/* Anderson's acceleration, type II. From the differences of f = G(x) - x and of G(x) over the last iterations it forms
 * the combination that makes f smallest,
 *     x' = G(x) - sum gamma_j dG_j,      |f - sum gamma_j dF_j| = min,
 * in the norm |f|^2 = f.r with r = A f. For a descent x <- x + A^-1 r this is the norm in which the iteration is a
 * plain gradient descent; on cloth it needed half to a third of the iterations of the Euclidean norm. The normal
 * equations, with columns scaled to length 1 and 1e-12 added to the diagonal, are solved by Cholesky factorization; a
 * column that depends on the others to that accuracy gets the weight 0. The matrix of the normal equations is stored,
 * so an iteration costs two scalar products per stored difference. Anderson, J. ACM 12 (1965); Walker and Ni, SIAM J.
 * Numer. Anal. 49 (2011). */
#include "plugins/common/linear/anderson.h"

static const double regularization = 1e-12;

hk_status hk_anderson_reserve(hk_anderson *a, const hk_host *host, size_t length, size_t window) {
  hk_anderson_release(a, host);
  a->length = length;
  a->window = window < HK_ANDERSON_MOST ? window : HK_ANDERSON_MOST;
  a->memory = host->allocate(host, (3 * (a->window + 2) * length + 1) * sizeof *a->memory);
  if (!a->memory) return host->fail(host, HK_NO_MEMORY, "no memory for %zu steps of %zu numbers", window, length);
  a->f_last = a->memory;
  a->g_last = a->memory + length;
  a->r_last = a->memory + 2 * length;
  return HK_OK;
}

void hk_anderson_release(hk_anderson *a, const hk_host *host) {
  host->release(host, a->memory);
  *a = (hk_anderson){0};
}

void hk_anderson_clear(hk_anderson *a) {
  a->count = a->next = 0;
  a->primed = false;
}

static double *dF(const hk_anderson *a, size_t k) { return a->memory + (3 + 3 * k) * a->length; }

static double *dG(const hk_anderson *a, size_t k) { return a->memory + (4 + 3 * k) * a->length; }

static double *dR(const hk_anderson *a, size_t k) { return a->memory + (5 + 3 * k) * a->length; }

static double product(const double *restrict a, const double *restrict b, size_t count) {
  double sum[8] = {0};
  size_t e = 0;
  for (; e + 8 <= count; e += 8)
    for (int k = 0; k < 8; k++) sum[k] += a[e + k] * b[e + k];
  for (; e < count; e++) sum[0] += a[e] * b[e];
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

static void remember(hk_anderson *a, const double *f, const double *g, const double *r) {
  double *restrict f_last = a->f_last, *restrict g_last = a->g_last, *restrict r_last = a->r_last;
  double *restrict df = dF(a, a->next), *restrict dg = dG(a, a->next), *restrict dr = dR(a, a->next);
  bool primed = a->primed;
  for (size_t e = 0; e < a->length; e++) {
    df[e] = f[e] - f_last[e];
    dg[e] = g[e] - g_last[e];
    f_last[e] = f[e];
    dr[e] = r[e] - r_last[e];
    r_last[e] = r[e];
    g_last[e] = g[e];
  }
  a->primed = true;
  if (!primed || a->window == 0) return;
  size_t k = a->next;
  if (a->count < a->window) a->count++;
  a->next = (a->next + 1) % a->window;
  for (size_t j = 0; j < a->count; j++) a->gram[j][k] = a->gram[k][j] = product(dr, dF(a, j), a->length);
}

/* Solves the scaled normal equations for gamma. */
static void combine(const hk_anderson *a, const double *r, double gamma[HK_ANDERSON_MOST]) {
  double L[HK_ANDERSON_MOST][HK_ANDERSON_MOST], scale[HK_ANDERSON_MOST];
  size_t m = a->count;
  for (size_t j = 0; j < m; j++) scale[j] = a->gram[j][j] > 0 ? 1 / sqrt(a->gram[j][j]) : 0;
  for (size_t j = 0; j < m; j++) gamma[j] = scale[j] * product(dF(a, j), r, a->length);
  for (size_t j = 0; j < m; j++)
    for (size_t i = j; i < m; i++) {
      double sum = a->gram[i][j] * scale[i] * scale[j] + (i == j ? regularization : 0);
      for (size_t k = 0; k < j; k++) sum -= L[i][k] * L[j][k];
      if (i == j)
        L[j][j] = sum > regularization / 2 ? sqrt(sum) : 0;
      else
        L[i][j] = L[j][j] > 0 ? sum / L[j][j] : 0;
    }
  for (size_t j = 0; j < m; j++) {
    for (size_t k = 0; k < j; k++) gamma[j] -= L[j][k] * gamma[k];
    gamma[j] = L[j][j] > 0 ? gamma[j] / L[j][j] : 0;
  }
  for (size_t j = m; j-- > 0;) {
    for (size_t k = j + 1; k < m; k++) gamma[j] -= L[k][j] * gamma[k];
    gamma[j] = L[j][j] > 0 ? gamma[j] / L[j][j] : 0;
  }
  for (size_t j = 0; j < m; j++) gamma[j] *= scale[j];
}

void hk_anderson_next(hk_anderson *a, const double *f, const double *g, const double *r, double *x) {
  double gamma[HK_ANDERSON_MOST];
  remember(a, f, g, r);
  combine(a, r, gamma);
  for (size_t e = 0; e < a->length; e++) x[e] = g[e];
  for (size_t j = 0; j < a->count; j++) {
    const double *restrict d = dG(a, j);
    for (size_t e = 0; e < a->length; e++) x[e] -= gamma[j] * d[e];
  }
}
