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

struct hk_spectrum_work {
  size_t n, tail; /* tail: length of y */
  double *memory; /* all the arrays */
  double *x, *v, *a[2], *y, *dy[2], *direction, *scratch;
  double *turn; /* 1/s, t of every particle */
  hk_lanczos stiffness, damping;
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
} operation;

static hk_status reserve(hk_spectrum_work *s, const hk_system *system) {
  size_t n = system->n, tail = system->size - 6 * n, vector = 3 * n;
  double *m = calloc(11 * vector + 4 * tail + 1, sizeof *m);
  if (!m) return HK_NO_MEMORY;
  free(s->memory);
  *s = (hk_spectrum_work){.n = n, .tail = tail, .memory = m, .x = m, .v = m + vector};
  s->a[0] = m + 2 * vector;
  s->a[1] = m + 3 * vector;
  s->stiffness = (hk_lanczos){.size = vector, .current = m + 4 * vector, .bound = INFINITY};
  s->stiffness.previous = m + 5 * vector;
  s->stiffness.image = m + 6 * vector;
  s->damping = s->stiffness;
  s->stiffness.ritz = m + 7 * vector;
  s->damping.ritz = m + 8 * vector;
  s->scratch = m + 9 * vector;
  s->turn = m + 10 * vector;
  s->y = m + 11 * vector;
  s->dy[0] = s->y + tail;
  s->dy[1] = s->dy[0] + tail;
  s->direction = s->dy[1] + tail;
  return HK_OK;
}

/* x (or v) = that of X + factor * direction / sqrt(m). */
static void displace(const operation *o, const double *direction, double factor) {
  size_t n = o->system->n;
  const double *base = o->system->X + (o->velocity ? 3 * n : 0), *w = o->system->model->inverse_mass;
  double *into = o->velocity ? o->work->v : o->work->x;
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
  if (!system->tangent) return HK_OK;
  for (size_t c = 0; c < 3 * system->n; c++) vector[c] *= sqrt(w[c / 3]);
  hk_status status = system->tangent(system, vector);
  for (size_t c = 0; c < 3 * system->n; c++) vector[c] = w[c / 3] > 0 ? vector[c] / sqrt(w[c / 3]) : 0;
  return status;
}

static hk_status apply(void *context, const double *in, double *out) {
  operation *o = context;
  hk_spectrum_work *s = o->work;
  const double *w = o->system->model->inverse_mass;
  double most = largest_move(o->system->model, in), factor = most > 0 ? o->step / most : 0;
  for (int side = 0; side < 2; side++) {
    displace(o, in, side == 0 ? factor : -factor);
    s->bounds.evaluations++;
    hk_status status =
        o->system->accelerations(o->system, o->system->t, s->x, s->v, o->system->X + 6 * s->n, s->a[side], s->dy[side]);
    if (status != HK_OK) return status;
    if (o->system->aside) o->system->aside->remove(o->system->aside->self, o->system, s->x, s->v, s->a[side]);
  }
  for (size_t i = 0; i < s->n; i++) {
    double f = w[i] > 0 && factor > 0 ? -1 / (2 * factor * sqrt(w[i])) : 0;
    for (size_t c = 3 * i; c < 3 * i + 3; c++) out[c] = f * (s->a[0][c] - s->a[1][c]);
  }
  if (o->system->equations > 0) s->bounds.evaluations++; /* `tangent` costs as much as one */
  return allow(o->system, out);
}

/* The velocities at which K is taken. */
static void take_velocities(hk_spectrum_work *s, const hk_system *system) {
  if (system->equations > 0)
    memcpy(s->v, system->X + 3 * s->n, 3 * s->n * sizeof *s->v);
  else
    memset(s->v, 0, 3 * s->n * sizeof *s->v);
}

/* As `apply` without the turning of velocities, out -= t x in. */
static hk_status apply_unturned(void *context, const double *in, double *out) {
  const hk_spectrum_work *s = ((operation *)context)->work;
  hk_status status = apply(context, in, out);
  for (size_t i = 0; i < s->n && s->bounds.b_max > 0; i++) {
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

/* Bounds w_max. The bounds that the forces state are used when `use_stated`; when Lanczos iteration finds a larger
 * eigenvalue, they are wrong and the estimate is repeated without them. */
static hk_status bound_stiffness(hk_spectrum_work *s, hk_system *system, bool use_stated, int steps, bool warm) {
  if (!(system->flags & HK_DEPENDS_ON_X)) return HK_OK;
  hk_spectrum *b = &s->bounds;
  hk_stiffness stated = hk_stiffness_of(system, (double(*)[6])(void *)s->a[0]); /* 6n numbers: a[0] and a[1] */
  bool covered = use_stated && stated.covered;
  measure_scene(s, system, stated.length);
  s->stiffening_damping = stated.stiffening_damping;
  s->damps_alone = stated.damps_alone;
  b->w_switching = sqrt(stated.stiffening * inflate);
  operation o = {s, system, false, difference_step(s)};
  take_velocities(s, system);
  hk_status status = bound(&o, &s->stiffness, covered ? stated.whole : INFINITY, steps, warm);
  if (status != HK_OK) return status;
  double noise = ulps * rounding * largest(s->a[0], 3 * s->n) / o.step;
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
  return ulps * rounding * largest(s->a[0], 3 * s->n) / o->step;
}

/* *whole: whether the skew part of D is that of single particles. */
static hk_status check_turning(operation *o, bool *whole) {
  hk_spectrum_work *s = o->work;
  double *p = s->damping.current, *q = s->damping.previous, *Dp = s->damping.image, *Dq = s->damping.ritz;
  hk_turning_pair(o->system, p, q);
  hk_status status = apply(o, p, Dp);
  if (status == HK_OK) status = apply(o, q, Dq);
  *whole = status == HK_OK && hk_turning_is_whole(s->n, s->turn, p, q, Dp, Dq);
  return status;
}

static hk_status common_damping(operation *o, double *alpha) {
  hk_spectrum_work *s = o->work;
  const double *w = o->system->model->inverse_mass;
  double *column[3] = {s->damping.current, s->damping.previous, s->damping.image}, *all = s->damping.ritz;
  for (size_t c = 0; c < 3; c++) {
    memset(all, 0, 3 * s->n * sizeof *all);
    for (size_t i = 0; i < s->n; i++) all[3 * i + c] = w[i] > 0 ? 1 / sqrt(w[i]) : 0;
    hk_status status = apply(o, all, column[c]);
    if (status != HK_OK) return status;
  }
  *alpha = hk_common_damping(o->system->model, column);
  double turn = hk_common_turning(o->system->model, column, s->turn);
  bool whole = turn > velocity_noise(s, o);
  hk_status status = whole ? check_turning(o, &whole) : HK_OK;
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
  const double *X = p->damping.system->X;
  size_t vector = 3 * s->n;
  take_velocities(s, p->damping.system);
  hk_status status = apply(&p->stiffness, in, s->scratch);
  if (status != HK_OK) return status;
  memcpy(s->x, X, vector * sizeof *s->x);
  status = apply_unturned(&p->damping, in, out);
  for (size_t c = 0; c < vector; c++) out[c] -= p->slope * s->scratch[c];
  return status;
}

/* The vectors of the damping's Lanczos iteration are used again: a first run without `known` leaves no data in them. */
static hk_status bound_pencil(hk_spectrum_work *s, hk_system *system, const operation *damping) {
  hk_spectrum *b = &s->bounds;
  pencil p = {{s, system, false, difference_step(s)}, *damping, b->g_max / (b->w_max * b->w_max)};
  hk_lanczos l = s->damping;
  l.bound = INFINITY;
  l.slack = pencil_slack * b->g_max;
  double share;
  hk_status status = start(&l, system, false, &share);
  if (status == HK_OK) status = hk_lanczos_run(&l, apply_pencil, &p, INFINITY, share, HK_LANCZOS_STEPS);
  if (status != HK_OK) return status;
  b->damping_slope = p.slope;
  b->damping_offset = fmax(0, l.bound) + 1e-6 * b->g_max; /* the differences are accurate to about 1e-9 */
  return HK_OK;
}

static hk_status bound_damping(hk_spectrum_work *s, hk_system *system, int steps, bool warm) {
  hk_spectrum *b = &s->bounds;
  b->beta = system->flags & HK_DEPENDS_ON_V ? b->beta : 0;
  if (!(system->flags & HK_DEPENDS_ON_V)) return HK_OK;
  if (!(s->length > 0)) measure_scene(s, system, INFINITY);
  double speed = fmax(largest(system->X + 3 * s->n, 3 * s->n), s->spacing * b->w_max);
  operation o = {s, system, true, 1e-5 * (speed > 0 ? speed : 1)};
  memcpy(s->x, system->X, 3 * s->n * sizeof *s->x);
  s->damping.slack = damping_slack * b->w_max;
  hk_status status = warm ? HK_OK : common_damping(&o, &b->alpha);
  if (status == HK_OK) status = bound(&o, &s->damping, INFINITY, steps, warm);
  if (status != HK_OK) return status;
  double noise = velocity_noise(s, &o);
  b->g_max = s->damping.bound > noise ? s->damping.bound * inflate : 0;
  b->g_max = s->damps_alone && s->stiffening_damping > 0 ? s->stiffening_damping : b->g_max + s->stiffening_damping;
  b->alpha = b->alpha > noise ? fmin(b->alpha / inflate, b->g_max) : 0;
  bool symmetric = s->damping.asymmetry <= 1e-3 * s->damping.norm + noise;
  if (!symmetric) count_rotation(b, s->damping.norm);
  bool strong = b->w_max > 0 && b->g_max > strong_damping * b->w_max && symmetric;
  return strong && !warm ? bound_pencil(s, system, &o) : HK_OK;
}

/* A failed call does not change *spectrum, but makes the data of a warm start invalid. */
static hk_status bound_all(hk_spectrum_work *s, hk_system *system, int steps, bool warm, hk_spectrum *spectrum) {
  s->bounds = (hk_spectrum){.alpha = warm ? s->bounds.alpha : 0, .b_max = warm ? s->bounds.b_max : 0, .rigorous = true};
  s->length = s->stiffening_damping = 0;
  s->damps_alone = false;
  hk_status status = bound_stiffness(s, system, true, steps, warm);
  if (status == HK_OK) status = bound_damping(s, system, steps, warm);
  if (status == HK_OK && system->model->channels > 0) {
    hk_channel_scratch scratch = {s->x, s->v, s->a[0], s->y, {s->dy[0], s->dy[1]}, s->direction};
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
  hk_spectrum_work *s = malloc(sizeof *s);
  if (s) s->memory = NULL;
  if (s && reserve(s, system) == HK_OK) return s;
  free(s);
  return NULL;
}

void hk_spectrum_destroy(hk_spectrum_work *s) {
  if (s) free(s->memory);
  free(s);
}

hk_status hk_spectrum_estimate(hk_system *system, hk_spectrum *spectrum, hk_error *error) {
  if (hk_lone_spectrum(system, spectrum)) return HK_OK;
  hk_spectrum_work *s = hk_spectrum_create(system);
  if (!s) return hk_error_set(error, HK_NO_MEMORY, "no memory to estimate the stable step");
  hk_status status = hk_spectrum_measure(s, system, spectrum);
  hk_spectrum_destroy(s);
  return status;
}
