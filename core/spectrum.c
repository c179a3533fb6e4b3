/* Bounds on the spectrum, without a matrix.
 *
 * The operators K^ = M^-1/2 K M^-1/2 and D^ = M^-1/2 D M^-1/2 are applied by central differences of the accelerations.
 * Lanczos' three-term recurrence, from a fixed pseudo-random start, gives the largest Ritz value theta and the norm r
 * of its residual; as in Zhou and Li 2011 ("Bounding the spectrum of large Hermitian matrices") the bound is theta + r,
 * which iteration draws together, and not theta, which lies below (power iteration alone would make the step too
 * large). Where elements cover the forces, Gershgorin's rows over them bound it from above at any shape of the scene:
 * the smaller of the two is taken. Least damping: alpha from how a rigid motion is damped, beta as the least c/k. */
#include "core/spectrum.h"

#include <stdlib.h>
#include <string.h>

enum { ITERATIONS = 48 };
static const double settled = 0.01; /* residual relative to theta: then the bound is within a percent */

typedef struct probe {
  hk_system *s;
  hk_error *error;
  size_t count;                          /* 3n */
  double *x, *v, *y;                     /* the state, and room to move it */
  double *forward, *backward, *dy, *dy2; /* accelerations */
  double *q, *before, *next;             /* Lanczos vectors */
  double *root;                          /* sqrt of the inverse mass, per component */
  double step;                           /* m or m/s, largest displacement of a difference */
  bool velocity;                         /* probe D instead of K */
} probe;

static void free_probe(probe *p) {
  free(p->x);
  free(p->forward);
}

static hk_status open_probe(probe *p) {
  size_t n3 = p->count, size = p->s->size;
  p->x = malloc((2 * size) * sizeof *p->x);
  p->forward = calloc(6 * n3 + 2 * (size - 2 * n3) + 1, sizeof *p->forward);
  if (!p->x || !p->forward) return hk_error_set(p->error, HK_NO_MEMORY, "no memory to estimate the stable step");
  memcpy(p->x, p->s->X, size * sizeof *p->x);
  p->v = p->x + n3;
  p->y = p->x + 2 * n3;
  p->backward = p->forward + n3;
  p->q = p->backward + n3;
  p->before = p->q + n3;
  p->next = p->before + n3;
  p->root = p->next + n3;
  p->dy = p->root + n3;
  p->dy2 = p->dy + (size - 2 * n3);
  for (size_t e = 0; e < n3; e++) p->root[e] = sqrt(p->s->model->inverse_mass[e / 3]);
  return HK_OK;
}

/* The smallest positive rest or edge length, else the extent of the scene, else 1 m. */
static double length_scale(const hk_system *s) {
  double least = INFINITY, low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY},
         extent = 0;
  for (size_t k = 0; k < s->model->element_lists; k++) {
    const hk_elements *e = &s->model->element_list[k].elements;
    for (size_t j = 0; j < e->rest.count; j++)
      if (e->rest.value[j] > 0) least = fmin(least, e->rest.value[j]);
  }
  if (isfinite(least)) return least;
  for (size_t e = 0; e < 3 * s->n; e++) {
    low[e % 3] = fmin(low[e % 3], s->X[e]);
    high[e % 3] = fmax(high[e % 3], s->X[e]);
  }
  for (int c = 0; c < 3 && s->n; c++) extent = fmax(extent, high[c] - low[c]);
  return extent > 0 ? extent : 1;
}

/* next = K^ q (or D^ q): -(a(x + e d) - a(x - e d)) / 2e with d = M^-1/2 q, times M^1/2. */
static hk_status apply(probe *p) {
  double *moved = p->velocity ? p->v : p->x, largest = 0;
  const double *still = p->s->X + (p->velocity ? p->count : 0);
  for (size_t e = 0; e < p->count; e++) largest = fmax(largest, fabs(p->root[e] * p->q[e]));
  double scale = largest > 0 ? p->step / largest : 0;
  if (scale == 0) {
    memset(p->next, 0, p->count * sizeof *p->next);
    return HK_OK;
  }
  for (size_t e = 0; e < p->count; e++) moved[e] = still[e] + scale * p->root[e] * p->q[e];
  hk_status status = p->s->accelerations(p->s, p->s->t, p->x, p->v, p->y, p->forward, p->dy);
  for (size_t e = 0; e < p->count; e++) moved[e] = still[e] - scale * p->root[e] * p->q[e];
  if (status == HK_OK) status = p->s->accelerations(p->s, p->s->t, p->x, p->v, p->y, p->backward, p->dy);
  memcpy(moved, still, p->count * sizeof *moved);
  for (size_t e = 0; e < p->count; e++)
    p->next[e] = p->root[e] > 0 ? (p->backward[e] - p->forward[e]) / (2 * scale * p->root[e]) : 0;
  return status;
}

static double dot(const double *a, const double *b, size_t count) {
  double sum = 0;
  for (size_t e = 0; e < count; e++) sum += a[e] * b[e];
  return sum;
}

/* How many eigenvalues of the tridiagonal matrix are below z (Sturm's sequence). */
static int below(const double *diagonal, const double *off, int m, double z) {
  int count = 0;
  double d = 1;
  for (int k = 0; k < m; k++) {
    d = diagonal[k] - z - (k ? off[k - 1] * off[k - 1] / d : 0);
    if (d == 0) d = 1e-300;
    count += d < 0;
  }
  return count;
}

static double largest_ritz(const double *diagonal, const double *off, int m) {
  double low = -INFINITY, high = -INFINITY;
  for (int k = 0; k < m; k++) {
    double reach = (k ? fabs(off[k - 1]) : 0) + (k + 1 < m ? fabs(off[k]) : 0);
    high = fmax(high, diagonal[k] + reach);
    low = fmax(low, diagonal[k]); /* a Rayleigh quotient */
  }
  for (int k = 0; k < 60 && high - low > 1e-12 * fabs(high); k++) {
    double middle = low + (high - low) / 2;
    if (below(diagonal, off, m, middle) == m)
      high = middle;
    else
      low = middle;
  }
  return high;
}

/* The last component of theta's unit eigenvector: times the next beta, the norm of its residual. */
static double last_component(const double *diagonal, const double *off, int m, double theta) {
  double s[ITERATIONS + 1] = {1}, sum = 1;
  for (int k = 0; k + 1 < m; k++) {
    if (off[k] == 0) return 0;
    s[k + 1] = ((theta - diagonal[k]) * s[k] - (k ? off[k - 1] * s[k - 1] : 0)) / off[k];
    sum += s[k + 1] * s[k + 1];
  }
  return fabs(s[m - 1]) / sqrt(sum);
}

static void random_start(probe *p) {
  uint64_t state = 88172645463325252u; /* xorshift64, Marsaglia 2003 */
  for (size_t e = 0; e < p->count; e++) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    p->q[e] = p->root[e] > 0 ? (double)(state >> 11) * 0x1.0p-52 - 1 : 0;
  }
  p->s->filter(p->s, p->q);
  double norm = sqrt(dot(p->q, p->q, p->count));
  for (size_t e = 0; e < p->count && norm > 0; e++) p->q[e] /= norm;
  memset(p->before, 0, p->count * sizeof *p->before);
}

static hk_status lanczos(probe *p, double *bound) {
  double diagonal[ITERATIONS], off[ITERATIONS], beta = 0, theta = 0, residual = 0;
  random_start(p);
  for (int k = 0; k < ITERATIONS; k++) {
    hk_status status = apply(p);
    if (status != HK_OK) return status;
    diagonal[k] = dot(p->q, p->next, p->count);
    for (size_t e = 0; e < p->count; e++) p->next[e] -= diagonal[k] * p->q[e] + beta * p->before[e];
    off[k] = beta = sqrt(dot(p->next, p->next, p->count));
    theta = largest_ritz(diagonal, off, k + 1);
    residual = beta * last_component(diagonal, off, k + 1, theta);
    bool exhausted = beta <= 1e-7 * fabs(theta) || k + 1 >= (int)p->count;
    if (exhausted) residual = fmin(residual, 1e-6 * fabs(theta));
    if (exhausted || beta == 0 || (k > 8 && residual < settled * theta)) break;
    double *old = p->before;
    p->before = p->q;
    p->q = p->next;
    p->next = old;
    for (size_t e = 0; e < p->count; e++) p->q[e] /= beta;
  }
  *bound = fmax(0, theta + residual);
  return HK_OK;
}

/* Row sums over the elements; a compressed element's lateral stiffness may exceed its own. */
static double gershgorin(const hk_system *s, double *row) {
  double largest = 0;
  memset(row, 0, s->n * sizeof *row);
  for (size_t l = 0; l < s->model->element_lists; l++) {
    const hk_elements *e = &s->model->element_list[l].elements;
    for (size_t k = 0; k < e->count; k++) {
      uint32_t i = e->pair[k][0], j = e->pair[k][1];
      double wi = s->model->inverse_mass[i], wj = s->model->inverse_mass[j], length = 0;
      for (int c = 0; c < 3; c++) length += pow(s->X[3 * (size_t)j + c] - s->X[3 * (size_t)i + c], 2);
      double value = hk_edge_value(&e->stiffness, k), rest = hk_edge_value(&e->rest, k);
      if (length > 0) value *= fmax(1, fabs(1 - rest / sqrt(length)));
      row[i] += value * (wi + sqrt(wi * wj));
      row[j] += value * (wj + sqrt(wi * wj));
    }
  }
  for (size_t i = 0; i < s->n; i++) largest = fmax(largest, row[i]);
  return largest;
}

static double least_ratio(const hk_system *s) {
  double least = INFINITY;
  for (size_t l = 0; l < s->model->element_lists; l++) {
    const hk_elements *e = &s->model->element_list[l].elements;
    bool common = e->stiffness.count == 1 && e->damping.count == 1;
    for (size_t k = 0; k < (common && e->count ? 1 : e->count); k++) {
      double stiffness = hk_edge_value(&e->stiffness, k);
      if (stiffness > 0) least = fmin(least, hk_edge_value(&e->damping, k) / stiffness);
    }
  }
  return isfinite(least) ? least : 0;
}

/* A rigid motion is damped by drag alone; springs to pinned neighbours only add to it. */
static hk_status least_drag(probe *p, double *alpha) {
  *alpha = INFINITY;
  for (size_t c = 0; c < 3; c++) {
    for (size_t e = 0; e < p->count; e++) p->q[e] = e % 3 == c && p->root[e] > 0 ? 1 / p->root[e] : 0;
    hk_status status = apply(p);
    if (status != HK_OK) return status;
    for (size_t e = c; e < p->count; e += 3)
      if (p->root[e] > 0) *alpha = fmin(*alpha, p->next[e] * p->root[e]);
  }
  if (!isfinite(*alpha) || *alpha < 1e-6) *alpha = 0;
  return HK_OK;
}

static hk_status channel_rate(probe *p, double *rate) {
  size_t tail = p->s->size - 2 * p->count, channels = tail - 1;
  double largest = 0;
  *rate = 0;
  if (channels == 0) return HK_OK;
  for (size_t e = 0; e < channels; e++) largest = fmax(largest, fabs(p->y[e]));
  double move = 1e-6 * (largest > 0 ? largest : 1);
  for (size_t e = 0; e < channels; e++) p->y[e] += move;
  hk_status status = p->s->accelerations(p->s, p->s->t, p->x, p->v, p->y, p->forward, p->dy);
  for (size_t e = 0; e < channels; e++) p->y[e] -= 2 * move;
  if (status == HK_OK) status = p->s->accelerations(p->s, p->s->t, p->x, p->v, p->y, p->backward, p->dy2);
  for (size_t e = 0; e < channels; e++) *rate = fmax(*rate, (p->dy2[e] - p->dy[e]) / (2 * move));
  memcpy(p->y, p->s->X + 2 * p->count, tail * sizeof *p->y);
  return status;
}

static hk_status frequencies(probe *p, bool covered, hk_spectrum *spectrum) {
  double bound = 0;
  if (!(p->s->flags & HK_DEPENDS_ON_X)) return HK_OK;
  p->step = 1e-6 * length_scale(p->s); /* truncation (1e-6)^2, rounding eps/1e-6: both below 1e-9 of a spring's force */
  hk_status status = lanczos(p, &bound);
  if (status == HK_OK && covered) bound = fmin(bound, gershgorin(p->s, p->next));
  spectrum->w_max = sqrt(bound);
  if (covered) spectrum->beta = least_ratio(p->s);
  return status;
}

static hk_status damping(probe *p, hk_spectrum *spectrum) {
  if (!(p->s->flags & HK_DEPENDS_ON_V)) return HK_OK;
  p->velocity = true;
  p->step = 1e-3 * length_scale(p->s);
  hk_status status = lanczos(p, &spectrum->g_max);
  if (status == HK_OK) status = least_drag(p, &spectrum->alpha);
  return status;
}

hk_status hk_spectrum_estimate(hk_system *s, bool covered, hk_spectrum *spectrum, hk_error *error) {
  probe p = {.s = s, .error = error, .count = 3 * s->n};
  *spectrum = (hk_spectrum){0};
  hk_status status = open_probe(&p);
  if (status == HK_OK) status = frequencies(&p, covered, spectrum);
  if (status == HK_OK) status = damping(&p, spectrum);
  if (status == HK_OK) status = channel_rate(&p, &spectrum->channel_rate);
  free_probe(&p);
  return status;
}
