/* The reference: midpoint steps extrapolated to order 16 (Gragg, Bulirsch and Stoer; Hairer, Norsett and Wanner,
 * Solving ODEs I, II.9), in long double, with steps from the difference of the last two columns. Steps end at frames
 * and at every known change. A rope is slack, taut, or taut without tension through a whole step; where that is not so
 * at its end, the step is cut at the change, by bisection. Each scene is integrated three times, with two tolerances,
 * and from a start that is off by 1e-17: what the results differ by is the uncertainty. */
#include "tests/adversary/adversary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 8, MOST_CHANGES = 5000 };
static const long most_evaluations = 12000000; /* some 5 s */

typedef struct cuts {
  adv_real *t;
  size_t count, room;
  adv_real end;
  bool failed;
} cuts;

static void add_cut(void *context, adv_real t) {
  cuts *c = context;
  if (!(t > 0) || t > c->end || c->failed) return;
  if (c->count == c->room) {
    size_t room = 2 * c->room + 64;
    adv_real *grown = realloc(c->t, room * sizeof *grown);
    if (!grown) {
      c->failed = true;
      return;
    }
    c->t = grown, c->room = room;
  }
  c->t[c->count++] = t;
}

static int compare(const void *a, const void *b) {
  adv_real x = *(const adv_real *)a, y = *(const adv_real *)b;
  return (x > y) - (x < y);
}

static adv_real frame_time(const adv_scene *m, int frame) { return frame / (adv_real)m->fps; }

static void find_cuts(const adv_scene *m, cuts *c) {
  for (int k = 1; k <= m->frames; k++) add_cut(c, frame_time(m, k));
  for (int k = 0; k < m->pins; k++) {
    add_cut(c, m->pin[k].release);
    if (m->pin[k].hold == ADV_PATH) adv_wave_cuts(&m->pin[k].path.wave, c->end, add_cut, c);
  }
  for (int k = 0; k < m->forces; k++) {
    add_cut(c, m->force[k].from), add_cut(c, m->force[k].to);
    adv_wave_cuts(&m->force[k].vector.wave, c->end, add_cut, c);
    adv_wave_cuts(&m->force[k].strength, c->end, add_cut, c);
  }
  if (c->count > 0) qsort(c->t, c->count, sizeof *c->t, compare);
}

/* One integration. */
typedef struct flight {
  adv_system s;
  int size;
  adv_real tolerance, t, h, y[ADV_STATE];
  long evaluations, changes;
} flight;

static void midpoints(flight *f, const adv_real *slope, adv_real h, int parts, adv_real *out) {
  adv_real before[ADV_STATE], now[ADV_STATE], rate[ADV_STATE], part = h / parts;
  for (int e = 0; e < f->size; e++) before[e] = f->y[e], now[e] = f->y[e] + part * slope[e];
  for (int k = 1; k < parts; k++) {
    adv_rates(&f->s, f->t + k * part, now, rate);
    for (int e = 0; e < f->size; e++) {
      adv_real next = before[e] + 2 * part * rate[e];
      before[e] = now[e], now[e] = next;
    }
  }
  f->evaluations += parts - 1;
  memcpy(out, now, (size_t)f->size * sizeof *out);
}

/* The state after a step of h, and its error over the tolerance. */
static adv_real extrapolate(flight *f, adv_real h, adv_real *out) {
  adv_real row[COLUMNS][ADV_STATE], slope[ADV_STATE], error = 0;
  adv_rates(&f->s, f->t, f->y, slope);
  for (int k = 0; k < COLUMNS; k++) {
    midpoints(f, slope, h, 2 * (k + 1), row[k]);
    for (int j = k - 1; j >= 0; j--) {
      adv_real ratio = (adv_real)(k + 1) / (adv_real)(j + 1);
      for (int e = 0; e < f->size; e++) row[j][e] = row[j + 1][e] + (row[j + 1][e] - row[j][e]) / (ratio * ratio - 1);
    }
  }
  for (int e = 0; e < f->size; e++) {
    adv_real off = fabsl(row[0][e] - row[1][e]) / (f->tolerance * (1 + fabsl(row[0][e])));
    error = off > error || isnan(off) ? off : error;
  }
  memcpy(out, row[0], (size_t)f->size * sizeof *out);
  adv_impose(&f->s, f->t + h, out);
  return isnan(error) ? INFINITY : error;
}

/* ---- Ropes ---- */

static int mode_of(const adv_rope *r) { return !(r->stretch > 0) ? ADV_SLACK : r->tension > 0 ? ADV_TAUT : ADV_LOOSE; }

static bool acts(const flight *f, const adv_force *force) {
  return force->law == ADV_ROPES && f->s.inside >= force->from && f->s.inside < force->to;
}

/* Whether all ropes are still what they were, in the state y at t. */
static bool modes_hold(const flight *f, adv_real t, const adv_real *y) {
  for (int k = 0; k < f->s.scene->forces; k++) {
    const adv_force *force = &f->s.scene->force[k];
    for (int e = 0; e < force->edges && acts(f, force); e++) {
      adv_rope r = adv_rope_at(&f->s, force, e, t, y);
      if (mode_of(&r) != (int)f->s.mode[k * ADV_EDGES + e]) return false;
    }
  }
  return true;
}

static void set_modes(flight *f) {
  for (int k = 0; k < f->s.scene->forces; k++) {
    const adv_force *force = &f->s.scene->force[k];
    for (int e = 0; e < force->edges && acts(f, force); e++) {
      adv_rope r = adv_rope_at(&f->s, force, e, f->t, f->y);
      f->s.mode[k * ADV_EDGES + e] = mode_of(&r);
    }
  }
}

/* Whether a rope may have changed and changed back within a step: its ends approach the change first and recede from it
 * at the end, and straight lines on from both do not say that it was out of reach. */
static bool may_have_touched(const flight *f, adv_real h, const adv_real *after) {
  for (int k = 0; k < f->s.scene->forces; k++) {
    const adv_force *force = &f->s.scene->force[k];
    for (int e = 0; e < force->edges && acts(f, force); e++) {
      adv_rope a = adv_rope_at(&f->s, force, e, f->t, f->y), b = adv_rope_at(&f->s, force, e, f->t + h, after);
      adv_real sign = f->s.mode[k * ADV_EDGES + e] == ADV_SLACK ? 1 : -1;
      adv_real near = fmaxl(sign * a.stretch + sign * a.rate * h, sign * b.stretch - sign * b.rate * h);
      if (sign * a.rate > 0 && sign * b.rate < 0 && near > 0) return true;
    }
  }
  return false;
}

/* The shortest step, up to h, at whose end a rope has changed; the state there. */
static adv_real find_change(flight *f, adv_real h, adv_real *after) {
  adv_real low = 0, high = h, middle[ADV_STATE];
  for (int k = 0; k < 70 && high - low > 1e-19L * (f->t + h); k++) {
    adv_real half = (low + high) / 2;
    extrapolate(f, half, middle);
    if (modes_hold(f, f->t + half, middle))
      low = half;
    else
      high = half, memcpy(after, middle, sizeof middle);
  }
  return high;
}

/* ---- Steps ---- */

static adv_real shortest(const flight *f) { return 1e-11L * (adv_real)adv_scene_end(f->s.scene); }

static bool within_limits(const flight *f) {
  return f->evaluations < most_evaluations && f->changes < MOST_CHANGES && isfinite(f->y[0]);
}

static void step(flight *f, adv_real to) {
  adv_real after[ADV_STATE], most = adv_longest_step(&f->s, f->t, f->y), h = fminl(f->h, most);
  bool last = h >= to - f->t;
  if (last) h = to - f->t;
  adv_real error = extrapolate(f, h, after);
  adv_real factor = error > 0 ? 0.8L * powl(error, -1.0L / (2 * COLUMNS - 1)) : 3;
  bool shortens = (error > 1 || may_have_touched(f, h, after)) && h > shortest(f);
  if (shortens) {
    f->h = h * (error > 1 ? fmaxl(0.1L, fminl(0.9L, factor)) : 0.5L);
    return;
  }
  if (!last || factor < 1) f->h = h * fmaxl(0.3L, fminl(3, factor));
  if (!modes_hold(f, f->t + h, after)) h = find_change(f, h, after), f->changes++, last = false;
  memcpy(f->y, after, sizeof after);
  f->t = last ? to : f->t + h;
  set_modes(f);
}

static void start(flight *f, const adv_scene *m, adv_real tolerance, adv_real off) {
  uint64_t seed = 1;
  *f = (flight){.s = {.scene = m}, .size = (6 + m->size) * m->n, .tolerance = tolerance};
  for (int e = 0; e < 3 * m->n; e++) {
    f->y[e] = m->x[e / 3][e % 3] + off * adv_uniform(&seed, -1, 1) * (1 + fabs(m->x[e / 3][e % 3]));
    f->y[3 * m->n + e] = m->v[e / 3][e % 3];
  }
  for (int i = 0; i < m->n; i++)
    for (int c = 0; c < m->size; c++) f->y[6 * m->n + i * m->size + c] = m->initial[c];
  f->h = (adv_real)adv_scene_end(m) / 1000;
}

static void store(flight *f, int frame, adv_real *x, adv_real *c) {
  const adv_scene *m = f->s.scene;
  adv_real before = f->s.inside;
  f->s.inside = f->t; /* a path that jumps here has jumped */
  adv_real y[ADV_STATE];
  memcpy(y, f->y, sizeof y);
  adv_impose(&f->s, f->t, y);
  f->s.inside = before;
  memcpy(x + 3 * frame * m->n, y, (size_t)(3 * m->n) * sizeof *x);
  memcpy(c + frame * m->n * m->size, y + 6 * m->n, (size_t)(m->n * m->size) * sizeof *c);
}

/* False where it could not be done within the limits. */
static bool fly(const adv_scene *m, const cuts *c, adv_real tolerance, adv_real off, adv_real *x, adv_real *channels) {
  flight f;
  int frame = 0;
  start(&f, m, tolerance, off);
  f.s.inside = 0;
  adv_impose(&f.s, 0, f.y);
  store(&f, frame++, x, channels);
  for (size_t k = 0; k < c->count; k++) {
    if (c->t[k] > f.t) {
      adv_impose(&f.s, f.t, f.y); /* pins that are let go here have the motion of the piece before */
      f.s.inside = (f.t + c->t[k]) / 2;
      adv_impose(&f.s, f.t, f.y);
      set_modes(&f);
    }
    while (f.t < c->t[k] && within_limits(&f)) step(&f, c->t[k]);
    if (!within_limits(&f)) return false;
    if (frame <= m->frames && f.t == frame_time(m, frame)) store(&f, frame++, x, channels);
  }
  return frame == m->frames + 1;
}

/* ---- The answer ---- */

static double largest_difference(const adv_real *a, const adv_real *b, int frames, int each, int n, bool from_start) {
  adv_real most = 0;
  for (int f = 0; f < frames; f++) {
    adv_real sum = 0;
    for (int e = 0; e < each; e++) {
      adv_real d = a[f * each + e] - b[(from_start ? 0 : f) * each + e];
      sum += d * d;
    }
    most = fmaxl(most, sqrtl(sum / n));
  }
  return (double)most;
}

void adv_answer_free(adv_answer *a) { free(a->x), free(a->c); }

bool adv_answer_make(adv_answer *a, const adv_scene *m) {
  int frames = m->frames + 1, each = 3 * m->n, others = m->n * m->size;
  size_t rows = (size_t)(frames * each), more = (size_t)(frames * others + 1);
  cuts c = {.end = frame_time(m, m->frames)};
  *a = (adv_answer){.x = calloc(rows, sizeof *a->x), .c = calloc(more, sizeof *a->c), .uncertainty = INFINITY};
  adv_real *x = calloc(2 * rows, sizeof *x), *y = calloc(2 * more, sizeof *y);
  find_cuts(m, &c);
  bool memory = a->x && a->c && x && y && !c.failed;
  if (memory && fly(m, &c, 1e-15L, 0, a->x, a->c) && fly(m, &c, 1e-13L, 0, x, y) &&
      fly(m, &c, 1e-15L, 1e-17L, x + rows, y + more)) {
    double coarse = largest_difference(x, a->x, frames, each, m->n, false);
    double off = largest_difference(x + rows, a->x, frames, each, m->n, false);
    a->uncertainty = fmax(coarse, off);
    a->growth = off / 1e-17;
    a->extent = largest_difference(a->x, a->x, frames, each, m->n, true);
    a->channel_extent = 0;
    for (int k = 0; k < frames * others; k++) a->channel_extent = fmax(a->channel_extent, (double)fabsl(a->c[k]));
    a->channel_change = largest_difference(a->c, a->c, frames, others, m->n, true);
    a->channel_uncertainty = largest_difference(y, a->c, frames, others, m->n, false);
  }
  free(c.t), free(x), free(y);
  return memory;
}
