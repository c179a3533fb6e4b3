/* Pseudo-transient continuation (Kelley and Keyes 1998, SIAM Journal on Numerical Analysis 35): stages of backward
 * Euler from rest, M (x' - x)/g^2 = F(x'), each solved by the damped Newton method of the implicit integrators
 * (newton.h), whose line search descends on the energy E(x') + M |x' - x|^2/(2 g^2). Each stage starts at rest, so that
 * E falls in all of them; g grows with success, and what is left of the inertia vanishes: the last stages are Newton's
 * method for F = 0. Where a stage fails, g shrinks.
 *
 * What has been found is pushed a little off in a random direction: of a minimum of the energy it comes back, off a
 * saddle it slides away, to another equilibrium, which is then taken and pushed in its turn. */
#include "tools/native/common/equilibrium.h"
#include "plugins/common/implicit/newton.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { STAGES = 400, FAILURES = 40, PUSHES = 4 };

static const double growth = 4, shrink = 0.1, push = 1e-6, back = 100, longest = 1e8;

typedef struct search {
  hk_run *run;
  hk_system *s;
  hk_newton newton;
  double *memory, *base, *X, *force, *kept; /* 5, 1 and 1 states; n x 3; a state */
  double g;
  hk_equilibrium *found;
} search;

static double size_of(const double *f) { return sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]); }

static void stop(search *e) {
  size_t v = 3 * e->s->n;
  memset(e->s->X + v, 0, v * sizeof *e->s->X);
}

/* The forces with those of constraints, at rest, in the directions in which particles may move. */
static hk_status residual(search *e) {
  hk_system *s = e->s;
  size_t v = 3 * s->n;
  double *rates = e->base; /* behind the accelerations those of channels */
  stop(e);
  hk_status status = s->accelerations(s, s->t, s->X, s->X + v, s->X + 2 * v, rates, rates + v);
  if (status != HK_OK) return status;
  for (size_t i = 0; i < s->n; i++)
    for (size_t c = 3 * i; c < 3 * i + 3; c++) e->force[c] = s->model->mass[i] * rates[c];
  s->filter(s, e->force);
  e->found->residual = 0;
  for (size_t i = 0; i < s->n; i++) {
    double size = size_of(e->force + 3 * i);
    if (!(size <= e->found->residual)) e->found->residual = size, e->found->id = e->run->state.id[i];
  }
  return isfinite(e->found->residual) ? HK_OK : HK_NOT_FINITE;
}

/* N: what the rounding of the positions does to the forces, by the rows of K. */
static hk_status rounding(search *e, double *newton) {
  hk_matrix K, D;
  *newton = 0;
  hk_status status = e->s->linear->jacobian(e->s, e->s->t, e->s->X, HK_WANT_SYMMETRIC, &K, &D);
  if (status != HK_OK) return status;
  for (size_t i = 0; i < K.rows; i++) {
    double sum = 0;
    for (size_t b = K.row_start[i]; b < K.row_start[i + 1]; b++) {
      double square = 0;
      for (size_t c = 0; c < 9; c++) square += K.value[9 * b + c] * K.value[9 * b + c];
      sum += sqrt(square) * size_of(e->s->X + 3 * K.column[b]);
    }
    *newton = fmax(*newton, 8 * DBL_EPSILON * sum);
  }
  return HK_OK;
}

/* One stage with the present g; the state is as it was where it fails. */
static hk_status stage(search *e) {
  hk_system *s = e->s;
  size_t v = 3 * s->n;
  stop(e);
  memcpy(e->base, s->X, s->size * sizeof *s->X);
  memcpy(e->X, s->X, s->size * sizeof *s->X);
  const hk_stage at = {.t = s->t, .g = e->g, .limit = INFINITY, .base = e->base, .X = e->X, .fixed = true};
  hk_status status = hk_newton_solve(&e->newton, s, &at);
  if (status == HK_OK) {
    memcpy(s->X, e->X, v * sizeof *s->X);
    stop(e);
    if (s->constraint) status = s->constraint->project(s, s->t, s->X, s->X + v);
  }
  if (status != HK_OK) {
    memcpy(s->X, e->base, s->size * sizeof *s->X);
    hk_newton_forget(&e->newton);
  }
  e->found->stages++;
  return status;
}

static bool may_be_repeated(hk_status status) { return status == HK_NOT_CONVERGED || status == HK_NOT_FINITE; }

/* Stages until the forces balance; found->balanced says whether they do. */
static hk_status settle(search *e) {
  hk_equilibrium *f = e->found;
  double floor = 0, before = INFINITY;
  for (int k = 0, failures = 0; k < STAGES && failures < FAILURES; k++) {
    hk_status status = residual(e);
    if (status == HK_OK) status = rounding(e, &floor);
    if (status != HK_OK) return status;
    if (k == 0) f->first = fmax(f->first, f->residual);
    f->allowed = fmax(f->tolerance * f->first, floor);
    f->balanced = f->residual <= f->allowed;
    if (f->balanced) return HK_OK;
    status = stage(e);
    if (status != HK_OK && !may_be_repeated(status)) return status;
    failures = status == HK_OK && f->residual < before ? 0 : failures + 1;
    before = fmin(before, f->residual);
    e->g = status == HK_OK ? fmin(growth * e->g, longest) : shrink * e->g;
  }
  return HK_OK;
}

/* A number in -1 to 1 that is the same in each run (Knuth's generator MMIX). */
static double chance(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(int64_t)(*seed >> 11) / 4503599627370496.0 - 1;
}

static double distance(const search *e) {
  double sum = 0;
  size_t v = 3 * e->s->n;
  for (size_t c = 0; c < v; c++) sum += (e->s->X[c] - e->kept[c]) * (e->s->X[c] - e->kept[c]);
  return sqrt(sum / (double)(e->s->n ? e->s->n : 1));
}

/* Whether it comes back; the state is then the one before the push, and else the one where it ends. */
static hk_status try_push(search *e, uint64_t *seed) {
  hk_system *s = e->s;
  hk_equilibrium *f = e->found;
  size_t v = 3 * s->n;
  double extent = hk_state_extent(&e->run->state), allowed = f->allowed;
  const hk_equilibrium now = *f;
  memcpy(e->kept, s->X, s->size * sizeof *s->X);
  for (size_t c = 0; c < v; c++) e->force[c] = push * extent * chance(seed);
  s->filter(s, e->force);
  for (size_t c = 0; c < v; c++) s->X[c] += e->force[c];
  hk_status status = s->constraint ? s->constraint->project(s, s->t, s->X, s->X + v) : HK_OK;
  f->asked = true;
  f->pushed = distance(e);
  e->g = fmax(1 / e->run->scene->fps, shrink * e->g);
  if (status == HK_OK) status = settle(e);
  if (status != HK_OK) return status;
  f->away = distance(e);
  f->returned = f->balanced && f->away <= back * f->pushed;
  if (!f->returned) return HK_OK;
  memcpy(s->X, e->kept, s->size * sizeof *s->X);
  f->residual = now.residual, f->id = now.id, f->allowed = allowed;
  return HK_OK;
}

static hk_status refuse(hk_error *error, const char *what, const char *name, const char *remedy) {
  return hk_error_set(error, HK_BAD_PARAM, "equilibrium is of forces and constraints, and the scene has %s '%s': %s",
                      what, name, remedy);
}

static hk_status check(const hk_run *run, hk_error *error) {
  const hk_plugins *p = &run->plugins;
  const hk_instances *correctors = &p->kind[HK_CORRECTOR], *sources = &p->kind[HK_SOURCE];
  if (correctors->count)
    return refuse(error, "the corrector", correctors->item[0]->label,
                  "take a force in its place, such as penalty or barrier, or leave it out by --without LABEL");
  if (sources->count) return refuse(error, "the source", sources->item[0]->label, "leave it out by --without LABEL");
  const hk_constraint_table *c = run->dynamics.system.constraint;
  if (c && !c->holonomic)
    return hk_error_set(error, HK_BAD_PARAM,
                        "the scene has one-sided constraints that act, such as cables and stops, whose "
                        "equilibrium is not found here: take bars, or springs");
  return HK_OK;
}

static hk_status check_channels(const search *e, hk_error *error) {
  const double *rates = e->base + 3 * e->s->n;
  for (size_t k = 0; k + 1 < e->s->size - 6 * e->s->n; k++)
    if (rates[k] != 0)
      return refuse(error, "the channel", e->run->state.channel[0].name,
                    "it changes with time; leave out what changes it");
  return HK_OK;
}

static hk_status begin(search *e, hk_error *error) {
  hk_system *s = e->s;
  size_t size = s->size + 1;
  e->newton = (hk_newton){.tolerance = 1e-3, .iterations = 60, .krylov_most = 8, .reuse = true};
  e->memory = calloc((HK_NEWTON_STATES + 4) * size, sizeof *e->memory);
  if (!e->memory) return hk_error_set(error, HK_NO_MEMORY, "no memory for the search of an equilibrium");
  e->newton.memory = e->memory;
  e->base = e->memory + HK_NEWTON_STATES * size;
  e->X = e->base + size;
  e->kept = e->X + size;
  e->force = e->kept + size;
  e->g = 1 / e->run->scene->fps;
  return hk_newton_create(&e->newton, s->host, hk_run_view(e->run));
}

static hk_status find(search *e, hk_error *error) {
  double before = NAN, after = NAN;
  uint64_t seed = 1;
  hk_status status = residual(e);
  if (status == HK_OK) status = check_channels(e, error);
  if (status == HK_OK) status = e->s->linear->potential(e->s, e->s->t, e->s->X, &before);
  if (status == HK_OK) status = settle(e);
  /* No state may be tried that contact was not told of. */
  for (int k = 0; k < PUSHES && status == HK_OK && e->found->balanced && !e->found->returned && !e->s->contact; k++)
    status = try_push(e, &seed);
  if (status == HK_OK) status = e->s->linear->potential(e->s, e->s->t, e->s->X, &after);
  e->found->lowered = before - after;
  return status;
}

hk_status hk_equilibrium_find(hk_run *run, hk_equilibrium *found, hk_error *error) {
  search e = {.run = run, .s = &run->dynamics.system, .found = found};
  *found = (hk_equilibrium){.tolerance = found->tolerance};
  hk_status status = check(run, error);
  if (status == HK_OK) status = begin(&e, error);
  if (status == HK_OK) status = find(&e, error);
  if (e.memory) hk_newton_destroy(&e.newton, e.s->host);
  free(e.memory);
  if (status == HK_OK) return HK_OK;
  if (error->status == HK_OK)
    return hk_error_set(error, status, "%s", run->error.text[0] ? run->error.text : "forces are not finite");
  return status;
}
