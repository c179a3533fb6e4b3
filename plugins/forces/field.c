/* A force that the scene's script states as a function of the state, to try things out: F = f(t, x, v, id), or the
 * gradient of a potential, F = -dU/dx(t, x, id), by central differences.
 *
 * The script is called for one particle after another in one thread: some 0.1 us a call, in groups that the host takes
 * together, of which a potential needs six for a force and two for the power of its change in time. The same force in C
 * takes some nanoseconds; what pays is written as a plugin once it is right (hooke new force).
 *
 * In units of `length`, over which the force changes, the differences are over 2e-5 (first ones: roundings of eps/d and
 * errors of d^2/24 are about equal) and 2.4e-4 (second ones of U, for Jacobians: 4 eps/d^2 and d^2/12). They assume 1 m
 * where no length is stated; where one is, no step moves a particle by more than half of it. What the functions do
 * between the steps of a run is sampled as for other functions of time, on the ways of three particles. */
#include "core/plugin.h"

#include <string.h>

typedef struct field {
  const hk_function *f, *potential;
  double length;
} field;

static const hk_param params[] = {
    {"f", "N", "the force on a particle; a call takes some 0.1 us, twenty times what C takes",
     .function = HK_AT(field, f), .signature = "function(t, x, y, z, vx, vy, vz, id) -> fx, fy, fz"},
    {"potential", "J", "or its potential energy, whose gradient takes 6 calls, and 2 more for its power",
     .function = HK_AT(field, potential), .signature = "function(t, x, y, z, id) -> energy"},
    {"length", "m", "over which the force changes: no step moves a particle by more than half of it",
     .number = HK_AT(field, length), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {0},
};

static const double part = 1e-5, wide = 12, /* of the length, and times that for second differences */
    exact = 128 * 2.2e-16,                  /* of a coordinate: shorter differences are mostly its rounding */
    instant = 1e-5; /* s, of differences in time: their power is a figure of the summary, and no part of the motion */

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  const field *p = self;
  (void)view;
  if (!p->f == !p->potential) return host->fail(host, HK_BAD_PARAM, "give either f or potential");
  return HK_OK;
}

/* ---- one particle ---- */

typedef struct place {
  const field *self;
  const hk_view *view;
  double t, x[3], v[3], id;
} place;

static place place_of(const field *p, const hk_view *view, size_t i) {
  const double *x = view->x + 3 * i, *v = view->v + 3 * i;
  return (place){p, view, view->t, {x[0], x[1], x[2]}, {v[0], v[1], v[2]}, view->model->id[i]};
}

static hk_status call_f(const place *a, double F[3]) {
  const double in[] = {a->t, a->x[0], a->x[1], a->x[2], a->v[0], a->v[1], a->v[2], a->id};
  return a->view->host->call(a->view->host, a->self->f, in, 8, F, 3);
}

static hk_status call_potential(const place *a, double *U) {
  const double in[] = {a->t, a->x[0], a->x[1], a->x[2], a->id};
  return a->view->host->call(a->view->host, a->self->potential, in, 5, U, 1);
}

/* Half of a difference around a number. */
static double step_of(const field *p, double middle) {
  return fmax(part * (isnan(p->length) ? 1 : p->length), exact * fabs(middle));
}

static size_t acting(const hk_view *view, size_t k) { return view->active ? view->active[k] : k; }

/* ---- all particles, in groups ---- */

enum { GROUP = 64, IN_F = 8, IN_U = 5, MOST = 8 /* calls of a potential for a particle */ };

/* Of particles first, ..., `count` of those that the force acts on. */
typedef struct group {
  const field *self;
  const hk_view *view;
  size_t first, count;
} group;

static place member(const group *g, size_t k) { return place_of(g->self, g->view, acting(g->view, g->first + k)); }

/* Adds one force, of which all power is work or, of a potential, what it changes in time. */
static void add_one(const group *g, size_t k, const double one[3], double change, double *F) {
  const size_t i = acting(g->view, g->first + k);
  const double *v = g->view->v + 3 * i;
  for (size_t c = 0; c < 3; c++) F[3 * i + c] += one[c];
  if (g->view->power) *g->view->power += g->self->f ? one[0] * v[0] + one[1] * v[1] + one[2] * v[2] : change;
}

static hk_status add_f(const group *g, double *F) {
  const hk_host *host = g->view->host;
  double in[GROUP][IN_F], out[GROUP][3];
  for (size_t k = 0; k < g->count; k++) {
    const place a = member(g, k);
    const double one[IN_F] = {a.t, a.x[0], a.x[1], a.x[2], a.v[0], a.v[1], a.v[2], a.id};
    memcpy(in[k], one, sizeof one);
  }
  hk_status status = host->call_each(host, g->self->f, in[0], IN_F, out[0], 3, g->count);
  for (size_t k = 0; k < g->count && status == HK_OK; k++) add_one(g, k, out[k], 0, F);
  return status;
}

/* The arguments of two calls around a place along one of its numbers, 1 to 3 of x, 0 of t; their distance. */
static double around(const place *a, size_t which, double in[2][IN_U]) {
  const double all[IN_U] = {a->t, a->x[0], a->x[1], a->x[2], a->id};
  const double h = which ? step_of(a->self, all[which]) : instant;
  memcpy(in[0], all, sizeof all);
  memcpy(in[1], all, sizeof all);
  in[0][which] += h, in[1][which] -= h;
  return in[0][which] - in[1][which];
}

static hk_status add_potential(const group *g, double *F) {
  static const size_t which[] = {1, 2, 3, 0};
  const hk_host *host = g->view->host;
  const size_t slopes = g->view->power ? 4 : 3;
  double in[GROUP * MOST][IN_U], U[GROUP * MOST], apart[GROUP * MOST / 2];
  for (size_t k = 0, q = 0; k < g->count; k++) {
    const place a = member(g, k);
    for (size_t c = 0; c < slopes; c++, q++) apart[q] = around(&a, which[c], in + 2 * q);
  }
  hk_status status = host->call_each(host, g->self->potential, in[0], IN_U, U, 1, 2 * slopes * g->count);
  for (size_t k = 0; k < g->count && status == HK_OK; k++) {
    double slope[4] = {0};
    for (size_t c = 0, q = slopes * k; c < slopes; c++, q++) slope[c] = (U[2 * q] - U[2 * q + 1]) / apart[q];
    add_one(g, k, (const double[]){-slope[0], -slope[1], -slope[2]}, slope[3], F);
  }
  return status;
}

static group group_at(const field *self, const hk_view *view, size_t first) {
  const size_t rest = view->acting - first;
  return (group){self, view, first, rest < GROUP ? rest : GROUP};
}

static hk_status add(void *self, const hk_view *view, double *F) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < view->acting && status == HK_OK; k += GROUP) {
    const group g = group_at(self, view, k);
    status = g.self->f ? add_f(&g, F) : add_potential(&g, F);
  }
  return status;
}

/* NaN where the potential fails: the next evaluation says why. */
static double energy(void *self, const hk_view *view) {
  double sum = 0;
  if (((const field *)self)->f) return 0;
  for (size_t first = 0; first < view->acting; first += GROUP) {
    const group g = group_at(self, view, first);
    double in[GROUP][IN_U], U[GROUP];
    for (size_t k = 0; k < g.count; k++) {
      const place a = member(&g, k);
      const double one[IN_U] = {a.t, a.x[0], a.x[1], a.x[2], a.id};
      memcpy(in[k], one, sizeof one);
    }
    bool fine = view->host->call_each(view->host, g.self->potential, in[0], IN_U, U, 1, g.count) == HK_OK;
    for (size_t k = 0; k < g.count; k++) sum += fine ? U[k] : NAN;
  }
  return sum;
}

/* ---- Jacobians ---- */

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  (void)self;
  for (size_t k = 0; k < view->acting; k++) p->block(p, (uint32_t)acting(view, k), (uint32_t)acting(view, k));
}

/* A -= df/d(what) in the column c, for the three numbers `what` of the place. */
static hk_status subtract_columns(place *a, double *what, double *A) {
  hk_status status = HK_OK;
  for (int c = 0; c < 3 && status == HK_OK; c++) {
    const double middle = what[c], h = step_of(a->self, middle), above = middle + h, below = middle - h;
    double high[3], low[3];
    what[c] = above;
    status = call_f(a, high);
    what[c] = below;
    if (status == HK_OK) status = call_f(a, low);
    what[c] = middle;
    for (int r = 0; r < 3 && status == HK_OK; r++) A[3 * r + c] -= (high[r] - low[r]) / (above - below);
  }
  return status;
}

/* U at x + i e_c + j e_d. */
static hk_status beside(place a, int c, double i, int d, double j, double *U) {
  a.x[c] += i;
  a.x[d] += j;
  return call_potential(&a, U);
}

/* K += d^2 U/dx_c dx_d: (U(+,+) - U(+,-) - U(-,+) + U(-,-))/(4 h_c h_d), for c = d the second difference over 2h. */
static hk_status add_second(const place *a, int c, int d, double *K) {
  static const double sign[4][2] = {{1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
  double sum = 0, hc = wide * step_of(a->self, a->x[c]), hd = wide * step_of(a->self, a->x[d]);
  for (int k = 0; k < 4; k++) {
    double U = 0;
    hk_status status = beside(*a, c, sign[k][0] * hc, d, sign[k][1] * hd, &U);
    if (status != HK_OK) return status;
    sum += sign[k][0] * sign[k][1] * U;
  }
  K[3 * c + d] += sum / (4 * hc * hd);
  if (c != d) K[3 * d + c] += sum / (4 * hc * hd);
  return HK_OK;
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const field *p = self;
  hk_status status = HK_OK;
  for (size_t k = 0; k < view->acting && status == HK_OK; k++) {
    place a = place_of(p, view, acting(view, k));
    double *K = into->K + 9 * into->slot[k], *D = into->D + 9 * into->slot[k];
    if (p->f) status = subtract_columns(&a, a.x, K);
    if (p->f && status == HK_OK) status = subtract_columns(&a, a.v, D);
    for (int q = 0; q < 9 && !p->f && status == HK_OK; q++)
      if (q / 3 <= q % 3) status = add_second(&a, q / 3, q % 3, K);
  }
  return status;
}

/* ---- */

static double longest_step(void *self, const hk_view *view) {
  const field *p = self;
  double most = 0;
  if (isnan(p->length)) return INFINITY;
  for (size_t k = 0; k < view->acting; k++) {
    const double *v = view->v + 3 * acting(view, k);
    most = fmax(most, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  return most > 0 ? p->length / 2 / sqrt(most) : INFINITY;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_POWER,
    .add = add,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.longest_step = longest_step)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "field",
    .summary = "a force in Lua, F = f(t, x, y, z, vx, vy, vz, id) or minus the gradient of a potential; slow",
    .reference = "",
    .instance_size = sizeof(field),
    .params = params,
    .create = create,
    .force = &force,
};
