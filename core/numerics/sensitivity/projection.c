/* Steps of scenes with constraints taken again, and their tangents. */
#include "core/numerics/sensitivity/projection.h"

#include "core/engine/contract/contract.h"

#include <stdlib.h>
#include <string.h>

/* ---- what cannot be differentiated ---- */

static hk_status refuse_constraint(const hk_instance *instance, hk_error *error) {
  const hk_constraint *c = instance->plugin->constraint;
  const char *why = NULL;
  if (instance->spec->timed_count || c->speed) why = "changes with time, which is not differentiated";
  if (!(c->flags & (HK_DISTANCES | HK_DIFFERENCES | HK_WAYS)))
    why = "states no second derivatives of its equations (distances, differences, ways)";
  if (c->flags & HK_ONE_SIDED) why = "acts on one side only, and its begin and end are not differentiated";
  if (c->update || c->loads) why = "changes its equations in the run, which is not differentiated";
  if (!why) return HK_OK;
  return hk_error_set(error, HK_FAILED,
                      "constraint '%s' %s: leave it out (--without), or take forces in its place, stiff ones with an "
                      "implicit integrator",
                      instance->label, why);
}

/* Whether the method is one kick and a drift, or a kick, a drift and a kick: as it states its stages. */
static bool kicks(const hk_stages_facet *m) {
  if (m->back != 0 || m->c[0] != 0 || m->x_end[0] != m->v_end[0]) return false;
  if (m->count == 1) return m->x_end[0] == 1 && m->v[0][0] == 0;
  double k = m->x_end[0];
  return m->count == 2 && m->carries && m->c[1] == 1 && m->x[1][0] == k && m->x_end[1] == 0 && m->v[1][0] == 2 * k &&
         m->v_end[0] + m->v_end[1] == 1 && m->v_end[0] == k && m->v[1][1] == 0;
}

hk_status hk_projection_refuse(const hk_loop *loop, hk_error *error) {
  const hk_instances *list = &loop->plugins->kind[HK_CONSTRAINT];
  hk_status status = HK_OK;
  for (size_t k = 0; k < list->count && status == HK_OK; k++) status = refuse_constraint(list->item[k], error);
  if (status != HK_OK || list->count == 0 || kicks(&hk_integrator_tables_of(loop->method)->stages)) return status;
  return hk_error_set(error, HK_FAILED,
                      "integrator '%s' brings the state back onto constraints by an iteration that is not "
                      "differentiated: with constraints choose one whose steps are kicks and drifts, with --integrator",
                      loop->integrator->plugin->name);
}

/* ---- memory ---- */

static double *take(double **at, size_t count) {
  double *taken = *at;
  *at += count;
  return taken;
}

hk_status hk_projection_open(hk_sensitivity *s) {
  const hk_constraints *c = s->dynamics->constraints;
  if (!c || c->equations == 0) return HK_OK;
  hk_projection *p = s->projection = calloc(1, sizeof *p);
  size_t m = c->equations, v = 3 * s->n, named = hk_constraint_bend_blocks(s->dynamics);
  if (p) p->memory = malloc((2 * m + s->n + 14 * v + 6 * named + 1) * sizeof *p->memory);
  if (!p || !p->memory) return HK_NO_MEMORY;
  double *at = p->memory;
  p->equations = m;
  p->kick = s->method->v_end[0];
  s->wide += m;
  p->by_equation = take(&at, m);
  p->by_mass = take(&at, s->n);
  p->push = take(&at, v);
  p->work = take(&at, 10 * v + m);
  p->bend = (hk_constraint_bend){.n = s->n, .work = take(&at, 3 * v)};
  for (int side = 0; side < 2; side++) p->bend.beside[side] = (double(*)[3])take(&at, 3 * named);
  return HK_OK;
}

void hk_projection_close(hk_sensitivity *s) {
  if (s->projection) free(s->projection->memory);
  free(s->projection);
  s->projection = NULL;
}

size_t hk_projection_taped(const hk_sensitivity *s) {
  return s->projection ? 9 * s->n + 2 * s->projection->equations : 0;
}

void hk_projection_put(hk_sensitivity *s, double *at) {
  hk_projection *p = s->projection;
  if (!p) return;
  p->from = take(&at, 3 * s->n);
  p->after = take(&at, 3 * s->n);
  p->end = take(&at, 3 * s->n);
  p->impulse = take(&at, p->equations);
  p->lambda = take(&at, p->equations);
}

/* ---- linear algebra of the equations ---- */

void hk_projection_rates(const hk_constraints *c, double (*J)[3], const double *u, double *of) {
  memset(of, 0, c->equations * sizeof *of);
  for (size_t b = 0; b < c->blocks; b++)
    of[c->list.pair[b][0]] += hk_constraint_dot(J[b], u + 3 * (size_t)c->list.pair[b][1]);
}

hk_status hk_projection_linearise(hk_dynamics *d, double t, const double *x) {
  hk_constraints *c = d->constraints;
  memcpy(c->rests, c->implied, c->equations * sizeof *c->rests);
  return hk_constraint_matrix_linearise(d, t, x, x);
}

hk_status hk_projection_stand(hk_sensitivity *s, double t, const double *x) {
  hk_status status = hk_projection_linearise(s->dynamics, t, x);
  return status == HK_OK ? hk_constraint_matrix_factorize(s->dynamics) : status;
}

hk_status hk_projection_mix(hk_sensitivity *s, double t, const double *x, double t_of_push, const double *x_of_push) {
  hk_dynamics *d = s->dynamics;
  hk_status status = hk_projection_linearise(d, t_of_push, x_of_push);
  if (status == HK_OK) status = hk_constraint_matrix_mix(d, t, x, x);
  if (status != HK_NOT_CONVERGED || *d->error->text) return status;
  return hk_error_set(d->error, status,
                      "the equations of the constraints follow from each other in the step at t = %g s, where its "
                      "derivative is not unique: leave out what says the same twice, or take a shorter step (--dt)",
                      t);
}

/* ---- a step taken again ---- */

/* The multipliers of W J^T l = change, by which free particles differ. */
static hk_status multipliers_of(hk_sensitivity *s, double t, const double *x, const double *after, const double *before,
                                double *multipliers) {
  hk_constraints *c = s->dynamics->constraints;
  double *change = s->projection->work;
  for (size_t e = 0; e < 3 * s->n; e++)
    change[e] = s->dynamics->state->model.inverse_mass[e / 3] > 0 ? after[e] - before[e] : 0;
  if (s->dynamics->pins->has_slides) hk_pins_filter(s->dynamics->pins, change);
  hk_status status = hk_projection_stand(s, t, x);
  if (status != HK_OK) return status;
  hk_projection_rates(c, c->J, change, c->rhs);
  status = hk_constraint_matrix_solve(s->dynamics);
  memcpy(multipliers, c->solution, c->equations * sizeof *multipliers);
  return status;
}

/* X: on entry y and v_h, then x' and v_m; Z: x and v. */
static hk_status drift(hk_sensitivity *s, const hk_taken_step *step, hk_carried *Z, double *X) {
  hk_dynamics *d = s->dynamics;
  hk_projection *p = s->projection;
  size_t v = 3 * s->n;
  double work = 0, *free_x = p->work + v;
  memcpy(free_x, X, v * sizeof *X);
  hk_status status =
      d->constraints->table.shake_from(&d->system, step->t, Z, step->t + step->h, step->h, X, X + v, &work);
  hk_riders_follow(d->constraints->model, X);
  hk_riders_follow(d->constraints->model, X + v);
  if (status != HK_OK || d->constraints->groups) /* of which each solves its own equations */
    return status == HK_OK ? multipliers_of(s, step->t, p->from, X, free_x, p->impulse) : status;
  memcpy(p->impulse, d->constraints->impulse, p->equations * sizeof *p->impulse);
  return HK_OK;
}

static hk_status settle(hk_sensitivity *s, const hk_taken_step *step, double *X) {
  hk_dynamics *d = s->dynamics;
  hk_projection *p = s->projection;
  size_t v = 3 * s->n;
  double work = 0, *before = p->work + v;
  memcpy(before, X + v, v * sizeof *X);
  hk_status status = d->constraints->table.rattle(&d->system, step->t + step->h, X, step->h, X + v, &work);
  if (status != HK_OK || d->constraints->groups)
    return status == HK_OK ? multipliers_of(s, step->t + step->h, X, X + v, before, p->lambda) : status;
  memcpy(p->lambda, d->constraints->solution, p->equations * sizeof *p->lambda);
  return HK_OK;
}

/* What is carried has the constraint forces in it, as in the run, whose steps begin near their end for it: then l is
 * less by h m of the step before. */
static void take_all_of_impulse(hk_projection *p, const double *lambda_before, double h) {
  for (size_t k = 0; k < p->equations; k++) p->impulse[k] += h * lambda_before[k];
}

/* The second stage: X has x' and v_m, and gets w. */
static hk_status second_stage(hk_sensitivity *s, const hk_taken_step *step, const hk_carried *Z, double *X) {
  size_t v = 3 * s->n, last = s->method->count - 1;
  hk_stage_point *end = &s->point[last];
  end->t = step->t + step->h;
  memcpy(end->X, X, v * sizeof *X);
  for (size_t e = 0; e < v; e++) end->X[v + e] = 2 * X[v + e] - Z[v + e];
  hk_status status = hk_sensitivity_evaluate(s->dynamics, end->t, end->X, end->a);
  for (size_t e = 0; e < v; e++) X[v + e] += step->h * s->method->v_end[last] * end->a[e];
  return status;
}

hk_status hk_projection_step(hk_sensitivity *s, const hk_taken_step *step, hk_carried *Z) {
  hk_projection *p = s->projection;
  size_t v = 3 * s->n, last = s->method->count - 1;
  bool fresh = hk_sensitivity_evaluates(s, step, 0);
  double h = step->h, *X = p->work + 2 * v, *middle = X + 2 * v, *a = Z + 2 * v, *lambda = Z + 3 * v;
  hk_status status = HK_OK;
  memcpy(p->from, Z, v * sizeof *Z);
  if (fresh) {
    s->point[0].t = step->t;
    memcpy(s->point[0].X, Z, 2 * v * sizeof *Z);
    status = hk_sensitivity_evaluate(s->dynamics, step->t, s->point[0].X, s->point[0].a);
  }
  for (size_t e = 0; e < v; e++) {
    X[v + e] = Z[v + e] + p->kick * h * (fresh ? s->point[0].a : a)[e];
    X[e] = Z[e] + h * X[v + e];
  }
  if (status == HK_OK) status = drift(s, step, Z, X);
  if (!fresh) take_all_of_impulse(p, lambda, h);
  memcpy(middle, X + v, v * sizeof *X);
  if (last > 0 && status == HK_OK) status = second_stage(s, step, Z, X);
  if (status == HK_OK) status = settle(s, step, X);
  memcpy(p->after, X, v * sizeof *X);
  memcpy(p->end, X + v, v * sizeof *X);
  for (size_t e = 0; e < v; e++) a[e] = 2 / h * (X[v + e] - middle[e]);
  memcpy(lambda, p->lambda, p->equations * sizeof *lambda);
  memcpy(Z, X, 2 * v * sizeof *X);
  return status;
}

hk_status hk_projection_place(hk_sensitivity *s, const hk_taken_step *step, double *Z) {
  hk_projection *p = s->projection;
  size_t v = 3 * s->n;
  double *X = p->work + 2 * v;
  memcpy(p->from, Z, v * sizeof *Z);
  memcpy(X, Z, v * sizeof *X);
  memset(X + v, 0, v * sizeof *X);
  hk_status status = drift(s, step, Z, X);
  memcpy(X + v, Z + v, v * sizeof *X);
  if (status == HK_OK) status = settle(s, step, X);
  memcpy(p->after, X, v * sizeof *X);
  memcpy(p->end, X + v, v * sizeof *X);
  memcpy(Z, X, 2 * v * sizeof *X);
  return status;
}

/* ---- tangents ---- */

/* to += W q, and what masses that change by dm make of W J^T l, in `push`: -dm/m of it. */
static void weigh(hk_sensitivity *s, double *q, const hk_projection_slopes *by, const double *push, double *to) {
  const hk_model *model = &s->dynamics->state->model;
  hk_sensitivity_divide(s, q);
  for (size_t e = 0; e < 3 * s->n; e++) {
    double mass = by && model->inverse_mass[e / 3] > 0 ? by->mass[e / 3] * model->inverse_mass[e / 3] : 0;
    to[e] += q[e] - mass * push[e];
  }
  hk_riders_follow(model, to);
}

/* push = W J^T u, J of the last linearisation */
static void find_push(hk_sensitivity *s, const double *u) {
  double *push = s->projection->push;
  memset(push, 0, 3 * s->n * sizeof *push);
  hk_constraint_matrix_push(s->dynamics->constraints, u, 1, push);
}

static hk_status drift_one(hk_sensitivity *s, const hk_taken_step *step, const double *da,
                           const hk_projection_slopes *by, hk_carried *dZ) {
  hk_projection *p = s->projection;
  hk_constraints *c = s->dynamics->constraints;
  size_t v = 3 * s->n;
  double h = step->h, *dy = p->work + 5 * v, *dx = dy + v, *q = dx + v;
  memset(q, 0, v * sizeof *q);
  hk_status status = hk_constraint_bend_add(s->dynamics, &p->bend, step->t, p->from, p->impulse, dZ, q);
  if (status != HK_OK) return status;
  for (size_t e = 0; e < v; e++) {
    dZ[v + e] += p->kick * h * da[e];
    dx[e] = dy[e] = dZ[e] + h * dZ[v + e];
  }
  weigh(s, q, by, p->push, dx);
  hk_projection_rates(c, c->J_end, dx, c->rhs);
  for (size_t k = 0; k < c->equations; k++) c->rhs[k] = -c->rhs[k] - (by ? by->g[k] : 0);
  status = hk_constraint_matrix_solve_mixed(s->dynamics);
  hk_constraint_matrix_move(c, dx);
  for (size_t e = 0; e < v; e++) {
    dZ[e] = dx[e];
    dZ[v + e] += (dx[e] - dy[e]) / h;
  }
  return status;
}

hk_status hk_projection_drift(hk_sensitivity *s, const hk_taken_step *step, size_t count, size_t apart,
                              const double *da, const hk_projection_slopes *by, hk_carried *dZ, double *dX) {
  hk_projection *p = s->projection;
  size_t v = 3 * s->n;
  hk_status status = hk_projection_mix(s, step->t + step->h, p->after, step->t, p->from);
  if (status == HK_OK) find_push(s, p->impulse);
  for (size_t j = 0; j < count && status == HK_OK; j++) {
    double *X = dX + j * apart, *Z = dZ + j * apart;
    memcpy(X + v, Z + v, v * sizeof *X);
    status = drift_one(s, step, da + j * apart, by ? &by[j] : NULL, Z);
    memcpy(X, Z, v * sizeof *X);
    for (size_t e = 0; e < v; e++) X[v + e] = 2 * Z[v + e] - X[v + e];
  }
  return status;
}

hk_status hk_projection_settle(hk_sensitivity *s, const hk_taken_step *step, size_t count, size_t apart,
                               const hk_projection_slopes *by, hk_carried *dZ) {
  hk_projection *p = s->projection;
  hk_constraints *c = s->dynamics->constraints;
  size_t v = 3 * s->n;
  double t = step->t + step->h, *q = p->work + 5 * v, *turn = p->work + 10 * v;
  hk_status status = hk_projection_stand(s, t, p->after);
  if (status == HK_OK) find_push(s, p->lambda);
  for (size_t j = 0; j < count && status == HK_OK; j++) {
    double *Z = dZ + j * apart;
    memset(q, 0, v * sizeof *q);
    status = hk_constraint_bend_add(s->dynamics, &p->bend, t, p->after, p->lambda, Z, q);
    if (status == HK_OK) status = hk_constraint_turn(s->dynamics, &p->bend, t, p->after, Z, p->end, turn);
    if (status != HK_OK) return status;
    weigh(s, q, by ? &by[j] : NULL, p->push, Z + v);
    hk_projection_rates(c, c->J, Z + v, c->rhs);
    for (size_t k = 0; k < c->equations; k++) c->rhs[k] = -c->rhs[k] - turn[k];
    status = hk_constraint_matrix_solve(s->dynamics);
    hk_constraint_matrix_move(c, Z + v);
  }
  return status;
}

/* ---- what parameters change ---- */

/* What a parameter changes differs by some 1e-5 of it between two scenes; what it does not change, by rounding. */
static const double rounding = 1e-10;

static bool same_riders(const hk_model *a, const hk_model *b) {
  bool same = a->riders == b->riders;
  for (size_t k = 0; same && k < a->riders; k++) {
    const hk_rider *p = &a->rider[k], *q = &b->rider[k];
    same = p->particle == q->particle && p->carriers == q->carriers;
    for (uint32_t c = 0; same && c < p->carriers; c++)
      same = p->carrier[c] == q->carrier[c] && fabs(p->weight[c] - q->weight[c]) <= rounding * (1 + fabs(p->weight[c]));
  }
  return same;
}

static bool same_equations(const hk_dynamics *a, const hk_dynamics *b) {
  const hk_constraints *c = a->constraints, *e = b->constraints;
  return e && c->equations == e->equations && c->blocks == e->blocks && c->riding.given == e->riding.given &&
         memcmp(c->list.pair, e->list.pair, c->blocks * sizeof *c->list.pair) == 0 &&
         same_riders(&a->state->model, &b->state->model);
}

/* g at the start, and the gradients there. */
static hk_status values_of(hk_sensitivity *s, hk_dynamics *d, double (*J)[3]) {
  const double *x = s->start, *v = x + 3 * s->n;
  double t = s->steps ? s->step[0].t : 0;
  hk_status status = hk_constraint_value(d, t, x, v);
  return status == HK_OK ? hk_constraint_gradients(d, t, x, v, J) : status;
}

static hk_status vary_one(hk_sensitivity *s, const hk_varied *by, hk_projection_slopes *slopes, hk_error *error) {
  const hk_projection *p = s->projection;
  size_t named = hk_constraint_bend_blocks(s->dynamics);
  if (!same_equations(s->dynamics, by->more) || !same_equations(s->dynamics, by->less))
    return hk_error_set(error, HK_FAILED,
                        "a parameter changes which particles constraints or bodies join, and how: it has no "
                        "derivative; compare whole runs (hooke sweep)");
  hk_status status = values_of(s, by->more, p->bend.beside[0]);
  if (status == HK_OK) status = values_of(s, by->less, p->bend.beside[1]);
  if (status != HK_OK) return hk_error_set(error, status, "%s", by->more->error->text);
  const double *more = p->bend.beside[0][0], *less = p->bend.beside[1][0];
  bool any = false, turns = false;
  for (size_t k = 0; k < p->equations; k++) {
    slopes->g[k] = (by->more->constraints->g[k] - by->less->constraints->g[k]) / (2 * by->by);
    any |= slopes->g[k] != 0;
  }
  for (size_t i = 0; i < s->n; i++) {
    slopes->mass[i] = (by->more->state->model.mass[i] - by->less->state->model.mass[i]) / (2 * by->by);
    any |= slopes->mass[i] != 0;
  }
  for (size_t e = 0; e < 3 * named; e++) turns |= !(fabs(more[e] - less[e]) <= rounding * (1 + fabs(more[e])));
  if (turns)
    return hk_error_set(error, HK_FAILED,
                        "a parameter changes the length by which a guide is measured, which is not differentiated: "
                        "compare whole runs (hooke sweep)");
  if (!any || !by->knots) return HK_OK;
  return hk_error_set(error, HK_FAILED,
                      "a function of time changes masses or constraints, which is not differentiated: let it change a "
                      "force");
}

hk_status hk_projection_vary(hk_sensitivity *s, const hk_varied *by, size_t count, hk_projection_slopes **made,
                             hk_error *error) {
  size_t each = s->projection->equations + s->n;
  hk_projection_slopes *list = *made = calloc(1, count * (sizeof *list + each * sizeof(double)) + 1);
  if (!list) return hk_error_set(error, HK_NO_MEMORY, "no memory for derivatives of constraints");
  double *at = (double *)(void *)(list + count);
  hk_status status = HK_OK;
  for (size_t j = 0; j < count && status == HK_OK; j++) {
    list[j].g = take(&at, s->projection->equations);
    list[j].mass = take(&at, s->n);
    status = vary_one(s, &by[j], &list[j], error);
  }
  return status;
}
