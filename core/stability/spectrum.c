/* Frequencies, damping rates and channel rates of the scene linearised at its present state, bounded from above.
 *
 * The operators M^-1/2 K M^-1/2 and M^-1/2 D M^-1/2 (K = -dF/dx, D = -dF/dv) are applied by central differences of the
 * accelerations, and their largest eigenvalues bounded by Lanczos iteration (lanczos.c) and, for K, by the bounds that
 * the forces state (stiffness.c). The smaller bound is taken, but a force that may become stiffer counts with its
 * largest possible stiffness. A mode u of the damped scene is a root of l^2 + g l + w^2 = 0 with g = u*Du/u*Mu and w^2
 * = u*Ku/u*Mu, for any damping, so bounds of the two operators bound every mode, and D >= alpha M + beta (K - tension)
 * bounds the damping rates from below. Where damping is strong, the largest eigenvalue of the pencil D - slope K, slope
 * = g_max/w_max^2, bounds in the same way the excess of a mode's g over slope w^2: with damping proportional to
 * stiffness, slow modes are then not mistaken for overdamped ones.
 *
 * Forces like v x B make D unsymmetric: its skew part A turns velocities, u*Au = i b. What all particles in common
 * motion are subject to is a 3x3 block for each, which elements between them do not share; the skew parts of these
 * blocks are A, their axial vectors t (A u = t x u) bound b, and D - A is what Lanczos iteration is applied to. That it
 * is symmetric is checked on the way; a rotation that is none of single particles is counted as a frequency
 * (count_rotation).
 *
 * Constraints leave the motion along them alone: vectors are projected onto the velocities that they allow, and so is
 * what the operators give. Their forces grow with v^2, as in a sling, and stiffen what they hold: K is then that at the
 * present velocities, which adds (v/R)^2 on a path of the radius R. Without constraints K is taken at v = 0: terms
 * proportional to damping times velocity are unsymmetric, and small while no particle moves by the distance to its
 * neighbour in a step. alpha is the smallest damping rate of the particles when all have the same velocity: elements
 * between them then exert no damping force, and pins only add damping. This is exact for drag and an estimate for other
 * forces.
 *
 * What a method sets aside for shorter steps of its own (hk_integrator.divide) is no part of the scene here. */
#include "core/stability/stability.h"
#include "core/stability/channel_rate.h"
#include "core/stability/common_motion.h"
#include "core/stability/stiffness.h"
#include "core/stability/lanczos.h"
#include "core/stability/lone_particles.h"

#include <stdlib.h>
#include <string.h>

/* The central differences are accurate to about 1e-9. The rounding error of an acceleration is `ulps` units in the last
 * place. */
static const double inflate = 1 + 1e-8, rounding = 2.2e-16, ulps = 64, warm_share = 0.6;
/* Relative to w_max: where w determines the step, such a change of g changes the step by about that fraction. */
static const double damping_slack = 0.03;
/* The pencil is estimated where g_max/w_max is above strong_damping; pencil_slack, relative to g_max, is the tolerance
 * of its bound. */
static const double strong_damping = 0.2, pencil_slack = 0.03;

/* A scene's vectors are most of the memory that an estimate takes: five are needed in any case, and what only some
 * scenes need is allocated for them. */
struct hk_spectrum_work {
  size_t n, tail; /* tail: length of y */
  double *memory; /* the vectors that every estimate needs */
  double *moved;  /* x or v, displaced; a follows it in memory */
  double *a;      /* m/s^2, on the far side of a difference */
  double *still;  /* what is not displaced: velocities 0, in memory that is never written, or a copy, see rest() */
  bool written;   /* `still` has been written */
  bool imposes;   /* evaluations put particles where their pins have them, and so may change what they are given */
  double *y, *dy[2], *direction;
  double *turn;  /* 1/s, t of every particle; NULL: nothing turns */
  double *spare; /* one more vector; NULL: it was not needed */
  double *ritz;  /* two vectors of repeated estimates; NULL: they are not repeated */
  bool repeats;
  hk_lanczos stiffness, damping;
  const hk_integrator *method; /* whose stable step is wanted; NULL: all that can be said of the scene is */
  const void *parameters;
  double stiffening_damping; /* 1/s, see stiffness.h */
  bool damps_alone;
  double length, spacing; /* m, see measure_scene; 0: not yet */
  hk_spectrum bounds;
};

typedef struct operation {
  hk_spectrum_work *work;
  hk_system *system;
  bool velocity; /* true: D; false: K */
  double step;   /* m or m/s: the largest change of a component */
  double *rest;  /* n x 3: x (or v), which is not displaced */
} operation;

static void release(hk_spectrum_work *s) {
  free(s->memory);
  free(s->turn);
  free(s->spare);
  free(s->ritz);
}

static hk_status reserve(hk_spectrum_work *s, const hk_system *system) {
  enum { VECTORS = 6 };
  size_t n = system->n, tail = system->size - 6 * n, vector = 3 * n;
  double *m = calloc(VECTORS * vector + 4 * tail + 1, sizeof *m);
  double *ritz = m && s->repeats ? calloc(2 * vector + 1, sizeof *ritz) : NULL;
  if (!m || (s->repeats && !ritz)) {
    free(m);
    return HK_NO_MEMORY;
  }
  release(s);
  *s = (hk_spectrum_work){.n = n, .tail = tail, .memory = m, .ritz = ritz, .repeats = s->repeats, .moved = m};
  s->a = m + vector;
  s->stiffness = (hk_lanczos){.size = vector, .current = m + 2 * vector, .bound = INFINITY};
  s->stiffness.previous = m + 3 * vector;
  s->stiffness.image = m + 4 * vector;
  s->still = m + 5 * vector;
  s->damping = s->stiffness;
  if (ritz) s->stiffness.ritz = ritz, s->damping.ritz = ritz + vector;
  s->y = m + VECTORS * vector;
  s->dy[0] = s->y + tail;
  s->dy[1] = s->dy[0] + tail;
  s->direction = s->dy[1] + tail;
  return HK_OK;
}

/* Makes room for a vector that only some scenes need. Forces are evaluated into those of `memory` alone: one that
 * writes next to them does no harm there, and hooke check names it. */
static hk_status need(const hk_spectrum_work *s, double **vector) {
  if (!*vector) *vector = calloc(3 * s->n + 1, sizeof **vector);
  return *vector ? HK_OK : HK_NO_MEMORY;
}

/* moved = x (or v) of X + factor * direction / sqrt(m). */
static void displace(const operation *o, const double *direction, double factor) {
  size_t n = o->system->n;
  const double *base = o->system->X + (o->velocity ? 3 * n : 0), *w = o->system->model->inverse_mass;
  double *into = o->work->moved;
  for (size_t i = 0; i < n; i++) {
    double f = factor * sqrt(w[i]);
    for (size_t c = 3 * i; c < 3 * i + 3; c++) into[c] = base[c] + f * direction[c];
  }
}

static double largest_move(const hk_model *model, const double *direction) {
  double most = 0;
  for (size_t i = 0; i < model->n; i++) {
    double f = sqrt(model->inverse_mass[i]);
    for (size_t c = 3 * i; c < 3 * i + 3; c++)
      if (f * fabs(direction[c]) > most) most = f * fabs(direction[c]);
  }
  return most;
}

/* Leaves of a vector that is scaled by the roots of the masses what pins and constraints allow. */
static hk_status allow(hk_system *system, double *vector) {
  const double *w = system->model->inverse_mass;
  system->filter(system, vector);
  if (!system->tangent || system->equations == 0) return HK_OK;
  for (size_t c = 0; c < 3 * system->n; c++) vector[c] *= sqrt(w[c / 3]);
  hk_status status = system->tangent(system, vector);
  for (size_t c = 0; c < 3 * system->n; c++) vector[c] = w[c / 3] > 0 ? vector[c] / sqrt(w[c / 3]) : 0;
  return status;
}

/* a = the accelerations at the displaced state. */
static hk_status evaluate(operation *o, double *a) {
  hk_spectrum_work *s = o->work;
  hk_system *system = o->system;
  double *x = o->velocity ? o->rest : s->moved, *v = o->velocity ? s->moved : o->rest;
  s->bounds.evaluations++;
  hk_status status = system->accelerations(system, system->t, x, v, system->X + 6 * s->n, a, s->dy[0]);
  if (status == HK_OK && system->aside) system->aside->remove(system->aside->self, system, x, v, a);
  return status;
}

/* out = (out - a) -1/2 / (factor sqrt(m)) */
static void divide_difference(const operation *o, double factor, double *out) {
  const double *w = o->system->model->inverse_mass, *a = o->work->a;
  for (size_t i = 0; i < o->system->n; i++) {
    double f = w[i] > 0 && factor > 0 ? -1 / (2 * factor * sqrt(w[i])) : 0;
    for (size_t c = 3 * i; c < 3 * i + 3; c++) out[c] = f * (out[c] - a[c]);
  }
}

static hk_status apply(void *context, const double *in, double *out) {
  operation *o = context;
  double most = largest_move(o->system->model, in), factor = most > 0 ? o->step / most : 0;
  displace(o, in, factor);
  hk_status status = evaluate(o, out);
  displace(o, in, -factor);
  if (status == HK_OK) status = evaluate(o, o->work->a);
  if (status != HK_OK) return status;
  divide_difference(o, factor, out);
  if (o->system->equations > 0) o->work->bounds.evaluations++; /* `tangent` costs as much as one */
  return allow(o->system, out);
}

/* The part of X at `from` for evaluations: a copy where imposing pins may change it. */
static double *rest(hk_spectrum_work *s, double *from) {
  if (!s->imposes) return from;
  s->written = true;
  return memcpy(s->still, from, 3 * s->n * sizeof *from);
}

/* The velocities at which K is taken. */
static double *velocities(hk_spectrum_work *s, const hk_system *system) {
  if (system->equations > 0) return rest(s, system->X + 3 * s->n);
  if (s->written) memset(s->still, 0, 3 * s->n * sizeof *s->still);
  s->written = s->imposes;
  return s->still;
}

/* As `apply` without the turning of velocities, out -= t x in. */
static hk_status apply_unturned(void *context, const double *in, double *out) {
  const hk_spectrum_work *s = ((operation *)context)->work;
  hk_status status = apply(context, in, out);
  for (size_t i = 0; i < s->n && s->turn && s->bounds.b_max > 0; i++) {
    const double *t = s->turn + 3 * i, *u = in + 3 * i;
    for (int c = 0; c < 3; c++)
      out[3 * i + (size_t)c] -= t[(c + 1) % 3] * u[(c + 2) % 3] - t[(c + 2) % 3] * u[(c + 1) % 3];
  }
  return status;
}

static double largest(const double *x, size_t count) {
  double most = 0;
  for (size_t c = 0; c < count; c++)
    if (fabs(x[c]) > most) most = fabs(x[c]);
  return most;
}

/* Sets `length`, the magnitude of the coordinates, and `spacing`, the scale on which forces vary: the shortest element,
 * or the mean distance of the particles. */
static void measure_scene(hk_spectrum_work *s, const hk_system *system, double shortest) {
  const double *x = system->X;
  double size = 0;
  for (size_t c = 3; c < 3 * s->n; c++)
    if (fabs(x[c] - x[c % 3]) > size) size = fabs(x[c] - x[c % 3]);
  s->length = fmax(largest(x, 3 * s->n), size);
  if (!(s->length > 0)) s->length = 1;
  s->spacing = isfinite(shortest) ? shortest : size > 0 ? size / cbrt((double)s->n) : s->length;
  s->spacing = fmax(s->spacing, 1e-6 * s->length);
}

/* The start vector: random, or the last approximate eigenvector mixed with a random direction, which has a component
 * along every eigenvector. *share: that of the random part. */
static hk_status start(hk_lanczos *l, hk_system *system, bool warm, double *share) {
  double length = 0, direct = sqrt(1 - warm_share * warm_share);
  hk_lanczos_random(l->current, l->size);
  for (size_t i = 0; i < system->n; i++)
    if (!(system->model->inverse_mass[i] > 0)) memset(l->current + 3 * i, 0, 3 * sizeof *l->current);
  hk_status status = allow(system, l->current);
  for (size_t c = 0; c < l->size; c++) length += l->current[c] * l->current[c];
  *share = 1;
  if (!warm || !l->warm || !(length > 0)) return status;
  length = sqrt(length);
  for (size_t c = 0; c < l->size; c++) l->current[c] = warm_share / length * l->current[c] + direct * l->ritz[c];
  *share = warm_share;
  return status;
}

/* Bounds the largest eigenvalue of one operator. When `steps` are too few for a rigorous bound, the last bound is
 * scaled up: with the eigenvalue reached, by the margin of the last rigorous bound, and with the bound `known`. */
static hk_status bound(operation *o, hk_lanczos *l, double known, int steps, bool warm) {
  double last = l->bound, grown = INFINITY, share;
  hk_status status = start(l, o->system, warm, &share);
  if (status == HK_OK) status = hk_lanczos_run(l, o->velocity ? apply_unturned : apply, o, known, share, steps);
  if (status != HK_OK) return status;
  if (warm && l->margin > 0) grown = fmax(last, l->margin * l->theta);
  if (isfinite(known) && l->before > 0) grown = fmax(grown, last * known / l->before);
  l->before = isfinite(known) ? known : 0;
  if (grown < l->bound) {
    l->bound = grown;
    o->work->bounds.rigorous = false;
  } else {
    l->margin = l->theta > 0 ? l->bound / l->theta : 0;
  }
  return HK_OK;
}

/* The step at which the truncation error (step/spacing)^2 equals the rounding error 2e-16 length/step; both are below
 * 1e-9 for usual scenes. */
static double difference_step(const hk_spectrum_work *s) {
  return cbrt(rounding * s->length * s->spacing * s->spacing);
}

/* 6n numbers: `moved` and `a`. */
static double (*blocks(hk_spectrum_work *s))[6] { return (double(*)[6])(void *)s->moved; }

/* Bounds w_max. The bounds that the forces state are used when `use_stated`; when Lanczos iteration finds a larger
 * eigenvalue, they are wrong and the estimate is repeated without them. */
static hk_status bound_stiffness(hk_spectrum_work *s, hk_system *system, bool use_stated, int steps, bool warm) {
  if (!(system->flags & HK_DEPENDS_ON_X)) return HK_OK;
  hk_spectrum *b = &s->bounds;
  hk_stiffness stated = hk_stiffness_of(system, blocks(s));
  bool covered = use_stated && stated.covered;
  measure_scene(s, system, stated.length);
  s->stiffening_damping = stated.stiffening_damping;
  s->damps_alone = stated.damps_alone;
  b->w_switching = sqrt(stated.stiffening * inflate);
  operation o = {s, system, false, difference_step(s), velocities(s, system)};
  hk_status status = bound(&o, &s->stiffness, covered ? stated.whole : INFINITY, steps, warm);
  if (status != HK_OK) return status;
  double noise = ulps * rounding * largest(s->a, 3 * s->n) / o.step;
  if (covered && s->stiffness.theta > stated.whole * (1 + 1e-6) + noise) /* a force is stiffer than it states */
    return bound_stiffness(s, system, false, steps, false);
  double most = s->stiffness.bound + stated.stiffening; /* of the present stiffness plus its possible increase */
  if (covered) most = fmin(most, stated.whole);
  b->covered = covered;
  b->beta = covered ? stated.beta : 0;
  b->w_undamped = covered ? sqrt(stated.undamped) : 0;
  if (s->stiffness.asymmetry > 1e-4 * s->stiffness.norm + noise) b->rigorous = false;
  b->w_max = most > noise ? sqrt(most * inflate) : 0;
  b->w_reached = s->stiffness.theta > noise ? sqrt(s->stiffness.theta) : 0;
  return HK_OK;
}

/* The rounding error of rates measured at the last evaluation, 1/s. */
static double velocity_noise(const hk_spectrum_work *s, const operation *o) {
  return ulps * rounding * largest(s->a, 3 * s->n) / o->step;
}

/* *whole: whether the skew part of D is that of single particles. */
static hk_status check_turning(operation *o, bool *whole) {
  hk_spectrum_work *s = o->work;
  double *p = s->damping.current, *q = s->damping.previous, *D = s->damping.image;
  hk_status status = need(s, &s->spare);
  if (status != HK_OK) return status;
  hk_turning_pair(o->system, p, q);
  status = apply(o, p, D);
  if (status != HK_OK) return status;
  memcpy(s->spare, D, 3 * s->n * sizeof *D);
  status = apply(o, q, D);
  *whole = status == HK_OK && hk_turning_is_whole(s->n, s->turn, p, q, s->spare, D);
  return status;
}

/* The response to the same velocity of all particles along the axis c. */
static hk_status respond(operation *o, size_t c, double *column) {
  const double *w = o->system->model->inverse_mass, *v = o->system->X + 3 * o->system->n;
  size_t n = o->system->n;
  hk_status status = HK_OK;
  for (int side = 0; side < 2 && status == HK_OK; side++) {
    double by = side == 0 ? o->step : -o->step;
    memcpy(o->work->moved, v, 3 * n * sizeof *v);
    for (size_t i = 0; i < n; i++) o->work->moved[3 * i + c] += w[i] > 0 ? by : 0;
    status = evaluate(o, side == 0 ? column : o->work->a);
  }
  if (status != HK_OK) return status;
  divide_difference(o, o->step, column);
  if (o->system->equations > 0) o->work->bounds.evaluations++;
  return allow(o->system, column);
}

static hk_status common_damping(operation *o, double *alpha) {
  hk_spectrum_work *s = o->work;
  double *column[3] = {s->damping.current, s->damping.previous, s->damping.image};
  hk_status status = HK_OK;
  for (size_t c = 0; c < 3 && status == HK_OK; c++) status = respond(o, c, column[c]);
  if (status != HK_OK) return status;
  *alpha = hk_common_damping(o->system->model, column);
  double turn = hk_common_turning(o->system->model, column, NULL);
  bool whole = turn > velocity_noise(s, o);
  if (whole) status = need(s, &s->turn);
  if (whole && status == HK_OK) {
    hk_common_turning(o->system->model, column, s->turn);
    status = check_turning(o, &whole);
  }
  s->bounds.b_max = whole ? turn * inflate : 0;
  return status;
}

/* D has an unsymmetric part that is none of single particles, and a norm G. A mode with a skew D of that norm has a
 * rate of at most (G + sqrt(G^2 + 4 w^2))/2. The estimate of G is a lower bound, so it is increased by a tenth. */
static void count_rotation(hk_spectrum *b, double norm) {
  double G = 1.1 * norm;
  b->rigorous = false;
  b->w_max = (G + sqrt(G * G + 4 * b->w_max * b->w_max)) / 2;
  b->g_max = fmax(b->g_max, G);
  b->alpha = b->beta = 0;
}

typedef struct pencil {
  operation stiffness, damping;
  double slope;
} pencil;

/* out = (D - slope K) in */
static hk_status apply_pencil(void *context, const double *in, double *out) {
  pencil *p = context;
  hk_spectrum_work *s = p->damping.work;
  hk_system *system = p->damping.system;
  p->stiffness.rest = velocities(s, system);
  hk_status status = apply(&p->stiffness, in, out);
  if (status != HK_OK) return status;
  memcpy(s->spare, out, 3 * s->n * sizeof *out);
  p->damping.rest = rest(s, system->X);
  status = apply_unturned(&p->damping, in, out);
  for (size_t c = 0; c < 3 * s->n; c++) out[c] -= p->slope * s->spare[c];
  return status;
}

/* The vectors of the damping's Lanczos iteration are used again: a first run without `known` leaves no data in them. */
static hk_status bound_pencil(hk_spectrum_work *s, hk_system *system, const operation *damping) {
  hk_spectrum *b = &s->bounds;
  pencil p = {{s, system, false, difference_step(s), NULL}, *damping, b->g_max / (b->w_max * b->w_max)};
  hk_lanczos l = s->damping;
  l.bound = INFINITY;
  l.slack = pencil_slack * b->g_max;
  double share;
  hk_status status = need(s, &s->spare);
  if (status == HK_OK) status = start(&l, system, false, &share);
  if (status == HK_OK) status = hk_lanczos_run(&l, apply_pencil, &p, INFINITY, share, HK_LANCZOS_STEPS);
  if (status != HK_OK) return status;
  b->damping_slope = p.slope;
  b->damping_offset = fmax(0, l.bound) + 1e-6 * b->g_max; /* the differences are accurate to about 1e-9 */
  return HK_OK;
}

/* Whether the fastest and most strongly damped of all modes that the bounds allow for sets the step of the method that
 * is wanted: nothing that is known beside raises it. */
static bool is_settled(const hk_spectrum_work *s) {
  const hk_spectrum *b = &s->bounds;
  if (!s->method) return false;
  hk_stable stable = hk_stable_step(s->method, s->parameters, b);
  return stable.limit > 0 && stable.w == b->w_max && stable.g == b->g_max;
}

/* Bounds the eigenvalues of D; `use_stated` as in bound_stiffness. */
static hk_status iterate_damping(operation *o, bool use_stated, int steps, bool warm) {
  hk_spectrum_work *s = o->work;
  double stated;
  bool covered = use_stated && hk_stated_damping(o->system, blocks(s), &stated);
  hk_status status = bound(o, &s->damping, covered ? stated : INFINITY, steps, warm);
  if (status != HK_OK || !covered || s->damping.theta <= stated * (1 + 1e-6) + velocity_noise(s, o)) return status;
  return iterate_damping(o, false, steps, false);
}

static hk_status bound_damping(hk_spectrum_work *s, hk_system *system, int steps, bool warm) {
  hk_spectrum *b = &s->bounds;
  b->beta = system->flags & HK_DEPENDS_ON_V ? b->beta : 0;
  if (!(system->flags & HK_DEPENDS_ON_V)) return HK_OK;
  if (!(s->length > 0)) measure_scene(s, system, INFINITY);
  double speed = fmax(largest(system->X + 3 * s->n, 3 * s->n), s->spacing * b->w_max);
  operation o = {s, system, true, 1e-5 * (speed > 0 ? speed : 1), rest(s, system->X)};
  s->damping.slack = damping_slack * b->w_max;
  hk_status status = warm ? HK_OK : common_damping(&o, &b->alpha);
  if (status == HK_OK) status = iterate_damping(&o, b->b_max == 0, steps, warm);
  if (status != HK_OK) return status;
  double noise = velocity_noise(s, &o);
  b->g_max = s->damping.bound > noise ? s->damping.bound * inflate : 0;
  b->g_max = s->damps_alone && s->stiffening_damping > 0 ? s->stiffening_damping : b->g_max + s->stiffening_damping;
  b->alpha = b->alpha > noise ? fmin(b->alpha / inflate, b->g_max) : 0;
  bool symmetric = s->damping.asymmetry <= 1e-3 * s->damping.norm + noise;
  if (!symmetric) count_rotation(b, s->damping.norm);
  bool strong = b->w_max > 0 && b->g_max > strong_damping * b->w_max && symmetric;
  return strong && !warm && !is_settled(s) ? bound_pencil(s, system, &o) : HK_OK;
}

/* Whether pins have a place for a particle: fixed ones only have no velocity. */
static bool pins_impose(const hk_model *model) {
  for (size_t i = 0; i < model->n; i++)
    if (model->pin[i] != HK_FREE && model->pin[i] != HK_PIN_FIXED) return true;
  return false;
}

/* A failed call does not change *spectrum, but makes the data of a warm start invalid. */
static hk_status bound_all(hk_spectrum_work *s, hk_system *system, int steps, bool warm, hk_spectrum *spectrum) {
  s->bounds = (hk_spectrum){.alpha = warm ? s->bounds.alpha : 0, .b_max = warm ? s->bounds.b_max : 0, .rigorous = true};
  s->length = s->stiffening_damping = 0;
  s->damps_alone = false;
  s->imposes = pins_impose(system->model);
  hk_status status = bound_stiffness(s, system, true, steps, warm);
  if (status == HK_OK) status = bound_damping(s, system, steps, warm);
  if (status == HK_OK && system->model->channels > 0) {
    hk_channel_scratch scratch = {s->moved, s->damping.current, s->a, s->y, {s->dy[0], s->dy[1]}, s->direction};
    status = hk_channel_rate(system, &scratch, &s->bounds.channel_rate, &s->bounds.evaluations);
  }
  if (status == HK_OK) *spectrum = s->bounds;
  if (status != HK_OK) s->n = SIZE_MAX; /* the next update is a full estimate */
  return status;
}

hk_status hk_spectrum_measure(hk_spectrum_work *s, hk_system *system, hk_spectrum *spectrum) {
  if (s->n != system->n || s->tail != system->size - 6 * system->n) {
    hk_status status = reserve(s, system);
    if (status != HK_OK) return status;
  }
  return bound_all(s, system, HK_LANCZOS_STEPS, false, spectrum);
}

hk_status hk_spectrum_update(hk_spectrum_work *s, hk_system *system, int iterations, hk_spectrum *spectrum) {
  if (s->n != system->n || s->tail != system->size - 6 * system->n) return hk_spectrum_measure(s, system, spectrum);
  return bound_all(s, system, iterations > 0 ? iterations : 1, true, spectrum);
}

hk_spectrum_work *hk_spectrum_create(const hk_system *system) {
  hk_spectrum_work *s = calloc(1, sizeof *s);
  if (s) s->repeats = true;
  if (s && reserve(s, system) == HK_OK) return s;
  free(s);
  return NULL;
}

void hk_spectrum_destroy(hk_spectrum_work *s) {
  if (s) release(s);
  free(s);
}

/* Whether the forces' own bounds allow the step: then they are the spectrum, and nothing is iterated. Small scenes are
 * looked at closely: it costs little there, and comparisons of runs want to know which frequency is reached. */
static bool allows(hk_spectrum_work *s, hk_system *system, double step, hk_spectrum *spectrum) {
  enum { MANY = 4096 };
  bool simple = !(system->flags & HK_DEPENDS_ON_V) && system->equations == 0 && system->model->channels == 0;
  if (!(step > 0) || !s->method || system->n < MANY || !simple) return false;
  hk_stiffness stated = hk_stiffness_of(system, blocks(s));
  double w = sqrt(stated.whole * inflate), switching = sqrt(stated.stiffening * inflate);
  hk_spectrum bounds = {.w_max = w, .w_reached = w, .w_switching = switching, .rigorous = true, .covered = true};
  bounds.evaluations = 1; /* takes as long as one */
  if (!stated.covered || !(hk_stable_step(s->method, s->parameters, &bounds).limit >= step)) return false;
  *spectrum = bounds;
  return true;
}

hk_status hk_spectrum_estimate_for(hk_system *system, const hk_integrator *method, const void *parameters, double step,
                                   hk_spectrum *spectrum, hk_error *error) {
  if (hk_lone_spectrum(system, spectrum)) return HK_OK;
  hk_spectrum_work s = {.method = NULL};
  if (reserve(&s, system) != HK_OK) return hk_error_set(error, HK_NO_MEMORY, "no memory to estimate the stable step");
  s.method = method;
  s.parameters = parameters;
  hk_status status =
      allows(&s, system, step, spectrum) ? HK_OK : bound_all(&s, system, HK_LANCZOS_STEPS, false, spectrum);
  release(&s);
  return status;
}

hk_status hk_spectrum_estimate(hk_system *system, hk_spectrum *spectrum, hk_error *error) {
  return hk_spectrum_estimate_for(system, NULL, NULL, NAN, spectrum, error);
}
