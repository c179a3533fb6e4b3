/* Stoermer's method in summed form, with backward differences D of the accelerations at the last steps:
 *     d' = d + h sum sigma_j D^j a,   x' = x + h d',   v' = d' + h sum (gamma_j - sigma_j) D^(j-1) a,
 *     y' = y + h sum gamma_j D^j dy,
 * with d the last change of x over h, so that rounding does not grow as in x' - 2x + x_before (Hairer, Norsett and
 * Wanner, Solving ODEs I, III.10). v' is what Adams and Bashforth's method of the same order, gamma_j, gives; taken
 * from d' it cannot drift away from the change of x. The first steps are Dormand and Prince's, of order 5, whose change
 * of x starts d without a subtraction. */
#include "plugins/common/stoermer.h"
#include "plugins/common/spectral.h"

#include <string.h>

enum { CHUNK = 256 };

static const double sigma[HK_STOERMER_ORDER_MAX] = {1, 0, 1.0 / 12, 1.0 / 12, 19.0 / 240};
static const double gamma_[HK_STOERMER_ORDER_MAX] = {1, 1.0 / 2, 5.0 / 12, 3.0 / 8, 251.0 / 720};

static double binomial(int n, int k) { return k == 0 ? 1 : binomial(n, k - 1) * (n - k + 1) / k; }

/* c += factor u^power (1 + u)^rest */
static void add_term(double *c, double factor, int power, int rest) {
  for (int k = 0; k <= rest; k++) c[power + k] += factor * binomial(rest, k);
}

/* With lambda = 1 + u, D is u/(1 + u), and the recurrence's polynomial is
 *     u^2 (1 + u)^(k-1) + (h w)^2 sum sigma_j u^j (1 + u)^(k-j) + h g sum gamma_j u^(j+1) (1 + u)^(k-1-j). */
double hk_stoermer_amplification(int order, double hw, double hg) {
  double c[HK_STOERMER_ORDER_MAX + 2] = {0};
  add_term(c, 1, 2, order - 1);
  for (int j = 0; j < order; j++) {
    add_term(c, hw * hw * sigma[j], j, order - j);
    add_term(c, hg * gamma_[j], j + 1, order - 1 - j);
  }
  return hk_polynomial_growth(order + 1, c);
}

/* The history, newest first, with its weights. */
typedef struct past {
  int count;
  const double *slope[HK_STOERMER_ORDER_MAX];
  double change[HK_STOERMER_ORDER_MAX], lead[HK_STOERMER_ORDER_MAX], rate[HK_STOERMER_ORDER_MAX];
} past;

static double *ring(const hk_stoermer *m, const hk_system *s, int order, int64_t place) {
  return m->slope + (size_t)(place % order) * (s->size - 3 * s->n);
}

static past recall(const hk_stoermer *m, const hk_system *s, int order, double h) {
  past p = {.count = order};
  for (int j = 0; j < order; j++) {
    p.slope[j] = ring(m, s, order, m->head + order - j);
    for (int i = 0; i <= j; i++) {
      double w = h * binomial(j, i) * (i % 2 ? -1 : 1);
      p.change[i] += sigma[j] * w;
      p.rate[i] += gamma_[j] * w;
      if (i < j) p.lead[i] += (gamma_[j] - sigma[j]) * h * binomial(j - 1, i) * (i % 2 ? -1 : 1);
    }
  }
  return p;
}

static void advance_chunk(double *restrict x, double *restrict v, double *restrict d, const past *p, size_t begin,
                          size_t count, double h) {
  double change[CHUNK] = {0}, lead[CHUNK] = {0};
  for (int j = 0; j < p->count; j++) {
    const double *restrict a = p->slope[j] + begin;
    double w = p->change[j], l = p->lead[j];
    for (size_t e = 0; e < count; e++) {
      change[e] += w * a[e];
      lead[e] += l * a[e];
    }
  }
  for (size_t e = 0; e < count; e++) {
    d[e] += change[e];
    x[e] += h * d[e];
    v[e] = d[e] + lead[e];
  }
}

static void advance(hk_stoermer *m, hk_system *s, int order, double h) {
  size_t v = 3 * s->n, y = 6 * s->n;
  past p = recall(m, s, order, h);
  for (size_t begin = 0; begin < v; begin += CHUNK)
    advance_chunk(s->X + begin, s->X + v + begin, m->change + begin, &p, begin, v - begin < CHUNK ? v - begin : CHUNK,
                  h);
  for (int j = 0; j < order; j++)
    for (size_t e = y; e < s->size; e++) s->X[e] += p.rate[j] * p.slope[j][e - v];
}

/* One step of Dormand and Prince, whose first slope is known; d = v + h sum (b A)_l a_l is the change of x over h. */
static hk_status start(hk_stoermer *m, hk_system *s, const double *slope, double h) {
  hk_tableau T = hk_dormand_prince;
  T.stages = 6; /* the seventh serves the error estimate */
  size_t v = 3 * s->n;
  memcpy(m->start, slope, (s->size - v) * sizeof *slope);
  hk_status status = hk_rk_stages(&T, s, h, m->start, 1);
  if (status != HK_OK) return status;
  memcpy(m->change, s->X + v, v * sizeof *slope);
  for (int l = 0; l < T.stages; l++) {
    double w = 0;
    for (int j = l + 1; j < T.stages; j++) w += h * T.b[j] * T.a[j][l];
    const double *a = hk_rk_slope(s, m->start, l);
    for (size_t e = 0; e < v; e++) m->change[e] += w * a[e];
  }
  hk_rk_combine(&T, s, h, m->start, T.b, T.stages, 1, s->X, s->X);
  return HK_OK;
}

hk_status hk_stoermer_step(hk_stoermer *m, int order, hk_system *s, double h) {
  size_t v = 3 * s->n;
  double *a = ring(m, s, order, m->head);
  if (h != m->h) m->known = 0;
  hk_status status = s->accelerations(s, s->t, s->X, s->X + v, s->X + 2 * v, a, a + v);
  if (status != HK_OK) return status;
  if (m->known < order - 1)
    status = start(m, s, a, h);
  else
    advance(m, s, order, h);
  if (status != HK_OK) return status;
  m->h = h;
  m->head = (m->head + 1) % order;
  if (m->known < order - 1) m->known++;
  return HK_OK;
}

void hk_stoermer_reset(void *self, hk_reason why) {
  (void)why;
  ((hk_stoermer *)self)->known = 0;
}
