/* The largest damping rate and the fastest turning of velocities from above, and what the damping is at least.
 *
 * A mode u of the damped scene is a root of l^2 + g l + w^2 = 0 with g = u*Du/u*Mu and w^2 = u*Ku/u*Mu, so bounds of
 * the two operators bound every mode, and D >= alpha M + beta (K - tension) bounds the damping rates from below. How
 * damping rises with frequency is what damping_pencil.c bounds.
 *
 * Forces like v x B make D unsymmetric: its skew part A turns velocities, u*Au = i b. What all particles in common
 * motion are subject to is a 3x3 block for each, which elements between them do not share; the skew parts of these
 * blocks are A, their axial vectors t (A u = t x u) bound b, and D - A is what Lanczos iteration is applied to. That it
 * is symmetric is checked on the way; a rotation that is none of single particles is counted as a frequency
 * (count_rotation). alpha is the smallest damping rate of the particles when all have the same velocity: elements
 * between them then exert no damping force, and pins only add damping. This is exact for drag and an estimate for other
 * forces. */
#include "core/numerics/stability/common_motion.h"
#include "core/numerics/stability/operation.h"
#include "core/numerics/stability/stiffness.h"

#include <stdlib.h>
#include <string.h>

/* Relative to w_max: where w determines the step, such a change of g changes the step by about that fraction. */
static const double damping_slack = 0.03;

/* *whole: whether the skew part of D is that of single particles. */
static hk_status check_turning(hk_operation *o, bool *whole) {
  hk_spectrum_work *s = o->work;
  double *p = s->damping.current, *q = s->damping.previous, *D = s->damping.image;
  hk_status status = hk_operation_need(s, &s->spare);
  if (status != HK_OK) return status;
  hk_turning_pair(o->system, p, q);
  status = hk_operation_apply(o, p, D);
  if (status != HK_OK) return status;
  memcpy(s->spare, D, 3 * s->n * sizeof *D);
  status = hk_operation_apply(o, q, D);
  *whole = status == HK_OK && hk_turning_is_whole(s->n, s->turn, p, q, s->spare, D);
  return status;
}

/* The response to the same velocity of all particles along the axis c. */
static hk_status respond(hk_operation *o, size_t c, double *column) {
  const double *w = o->system->model->inverse_mass, *v = o->system->X + 3 * o->system->n;
  size_t n = o->system->n;
  hk_status status = HK_OK;
  for (int side = 0; side < 2 && status == HK_OK; side++) {
    double by = side == 0 ? o->step : -o->step;
    memcpy(o->work->moved, v, 3 * n * sizeof *v);
    for (size_t i = 0; i < n; i++) o->work->moved[3 * i + c] += w[i] > 0 ? by : 0;
    status = hk_operation_evaluate(o, side == 0 ? column : o->work->a);
  }
  if (status != HK_OK) return status;
  hk_operation_difference(o, o->step, column);
  if (hk_system_equations(o->system) > 0) o->work->bounds.evaluations++;
  return hk_operation_allow(o->system, column);
}

static hk_status common_damping(hk_operation *o, double *alpha) {
  hk_spectrum_work *s = o->work;
  double *column[3] = {s->damping.current, s->damping.previous, s->damping.image};
  hk_status status = HK_OK;
  for (size_t c = 0; c < 3 && status == HK_OK; c++) status = respond(o, c, column[c]);
  if (status != HK_OK) return status;
  *alpha = hk_common_damping(o->system->model, column);
  double turn = hk_common_turning(o->system->model, column, NULL);
  bool whole = turn > hk_operation_noise(o);
  if (whole) status = hk_operation_need(s, &s->turn);
  if (whole && status == HK_OK) {
    hk_common_turning(o->system->model, column, s->turn);
    status = check_turning(o, &whole);
  }
  s->bounds.b_max = whole ? turn * HK_INFLATE : 0;
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

/* Bounds the eigenvalues of D; `use_stated` as in bound_stiffness. */
static hk_status iterate_damping(hk_operation *o, bool use_stated) {
  hk_spectrum_work *s = o->work;
  double stated;
  bool covered = use_stated && hk_stated_damping(o->system, hk_operation_blocks(s), &stated);
  hk_status status = hk_operation_bound(o, &s->damping, covered ? stated : INFINITY);
  if (status != HK_OK || !covered || s->damping.theta <= stated * (1 + 1e-6) + hk_operation_noise(o)) return status;
  return iterate_damping(o, false);
}

hk_status hk_bound_damping(hk_spectrum_work *s, hk_system *system) {
  hk_spectrum *b = &s->bounds;
  b->beta = system->queries->flags & HK_DEPENDS_ON_V ? b->beta : 0;
  if (!(system->queries->flags & HK_DEPENDS_ON_V)) return HK_OK;
  if (!(s->length > 0)) hk_operation_measure(s, system, INFINITY);
  double speed = fmax(hk_operation_largest(system->X + 3 * s->n, 3 * s->n), s->spacing * b->w_max);
  hk_operation o = {s, system, true, 1e-5 * (speed > 0 ? speed : 1), hk_operation_rest(s, system->X)};
  s->damping.slack = damping_slack * b->w_max;
  hk_status status = common_damping(&o, &b->alpha);
  if (status == HK_OK) status = iterate_damping(&o, b->b_max == 0);
  if (status != HK_OK) return status;
  double noise = hk_operation_noise(&o);
  b->g_max = s->damping.bound > noise ? s->damping.bound * HK_INFLATE : 0;
  b->g_max = s->damps_alone && s->stiffening_damping > 0 ? s->stiffening_damping : b->g_max + s->stiffening_damping;
  b->alpha = b->alpha > noise ? fmin(b->alpha / HK_INFLATE, b->g_max) : 0;
  bool symmetric = s->damping.asymmetry <= 1e-3 * s->damping.norm + noise;
  if (!symmetric) count_rotation(b, s->damping.norm);
  return symmetric ? hk_bound_pencils(s, &o) : HK_OK;
}
