/* Lanczos iteration for the largest eigenvalue of a symmetric operator, with an upper bound that fails with probability
 * 1e-6.
 *
 * Three vectors without a stored basis or re-orthogonalisation suffice for the end of the spectrum. After k steps
 * v_(k+1) = q_k(A) v_1 has length 1, q_k being the k-th Lanczos polynomial. So the component of v_1 along the wanted
 * eigenvector u obeys |q_k(l)| |v_1.u| <= 1, and as a random v_1 of N numbers has |v_1.u| >= d = P sqrt(pi / 2N) with
 * probability 1 - P, the largest eigenvalue l is at most the root of q_k(l) = 1/d above the largest Ritz value theta
 * (van Dorsselaer, Hochstenbach and van der Vorst, SIAM J. Matrix Anal. Appl. 22, 2000; P = 1e-6). Unlike theta plus
 * the residual (Zhou and Li, Linear Algebra Appl. 435, 2011, who say when that bound fails) this bound needs no gap in
 * the spectrum and is exact when the Krylov space is complete, so small and degenerate operators are no special case.
 * Above theta the q_k increase with l, and their ratios q_k/q_(k-1) = -d_k/b_k come from the pivots d_k of T - l, all
 * negative there.
 *
 * The iteration also sums z = sum of q_j(l*) v_(j+1), where l* is an earlier bound: this is the Christoffel-Darboux
 * kernel, a filter that peaks at l*, applied to v_1. The next run starts from z. */
#include "core/numerics/stability/lanczos.h"

#include <string.h>

static const double failure_probability = 1e-6, bound_ratio = 1.12, breakdown = 1e-12;

typedef struct tridiagonal {
  int k;
  double a[HK_LANCZOS_STEPS], b[HK_LANCZOS_STEPS];
} tridiagonal;

static double dot(const double *u, const double *v, size_t n) {
  double s[4] = {0};
  size_t i = 0;
  for (; i + 4 <= n; i += 4)
    for (size_t c = 0; c < 4; c++) s[c] += u[i + c] * v[i + c];
  for (; i < n; i++) s[0] += u[i] * v[i];
  return (s[0] + s[1]) + (s[2] + s[3]);
}

static void scale(double *v, double factor, size_t n) {
  for (size_t i = 0; i < n; i++) v[i] *= factor;
}

/* splitmix64 (Steele, Lea and Flood 2014); the sum of a word's four 16-bit parts is nearly normal. */
void hk_lanczos_random(double *vector, size_t size) {
  uint64_t state = 0x686f6f6b65ull;
  for (size_t i = 0; i < size; i++) {
    uint64_t z = state += 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    z ^= z >> 31;
    double sum = 0;
    for (int part = 0; part < 4; part++) sum += (double)((z >> (16 * part)) & 0xffff);
    vector[i] = sum / 65536 - 2 + 1.0 / 131072; /* never zero */
  }
}

/* Whether l is above every eigenvalue of T and q_k(l) >= level. */
static bool above(const tridiagonal *t, double l, double level) {
  double d = 1, q = 1, b = 0;
  for (int j = 0; j < t->k; j++) {
    d = t->a[j] - l - (j > 0 ? b * b / d : 0);
    if (!(d < 0)) return false;
    b = t->b[j];
    q *= b > 0 ? -d / b : INFINITY;
  }
  return q >= level;
}

/* The smallest l for which above() holds, by bisection. */
static double root(const tridiagonal *t, double level) {
  double low = -INFINITY, size = 0;
  for (int j = 0; j < t->k; j++) {
    low = fmax(low, t->a[j]);
    size = fmax(size, fabs(t->a[j]) + t->b[j]);
  }
  if (size == 0) return 0;
  double high = low, step = size;
  while (!above(t, high, level)) {
    high = low + step;
    step *= 2;
  }
  for (int i = 0; i < 64 && high - low > 1e-13 * size; i++) {
    double middle = low + (high - low) / 2;
    if (above(t, middle, level))
      high = middle;
    else
      low = middle;
  }
  return high;
}

static void swap(double **a, double **b) {
  double *kept = *a;
  *a = *b;
  *b = kept;
}

/* Computes row k of T: image = A current without its components along the last two vectors. */
static hk_status advance(hk_lanczos *l, tridiagonal *t, hk_lanczos_apply *apply, void *context) {
  int k = t->k;
  double before = k > 0 ? t->b[k - 1] : 0;
  hk_status status = apply(context, l->current, l->image);
  if (status != HK_OK) return status;
  l->norm = fmax(l->norm, sqrt(dot(l->image, l->image, l->size)));
  if (k > 0) l->asymmetry = fmax(l->asymmetry, fabs(dot(l->image, l->previous, l->size) - before));
  double a = dot(l->image, l->current, l->size);
  for (size_t i = 0; i < l->size; i++)
    l->image[i] -= a * l->current[i] + (k > 0 ? before * l->previous[i] : 0); /* previous is not set at first */
  t->a[k] = a;
  t->b[k] = sqrt(dot(l->image, l->image, l->size));
  l->steps = ++t->k;
  return isfinite(t->b[k]) ? HK_OK : HK_NOT_FINITE;
}

/* Updates the bound; true: it is tight enough or the Krylov space is complete. Whether theta is large enough for that
 * is a single question to T; itself it is looked for at the end. */
static bool update_bound(hk_lanczos *l, const tridiagonal *t, double known) {
  double d = failure_probability * sqrt(1.5707963267948966 / (double)l->size), last = t->b[t->k - 1];
  bool complete = (size_t)t->k >= l->size || last <= breakdown * l->norm;
  l->bound = fmin(fmin(l->bound, known), root(t, complete ? 0 : 1 / d));
  return complete || !above(t, (l->bound - l->slack) / bound_ratio, 0);
}

hk_status hk_lanczos_run(hk_lanczos *l, hk_lanczos_apply *apply, void *context, double known) {
  tridiagonal t = {.k = 0};
  double length = sqrt(dot(l->current, l->current, l->size));
  l->theta = l->norm = l->asymmetry = 0;
  l->steps = 0;
  l->bound = length > 0 ? INFINITY : 0;
  if (!(length > 0)) return HK_OK;
  scale(l->current, 1 / length, l->size);
  for (;;) {
    hk_status status = advance(l, &t, apply, context);
    if (status != HK_OK) return status;
    if (update_bound(l, &t, known) || t.k == HK_LANCZOS_STEPS) break;
    swap(&l->previous, &l->current);
    swap(&l->current, &l->image);
    scale(l->current, 1 / t.b[t.k - 1], l->size);
  }
  l->theta = root(&t, 0);
  return HK_OK;
}
