/* Stoermer's method in summed form, with backward differences D of the accelerations at the last steps:
 *     d' = d + h sum sigma_j D^j a,   x' = x + h d',   v' = d' + h sum (gamma_j - sigma_j) D^(j-1) a,
 *     y' = y + h sum gamma_j D^j dy,
 * where d is the last change of x divided by h, so that rounding does not grow as in x' - 2x + x_before (Hairer,
 * Norsett and Wanner, Solving ODEs I, III.10). v' equals the result of the Adams-Bashforth method of the same order,
 * with coefficients gamma_j; computed from d' it cannot drift away from the change of x. The first steps use the
 * Dormand-Prince method of order 5, or extrapolation, whose change of x initialises d without a subtraction.
 *
 * The coefficients belong to the method: up to its order they are those of the series, and beyond it they are chosen
 * for a wide range of stable steps. */
#include "plugins/common/integrate/stoermer.h"
#include "plugins/common/integrate/extrapolation.h"
#include "plugins/common/integrate/growth_factor.h"

#include <assert.h>
#include <complex.h>
#include <string.h>

static double binomial(int n, int k) { return k == 0 ? 1 : binomial(n, k - 1) * (n - k + 1) / k; }

/* c += factor u^power (1 + u)^rest */
static void add_term(double complex *c, double complex factor, int power, int rest) {
  for (int k = 0; k <= rest; k++) c[power + k] += factor * binomial(rest, k);
}

/* With lambda = 1 + u, D is u/(1 + u), and the recurrence's polynomial is
 *     u^2 (1 + u)^(k-1) + (h w)^2 sum sigma_j u^j (1 + u)^(k-j) + h g sum gamma_j u^(j+1) (1 + u)^(k-1-j),
 * with g + i b in place of g where velocities rotate. */
double hk_stoermer_rotation(const hk_stoermer_method *f, double hw, double hg, double hb) {
  double complex c[HK_STOERMER_TERMS + 2] = {0};
  add_term(c, 1, 2, f->terms - 1);
  for (int j = 0; j < f->terms; j++) {
    add_term(c, hw * hw * f->sigma[j], j, f->terms - j);
    add_term(c, (hg + hb * I) * f->gamma[j], j + 1, f->terms - 1 - j);
  }
  return hk_complex_polynomial_growth(f->terms + 1, c);
}

double hk_stoermer_amplification(const hk_stoermer_method *f, double hw, double hg) {
  return hk_stoermer_rotation(f, hw, hg, 0);
}

/* The history, newest first, with its weights; the weights of terms that the method does not use are zero. */
typedef struct past {
  const double *slope[HK_STOERMER_TERMS];
  double change[HK_STOERMER_TERMS], lead[HK_STOERMER_TERMS], rate[HK_STOERMER_TERMS];
} past;

static double *ring(const hk_stoermer *m, const hk_system *s, int terms, int64_t place) {
  return m->slope + (size_t)(place % terms) * (s->size - 3 * s->n);
}

static past recall(const hk_stoermer *m, const hk_system *s, const hk_stoermer_method *f, double h) {
  past p = {.slope = {NULL}};
  for (int j = 0; j < HK_STOERMER_TERMS; j++) {
    p.slope[j] = ring(m, s, f->terms, j < f->terms ? m->head + f->terms - j : m->head);
    for (int i = 0; i <= j; i++) {
      double w = h * binomial(j, i) * (i % 2 ? -1 : 1);
      p.change[i] += f->sigma[j] * w;
      p.rate[i] += f->gamma[j] * w;
      if (i < j) p.lead[i] += (f->gamma[j] - f->sigma[j]) * h * binomial(j - 1, i) * (i % 2 ? -1 : 1);
    }
  }
  return p;
}

typedef struct advance {
  past p;
  const double *x;
  double *x_next, *v_next;
  const double *d;
  double *d_next, h;
} advance;

/* Updates all arrays at once, because memory bandwidth limits a step. The first `terms` slopes count: 4, 6 or 8, known
 * when it is compiled. What is written has no other name, or the loop would not become one of vectors. */
#define INLINE static inline __attribute__((always_inline))
INLINE void update(const advance *all, double *restrict x_next, double *restrict v_next, double *restrict d_next,
                   size_t begin, size_t end, int terms) {
  const double *x = all->x, *d = all->d, *const *a = all->p.slope, *w = all->p.change, *l = all->p.lead, h = all->h;
  for (size_t e = begin; e < end; e++) {
    double change = w[0] * a[0][e] + w[1] * a[1][e] + w[2] * a[2][e] + w[3] * a[3][e];
    double lead = l[0] * a[0][e] + l[1] * a[1][e] + l[2] * a[2][e] + l[3] * a[3][e];
    if (terms > 4) change += w[4] * a[4][e] + w[5] * a[5][e], lead += l[4] * a[4][e] + l[5] * a[5][e];
    if (terms > 6) change += w[6] * a[6][e] + w[7] * a[7][e], lead += l[6] * a[6][e] + l[7] * a[7][e];
    double next = d[e] + change;
    d_next[e] = next;
    x_next[e] = x[e] + h * next;
    v_next[e] = next + lead;
  }
}

INLINE void sweep(const advance *all, size_t begin, size_t end, int terms) {
  update(all, all->x_next, all->v_next, all->d_next, 3 * begin, 3 * end, terms);
}

typedef void sweeping(void *context, size_t begin, size_t end);

static void sweep4(void *context, size_t begin, size_t end) { sweep(context, begin, end, 4); }
static void sweep6(void *context, size_t begin, size_t end) { sweep(context, begin, end, 6); }
static void sweep8(void *context, size_t begin, size_t end) { sweep(context, begin, end, 8); }
static sweeping *const narrow[] = {sweep4, sweep6, sweep8};

#if defined(__x86_64__)
#define WIDE __attribute__((target("avx2"))) static void
WIDE wide4(void *context, size_t begin, size_t end) { sweep(context, begin, end, 4); }
WIDE wide6(void *context, size_t begin, size_t end) { sweep(context, begin, end, 6); }
WIDE wide8(void *context, size_t begin, size_t end) { sweep(context, begin, end, 8); }
static sweeping *const wide[] = {wide4, wide6, wide8};

static sweeping *best(int terms) {
  int of = terms > 4 ? (terms - 3) / 2 : 0;
  return __builtin_cpu_supports("avx2") ? wide[of] : narrow[of];
}
#else
static sweeping *best(int terms) { return narrow[terms > 4 ? (terms - 3) / 2 : 0]; }
#endif

static double *change_at(const hk_stoermer *m, const hk_system *s, int64_t place) {
  return m->change + (place ? 3 * s->n : 0);
}

/* A step of the recurrence, with the slope `a` that is evaluated in it. */
static hk_status recur(hk_stoermer *m, hk_system *s, const hk_stoermer_method *f, double *a, double h) {
  size_t v = 3 * s->n, y = 6 * s->n;
  advance all = {recall(m, s, f, h),           s->X, s->spare, s->spare + v, change_at(m, s, m->current),
                 change_at(m, s, !m->current), h};
  hk_status status = s->pass(s, s->t, s->X, s->X + v, s->X + y, a, a + v, &(hk_pass){&all, NULL, best(f->terms)});
  if (status != HK_OK) return status;
  memcpy(s->spare + y, s->X + y, (s->size - y) * sizeof *s->X);
  for (int j = 0; j < f->terms; j++)
    for (size_t e = y; e < s->size; e++) s->spare[e] += all.p.rate[j] * all.p.slope[j][e - v];
  s->exchange(s);
  m->current = !m->current;
  return HK_OK;
}

/* One Dormand-Prince step; d = v + h sum (b A)_l a_l is the change of x divided by h. */
static hk_status dormand_prince(hk_stoermer *m, hk_system *s, const double *slope, double h) {
  hk_tableau T = hk_dormand_prince;
  T.stages = 6; /* the seventh is for the error estimate only */
  size_t v = 3 * s->n;
  memcpy(m->start, slope, (s->size - v) * sizeof *slope);
  hk_status status = hk_rk_stages(&T, s, h, m->start, 1);
  if (status != HK_OK) return status;
  double *change = change_at(m, s, m->current);
  memcpy(change, s->X + v, v * sizeof *slope);
  for (int l = 0; l < T.stages; l++) {
    double w = 0;
    for (int j = l + 1; j < T.stages; j++) w += h * T.b[j] * T.a[j][l];
    const double *a = hk_rk_slope(s, m->start, l);
    for (size_t e = 0; e < v; e++) change[e] += w * a[e];
  }
  hk_rk_combine(&T, s, h, m->start, T.b, T.stages, 1, s->X, s->X);
  return HK_OK;
}

static_assert((int)HK_EXTRAPOLATION_STATES <= (int)HK_STOERMER_START, "the field is wide enough for both");

static hk_status extrapolated(hk_stoermer *m, hk_system *s, const double *slope, double h) {
  const double *by;
  hk_status status = hk_extrapolated_change(s, h, slope, m->start, &by);
  if (status != HK_OK) return status;
  double *change = change_at(m, s, m->current);
  for (size_t e = 0; e < 3 * s->n; e++) change[e] = by[e] / h;
  for (size_t e = 0; e < s->size; e++) s->X[e] += by[e];
  return HK_OK;
}

/* A first step, and the change of x in it. */
static hk_status start(hk_stoermer *m, hk_system *s, const hk_stoermer_method *f, double *slope, double h) {
  size_t v = 3 * s->n;
  hk_status status = s->accelerations(s, s->t, s->X, s->X + v, s->X + 2 * v, slope, slope + v);
  if (status != HK_OK) return status;
  return f->order > 5 ? extrapolated(m, s, slope, h) : dormand_prince(m, s, slope, h);
}

hk_status hk_stoermer_step(hk_stoermer *m, const hk_stoermer_method *f, hk_system *s, double h) {
  double *a = ring(m, s, f->terms, m->head);
  if (h != m->h) m->known = 0;
  bool starts = m->known < f->terms - 1;
  hk_status status = starts ? start(m, s, f, a, h) : recur(m, s, f, a, h);
  if (status != HK_OK) return status;
  m->h = h;
  m->head = (m->head + 1) % f->terms;
  if (starts) m->known++;
  return HK_OK;
}

void hk_stoermer_reset(void *self, hk_reason why) {
  (void)why;
  ((hk_stoermer *)self)->known = 0;
}
