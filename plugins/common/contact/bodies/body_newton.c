/* Newton's iteration for all impacts at once (Alart and Curnier 1991, A mixed formulation for frictional contact
 * problems prone to Newton like solution methods, section 4): with the impulses z of the impacts along n and across,
 * and the distances or speeds u = u_0 + D (z - z_0), D = P U, the equations z_n - max(0, z_n - (u_n - target)/q) = 0,
 * z_t - projection of z_t - u_t/q on the disc of radius mu z_n = 0 are complementarity and Coulomb's law; each says of
 * its impact whether it opens, sticks or slips, and is linear then. Where contacts are more than what determines them
 * (four feet of a table), D is singular: a small part of its diagonal is added to the matrix of a round, not to the
 * equations, whose solution it leaves as it is. */
#include "plugins/common/contact/bodies/body_newton.h"
#include "plugins/common/contact/bodies/body_contact_law.h"
#include "plugins/common/cones/cone_program.h"
#include "plugins/common/contact/bodies/impact_response.h"
#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

enum { ROUNDS = 12, MOST = 400 /* unknowns */, SEARCHES = 12 };

static const double damping = 1e-7;

typedef struct newton {
  hk_body_impacts *bodies;
  const hk_contact_solver *solver;
  bool speeds;
  size_t size, count;                            /* unknowns; impacts that take part */
  size_t *impact, *first;                        /* count: their numbers and their first unknowns */
  double *D, *A;                                 /* size x size */
  double *z, *z_0, *u_0, *u, *rhs, *step, *axis; /* size; axis: size x 3, the direction of each unknown */
} newton;

static double friction_of(const newton *w, size_t k) { return hk_body_friction(w->bodies, w->solver, w->impact[k]); }

static const hk_impact_level *level_of(const newton *w, size_t k) {
  const hk_impact *impact = &w->solver->impact[w->impact[k]];
  return w->speeds ? &impact->speed : &impact->place;
}

static size_t unknowns_of(const newton *w, size_t k) { return friction_of(w, k) > 0 ? 3 : 1; }

static void choose(newton *w) {
  const hk_body_impacts *s = w->bodies;
  for (size_t e = 0; e < w->solver->count; e++) {
    const hk_impact *k = &w->solver->impact[e];
    if (!s->takes_part[e] || !s->response[e].known || !(k->mobility > 0)) continue;
    w->impact[w->count] = e;
    w->first[w->count] = w->size;
    w->size += unknowns_of(w, w->count++);
  }
}

static void set_axes(const newton *w, const double *y) {
  for (size_t k = 0; k < w->count; k++) {
    const hk_impact *impact = &w->solver->impact[w->impact[k]];
    const hk_impact_level *level = level_of(w, k);
    double r[3], *axis = w->axis + 3 * w->first[k];
    hk_copy(axis, impact->frame.n);
    if (unknowns_of(w, k) == 3) hk_vectors_across(axis, axis + 3, axis + 6);
    hk_body_relative(w->bodies, w->solver, w->impact[k], level, y, r);
    for (size_t a = 0; a < unknowns_of(w, k); a++) {
      size_t j = w->first[k] + a;
      w->z_0[j] = w->z[j] = a == 0 ? level->push : hk_dot(level->slide, axis + 3 * a);
      w->u_0[j] = hk_dot(r, axis + 3 * a) - (a == 0 ? level->target : 0);
    }
  }
}

/* G += the arms' part across n of the impact e, for impulses on the one whose columns r are. */
static void add_arms(const newton *w, size_t e, const hk_body_response *r, double G[9]) {
  const hk_body_impacts *s = w->bodies;
  const hk_body_arms *arms = hk_body_arms_of(s, e);
  double sum[9] = {0};
  for (int k = 0; k < 2 && arms; k++)
    for (int i = 0; i < 4 && arms->side[k].carrier; i++) {
      uint32_t at = s->place[arms->side[k].carrier[i]];
      for (int c = 0; c < 9 && at; c++) sum[c] += arms->side[k].weight[i] * s->block[r->first + at - 1][c];
    }
  hk_body_arms_across(sum, w->solver->impact[e].frame.n, G);
}

/* The columns of D of impact f: how the others' points move by its impulses. */
static void find_columns(const newton *w, size_t f) {
  hk_body_impacts *s = w->bodies;
  const hk_body_response *r = &s->response[w->impact[f]];
  for (size_t j = 0; j < r->count; j++) s->place[s->particle[r->first + j]] = (uint32_t)j + 1;
  for (size_t e = 0; e < w->count; e++) {
    const hk_impact *k = &w->solver->impact[w->impact[e]];
    double G[9] = {0};
    for (int i = 0; i < 4; i++) {
      uint32_t at = s->place[k->pair.vertex[i]];
      for (int c = 0; c < 9 && at && k->frame.w[i] != 0; c++) G[c] += k->frame.w[i] * s->block[r->first + at - 1][c];
    }
    if (hk_body_arms_of(s, w->impact[e])) add_arms(w, w->impact[e], r, G);
    for (size_t a = 0; a < unknowns_of(w, e); a++)
      for (size_t b = 0; b < unknowns_of(w, f); b++) {
        double moved[3];
        for (int c = 0; c < 3; c++) moved[c] = hk_dot(G + 3 * c, w->axis + 3 * (w->first[f] + b));
        w->D[(w->first[e] + a) * w->size + w->first[f] + b] = hk_dot(w->axis + 3 * (w->first[e] + a), moved);
      }
  }
  for (size_t j = 0; j < r->count; j++) s->place[s->particle[r->first + j]] = 0;
}

/* ---- a round ---- */

static void find_u(const newton *w) {
  for (size_t i = 0; i < w->size; i++) {
    w->u[i] = w->u_0[i];
    for (size_t j = 0; j < w->size; j++) w->u[i] += w->D[i * w->size + j] * (w->z[j] - w->z_0[j]);
  }
}

/* Row i says u_i = 0. */
static void hold(const newton *w, size_t i) {
  memcpy(w->A + i * w->size, w->D + i * w->size, w->size * sizeof *w->A);
  w->A[i * w->size + i] *= 1 + damping;
  w->rhs[i] = -w->u[i];
}

/* Row i says z_i = 0, in the units of u_i. */
static void release(const newton *w, size_t i) {
  memset(w->A + i * w->size, 0, w->size * sizeof *w->A);
  w->A[i * w->size + i] = w->D[i * w->size + i];
  w->rhs[i] = -w->D[i * w->size + i] * w->z[i];
}

/* The two rows across n of an impact that slips: z_t = mu z_n d, d the direction of z_t - u_t/q. */
static void slip(const newton *w, size_t i, double mu, double q, const double s[2]) {
  double size = sqrt(s[0] * s[0] + s[1] * s[1]), d[2] = {s[0] / size, s[1] / size}, limit = mu * fmax(0, w->z[i]),
         part = limit / size;
  for (size_t a = 0; a < 2; a++) {
    double *row = w->A + (i + 1 + a) * w->size;
    for (size_t j = 0; j < w->size; j++) {
      row[j] = 0;
      for (size_t b = 0; b < 2; b++) {
        double P = part * ((a == b) - d[a] * d[b]), ds = (j == i + 1 + b) - w->D[(i + 1 + b) * w->size + j] / q;
        row[j] -= q * P * ds;
      }
    }
    row[i + 1 + a] += q;
    row[i] -= q * mu * d[a];
    w->rhs[i + 1 + a] = -q * (w->z[i + 1 + a] - limit * d[a]);
  }
}

/* Sets the rows of impact k; returns what is left of its equations, m or m/s. */
static double set_rows(const newton *w, size_t k) {
  size_t i = w->first[k], size = w->size;
  double q = w->D[i * size + i], left;
  bool pushes = w->z[i] - w->u[i] / q > 0;
  pushes ? hold(w, i) : release(w, i);
  left = fabs(w->rhs[i]);
  if (unknowns_of(w, k) == 1) return left;
  double mu = friction_of(w, k), a = w->D[(i + 1) * size + i + 1], b = w->D[(i + 2) * size + i + 2];
  double across = a + b; /* no eigenvalue of the two is larger */
  double s[2] = {w->z[i + 1] - w->u[i + 1] / across, w->z[i + 2] - w->u[i + 2] / across};
  for (size_t c = 1; c <= 2; c++) {
    if (!pushes) release(w, i + c);
    if (pushes && sqrt(s[0] * s[0] + s[1] * s[1]) <= mu * fmax(0, w->z[i])) hold(w, i + c);
  }
  if (pushes && sqrt(s[0] * s[0] + s[1] * s[1]) > mu * fmax(0, w->z[i])) slip(w, i, mu, across, s);
  return fmax(left, sqrt(w->rhs[i + 1] * w->rhs[i + 1] + w->rhs[i + 2] * w->rhs[i + 2]));
}

/* Sets the rows at z and returns the sum of the squares of what is left; *most: the largest. */
static double evaluate(const newton *w, double *most) {
  double sum = 0;
  *most = 0;
  find_u(w);
  for (size_t k = 0; k < w->count; k++) {
    double left = set_rows(w, k);
    sum += left * left;
    if (!(left <= *most)) *most = left;
  }
  return sum;
}

/* Takes the part of the step w->rhs that makes what is left smaller; its rows are set then. False: none does. */
static bool search(const newton *w, double *left, double *most) {
  double part = 1, before = *left;
  memcpy(w->step, w->rhs, w->size * sizeof *w->rhs);
  for (size_t i = 0; i < w->size; i++) w->z[i] += w->step[i];
  for (int k = 0; k < SEARCHES; k++, part /= 2) {
    *left = evaluate(w, most);
    if (*left < before) return true;
    for (size_t i = 0; i < w->size; i++) w->z[i] -= part / 2 * w->step[i];
  }
  return false;
}

static bool iterate(const newton *w, double tolerance) {
  double most, left = evaluate(w, &most);
  for (int round = 0; round < ROUNDS; round++) {
    if (most <= tolerance) return true;
    if (!isfinite(left) || !hk_eliminate(w->A, w->rhs, w->size)) return false;
    if (!search(w, &left, &most)) return false;
  }
  return false;
}

/* Begins again from the optimum of the convex programs. */
static bool iterate_from_cones(const newton *w, double tolerance, double *room) {
  double *mu = room, *u_0 = room + w->count;
  for (size_t k = 0; k < w->count; k++) mu[k] = friction_of(w, k);
  for (size_t i = 0; i < w->size; i++) {
    u_0[i] = w->u_0[i];
    for (size_t j = 0; j < w->size; j++) u_0[i] -= w->D[i * w->size + j] * w->z_0[j];
  }
  memcpy(w->z, w->z_0, w->size * sizeof *w->z);
  hk_cone_program program = {w->size, w->count, w->first, mu, w->D, u_0, w->z, w->A, u_0 + w->size};
  return hk_cone_program_solve(&program) && iterate(w, tolerance);
}

/* ---- all ---- */

static void take_over(const newton *w, hk_contact_solver *solver, double *y) {
  for (size_t k = 0; k < w->count; k++) {
    size_t i = w->first[k];
    double slide[3] = {0, 0, 0};
    for (size_t a = 1; a < unknowns_of(w, k); a++) hk_add_scaled(slide, w->z[i + a], w->axis + 3 * (i + a));
    hk_body_impulse_set(w->bodies, solver, w->impact[k], w->speeds, w->z[i], slide, y);
  }
}

hk_status hk_body_newton(hk_body_impacts *s, hk_contact_solver *solver, const hk_body_newton_task *task, bool *solved) {
  newton w = {s, solver, task->speeds, 0, 0, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL};
  *solved = false;
  hk_status status = hk_reserve(s->host, &s->unknown, &s->unknown_room, 2 * solver->count, sizeof *s->unknown);
  if (status != HK_OK) return status;
  w.impact = s->unknown;
  w.first = s->unknown + solver->count;
  choose(&w);
  if (w.size == 0 || w.size > MOST) return HK_OK;
  status = hk_reserve(s->host, &s->matrix, &s->matrix_room, 2 * w.size * w.size + 17 * w.size + 2 * w.count,
                      sizeof *s->matrix);
  if (status != HK_OK) return status;
  w.D = s->matrix;
  w.A = w.D + w.size * w.size;
  w.z = w.A + w.size * w.size;
  w.z_0 = w.z + w.size, w.u_0 = w.z_0 + w.size, w.u = w.u_0 + w.size, w.rhs = w.u + w.size, w.step = w.rhs + w.size,
  w.axis = w.step + w.size;
  set_axes(&w, task->y);
  for (size_t k = 0; k < w.count; k++) find_columns(&w, k);
  *solved = iterate(&w, task->tolerance);
  if (!*solved && task->rest) *solved = iterate_from_cones(&w, task->tolerance, w.axis + 3 * w.size);
  if (*solved) take_over(&w, solver, task->y);
  return HK_OK;
}
