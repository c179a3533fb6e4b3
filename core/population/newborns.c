/* Newborn particles are moved from their births, at different times within a step, to its end: by one step of the
 * classical Runge-Kutta method each, as long as the particle is old, under the forces of the scene on it alone (forces
 * between it and others begin to act with the next step). Constant accelerations are followed exactly, others with an
 * error of h^5 where they do not depend on the time. Where they do, they are evaluated at the ends and the middle of
 * the step, and the parabola through the three gives them at each particle's own times, which leaves h^4 in the
 * velocity. */
#include "core/population/population.h"

#include <stdlib.h>
#include <string.h>

enum { NODES = 3 };

/* All vectors have the shape of X; only what is of newborns in them is ever touched. */
typedef struct nursery {
  hk_dynamics *d;
  const hk_newborn *newborn;
  size_t first, count;
  double h;
  double *begin, *sum, *slope, *part; /* the state at birth; the weighted sum of slopes; a slope, and one at a node */
  uint32_t *index;                    /* count, of the newborns */
  bool *is_active;                    /* n, false between evaluations */
} nursery;

/* Calls visit for the newborns' numbers in each block of X: `at` is the first, `width` the number per particle. */
static void each_block(const nursery *y, void (*visit)(const nursery *, size_t at, size_t width, const double *number),
                       const double *number) {
  const hk_state *s = y->d->state;
  size_t n = s->model.n;
  visit(y, 3 * y->first, 3, number);
  visit(y, 3 * (n + y->first), 3, number);
  for (size_t k = 0; k < s->model.channels; k++) {
    size_t width = s->channel[k].size;
    visit(y, (6 + s->channel[k].offset) * n + width * y->first, width, number);
  }
}

static double age_of(const nursery *y, size_t b) { return isinf(y->newborn[b].age) ? 0 : y->newborn[b].age; }

/* ---- f at one time ---- */

/* The view of force k with the newborns alone; false: it acts on none of them. */
static bool narrow(const nursery *y, size_t k, hk_view *view) {
  if (view->active) {
    size_t before = view->acting;
    while (before > 0 && view->active[before - 1] >= y->first) before--;
    view->active += before;
    view->acting -= before;
  } else {
    view->active = y->index;
    view->acting = y->count;
  }
  view->is_active = y->is_active;
  view->power = NULL;
  return y->d->force_acts[k] && view->acting > 0;
}

static hk_status add_force(const nursery *y, size_t k, double t, double *slope) {
  hk_state *s = y->d->state;
  hk_instance *force = y->d->plugins->kind[HK_FORCE].item[k];
  const hk_force *functions = force->plugin->force;
  hk_view view = hk_force_view_at(y->d, k, t, s->X, s->model.n);
  if (!narrow(y, k, &view)) return HK_OK;
  hk_status status = hk_instance_set_time(force, t, y->d->error);
  for (size_t e = 0; e < view.acting; e++) y->is_active[view.active[e]] = true;
  const hk_instance *outer = hk_enter(force);
  if (status == HK_OK) status = functions->add(force->self, &view, slope + 3 * s->model.n);
  if (status == HK_OK && functions->rates) status = functions->rates(force->self, &view, slope + 6 * s->model.n);
  status = hk_leave_with(force, outer, "add", status);
  for (size_t e = 0; e < view.acting; e++) y->is_active[view.active[e]] = false;
  return status;
}

static void clear(const nursery *y, size_t at, size_t width, const double *number) {
  (void)number;
  memset(y->part + at, 0, width * y->count * sizeof *y->part);
}

/* part = f(t, X) */
static hk_status evaluate(const nursery *y, double t) {
  hk_state *s = y->d->state;
  size_t v = 3 * s->model.n;
  hk_status status = HK_OK;
  each_block(y, clear, NULL);
  for (size_t k = 0; k < y->d->system.forces && status == HK_OK; k++) status = add_force(y, k, t, y->part);
  for (size_t k = 0; k < s->model.channels && status == HK_OK; k++)
    status = hk_evaluate_rate(y->d, k, t, s->X + 2 * v, y->part + 2 * v, y->first);
  for (size_t e = 3 * y->first; e < 3 * (y->first + y->count); e++) {
    y->part[e] = s->X[v + e];
    y->part[v + e] *= s->inverse_mass[e / 3];
  }
  return status;
}

/* ---- f at each newborn's own time ---- */

/* slope += part times the node's weight at the times t - (1 - c) age, which number[0] = c and number[1], the node,
 * name. */
static void add_node(const nursery *y, size_t at, size_t width, const double *number) {
  for (size_t b = 0, e = at; b < y->count; b++) {
    double u = 1 - (1 - number[0]) * age_of(y, b) / y->h;
    const double weight[NODES] = {(2 * u - 1) * (u - 1), 4 * u * (1 - u), u * (2 * u - 1)};
    for (size_t c = 0; c < width; c++, e++) y->slope[e] += weight[(int)number[1]] * y->part[e];
  }
}

static void clear_slope(const nursery *y, size_t at, size_t width, const double *number) {
  (void)number;
  memset(y->slope + at, 0, width * y->count * sizeof *y->slope);
}

static hk_status find_slope(nursery *y, double c) {
  double t = y->d->state->t;
  hk_status status = HK_OK;
  if (!(y->d->system.flags & HK_DEPENDS_ON_T)) {
    double *slope = y->slope;
    status = evaluate(y, t);
    y->slope = y->part;
    y->part = slope;
    return status;
  }
  each_block(y, clear_slope, NULL);
  for (int node = 0; node < NODES && status == HK_OK; node++) {
    status = evaluate(y, t - y->h * (NODES - 1 - node) / (NODES - 1));
    each_block(y, add_node, (const double[]){c, node});
  }
  return status;
}

/* ---- the step ---- */

static void begin(const nursery *y, size_t at, size_t width, const double *number) {
  (void)number;
  memcpy(y->begin + at, y->d->state->X + at, width * y->count * sizeof *y->begin);
  memset(y->sum + at, 0, width * y->count * sizeof *y->sum);
}

/* Adds number[0] slope to the sum and goes on to begin + age number[1] slope, or, at the end, begin + age sum. */
static void go_on(const nursery *y, size_t at, size_t width, const double *number) {
  bool last = number[1] == 0;
  for (size_t b = 0, e = at; b < y->count; b++)
    for (size_t c = 0; c < width; c++, e++) {
      y->sum[e] += number[0] * y->slope[e];
      y->d->state->X[e] = y->begin[e] + age_of(y, b) * (last ? y->sum[e] : number[1] * y->slope[e]);
    }
}

static hk_status take_step(nursery *y) {
  static const double time[] = {0, 0.5, 0.5, 1}, weight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6},
                      ahead[] = {0.5, 0.5, 1, 0};
  hk_status status = HK_OK;
  each_block(y, begin, NULL);
  for (int stage = 0; stage < 4 && status == HK_OK; stage++) {
    status = find_slope(y, time[stage]);
    each_block(y, go_on, (const double[]){weight[stage], ahead[stage]});
  }
  y->d->timed_at = NAN; /* parameters are those of another time */
  return status;
}

hk_status hk_newborns_move(hk_dynamics *d, const hk_newborn *newborn, size_t count, double h) {
  size_t n = d->state->model.n, size = d->state->size, aged = 0;
  for (size_t b = 0; b < count; b++) aged += newborn[b].age > 0 && !isinf(newborn[b].age);
  if (aged == 0) return HK_OK;
  nursery y = {.d = d, .newborn = newborn, .first = n - count, .count = count, .h = h};
  double *memory = calloc(4 * size, sizeof *memory);
  y.begin = memory, y.sum = memory + size, y.slope = memory + 2 * size, y.part = memory + 3 * size;
  y.index = malloc(count * sizeof *y.index);
  y.is_active = calloc(n, sizeof *y.is_active);
  bool fine = memory && y.index && y.is_active;
  for (size_t b = 0; fine && b < count; b++) y.index[b] = (uint32_t)(y.first + b);
  hk_status status = fine ? take_step(&y) : hk_error_set(d->error, HK_NO_MEMORY, "no memory for %zu births", count);
  free(memory);
  free(y.index);
  free(y.is_active);
  return status;
}
