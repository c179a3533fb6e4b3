/* Derivatives by the numbers that forces and masses are, and the chain rule from these to a parameter of the scene. */
#include "core/numerics/sensitivity/force_slopes.h"

#include "core/engine/contract/contract.h"

#include <stdlib.h>
#include <string.h>

static const hk_instance *force_at(const hk_dynamics *d, size_t k) { return d->plugins->kind[HK_FORCE].item[k]; }

static bool is_tuples(hk_type type) { return type == HK_EDGES || type == HK_TRIANGLES || type == HK_TETRAHEDRA; }

static bool is_number(hk_type type) { return type == HK_NUMBER || type == HK_VECTOR || type == HK_PER_TUPLE; }

/* How many derivatives a row has. */
static size_t numbers_of(const hk_instance *force, const hk_param *p) {
  switch (hk_param_type(p)) {
  case HK_NUMBER:
    return 1;
  case HK_VECTOR:
    return 3;
  case HK_PER_TUPLE: {
    size_t count = ((const hk_tuples *)hk_param_in(hk_param_list(force->plugin, p->list), force->self))->count;
    return count > 0 ? count : 1;
  }
  default:
    return 0;
  }
}

static size_t rows_of(const hk_instance *force) {
  size_t rows = 0;
  while (force->plugin->params && force->plugin->params[rows].name) rows++;
  return rows;
}

static bool is_covered(const hk_instance *force, bool along) {
  const hk_implicit_facet *f = &hk_force_of(force->plugin)->implicit;
  return (along ? f->along != NULL : f->transposed != NULL) && force->spec->timed_count == 0;
}

static hk_status cover(hk_force_slopes *s, const hk_instance *force, size_t k) {
  size_t rows = rows_of(force);
  double **row = calloc(rows + 1, sizeof *row);
  if (!row) return HK_NO_MEMORY;
  s->force[k] = row;
  for (size_t r = 0; r < rows; r++) {
    size_t count = numbers_of(force, &force->plugin->params[r]);
    if (count > 0 && !(row[r] = calloc(count, sizeof **row))) return HK_NO_MEMORY;
  }
  return HK_OK;
}

hk_status hk_force_slopes_open(hk_force_slopes *s, const hk_dynamics *d, const bool *exact) {
  size_t forces = d->split.forces;
  *s = (hk_force_slopes){.all = true,
                         .covers = calloc(forces + 1, sizeof *s->covers),
                         .force = calloc(forces + 1, sizeof *s->force),
                         .mass = calloc(d->state->model.n + 1, sizeof *s->mass)};
  if (!s->covers || !s->force || !s->mass) return HK_NO_MEMORY;
  hk_status status = HK_OK;
  for (size_t k = 0; k < forces && status == HK_OK; k++) {
    s->covers[k] = is_covered(force_at(d, k), exact) && (!exact || exact[k]);
    if (s->covers[k]) status = cover(s, force_at(d, k), k);
    s->any |= s->covers[k];
    s->all &= s->covers[k];
  }
  return status;
}

void hk_force_slopes_close(hk_force_slopes *s, const hk_dynamics *d) {
  for (size_t k = 0; s->force && k < d->split.forces; k++) {
    size_t rows = s->force[k] ? rows_of(force_at(d, k)) : 0;
    for (size_t r = 0; r < rows; r++) free(s->force[k][r]);
    free(s->force[k]);
  }
  free(s->force);
  free(s->covers);
  free(s->mass);
  *s = (hk_force_slopes){0};
}

/* ---- whether the chain rule holds ---- */

bool hk_varied_moves_pins(const hk_varied *by) {
  const hk_pins *more = by->more->pins, *less = by->less->pins;
  return more->has_paths || more->has_slides || less->has_paths || less->has_slides;
}

static bool same_tuples(const hk_tuples *a, const hk_tuples *b) {
  return a->count == b->count && a->arity == b->arity &&
         (a->count == 0 || memcmp(a->index, b->index, a->count * a->arity * sizeof *a->index) == 0);
}

static bool same_list(const double *a, size_t count, const double *b, size_t other) {
  return count == other && (count == 0 || memcmp(a, b, count * sizeof *a) == 0);
}

/* Numbers by which the force gives no derivative. */
static bool same_numbers(const hk_param *p, const void *a, const void *b) {
  if (hk_param_type(p) == HK_PER_TUPLE) {
    const hk_per_tuple *x = hk_param_in(p, a), *y = hk_param_in(p, b);
    return same_list(x->value, x->count, y->value, y->count);
  }
  size_t count = hk_param_type(p) == HK_VECTOR ? 3 : 1;
  return same_list(hk_param_in(p, a), count, hk_param_in(p, b), count);
}

/* A row that is no number has the same value in both. */
static bool same_row(const hk_param *p, const void *a, const void *b) {
  hk_type type = hk_param_type(p);
  if (is_number(type)) return true;
  if (type == HK_NUMBERS) {
    const hk_numbers *x = hk_param_in(p, a), *y = hk_param_in(p, b);
    return same_list(x->value, x->count, y->value, y->count);
  }
  if (is_tuples(type)) return same_tuples(hk_param_in(p, a), hk_param_in(p, b));
  if (type == HK_CHOICE) return *(int *)hk_param_in(p, a) == *(int *)hk_param_in(p, b);
  if (type == HK_INTEGER) return *(int64_t *)hk_param_in(p, a) == *(int64_t *)hk_param_in(p, b);
  if (type == HK_BOOLEAN) return *(bool *)hk_param_in(p, a) == *(bool *)hk_param_in(p, b);
  return false;
}

static bool same_selection(const hk_instance *a, const hk_instance *b, size_t n) {
  if (a->acting != b->acting || !a->is_active != !b->is_active) return false;
  return !a->is_active || memcmp(a->is_active, b->is_active, n * sizeof *a->is_active) == 0;
}

static bool same_rows(const hk_instance *a, const hk_instance *b) {
  uint64_t not_by = hk_force_of(a->plugin)->implicit.not_by;
  const hk_param *params = a->plugin->params;
  for (size_t r = 0; params && params[r].name; r++) {
    bool none = r < 64 && not_by >> r & 1 && is_number(hk_param_type(&params[r]));
    if (!(none ? same_numbers : same_row)(&params[r], a->self, b->self)) return false;
  }
  return true;
}

static bool same_force(const hk_dynamics *d, const hk_dynamics *e, size_t k, bool covered) {
  const hk_instance *a = force_at(d, k), *b = force_at(e, k);
  if (strcmp(a->plugin->name, b->plugin->name) != 0) return false;
  if (!covered) return true;
  if (d->force_acts[k] != e->force_acts[k] || b->spec->timed_count > 0) return false;
  if (!same_selection(a, b, d->state->model.n)) return false;
  return same_rows(a, b);
}

/* Riders hand what acts on them to their carriers by their weights. */
static bool same_riders(const hk_model *a, const hk_model *b) {
  bool same = a->riders == b->riders;
  for (size_t k = 0; k < a->riders && same; k++) {
    const hk_rider *x = &a->rider[k], *y = &b->rider[k];
    same = x->particle == y->particle && x->carriers == y->carriers;
    for (uint32_t c = 0; same && c < x->carriers; c++)
      same = x->carrier[c] == y->carrier[c] && x->weight[c] == y->weight[c];
  }
  return same;
}

static bool same_scene(const hk_force_slopes *s, const hk_dynamics *d, const hk_dynamics *e) {
  const hk_model *a = &d->state->model, *b = &e->state->model;
  if (!same_tuples(&a->triangles, &b->triangles) || !same_riders(a, b)) return false;
  if (d->split.forces != e->split.forces || memcmp(a->pin, b->pin, a->n * sizeof *a->pin) != 0) return false;
  for (size_t k = 0; k < d->split.forces; k++)
    if (!same_force(d, e, k, s->covers[k])) return false;
  return true;
}

/* Shapes at rest are those of the start: both scenes stand there. */
static bool same_shapes(const hk_force_slopes *s, const hk_dynamics *d, const hk_varied *by) {
  bool any = false;
  for (size_t k = 0; k < d->split.forces; k++)
    any |= s->covers[k] && hk_force_of(force_at(d, k)->plugin)->implicit.of_start;
  const double *more = by->more->state->X, *less = by->less->state->X;
  return !any || memcmp(more, less, 3 * d->state->model.n * sizeof *more) == 0;
}

static bool same_masses(const hk_varied *by) {
  const hk_model *a = &by->more->state->model, *b = &by->less->state->model;
  return memcmp(a->mass, b->mass, a->n * sizeof *a->mass) == 0;
}

static bool same_values(const hk_instance *a, const hk_instance *b) {
  const hk_param *params = a->plugin->params;
  for (size_t r = 0; params && params[r].name; r++)
    if (is_number(hk_param_type(&params[r])) && !same_numbers(&params[r], a->self, b->self)) return false;
  return true;
}

bool hk_force_slopes_unmoved(const hk_force_slopes *s, const hk_varied *by, bool *unmoved) {
  const hk_dynamics *d = by->more, *e = by->less;
  bool start = memcmp(d->state->X, e->state->X, 3 * d->state->model.n * sizeof(double)) == 0,
       all = !hk_varied_moves_pins(by);
  bool same = !by->knots && same_scene(s, d, e) && same_masses(by);
  for (size_t k = 0; k < d->split.forces; k++) {
    unmoved[k] = same && s->covers[k] && same_values(force_at(d, k), force_at(e, k)) &&
                 (start || !hk_force_of(force_at(d, k)->plugin)->implicit.of_start);
    all = all && unmoved[k];
  }
  return all;
}

/* ---- the chain rule ---- */

/* Of the numbers of a row; equal ones, which may be NAN where they are not given, count nothing. */
static double row_change(const double *slope, size_t count, const double *more, const double *less, size_t more_apart,
                         size_t less_apart) {
  double sum = 0;
  for (size_t e = 0; e < count; e++) {
    double a = more[e * more_apart], b = less[e * less_apart];
    if (a != b && !(isnan(a) && isnan(b))) sum += (slope ? slope[e] : 1) * (slope ? a - b : fabs(a - b));
  }
  return sum;
}

/* With `slope` the derivative along the change of the row, otherwise the size of that. */
static double by_row(const hk_param *p, const double *slope, size_t count, const void *more, const void *less) {
  const void *a = hk_param_in(p, more), *b = hk_param_in(p, less);
  if (hk_param_type(p) != HK_PER_TUPLE) return row_change(slope, count, a, b, 1, 1);
  const hk_per_tuple *x = a, *y = b;
  if (x->count == 0 || y->count == 0) return x->count == y->count ? 0 : NAN;
  return row_change(slope, count, x->value, y->value, x->count > 1, y->count > 1);
}

static double by_forces(const hk_force_slopes *s, const hk_dynamics *d, const hk_varied *by, bool size) {
  double sum = 0;
  for (size_t k = 0; k < d->split.forces; k++) {
    const hk_instance *force = force_at(d, k);
    size_t rows = s->covers[k] ? rows_of(force) : 0;
    for (size_t r = 0; r < rows; r++)
      if (s->force[k][r])
        sum += by_row(&force->plugin->params[r], size ? NULL : s->force[k][r],
                      numbers_of(force, &force->plugin->params[r]), force_at(by->more, k)->self,
                      force_at(by->less, k)->self);
  }
  return sum;
}

/* A function of time has no derivative by a number that holds all the time: it is found at each time instead. */
bool hk_force_slopes_fit(const hk_force_slopes *s, const hk_dynamics *d, const hk_varied *by) {
  if (!s->any || !same_scene(s, d, by->more) || !same_scene(s, d, by->less)) return false;
  if (!same_shapes(s, d, by)) return false;
  if (!same_masses(by) && (!s->all || by->knots)) return false;
  double size = by_forces(s, d, by, true);
  return by->knots ? size == 0 : size >= 0;
}

double hk_force_slopes_by(const hk_force_slopes *s, const hk_dynamics *d, const hk_varied *by) {
  const hk_model *model = &d->state->model, *more = &by->more->state->model, *less = &by->less->state->model;
  double sum = by_forces(s, d, by, false);
  for (size_t i = 0; i < model->n; i++)
    if (model->inverse_mass[i] > 0) sum += s->mass[i] * (more->mass[i] - less->mass[i]);
  return sum / (2 * by->by);
}

/* ---- as directions ---- */

/* The changes of a row's numbers by one of the parameter; whether any is not 0. */
static bool row_along(const hk_param *p, size_t count, const void *more, const void *less, double by, double *to) {
  const double *a = hk_param_in(p, more), *b = hk_param_in(p, less);
  size_t more_apart = 1, less_apart = 1;
  bool any = false;
  if (hk_param_type(p) == HK_PER_TUPLE) {
    const hk_per_tuple *x = hk_param_in(p, more), *y = hk_param_in(p, less);
    if (x->count == 0) return false; /* and neither has y: the parameter fits */
    a = x->value, b = y->value;
    more_apart = x->count > 1, less_apart = y->count > 1;
  }
  for (size_t e = 0; e < count; e++) {
    double of_a = a[e * more_apart], of_b = b[e * less_apart];
    bool same = of_a == of_b || (isnan(of_a) && isnan(of_b));
    to[e] = same ? 0 : (of_a - of_b) / (2 * by);
    any |= !same;
  }
  return any;
}

static size_t numbers_of_all(const hk_force_slopes *s, const hk_dynamics *d, size_t *rows) {
  size_t numbers = 0;
  *rows = 0;
  for (size_t k = 0; k < d->split.forces; k++) {
    const hk_instance *force = force_at(d, k);
    size_t own = s->covers[k] ? rows_of(force) : 0;
    for (size_t r = 0; r < own; r++) numbers += numbers_of(force, &force->plugin->params[r]);
    *rows += own;
  }
  return numbers;
}

hk_status hk_force_changes_open(hk_force_changes *c, const hk_force_slopes *s, const hk_dynamics *d,
                                const hk_varied *by) {
  const hk_model *model = &d->state->model, *more = &by->more->state->model, *less = &by->less->state->model;
  size_t rows, n = model->n, numbers = numbers_of_all(s, d, &rows);
  c->memory = calloc(numbers + n + 1, sizeof *c->memory);
  c->force = calloc(d->split.forces + 1, sizeof *c->force);
  if (!c->memory || !c->force) return HK_NO_MEMORY;
  double *at = c->memory + n;
  for (size_t k = 0; k < d->split.forces; k++) {
    const hk_instance *force = force_at(d, k);
    size_t own = s->covers[k] ? rows_of(force) : 0;
    if (s->covers[k] && !(c->force[k] = calloc(own + 1, sizeof **c->force))) return HK_NO_MEMORY;
    for (size_t r = 0; r < own; r++) {
      const hk_param *p = &force->plugin->params[r];
      size_t count = numbers_of(force, p);
      if (count && row_along(p, count, force_at(by->more, k)->self, force_at(by->less, k)->self, by->by, at))
        c->force[k][r] = at;
      at += count;
    }
  }
  for (size_t i = 0; i < n; i++)
    if (model->inverse_mass[i] > 0 && more->mass[i] != less->mass[i]) {
      c->memory[i] = (more->mass[i] - less->mass[i]) / (2 * by->by);
      c->mass = c->memory;
    }
  return HK_OK;
}

void hk_force_changes_close(hk_force_changes *c, const hk_dynamics *d) {
  for (size_t k = 0; c->force && k < d->split.forces; k++) free(c->force[k]);
  free(c->force);
  free(c->memory);
  *c = (hk_force_changes){0};
}
