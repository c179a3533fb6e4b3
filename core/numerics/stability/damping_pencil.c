/* How damping rises with frequency, by the largest eigenvalues of D - r K and s K - D, which Lanczos iteration bounds:
 * every mode u has g - r w^2 = u*(D - r K)u/u*Mu below the first, and g above s w^2 less the second.
 *
 * From above, r = g_max/w_max^2: with damping proportional to stiffness, slow modes are then not mistaken for
 * overdamped ones. It is looked for where damping is strong.
 *
 * From below, for methods that are stable farther from the imaginary axis than on it: where some elements are
 * damped and others are not, the fastest modes are damped all the same. Of the slopes, as parts of r, the largest one
 * follows damping in proportion to stiffness; with the smaller ones modes that are held in part by what is not damped
 * count as damped as well. Forces that may cease (HK_STIFFENS) leave nothing to count on: there none is known. */
#include "core/numerics/stability/operation.h"

#include <string.h>

/* From above where g_max/w_max is above `strong`, from below above `weak`. `slack`, relative to slope w_max^2, is the
 * tolerance of the bounds; differences are accurate to about 1e-9, `accuracy` of g_max is added. */
static const double strong = 0.2, weak = 1e-3, slack = 0.03, accuracy = 1e-6;
static const double part[HK_DAMPED_LINES] = {0.8, 0.25, 0.08};
/* Of h w: where the end of stability without damping is looked for, and in which steps. Growth a step that is some. */
static const double first = 0.01, last = 10, beyond = 1.05, grown = 2e-7;

typedef struct pencil {
  hk_operation stiffness, damping;
  double slope;
  double sign; /* 1: D - slope K; -1: slope K - D */
} pencil;

static hk_status apply(void *context, const double *in, double *out) {
  pencil *p = context;
  hk_spectrum_work *s = p->damping.work;
  hk_system *system = p->damping.system;
  p->stiffness.rest = hk_operation_velocities(s, system);
  hk_status status = hk_operation_apply(&p->stiffness, in, out);
  if (status != HK_OK) return status;
  memcpy(s->spare, out, 3 * s->n * sizeof *out);
  p->damping.rest = hk_operation_rest(s, system->X);
  status = hk_operation_apply_unturned(&p->damping, in, out);
  for (size_t c = 0; c < 3 * s->n; c++) out[c] = p->sign * (out[c] - p->slope * s->spare[c]);
  return status;
}

/* *bound: no eigenvalue is larger. The vectors of the iteration on D are used again. */
static hk_status bound_one(hk_spectrum_work *s, const hk_operation *damping, double slope, double sign, double *bound) {
  pencil p = {{s, damping->system, false, hk_operation_step(s), NULL}, *damping, slope, sign};
  hk_lanczos l = s->damping;
  l.slack = slack * slope * s->bounds.w_max * s->bounds.w_max;
  hk_status status = hk_operation_need(s, &s->spare);
  if (status == HK_OK) status = hk_operation_start(&l, damping->system);
  if (status == HK_OK) status = hk_lanczos_run(&l, apply, &p, INFINITY);
  *bound = l.bound + accuracy * s->bounds.g_max;
  return status;
}

/* Whether the fastest and most strongly damped of all modes that the bounds allow for sets the step of the method that
 * is wanted: no bound from above raises it. */
static bool is_settled(const hk_spectrum_work *s) {
  const hk_spectrum *b = &s->bounds;
  if (!s->method) return false;
  hk_stable stable = hk_stable_step(s->method, s->parameters, b);
  return stable.limit > 0 && stable.w == b->w_max && stable.g == b->g_max;
}

static hk_status bound_above(hk_spectrum_work *s, const hk_operation *damping) {
  hk_spectrum *b = &s->bounds;
  double slope = b->g_max / (b->w_max * b->w_max), bound;
  hk_status status = bound_one(s, damping, slope, 1, &bound);
  if (status != HK_OK) return status;
  b->damping_slope = slope;
  b->damping_offset = fmax(bound, accuracy * b->g_max);
  return HK_OK;
}

/* Whether the method that is wanted is stable beyond its limit on the imaginary axis with as much damping as the
 * fastest modes may have, and that is more than is known of them. Some hundred growth factors: in a small scene finding
 * limits would take longer than all else. */
static bool is_worthwhile(const hk_spectrum_work *s) {
  const hk_spectrum *b = &s->bounds;
  const hk_integrator *m = s->method;
  double z = first, g = part[0] * b->g_max;
  if (!m) return true;
  if (!m->growth || hk_spectrum_floor(b, b->w_max) >= g) return false;
  if (m->order > 2 && m->flags & (HK_SYMPLECTIC | HK_REVERSIBLE)) return true;
  while (z < last && m->growth(s->parameters, m->method, z, 0, 0) <= 1 + grown) z *= beyond;
  z *= beyond;
  return m->growth(s->parameters, m->method, z, z * g / b->w_max, 0) <= 1 + grown;
}

static hk_status bound_below(hk_spectrum_work *s, const hk_operation *damping) {
  hk_spectrum *b = &s->bounds;
  hk_status status = HK_OK;
  for (int k = 0; k < HK_DAMPED_LINES && status == HK_OK; k++) {
    double slope = part[k] * b->g_max / (b->w_max * b->w_max), bound;
    status = bound_one(s, damping, slope, -1, &bound);
    if (status == HK_OK) b->damped[k].slope = slope, b->damped[k].offset = bound;
  }
  return status;
}

hk_status hk_bound_pencils(hk_spectrum_work *s, const hk_operation *damping) {
  const hk_spectrum *b = &s->bounds;
  hk_status status = HK_OK;
  if (!(b->w_max > 0)) return HK_OK;
  if (b->g_max > strong * b->w_max && !is_settled(s)) status = bound_above(s, damping);
  bool lasts = b->w_switching == 0 && s->stiffening_damping == 0;
  if (status == HK_OK && lasts && b->g_max > weak * b->w_max && is_worthwhile(s)) status = bound_below(s, damping);
  return status;
}
