/* Stoermer's method in summed form, with backward differences D of the accelerations at the last steps:
 *     d' = d + h sum sigma_j D^j a,   x' = x + h d',   v' = d' + h sum (gamma_j - sigma_j) D^(j-1) a,
 *     y' = y + h sum gamma_j D^j dy,
 * where d is the last change of x divided by h, so that rounding does not grow as in x' - 2x + x_before (Hairer,
 * Norsett and Wanner, Solving ODEs I, III.10). v' equals the result of the Adams-Bashforth method of the same order,
 * with coefficients gamma_j; computed from d' it cannot drift away from the change of x. No d is stored: it is v less
 * the sum that the step before has added. The first steps use the Dormand-Prince method of order 5, or extrapolation,
 * whose change of x gives the first d without a subtraction; v is then made the method's own.
 *
 * The coefficients belong to the method: up to its order they are those of the series, and beyond it they are chosen
 * for a wide range of stable steps. */
#include "plugins/common/multistep/stoermer.h"
#include "plugins/common/multistep/extrapolation.h"
#include "plugins/kit/integrate/growth_factor.h"

#include <assert.h>
#include <complex.h>
#include <string.h>

/* The binomial coefficient of n, at most HK_STOERMER_TERMS, and k. */
static double binomial(int n, int k) {
  static const double row[HK_STOERMER_TERMS + 1][HK_STOERMER_TERMS + 1] = {{1},
                                                                           {1, 1},
                                                                           {1, 2, 1},
                                                                           {1, 3, 3, 1},
                                                                           {1, 4, 6, 4, 1},
                                                                           {1, 5, 10, 10, 5, 1},
                                                                           {1, 6, 15, 20, 15, 6, 1},
                                                                           {1, 7, 21, 35, 35, 21, 7, 1},
                                                                           {1, 8, 28, 56, 70, 56, 28, 8, 1}};
  return row[n][k];
}

/* c += factor u^power (1 + u)^rest */
static void add_term(double *c, double factor, int power, int rest) {
  for (int k = 0; k <= rest; k++) c[power + k] += factor * binomial(rest, k);
}

/* With lambda = 1 + u, D is u/(1 + u), and the recurrence's polynomial is
 *     u^2 (1 + u)^(k-1) + (h w)^2 sum sigma_j u^j (1 + u)^(k-j) + h g sum gamma_j u^(j+1) (1 + u)^(k-1-j),
 * with g + i b in place of g where velocities rotate. */
double hk_stoermer_growth(const void *self, const void *method, double hw, double hg, double hb) {
  const hk_stoermer_method *f = method;
  double c[HK_STOERMER_TERMS + 2] = {0}, turned[HK_STOERMER_TERMS + 2] = {0};
  double complex sum[HK_STOERMER_TERMS + 2];
  (void)self;
  add_term(c, 1, 2, f->terms - 1);
  for (int j = 0; j < f->terms; j++) {
    add_term(c, hw * hw * f->sigma[j], j, f->terms - j);
    add_term(c, hg * f->gamma[j], j + 1, f->terms - 1 - j);
    if (hb != 0) add_term(turned, hb * f->gamma[j], j + 1, f->terms - 1 - j);
  }
  if (hb == 0) return hk_polynomial_growth(f->terms + 1, c);
  for (int k = 0; k <= f->terms + 1; k++) sum[k] = c[k] + turned[k] * I;
  return hk_complex_polynomial_growth(f->terms + 1, sum);
}

enum { LINE = 8 }; /* numbers of a cache line */

/* A slope has size - 3 n numbers. They begin with a cache line, where the field has room for that. */
static double *ring(const hk_stoermer *m, const hk_system *s, int terms, int64_t place) {
  size_t length = s->size - 3 * s->n, whole = (length + LINE - 1) / LINE * LINE;
  return m->slope + (size_t)(place % terms) * (whole < s->size ? whole : length);
}

static void weigh(hk_stoermer_weights *w, const hk_stoermer_method *f, double h) {
  if (w->h == h) return;
  *w = (hk_stoermer_weights){.h = h};
  for (int j = 0; j < f->terms; j++)
    for (int i = 0; i <= j; i++) {
      double part = h * binomial(j, i) * (i % 2 ? -1 : 1);
      w->change[i] += f->sigma[j] * part;
      w->rate[i] += f->gamma[j] * part;
      if (i < j) w->lead[i] += (f->gamma[j] - f->sigma[j]) * h * binomial(j - 1, i) * (i % 2 ? -1 : 1);
    }
}

typedef struct advance {
  const double *slope[HK_STOERMER_TERMS]; /* newest first; the newest in places that the method does not use */
  double next[HK_STOERMER_TERMS], lead[HK_STOERMER_TERMS]; /* of the slopes, in d' - v and in v' - d' */
  const double *x, *v;
  double *x_next, *v_next, h;
} advance;

/* Updates all arrays at once, because memory bandwidth limits a step. The first `terms` slopes count: 4, 5, 6 or 8,
 * known when it is compiled; the oldest has no part in v' - d'. What is written has no other name, or the loop would
 * not become one of vectors. `here`: in place. */
HK_INLINE void update(const advance *all, double *restrict x_next, double *restrict v_next, size_t begin, size_t end,
                      int terms, bool here) {
  const double *x = here ? x_next : all->x, *v = here ? v_next : all->v, *const *a = all->slope, *w = all->next,
               *l = all->lead, h = all->h;
  for (size_t e = begin; e < end; e++) {
    double change = w[0] * a[0][e] + w[1] * a[1][e] + w[2] * a[2][e] + w[3] * a[3][e];
    double lead = l[0] * a[0][e] + l[1] * a[1][e] + l[2] * a[2][e];
    if (terms > 4) lead += l[3] * a[3][e];
    if (terms == 5) change += w[4] * a[4][e];
    if (terms > 5) change += w[4] * a[4][e] + w[5] * a[5][e], lead += l[4] * a[4][e];
    if (terms > 6) change += w[6] * a[6][e] + w[7] * a[7][e], lead += l[5] * a[5][e] + l[6] * a[6][e];
    double d = v[e] + change;
    x_next[e] = x[e] + h * d;
    v_next[e] = d + lead;
  }
}

HK_INLINE void advance_range(const advance *all, size_t begin, size_t end, int terms, bool here) {
  update(all, all->x_next, all->v_next, 3 * begin, 3 * end, terms, here);
}

#define PARAMETERS (void *context, size_t begin, size_t end)
#define ADVANCE(terms)                                                                                                 \
  HK_VERSIONS(static void, advance_range##terms, PARAMETERS, advance_range(context, begin, end, terms, false))         \
  HK_VERSIONS(static void, advance_here##terms, PARAMETERS, advance_range(context, begin, end, terms, true))
ADVANCE(4)
ADVANCE(5)
ADVANCE(6)
ADVANCE(8)

typedef void range_function(void *context, size_t begin, size_t end);

#define BEST(name, terms)                                                                                              \
  ((terms) > 6   ? HK_WIDEST(lanes, name##8)                                                                           \
   : (terms) > 5 ? HK_WIDEST(lanes, name##6)                                                                           \
   : (terms) > 4 ? HK_WIDEST(lanes, name##5)                                                                           \
                 : HK_WIDEST(lanes, name##4))

static range_function *best(int lanes, int terms, bool here) {
  return here ? BEST(advance_here, terms) : BEST(advance_range, terms);
}

/* The step from `from` to `to` whose slope is at position `head` of the ring. */
static advance advance_of(const hk_stoermer *m, const hk_system *s, const hk_stoermer_method *f, int64_t head,
                          const double *from, double *to) {
  const hk_stoermer_weights *w = &m->weights;
  size_t v = 3 * s->n;
  advance all = {.x = from, .v = from + v, .x_next = to, .v_next = to + v, .h = w->h};
  for (int j = 0; j < HK_STOERMER_TERMS; j++) {
    all.slope[j] = ring(m, s, f->terms, j < f->terms ? head + f->terms - j : head);
    all.next[j] = w->change[j] - (j > 0 ? w->lead[j - 1] : 0);
    all.lead[j] = w->lead[j];
  }
  return all;
}

/* Channels and work. */
static void advance_rest(const hk_stoermer *m, const hk_system *s, const hk_stoermer_method *f, const advance *all,
                         const double *from, double *to) {
  size_t v = 3 * s->n, y = 6 * s->n;
  memmove(to + y, from + y, (s->size - y) * sizeof *to);
  for (int j = 0; j < f->terms; j++)
    for (size_t e = y; e < s->size; e++) to[e] += m->weights.rate[j] * all->slope[j][e - v];
}

/* A step of the recurrence, with the slope `a` that is evaluated in it. */
static hk_status recur(hk_stoermer *m, hk_system *s, const hk_stoermer_method *f, double *a) {
  size_t v = 3 * s->n, y = 6 * s->n;
  advance all = advance_of(m, s, f, m->head, s->X, s->spare);
  hk_status status = s->fused(s, s->t, s->X, s->X + v, s->X + y, a, a + v,
                              &(hk_fused){&all, NULL, best(s->host->lanes, f->terms, false)});
  if (status != HK_OK) return status;
  advance_rest(m, s, f, &all, s->X, s->spare);
  s->exchange(s);
  return HK_OK;
}

static hk_status steps(void *self, const void *method, hk_system *s, const double *t, double h, size_t *count) {
  hk_stoermer *m = self;
  const hk_stoermer_method *f = method;
  size_t v = 3 * s->n;
  double *next = s->spare;
  advance all[HK_TILE_STEPS];
  hk_tile_step step[HK_TILE_STEPS];
  if (h != m->h || m->known < f->terms - 1) *count = 0; /* no history yet */
  for (size_t k = 0; k < *count; k++) {
    int64_t head = (m->head + (int64_t)k) % f->terms;
    double *from = k ? next : s->X;
    all[k] = advance_of(m, s, f, head, from, next);
    hk_fused work = {&all[k], NULL, best(s->host->lanes, f->terms, k > 0)};
    step[k] = (hk_tile_step){k ? t[k - 1] : s->t, from, from + v, ring(m, s, f->terms, head), work, 0};
  }
  hk_status status = *count ? s->tile(s, step, *count) : HK_OK;
  if (status != HK_OK) return status;
  for (size_t k = 0; k < *count; k++) {
    step[k].a[v] = step[k].power;
    advance_rest(m, s, f, &all[k], k ? next : s->X, next);
  }
  m->head = (m->head + (int64_t)*count) % f->terms;
  return HK_OK;
}

/* One Dormand-Prince step; d = v + h sum (b A)_l a_l (n x 3) is the change of x divided by h. */
static hk_status dormand_prince(hk_stoermer *m, hk_system *s, const double *slope, double h, double *d) {
  hk_tableau T = hk_dormand_prince;
  T.stages = 6; /* the seventh is for the error estimate only */
  size_t v = 3 * s->n;
  memcpy(m->start, slope, (s->size - v) * sizeof *slope);
  hk_status status = hk_rk_stages(&T, s, h, m->start, 1);
  if (status != HK_OK) return status;
  memcpy(d, s->X + v, v * sizeof *slope);
  for (int l = 0; l < T.stages; l++) {
    double w = 0;
    for (int j = l + 1; j < T.stages; j++) w += h * T.b[j] * T.a[j][l];
    const double *a = hk_rk_slope(s, m->start, l);
    for (size_t e = 0; e < v; e++) d[e] += w * a[e];
  }
  hk_rk_combine(&T, s, h, m->start, T.b, T.stages, 1, s->X, s->X);
  return HK_OK;
}

static_assert((int)HK_EXTRAPOLATION_STATES <= (int)HK_STOERMER_START, "the field is wide enough for both");

static hk_status extrapolated(hk_stoermer *m, hk_system *s, const double *slope, double h, double *d) {
  const double *by;
  hk_status status = hk_extrapolated_change(s, h, slope, m->start, &by);
  if (status != HK_OK) return status;
  for (size_t e = 0; e < 3 * s->n; e++) d[e] = by[e] / h;
  for (size_t e = 0; e < s->size; e++) s->X[e] += by[e];
  return HK_OK;
}

/* v of the method, which follows from d and the history. */
static void own_velocity(const hk_stoermer *m, hk_system *s, const hk_stoermer_method *f, const double *d) {
  size_t v = 3 * s->n;
  memcpy(s->X + v, d, v * sizeof *d);
  for (int i = 0; i + 1 < f->terms; i++) {
    const double *a = ring(m, s, f->terms, m->head + f->terms - i), w = m->weights.lead[i];
    for (size_t e = 0; e < v; e++) s->X[v + e] += w * a[e];
  }
}

/* A first step; `slope` is the newest of the history. */
static hk_status start(hk_stoermer *m, hk_system *s, const hk_stoermer_method *f, double *slope, double h, bool last) {
  size_t v = 3 * s->n;
  double *d = s->spare;
  hk_status status = s->accelerations(s, s->t, s->X, s->X + v, s->X + 2 * v, slope, slope + v);
  if (status != HK_OK) return status;
  status = f->order > 5 ? extrapolated(m, s, slope, h, d) : dormand_prince(m, s, slope, h, d);
  if (status == HK_OK && last) own_velocity(m, s, f, d);
  return status;
}

hk_status hk_stoermer_step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  hk_stoermer *m = self;
  const hk_stoermer_method *f = method;
  double *a = ring(m, s, f->terms, m->head);
  (void)t_stop, (void)out;
  if (h != m->h) m->known = 0;
  bool starts = m->known < f->terms - 1;
  weigh(&m->weights, f, h);
  hk_status status = starts ? start(m, s, f, a, h, m->known == f->terms - 2) : recur(m, s, f, a);
  if (status != HK_OK) return status;
  m->h = h;
  m->head = (m->head + 1) % f->terms;
  if (starts) m->known++;
  return HK_OK;
}

static const hk_tile_facet tile = {.size = sizeof(hk_tile_facet), .steps = steps};
const hk_facet hk_stoermer_facets[] = {{HK_TILE_ID, &tile}, {0}};

void hk_stoermer_reset(void *self, hk_reason why) {
  (void)why;
  ((hk_stoermer *)self)->known = 0;
}
