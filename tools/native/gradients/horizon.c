/* Quadratic programs along time by the recursion of Riccati. Matrices are rows, one behind the other. */
#include "tools/native/gradients/horizon.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of a pivot, relative to what it was before subtraction: below that it is rounding, not positive. */
static const double least_pivot = 1e-12;

static size_t wide(const horizon *h) { return h->d + 2 * h->m; }

static double *take(double **at, size_t count) {
  double *taken = *at;
  *at += count;
  return taken;
}

horizon *hk_horizon_create(size_t knots, size_t d, size_t m, size_t goals) {
  horizon *h = calloc(1, sizeof *h);
  if (!h) return NULL;
  *h = (horizon){.knots = knots, .d = d, .m = m, .goals = goals};
  size_t q = d + m, w = wide(h), parts = knots - 1, s = q + m;
  size_t numbers = parts * (d * w + w * w + 4 * m * m + m * q) + knots * (m + q * q + m * m + 2 * q + d * d) +
                   2 * goals * d + 3 * s * s;
  h->memory = calloc(numbers, sizeof *h->memory);
  h->goal = calloc(goals + 1, sizeof *h->goal);
  if (!h->memory || !h->goal) {
    hk_horizon_free(h);
    return NULL;
  }
  double *at = h->memory;
  h->J = take(&at, parts * d * w);
  h->C = take(&at, parts * w * w);
  h->W = take(&at, parts * 4 * m * m);
  h->K = take(&at, parts * m * q);
  h->P = take(&at, knots * q * q);
  h->L = take(&at, knots * m * m);
  h->bend = take(&at, knots * d * d);
  for (size_t g = 0; g < goals; g++) h->goal[g].slope = take(&at, d), h->goal[g].square = take(&at, d);
  h->scratch = take(&at, knots * 2 * q + 3 * s * s);
  return h;
}

void hk_horizon_free(horizon *h) {
  if (!h) return;
  free(h->memory);
  free(h->goal);
  free(h);
}

/* ---- the matrix ---- */

/* L with L L' = M (n squared, rows `apart`); false: M is not positive. */
static bool cholesky(const double *M, size_t apart, size_t n, double *L) {
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k <= i; k++) {
      double sum = M[i * apart + k];
      for (size_t e = 0; e < k; e++) sum -= L[i * n + e] * L[k * n + e];
      if (k < i)
        L[i * n + k] = sum / L[k * n + k];
      else if (sum > least_pivot * fabs(M[i * apart + i]))
        L[i * n + i] = sqrt(sum);
      else
        return false; /* also of what is no number */
    }
  return true;
}

/* x = (L L')^-1 x, x with `apart` numbers between. */
static void solve(const double *L, size_t n, double *x, size_t apart) {
  for (size_t i = 0; i < n; i++) {
    for (size_t k = 0; k < i; k++) x[i * apart] -= L[i * n + k] * x[k * apart];
    x[i * apart] /= L[i * n + i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; k++) x[i * apart] -= L[k * n + i] * x[k * apart];
    x[i * apart] /= L[i * n + i];
  }
}

/* What stands at a knot alone: the goals' bend and squares. */
static void add_knot(const horizon *h, size_t k, double *P) {
  size_t d = h->d, q = d + h->m;
  const double *bend = h->bend + k * d * d;
  for (size_t i = 0; i < d; i++)
    for (size_t e = 0; e < d; e++) P[i * q + e] += bend[i * d + e];
  for (size_t g = 0; g < h->goals; g++) {
    const double *slope = h->goal[g].square;
    if (h->goal[g].knot != k || h->square == 0) continue;
    for (size_t i = 0; i < d; i++)
      for (size_t e = 0; e < d; e++) P[i * q + e] += h->square * slope[i] * slope[e];
  }
}

/* Q = C and the effort of segment k, and P of the knot behind it: of (x, u at the begin, u at the end), Q = C + W + F'
 * P F with F from these to (x, u) of the knot behind. */
static void join(const horizon *h, size_t k, const double *P, double *Q, double *PF) {
  size_t d = h->d, m = h->m, q = d + m, w = wide(h);
  const double *J = h->J + k * d * w, *C = h->C + k * w * w, *W = h->W + k * 4 * m * m;
  for (size_t i = 0; i < q; i++) {
    double *row = PF + i * w;
    memset(row, 0, w * sizeof *row);
    for (size_t e = 0; e < d; e++) {
      double part = P[i * q + e];
      for (size_t c = 0; c < w && part != 0; c++) row[c] += part * J[e * w + c];
    }
    for (size_t j = 0; j < m; j++) row[q + j] += P[i * q + d + j];
  }
  memcpy(Q, C, w * w * sizeof *Q);
  for (size_t i = 0; i < 2 * m; i++)
    for (size_t j = 0; j < 2 * m; j++) Q[(d + i) * w + d + j] += W[i * 2 * m + j];
  for (size_t e = 0; e < d; e++)
    for (size_t i = 0; i < w; i++) {
      double part = J[e * w + i];
      for (size_t c = 0; c < w && part != 0; c++) Q[i * w + c] += part * PF[e * w + c];
    }
  for (size_t j = 0; j < m; j++)
    for (size_t c = 0; c < w; c++) Q[(q + j) * w + c] += PF[(d + j) * w + c];
}

bool hk_horizon_factor(horizon *h) {
  size_t d = h->d, m = h->m, q = d + m, w = wide(h);
  double *Q = h->scratch + h->knots * 2 * q, *PF = Q + w * w;
  memset(h->P, 0, h->knots * q * q * sizeof *h->P);
  add_knot(h, h->knots - 1, h->P + (h->knots - 1) * q * q);
  for (size_t k = h->knots - 1; k-- > 0;) {
    double *P = h->P + k * q * q, *K = h->K + k * m * q, *L = h->L + (k + 1) * m * m;
    join(h, k, P + q * q, Q, PF);
    if (!cholesky(Q + q * w + q, w, m, L)) return false;
    for (size_t i = 0; i < m; i++)
      for (size_t c = 0; c < q; c++) K[i * q + c] = -Q[(q + i) * w + c];
    for (size_t c = 0; c < q; c++) solve(L, m, K + c, q);
    for (size_t i = 0; i < q; i++)
      for (size_t c = 0; c < q; c++) {
        double sum = Q[i * w + c];
        for (size_t j = 0; j < m; j++) sum += Q[i * w + q + j] * K[j * q + c];
        P[i * q + c] = sum;
      }
    for (size_t i = 0; i < q; i++)
      for (size_t c = 0; c < i; c++) P[i * q + c] = P[c * q + i] = (P[i * q + c] + P[c * q + i]) / 2;
    add_knot(h, k, P);
  }
  return cholesky(h->P + d * q + d, q, m, h->L);
}

/* ---- right sides ---- */

/* p of every knot, q each: how what is still to be paid changes with (x, u) there, at 0; and behind them the part of
 * the controls at the end of a segment that does not follow what is at its begin. */
static void sweep_back(const horizon *h, const double *gx, const double *gu, const double *off) {
  size_t d = h->d, m = h->m, q = d + m, w = wide(h), n = h->knots;
  double *p = h->scratch, *own = p + n * q, *at = own + n * q, *full = at + q;
  memset(p, 0, n * q * sizeof *p);
  for (size_t k = n; k-- > 0;) {
    double *here = p + k * q;
    if (k + 1 < n) {
      const double *J = h->J + k * d * w, *P = h->P + (k + 1) * q * q, *next = here + q, *K = h->K + k * m * q;
      for (size_t i = 0; i < q; i++) {
        at[i] = next[i];
        for (size_t e = 0; e < d && off; e++) at[i] += P[i * q + e] * off[k * d + e];
      }
      memset(full, 0, w * sizeof *full);
      for (size_t e = 0; e < d; e++)
        for (size_t c = 0; c < w; c++) full[c] += J[e * w + c] * at[e];
      double *end = own + (k + 1) * q;
      for (size_t j = 0; j < m; j++) end[j] = -(full[q + j] + at[d + j]);
      for (size_t c = 0; c < q; c++) { /* K' times the derivative by the controls behind: the envelope */
        here[c] = full[c];
        for (size_t j = 0; j < m; j++) here[c] -= K[j * q + c] * end[j];
      }
      solve(h->L + (k + 1) * m * m, m, end, 1);
    }
    for (size_t i = 0; i < d && gx; i++) here[i] += gx[k * d + i];
    for (size_t j = 0; j < m && gu; j++) here[d + j] += gu[k * m + j];
  }
  for (size_t j = 0; j < m; j++) own[j] = -p[d + j];
  solve(h->L, m, own, 1);
}

/* The multiplier of the equations of a segment is how what is still to be paid changes with the state behind it: P (x,
 * u)
 * + p there. */
static void fill_multipliers(const horizon *h, const double *x, const double *u, double *list) {
  size_t d = h->d, m = h->m, q = d + m;
  for (size_t k = 1; k < h->knots; k++)
    for (size_t i = 0; i < d; i++) {
      const double *row = h->P + k * q * q + i * q;
      double sum = h->scratch[k * q + i];
      for (size_t c = 0; c < d; c++) sum += row[c] * x[k * d + c];
      for (size_t c = 0; c < m; c++) sum += row[d + c] * u[k * m + c];
      list[(k - 1) * d + i] = sum;
    }
}

void hk_horizon_least(const horizon *h, const double *gx, const double *gu, const double *off, double *x, double *u,
                      double *multipliers) {
  size_t d = h->d, m = h->m, q = d + m, w = wide(h), n = h->knots;
  const double *own = h->scratch + n * q;
  sweep_back(h, gx, gu, off);
  memset(x, 0, d * sizeof *x);
  memcpy(u, own, m * sizeof *u);
  for (size_t k = 0; k + 1 < n; k++) {
    const double *K = h->K + k * m * q, *J = h->J + k * d * w;
    double *next_u = u + (k + 1) * m, *next_x = x + (k + 1) * d;
    for (size_t j = 0; j < m; j++) {
      next_u[j] = own[(k + 1) * q + j];
      for (size_t c = 0; c < d; c++) next_u[j] += K[j * q + c] * x[k * d + c];
      for (size_t c = 0; c < m; c++) next_u[j] += K[j * q + d + c] * u[k * m + c];
    }
    for (size_t i = 0; i < d; i++) {
      next_x[i] = off ? off[k * d + i] : 0;
      for (size_t c = 0; c < d; c++) next_x[i] += J[i * w + c] * x[k * d + c];
      for (size_t c = 0; c < 2 * m; c++) next_x[i] += J[i * w + d + c] * u[k * m + c];
    }
  }
  if (multipliers) fill_multipliers(h, x, u, multipliers);
}

void hk_horizon_row(const horizon *h, size_t knot, const double *slope, double *row) {
  size_t d = h->d, m = h->m, w = wide(h);
  double *at = h->scratch, *before = at + w;
  memcpy(at, slope, d * sizeof *at);
  for (size_t k = knot; k-- > 0;) {
    const double *J = h->J + k * d * w;
    memset(before, 0, w * sizeof *before);
    for (size_t e = 0; e < d; e++)
      for (size_t c = 0; c < w; c++) before[c] += J[e * w + c] * at[e];
    for (size_t j = 0; j < 2 * m; j++) row[k * m + j] += before[d + j];
    memcpy(at, before, d * sizeof *at);
  }
}
