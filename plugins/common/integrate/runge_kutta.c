/* See runge_kutta.h. Weights w of the slopes in the velocity become w A in the position: x' = x + h (sum w) v + h^2 sum
 * (w A)_l a_l (Hairer, Norsett and Wanner, Solving ODEs I, II.14). Sums are computed in chunks that fit the first-level
 * cache. The stability function follows from the same tableau, by applying the method to y' = z y: Y_i = 1 + z sum a_ij
 * Y_j, R = 1 + z sum b_i Y_i (Hairer and Wanner, Solving ODEs II, IV.2). */
#include "plugins/common/integrate/runge_kutta.h"
#include "plugins/kit/integrate/growth_factor.h"

#include <complex.h>
#include <string.h>

enum { CHUNK = 512 };

/* Dormand and Prince 1980, RK5(4)7M. */
const hk_tableau hk_dormand_prince = {
    .stages = 7,
    .c = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1},
    .a = {{0},
          {1.0 / 5},
          {3.0 / 40, 9.0 / 40},
          {44.0 / 45, -56.0 / 15, 32.0 / 9},
          {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
          {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
          {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}},
    .b = {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84, 0},
};

static size_t stride(const hk_system *s) { return s->size - 3 * s->n; }

double *hk_rk_slope(const hk_system *s, double *k, int i) { return k + (size_t)i * stride(s); }

double *hk_rk_stage_state(const hk_tableau *T, const hk_system *s, double *k) { return hk_rk_slope(s, k, T->stages); }

typedef struct blend {
  int count;
  double drift; /* h sum w */
  const double *k[HK_RK_STAGES];
  double x[HK_RK_STAGES], v[HK_RK_STAGES]; /* h^2 w A and h w */
} blend;

static blend weigh(const hk_tableau *T, const hk_system *s, double h, double *k, const double *w, int count,
                   double total) {
  blend b = {.drift = h * total};
  for (int l = 0; l < count; l++) {
    double x = 0;
    for (int j = l + 1; j < count; j++) x += w[j] * T->a[j][l];
    if (x == 0 && w[l] == 0) continue;
    b.k[b.count] = hk_rk_slope(s, k, l);
    b.x[b.count] = h * h * x;
    b.v[b.count++] = h * w[l];
  }
  return b;
}

static void add(double *restrict to, const double *restrict k, size_t count, double w) {
  if (w == 0) return;
  for (size_t e = 0; e < count; e++) to[e] += w * k[e];
}

static void copy_drifted(double *restrict x_to, double *restrict v_to, const double *restrict x,
                         const double *restrict v, size_t count, double drift) {
  for (size_t e = 0; e < count; e++) {
    x_to[e] = x[e] + drift * v[e];
    v_to[e] = v[e];
  }
}

/* The numbers begin to end - 1 of x and of v; m = 3n. */
static void combine_range(const blend *b, size_t m, const double *X, double *into, size_t begin, size_t end) {
  for (; begin < end; begin += CHUNK) {
    size_t length = end - begin < CHUNK ? end - begin : CHUNK;
    double *x = into + begin, *v = into + m + begin;
    if (into == X)
      add(x, v, length, b->drift);
    else
      copy_drifted(x, v, X + begin, X + m + begin, length, b->drift);
    for (int j = 0; j < b->count; j++) {
      add(x, b->k[j] + begin, length, b->x[j]);
      add(v, b->k[j] + begin, length, b->v[j]);
    }
  }
}

/* Channels and work. */
static void combine_rest(const blend *b, const hk_system *s, const double *X, double *into) {
  size_t m = 3 * s->n, tail = s->size - 2 * m;
  if (into != X) memcpy(into + 2 * m, X + 2 * m, tail * sizeof *into);
  for (int j = 0; j < b->count; j++) add(into + 2 * m, b->k[j] + m, tail, b->v[j]);
}

void hk_rk_combine(const hk_tableau *T, const hk_system *s, double h, double *k, const double *weight, int count,
                   double total, const double *X, double *into) {
  blend b = weigh(T, s, h, k, weight, count, total);
  combine_range(&b, 3 * s->n, X, into, 0, 3 * s->n);
  combine_rest(&b, s, X, into);
}

/* What is done with the particles before a stage and after the last one. */
typedef struct stage {
  blend before, after;
  size_t m;
  const double *X;
  double *state, *end; /* of the stage; of the step */
} stage;

static void before(void *context, size_t begin, size_t end) {
  const stage *s = context;
  combine_range(&s->before, s->m, s->X, s->state, 3 * begin, 3 * end);
}

static void after(void *context, size_t begin, size_t end) {
  const stage *s = context;
  combine_range(&s->after, s->m, s->X, s->end, 3 * begin, 3 * end);
}

/* Stage i; `end`: where the new state is built with the last one, or NULL. A stage is a move, too: where there is
 * contact, forces have to know all of it before. */
static hk_status evaluate(const hk_tableau *T, hk_system *s, double h, double *k, int i, double *end) {
  size_t m = 3 * s->n;
  double *slope = hk_rk_slope(s, k, i);
  stage at = {.m = m, .X = s->X, .state = i ? hk_rk_stage_state(T, s, k) : s->X, .end = end};
  hk_fused work = {&at, NULL, end && i + 1 == T->stages ? after : NULL};
  hk_status status = HK_OK;
  if (i > 0) {
    at.before = weigh(T, s, h, k, T->a[i], i, T->c[i]);
    combine_rest(&at.before, s, s->X, at.state);
    work.before = s->contact ? NULL : before;
    if (s->contact) before(&at, 0, s->n);
    if (s->contact) status = s->contact->update(s, s->t, s->X, at.state);
  }
  if (work.after) at.after = weigh(T, s, h, k, T->b, T->stages, 1);
  if (status != HK_OK) return status;
  status = s->fused(s, s->t + T->c[i] * h, at.state, at.state + m, at.state + 2 * m, slope, slope + m, &work);
  if (status == HK_OK && work.after) combine_rest(&at.after, s, s->X, end);
  return status;
}

hk_status hk_rk_stages(const hk_tableau *T, hk_system *s, double h, double *k, int first) {
  hk_status status = HK_OK;
  for (int i = first; i < T->stages && status == HK_OK; i++) status = evaluate(T, s, h, k, i, NULL);
  return status;
}

hk_status hk_rk_step(void *self, const void *tableau, hk_system *s, double t_stop, double h, hk_step *out) {
  const hk_tableau *T = tableau;
  double *k = ((hk_runge_kutta *)self)->k;
  hk_status status = HK_OK;
  (void)t_stop, (void)out;
  for (int i = 0; i < T->stages && status == HK_OK; i++) status = evaluate(T, s, h, k, i, s->spare);
  if (status == HK_OK) s->exchange(s);
  return status;
}

static double stability(const hk_tableau *T, double complex z) {
  double complex Y[HK_RK_STAGES], R = 1;
  for (int i = 0; i < T->stages; i++) {
    Y[i] = 1;
    for (int j = 0; j < i; j++) Y[i] += z * T->a[i][j] * Y[j];
    R += z * T->b[i] * Y[i];
  }
  return cabs(R);
}

double hk_rk_growth(const void *self, const void *T, double hw, double hg, double hb) {
  (void)self;
  double complex z[2];
  hk_oscillator_roots(hw, hg + hb * I, z);
  return fmax(stability(T, z[0]), stability(T, z[1]));
}
