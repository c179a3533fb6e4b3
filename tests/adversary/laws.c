/* The laws of force in long double, from the formulas that `hooke plugins NAME` documents. */
#include "tests/adversary/adversary.h"

#include <math.h>
#include <string.h>

static adv_real dot(const adv_real *a, const adv_real *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static bool acts(const adv_system *s, const adv_force *f) { return s->inside >= f->from && s->inside < f->to; }

static bool on(const adv_force *f, int i) { return !f->only || f->only >> i & 1; }

static bool held(const adv_system *s, const adv_pin *p) { return s->inside < p->release; }

static void vector_at(const adv_vector *v, adv_real t, adv_real inside, adv_real at[3], adv_real rate[3]) {
  adv_real r, f = adv_wave_at(&v->wave, t, inside, &r);
  for (int c = 0; c < 3; c++) at[c] = v->base[c] + v->along[c] * f, rate[c] = v->along[c] * r;
}

void adv_impose(const adv_system *s, adv_real t, adv_real *y) {
  const adv_scene *m = s->scene;
  for (int k = 0; k < m->pins; k++) {
    const adv_pin *p = &m->pin[k];
    adv_real *x = y + 3 * p->particle, *v = x + 3 * m->n, at[3] = {0}, rate[3] = {0};
    if (!held(s, p)) continue;
    if (p->hold == ADV_PATH) vector_at(&p->path, t, s->inside, at, rate);
    for (int c = 0; c < 3; c++) {
      bool moves = (p->hold == ADV_LINE && c == p->axis) || (p->hold == ADV_PLANE && c != p->axis);
      if (!moves) x[c] = m->x[p->particle][c] + at[c], v[c] = rate[c];
    }
  }
}

/* d, its length and the speed at which it grows. */
static adv_real stretch(const adv_real *x, const adv_real *v, const int pair[2], adv_real d[3], adv_real *rate) {
  adv_real u[3];
  for (int c = 0; c < 3; c++)
    d[c] = x[3 * pair[1] + c] - x[3 * pair[0] + c], u[c] = v[3 * pair[1] + c] - v[3 * pair[0] + c];
  adv_real l = sqrtl(dot(d, d));
  *rate = l > 0 ? dot(u, d) / l : 0;
  return l;
}

adv_rope adv_rope_at(const adv_system *s, const adv_force *f, int edge, adv_real t, const adv_real *from) {
  adv_real y[ADV_STATE], d[3];
  adv_rope r;
  size_t size = (size_t)(6 * s->scene->n);
  memcpy(y, from, size * sizeof *y);
  adv_impose(s, t, y);
  r.stretch = stretch(y, y + 3 * s->scene->n, f->edge[edge], d, &r.rate) - f->rest[edge];
  r.tension = f->k * r.stretch + f->damping * r.rate;
  return r;
}

static adv_real tension(const adv_force *f, int e, int mode, adv_real l, adv_real rate) {
  adv_real s = l - f->rest[e];
  if (f->law == ADV_CUBIC) return f->k * s * s * s;
  if (f->law == ADV_ROPES && mode != ADV_TAUT) return 0;
  return f->k * s + f->damping * rate;
}

static void add_edges(const adv_system *s, const adv_force *f, const adv_real *x, const adv_real *v, adv_real *F) {
  long first = (f - s->scene->force) * ADV_EDGES;
  for (int e = 0; e < f->edges; e++) {
    const int *pair = f->edge[e];
    adv_real d[3], rate, l;
    if (!on(f, pair[0]) || !on(f, pair[1])) continue;
    l = stretch(x, v, pair, d, &rate);
    adv_real T = l > 0 ? tension(f, e, s->mode[first + e], l, rate) / l : 0;
    for (int c = 0; c < 3; c++) F[3 * pair[0] + c] += T * d[c], F[3 * pair[1] + c] -= T * d[c];
  }
}

static void add_central(const adv_force *f, const adv_real centre[3], adv_real strength, const adv_real *x,
                        adv_real *F) {
  adv_real r[3];
  for (int c = 0; c < 3; c++) r[c] = x[c] - centre[c];
  adv_real square = dot(r, r) + (adv_real)f->softening * f->softening;
  for (int c = 0; c < 3; c++) F[c] -= strength * powl(square, (f->power - 1.0L) / 2) * r[c];
}

static void add_each(const adv_system *s, const adv_force *f, adv_real t, const adv_real *x, const adv_real *v,
                     adv_real *F) {
  const adv_scene *m = s->scene;
  adv_real at[3], rate[3], unused, strength = adv_wave_at(&f->strength, t, s->inside, &unused);
  vector_at(&f->vector, t, s->inside, at, rate);
  for (int i = 0; i < m->n; i++) {
    adv_real mass = m->mass[i], weight = f->per_mass ? mass : 1, amount = f->amount * weight;
    const adv_real *w = v + 3 * i;
    if (!on(f, i)) continue;
    for (int c = 0; c < 3 && f->law == ADV_GRAVITY; c++) F[3 * i + c] += mass * at[c];
    for (int c = 0; c < 3 && f->law == ADV_DRAG; c++) F[3 * i + c] -= amount * w[c];
    for (int c = 0; c < 3 && f->law == ADV_MAGNETIC; c++) {
      int d = (c + 1) % 3, e = (c + 2) % 3;
      F[3 * i + c] += amount * (w[d] * at[e] - w[e] * at[d]);
    }
    if (f->law == ADV_CENTRAL) add_central(f, at, strength * weight, x + 3 * i, F + 3 * i);
  }
}

static void channel_rates(const adv_scene *m, adv_real t, const adv_real *y, adv_real *dy) {
  adv_real r1 = m->rate[0], r2 = m->rate[1], r3 = m->rate[2];
  switch (m->kinetics) {
  case ADV_NO_CHANNEL:
    return;
  case ADV_DECAY:
    dy[0] = -r1 * y[0];
    return;
  case ADV_RELAXATION:
    dy[0] = -r1 * (y[0] - cosl(r2 * t));
    return;
  case ADV_ROBERTSON:
    dy[0] = r3 * y[1] * y[2] - r1 * y[0];
    dy[2] = r2 * y[1] * y[1];
    dy[1] = -dy[0] - dy[2];
    return;
  case ADV_VAN_DER_POL:
    dy[0] = y[1], dy[1] = r1 * (1 - y[0] * y[0]) * y[1] - r2 * y[0];
    return;
  }
}

void adv_rates(const adv_system *s, adv_real t, const adv_real *from, adv_real *dy) {
  const adv_scene *m = s->scene;
  int n = m->n;
  adv_real y[ADV_STATE], F[3 * ADV_PARTICLES] = {0}, *v = y + 3 * n;
  memcpy(y, from, (size_t)((6 + m->size) * n) * sizeof *y);
  adv_impose(s, t, y);
  for (int k = 0; k < m->forces; k++) {
    const adv_force *f = &m->force[k];
    if (!acts(s, f) || f->law == ADV_BARS) continue;
    if (f->edges > 0)
      add_edges(s, f, y, v, F);
    else
      add_each(s, f, t, y, v, F);
  }
  adv_add_bars(s, y, F);
  for (int e = 0; e < 3 * n; e++) dy[e] = v[e], dy[3 * n + e] = F[e] / m->mass[e / 3];
  for (int k = 0; k < m->pins; k++)
    for (int c = 0; c < 3 && held(s, &m->pin[k]); c++) {
      const adv_pin *p = &m->pin[k];
      bool moves = (p->hold == ADV_LINE && c == p->axis) || (p->hold == ADV_PLANE && c != p->axis);
      if (!moves) dy[3 * p->particle + c] = dy[3 * (n + p->particle) + c] = 0;
    }
  for (int i = 0; i < n; i++) channel_rates(m, t, y + 6 * n + i * m->size, dy + 6 * n + i * m->size);
}

static adv_real wave_limit(const adv_wave *f) {
  return f->shape == ADV_SINE && f->w != 0 ? 1.5L / fabsl((adv_real)f->w) : INFINITY;
}

/* A third of the shortest time in which a rope that is taut turns a motion round. */
static adv_real rope_limit(const adv_scene *m, const adv_force *f) {
  adv_real stiffness = 0;
  for (int e = 0; e < f->edges; e++)
    for (int end = 0; end < 2; end++) stiffness += 2 * (adv_real)f->k / m->mass[f->edge[e][end]];
  return f->law == ADV_ROPES ? 1 / sqrtl(stiffness + 1e-30L) : INFINITY;
}

/* Half the way to the centre: what pulls only nearby is not stepped over. */
static adv_real flyby_limit(const adv_scene *m, const adv_force *f, const adv_real centre[3], const adv_real *y) {
  adv_real limit = INFINITY, r[3];
  for (int i = 0; i < m->n; i++) {
    const adv_real *v = y + 3 * (m->n + i);
    for (int c = 0; c < 3; c++) r[c] = y[3 * i + c] - centre[c];
    limit = fminl(limit, sqrtl((dot(r, r) + (adv_real)f->softening * f->softening) / (dot(v, v) + 1e-30L)) / 2);
  }
  return limit;
}

adv_real adv_longest_step(const adv_system *s, adv_real t, const adv_real *y) {
  const adv_scene *m = s->scene;
  adv_real limit = INFINITY;
  for (int k = 0; k < m->pins; k++)
    if (m->pin[k].hold == ADV_PATH) limit = fminl(limit, wave_limit(&m->pin[k].path.wave));
  for (int k = 0; k < m->forces; k++) {
    const adv_force *f = &m->force[k];
    adv_real centre[3], rate[3];
    limit = fminl(limit, fminl(wave_limit(&f->vector.wave), wave_limit(&f->strength)));
    limit = fminl(limit, rope_limit(m, f));
    if (f->law != ADV_CENTRAL || f->power >= 0) continue;
    vector_at(&f->vector, t, s->inside, centre, rate);
    limit = fminl(limit, flyby_limit(m, f, centre, y));
  }
  return limit;
}
