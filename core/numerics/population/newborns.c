/* Newborn particles are moved from their births, at different times within a step, to its end: by steps of the
 * classical Runge-Kutta method, each as long as a part of the particle's age, under the forces of the scene on it alone
 * (forces between it and others begin to act with the next step). Constant accelerations are followed exactly, others
 * with an error of h^5 where they do not depend on the time. Where they do, they are evaluated at the ends and the
 * middle of the host's step, and the parabola through the three gives them at each particle's own times, which leaves
 * h^4 in the velocity.
 *
 * One step is enough for whatever an explicit method can follow. A drag that an implicit one steps over would make it
 * explode, so the steps are halved until they differ from the midpoint rule, which uses the same slopes, by a small
 * part of the change: then the product of rate and step is 0.25 at most. */
#include "core/numerics/population/population.h"

#include <stdlib.h>
#include <string.h>

enum { NODES = 3, VECTORS = 6, HALVINGS = 16 };

static const double small = 0.01, rounding = 1e-12;

/* All vectors have the shape of X; only what is of newborns in them is ever touched. */
typedef struct nursery {
  hk_dynamics *d;
  const hk_newborn *newborn;
  size_t first, count;
  double h;
  double *birth, *begin; /* the state at birth, and at the beginning of a step */
  double *slope, *part;  /* a slope, and one at a node */
  double *sum, *defect;  /* the weighted sums of slopes: the mean one, and its difference from that at the middle */
  uint32_t *index;       /* count, of the newborns */
  bool *is_active;       /* n, false between evaluations */
} nursery;

/* One of the four slopes of a step: at `time`, a fraction of the age; its weights in the two sums; where it leads, as a
 * fraction of the age. */
typedef struct stage {
  double time, weight, defect, ahead;
} stage;

typedef void visit(const nursery *, size_t at, size_t width, const void *context);

/* Calls `what` for the newborns' numbers in each block of X: `at` is the first, `width` the number per particle. */
static void each_block(const nursery *y, visit *what, const void *context) {
  const hk_state *s = y->d->state;
  size_t n = s->model.n;
  what(y, 3 * y->first, 3, context);
  what(y, 3 * (n + y->first), 3, context);
  for (size_t k = 0; k < s->model.channels; k++) {
    size_t width = s->channel[k].size;
    what(y, (6 + s->channel[k].offset) * n + width * y->first, width, context);
  }
}

static double age_of(const nursery *y, size_t b) { return isinf(y->newborn[b].age) ? 0 : y->newborn[b].age; }

static void clear(const nursery *y, size_t at, size_t width, const void *vector) {
  memset((double *)(uintptr_t)vector + at, 0, width * y->count * sizeof(double));
}

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
  if (status == HK_OK) status = hk_force_add(force, &view, slope + 3 * s->model.n);
  if (status == HK_OK && functions->rates) status = functions->rates(force->self, &view, slope + 6 * s->model.n);
  status = hk_leave_with(force, outer, "add", status);
  for (size_t e = 0; e < view.acting; e++) y->is_active[view.active[e]] = false;
  return status;
}

/* part = f(t, X) */
static hk_status evaluate(const nursery *y, double t) {
  hk_state *s = y->d->state;
  size_t v = 3 * s->model.n;
  hk_status status = HK_OK;
  each_block(y, clear, y->part);
  for (size_t k = 0; k < y->d->split.forces && status == HK_OK; k++) status = add_force(y, k, t, y->part);
  for (size_t k = 0; k < s->model.channels && status == HK_OK; k++)
    status = hk_evaluate_rate(y->d, k, t, s->X + 2 * v, y->part + 2 * v, y->first);
  for (size_t e = 3 * y->first; e < 3 * (y->first + y->count); e++) {
    y->part[e] = s->X[v + e];
    y->part[v + e] *= s->inverse_mass[e / 3];
  }
  return status;
}

/* ---- f at each newborn's own time ---- */

typedef struct node {
  int number;
  double time; /* fraction of the age */
} node;

/* slope += part times the node's weight at the newborn's time, which is a fraction u of the host's step. */
static void add_node(const nursery *y, size_t at, size_t width, const void *context) {
  const node *of = context;
  for (size_t b = 0, e = at; b < y->count; b++) {
    double u = 1 - (1 - of->time) * age_of(y, b) / y->h;
    const double weight[NODES] = {(2 * u - 1) * (u - 1), 4 * u * (1 - u), u * (2 * u - 1)};
    for (size_t c = 0; c < width; c++, e++) y->slope[e] += weight[of->number] * y->part[e];
  }
}

static hk_status find_slope(nursery *y, double time) {
  double t = y->d->state->t, *slope = y->slope;
  hk_status status = HK_OK;
  if (!(y->d->queries.flags & HK_DEPENDS_ON_T)) {
    status = evaluate(y, t);
    y->slope = y->part;
    y->part = slope;
    return status;
  }
  each_block(y, clear, y->slope);
  for (int k = 0; k < NODES && status == HK_OK; k++) {
    status = evaluate(y, t - y->h * (NODES - 1 - k) / (NODES - 1));
    each_block(y, add_node, &(node){k, time});
  }
  return status;
}

/* ---- the steps ---- */

static void copy(const nursery *y, size_t at, size_t width, const void *context) {
  double *const *pair = context;
  memcpy(pair[1] + at, pair[0] + at, width * y->count * sizeof(double));
}

static void copy_all(const nursery *y, double *from, double *to) { each_block(y, copy, (double *const[]){from, to}); }

/* Adds the slope to the sums and goes on from `begin` along it. */
static void go_on(const nursery *y, size_t at, size_t width, const void *context) {
  const stage *of = context;
  for (size_t b = 0, e = at; b < y->count; b++)
    for (size_t c = 0; c < width; c++, e++) {
      y->sum[e] += of->weight * y->slope[e];
      y->defect[e] += of->defect * y->slope[e];
      y->d->state->X[e] = y->begin[e] + age_of(y, b) * of->ahead * y->slope[e];
    }
}

typedef struct end {
  double part; /* of the age, the length of a step */
  bool *rough; /* the step is too long */
} end;

/* The end of a step: X = begin + part age sum. A block is rough where the defect is no small part of the change in the
 * step, nor of the step's share of the change since the birth. */
static void finish(const nursery *y, size_t at, size_t width, const void *context) {
  const end *of = context;
  double change = 0, defect = 0, size = 0, total = 0;
  for (size_t b = 0, e = at; b < y->count; b++) {
    double step = of->part * age_of(y, b);
    for (size_t c = 0; c < width; c++, e++) {
      change = fmax(change, fabs(step * y->sum[e]));
      defect = fmax(defect, fabs(step * y->defect[e]));
      size = fmax(size, fabs(y->begin[e]));
      total = fmax(total, fabs(y->begin[e] - y->birth[e]));
      y->d->state->X[e] = y->begin[e] + step * y->sum[e];
    }
  }
  *of->rough |= !(defect <= small * fmax(change, of->part * total) + rounding * size);
}

/* Step `number` of `steps`. */
static hk_status take_step(nursery *y, size_t number, size_t steps, bool *rough) {
  static const stage stages[] = {
      {0, 1.0 / 6, 1.0 / 6, 0.5}, {0.5, 1.0 / 3, -2.0 / 3, 0.5}, {0.5, 1.0 / 3, 1.0 / 3, 1}, {1, 1.0 / 6, 1.0 / 6, 0}};
  double part = 1 / (double)steps;
  hk_status status = HK_OK;
  copy_all(y, y->d->state->X, y->begin);
  each_block(y, clear, y->sum);
  each_block(y, clear, y->defect);
  for (int k = 0; k < 4 && status == HK_OK; k++) {
    stage s = stages[k];
    status = find_slope(y, ((double)number + s.time) * part);
    s.ahead *= part;
    each_block(y, go_on, &s);
  }
  each_block(y, finish, &(end){part, rough});
  return status;
}

static hk_status move(nursery *y) {
  hk_status status = HK_OK;
  bool rough = true;
  copy_all(y, y->d->state->X, y->birth);
  for (int halving = 0; rough && status == HK_OK; halving++) {
    size_t steps = (size_t)1 << halving;
    if (halving > HALVINGS)
      return hk_error_set(
          y->d->error, HK_NOT_CONVERGED,
          "%zu births at t = %g s: the forces on them change too fast to follow them from their births; "
          "a shorter dt may do",
          y->count, y->d->state->t);
    copy_all(y, y->birth, y->d->state->X);
    rough = false;
    for (size_t k = 0; k < steps && !rough && status == HK_OK; k++) status = take_step(y, k, steps, &rough);
  }
  y->d->timed_at = NAN; /* parameters are those of another time */
  return status;
}

hk_status hk_newborns_move(hk_dynamics *d, const hk_newborn *newborn, size_t count, double h) {
  size_t n = d->state->model.n, size = d->state->size, aged = 0;
  for (size_t b = 0; b < count; b++) aged += newborn[b].age > 0 && !isinf(newborn[b].age);
  if (aged == 0) return HK_OK;
  nursery y = {.d = d, .newborn = newborn, .first = n - count, .count = count, .h = h};
  double *memory = calloc(VECTORS * size, sizeof *memory),
         **vector[] = {&y.birth, &y.begin, &y.slope, &y.part, &y.sum, &y.defect};
  for (size_t k = 0; memory && k < sizeof vector / sizeof *vector; k++) *vector[k] = memory + k * size;
  y.index = malloc(count * sizeof *y.index);
  y.is_active = calloc(n, sizeof *y.is_active);
  bool fine = memory && y.index && y.is_active;
  for (size_t b = 0; fine && b < count; b++) y.index[b] = (uint32_t)(y.first + b);
  hk_status status = fine ? move(&y) : hk_error_set(d->error, HK_NO_MEMORY, "no memory for %zu births", count);
  free(memory);
  free(y.index);
  free(y.is_active);
  return status;
}
