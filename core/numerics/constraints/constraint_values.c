/* What the constraints of a scene say of a state: g, its derivatives and the rate of change of g, for all equations in
 * one list. */

#include "core/engine/contract/contract.h"
#include "core/numerics/constraints/constraints.h"
#include "core/numerics/rigid/rigid.h"

#include <stdio.h>
#include <string.h>

enum { MOST_NAMES = 4 };

hk_view hk_constraint_view(const hk_dynamics *d, const hk_instance *instance, double t, const double *x,
                           const double *v) {
  hk_view view = d->state->view;
  view.t = t;
  view.x = x;
  view.v = v;
  view.host = &instance->host;
  view.power = NULL;
  return view;
}

hk_status hk_constraint_failed(hk_dynamics *d, const hk_instance *instance, double t, hk_status status) {
  if (status != HK_OK && !*d->error->text)
    hk_error_set(d->error, status, "constraint '%s' failed at t = %g s without saying why", instance->label, t);
  return status;
}

hk_status hk_constraint_gradients(hk_dynamics *d, double t, const double *x, const double *v, double (*J)[3]) {
  const hk_constraints *c = d->constraints;
  const size_t *first = c->riding.given ? c->riding.first : c->block_first;
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count && status == HK_OK; k++) {
    const hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
    hk_view view = hk_constraint_view(d, instance, t, x, v);
    const hk_instance *outer = hk_enter(instance);
    status = instance->plugin->constraint->jacobian(instance->self, &view, J + first[k]);
    hk_leave(instance, outer);
    status = hk_constraint_failed(d, instance, t, status);
  }
  return status;
}

hk_status hk_constraint_jacobian(hk_dynamics *d, double t, const double *x, const double *v, double (*J)[3]) {
  const hk_constraints *c = d->constraints;
  const bool rides = c->riding.given > 0;
  hk_status status = hk_constraint_gradients(d, t, x, v, rides ? c->riding.J : J);
  if (rides && status == HK_OK) hk_rider_blocks_carry(c, J);
  return status;
}

typedef enum quantity { VALUE, CURVATURE, SPEED } quantity;

static hk_status ask(hk_dynamics *d, quantity what, double t, const double *x, const double *v, double *out) {
  hk_constraints *c = d->constraints;
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count && status == HK_OK; k++) {
    const hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
    const hk_constraint *functions = instance->plugin->constraint;
    hk_status (*function)(void *, const hk_view *, double *) = what == VALUE       ? functions->value
                                                               : what == CURVATURE ? functions->curvature
                                                                                   : functions->speed;
    hk_view view = hk_constraint_view(d, instance, t, x, v);
    const hk_instance *outer = hk_enter(instance);
    if (function) status = function(instance->self, &view, out + c->equation_first[k]);
    hk_leave(instance, outer);
    status = hk_constraint_failed(d, instance, t, status);
  }
  return status;
}

hk_status hk_constraint_value(hk_dynamics *d, double t, const double *x, const double *v) {
  return ask(d, VALUE, t, x, v, d->constraints->g);
}

hk_status hk_constraint_curvature(hk_dynamics *d, double t, const double *x, const double *v) {
  return ask(d, CURVATURE, t, x, v, d->constraints->c);
}

hk_status hk_constraint_speed(hk_dynamics *d, double t, const double *x, const double *v) {
  return d->constraints->has_speed ? ask(d, SPEED, t, x, v, d->constraints->speed) : HK_OK;
}

bool hk_constraint_touches(const hk_constraints *c, size_t k, double size) {
  bool rests = fabs(c->residual[k]) <= hk_constraint_resting * (c->correction[k] + size);
  return c->g[k] <= (rests ? hk_constraint_touching : hk_constraint_met) * size;
}

int hk_constraint_order(const hk_dynamics *d) {
  const hk_instances *methods = &d->plugins->kind[HK_INTEGRATOR];
  return methods->count ? methods->item[0]->plugin->integrator->order : 0;
}

double hk_constraint_extent(const hk_constraints *c, const double *x) {
  double largest[3] = {0, 0, 0};
  for (size_t b = 0; b < c->blocks; b++) {
    const double *at = x + 3 * (size_t)c->list.pair[b][1];
    for (int a = 0; a < 3; a++) largest[a] = fabs(at[a]) > largest[a] ? fabs(at[a]) : largest[a];
  }
  return fmax(fmax(largest[0], largest[1]), largest[2]);
}

void hk_constraint_rate(hk_constraints *c, const double *v, double *rate, double *sum) {
  memcpy(rate, c->speed, c->equations * sizeof *rate);
  for (size_t b = 0; b < c->blocks; b++)
    rate[c->list.pair[b][0]] += hk_constraint_dot(c->J[b], v + 3 * (size_t)c->list.pair[b][1]);
  if (!sum) return;
  for (size_t k = 0; k < c->equations; k++) sum[k] = fabs(c->speed[k]);
  for (size_t b = 0; b < c->blocks; b++) {
    const double *here = v + 3 * (size_t)c->list.pair[b][1];
    sum[c->list.pair[b][0]] += sqrt(hk_constraint_dot(c->J[b], c->J[b]) * hk_constraint_dot(here, here));
  }
}

double hk_constraint_power(const hk_dynamics *d, const double *v) {
  const hk_constraints *c = d->constraints;
  double sum = 0;
  for (size_t k = 0; c->has_speed && k < c->equations; k++) sum -= c->solution[k] * c->speed[k];
  for (size_t b = 0; d->pins->has_paths && b < c->blocks; b++) {
    uint32_t i = c->list.pair[b][1];
    if (d->state->pin[i] == HK_PIN_PATH)
      sum -= c->solution[c->list.pair[b][0]] * hk_constraint_dot(c->J[b], v + 3 * (size_t)i);
  }
  return sum;
}

const hk_instance *hk_constraint_of(const hk_dynamics *d, size_t equation, size_t *number) {
  size_t k = 0;
  while (d->constraints->equation_first[k + 1] <= equation) k++;
  *number = equation - d->constraints->equation_first[k] + 1;
  return d->plugins->kind[HK_CONSTRAINT].item[k];
}

void hk_constraint_name(const hk_dynamics *d, size_t equation, char *text, size_t size) {
  const hk_constraints *c = d->constraints;
  size_t number, named = 0, of = 0, blocks = c->riding.given ? c->riding.given : c->blocks;
  uint32_t(*pair)[2] = c->riding.given ? c->riding.pair : c->list.pair;
  hk_constraint_of(d, equation, &number);
  for (size_t b = 0; b < blocks; b++) of += pair[b][0] == equation;
  size_t at = (size_t)snprintf(text, size, "equation %zu (particle%s", number, of == 1 ? "" : "s");
  for (size_t b = 0; b < blocks && named < MOST_NAMES && at < size; b++) {
    if (pair[b][0] != equation) continue;
    const char *before = named == 0 ? " " : named + 1 == of ? " and " : ", ";
    at += (size_t)snprintf(text + at, size - at, "%s%u", before, (unsigned)d->state->id[pair[b][1]]);
    named++;
  }
  if (at < size) snprintf(text + at, size - at, "%s)", of > MOST_NAMES ? ", ..." : "");
}

const char *hk_constraint_doubt(const hk_dynamics *d, size_t equation, char *text, size_t size) {
  /* Of two bars at the chosen step those with masses 5e2 to 5e4 apart are solved, and those 5e5 apart are not. */
  static const double unlike = 1e5;
  const hk_constraints *c = d->constraints;
  size_t blocks = c->riding.given ? c->riding.given : c->blocks;
  uint32_t(*pair)[2] = c->riding.given ? c->riding.pair : c->list.pair;
  double least = INFINITY, most = 0;
  for (size_t b = 0; b < blocks; b++) {
    double mass = pair[b][0] == equation ? d->state->mass[pair[b][1]] : 0;
    if (mass > 0 && d->state->model.inverse_mass[pair[b][1]] > 0) least = fmin(least, mass), most = fmax(most, mass);
  }
  if (most > unlike * least)
    snprintf(text, size,
             "its particles have masses of %.3g and %.3g kg: an adaptive integrator (--tol) may follow the light one.",
             least, most);
  else
    snprintf(text, size,
             "do constraints contradict each other, or say the same twice, as a bar along two others does? Leave one "
             "out.");
  return text;
}

bool hk_constraint_held(const hk_dynamics *d, uint32_t pin) {
  if (pin == UINT32_MAX) return false;
  const hk_pin_spec *spec = d->pins->item[pin].spec;
  return (spec->kind == HK_PIN_FIXED || spec->kind == HK_PIN_PATH) && !isfinite(spec->release);
}

/* Fills the point of a particle or rider. */
static void fill_point(const hk_dynamics *d, uint32_t particle, size_t at[4], double weight[4]) {
  const hk_rider *r = hk_model_rider(&d->state->model, particle);
  for (uint32_t c = 0; c < 4; c++) {
    const bool carries = r && c < r->carriers;
    at[c] = 3 * (size_t)(carries ? r->carrier[c] : r ? r->carrier[0] : particle);
    weight[c] = carries ? r->weight[c] : !r && c == 0;
  }
}

int hk_rigid_pair_of(const hk_dynamics *d, size_t equation, uint32_t end[2], hk_rigid_pair *p) {
  size_t number, lengths = 0;
  const hk_instance *instance = hk_constraint_of(d, equation, &number);
  const unsigned kind = instance->plugin->constraint->flags & (HK_DISTANCES | HK_DIFFERENCES);
  const hk_tuples *pairs = NULL;
  if (!kind || instance->spec->timed_count) return -1;
  p->distance = kind == HK_DISTANCES;
  const size_t each = p->distance ? 1 : 3, tuple = (number - 1) / each;
  if ((number - 1) % each) return 0;
  for (const hk_param *q = instance->plugin->params; q->name; q++) {
    if (q->edges && !pairs) pairs = hk_param_in(q, instance->self);
    const hk_per_tuple *length = q->per_tuple && lengths < each ? hk_param_in(q, instance->self) : NULL;
    if (length && length->count == 0) return -1;
    if (length) p->length[lengths++] = hk_tuple_value(length, tuple);
  }
  if (!pairs || lengths < each) return -1;
  for (int e = 0; e < 2; e++) {
    end[e] = hk_tuple(pairs, tuple)[e];
    fill_point(d, end[e], p->at[e], p->weight[e]);
  }
  return (int)each;
}
