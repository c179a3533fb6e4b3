/* See solid_newton.h. Coordinates of a body are the velocity of its centre of mass times the root of its mass, and L^-1
 * times its spin, where the inverse of its moments of inertia is L L^T. That a body is free is seen from its response:
 * what joins it to something takes from the trace of the matrix G of an impact. */
#include "plugins/common/contact/bodies/solid_newton.h"
#include "plugins/common/contact/bodies/body_contact_law.h"
#include "plugins/common/contact/bodies/impact_response.h"
#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

/* Of a trace, what is none. */
static const double same = 1e-6;

typedef struct hk_solid_frame {
  uint32_t carrier;     /* the first of its body */
  double centre[3];     /* m */
  double root, turn[9]; /* 1/sqrt(mass); L^T, by rows */
} frame;

typedef struct builder {
  hk_body_impacts *s;
  const hk_contact_solver *solver;
  const hk_body_newton_task *task;
  const double *at;
  hk_solid_program *p;
} builder;

/* ---- bodies ---- */

/* The rows of L^T of a symmetric matrix A = L L^T; false: it is not positive. */
static bool factor_of(const double A[9], double turn[9]) {
  double L[9] = {0};
  for (int j = 0; j < 3; j++)
    for (int i = j; i < 3; i++) {
      double sum = A[3 * i + j];
      for (int k = 0; k < j; k++) sum -= L[3 * i + k] * L[3 * j + k];
      if (i == j && !(sum > 0)) return false;
      L[3 * i + j] = i == j ? sqrt(sum) : sum / L[3 * j + j];
    }
  for (int e = 0; e < 9; e++) turn[e] = L[3 * (e % 3) + e / 3];
  return true;
}

static void invert(const double A[9], double out[9]) {
  double across[3][3];
  for (int r = 0; r < 3; r++) hk_cross(across[r], A + 3 * ((r + 1) % 3), A + 3 * ((r + 2) % 3));
  double det = hk_dot(A, across[0]);
  for (int e = 0; e < 9; e++) out[e] = across[e % 3][e / 3] / det;
}

static bool frame_of(const builder *b, const uint32_t *carrier, frame *out) {
  const hk_model *m = b->s->model;
  double mass = 0, I[9] = {0}, inverse[9];
  *out = (frame){.carrier = carrier[0]};
  for (int c = 0; c < 4; c++) {
    if (!(m->inverse_mass[carrier[c]] > 0)) return false;
    mass += m->mass[carrier[c]];
    hk_add_scaled(out->centre, m->mass[carrier[c]], b->at + 3 * (size_t)carrier[c]);
  }
  for (int c = 0; c < 3; c++) out->centre[c] /= mass;
  for (int c = 0; c < 4; c++) {
    double r[3];
    hk_subtract(r, b->at + 3 * (size_t)carrier[c], out->centre);
    for (int e = 0; e < 9; e++) I[e] += m->mass[carrier[c]] * ((e % 4 == 0 ? hk_dot(r, r) : 0) - r[e / 3] * r[e % 3]);
  }
  out->root = 1 / sqrt(mass);
  invert(I, inverse);
  return factor_of(inverse, out->turn);
}

/* The number of the body, which is entered when it is met first; UINT32_MAX: it is no free one. */
static uint32_t solid_of(builder *b, const uint32_t *carrier) {
  hk_body_impacts *s = b->s;
  uint32_t known = s->place[carrier[0]];
  if (known) return known - 1;
  if (!frame_of(b, carrier, &s->frame[b->p->solids])) return UINT32_MAX;
  s->place[carrier[0]] = (uint32_t)++b->p->solids;
  return s->place[carrier[0]] - 1;
}

/* ---- impacts ---- */

static bool stands(const hk_body_impacts *s, const hk_impact *k, int first, int last) {
  for (int i = first; i < last; i++)
    if (k->frame.w[i] != 0 && hk_model_moves(s->model, k->pair.vertex[i])) return false;
  return true;
}

/* The rows of a side; false: it is of nothing rigid. */
static bool set_side(builder *b, size_t e, int side, const double axis[3][3], hk_solid_sides *out) {
  const hk_body_impacts *s = b->s;
  const hk_impact *k = &b->solver->impact[e];
  const hk_body_arms *arms = hk_body_arms_of(s, e);
  int split = hk_pair_split(k->pair.kind), first = side == 0 ? 0 : split, last = side == 0 ? split : 4;
  const uint32_t *carrier = hk_body_arm_carriers(s->model, k->pair.vertex + first, k->frame.w + first, last - first);
  double sum = 0, q[3] = {0, 0, 0}, d[3], turned[3];
  out->solid[side] = UINT32_MAX;
  if (!carrier) return stands(s, k, first, last);
  uint32_t solid = solid_of(b, carrier);
  if (solid == UINT32_MAX) return false;
  const frame *f = &s->frame[solid];
  for (int i = first; i < last; i++) {
    hk_subtract(d, b->at + 3 * (size_t)k->pair.vertex[i], f->centre);
    hk_add_scaled(q, k->frame.w[i], d);
    sum += k->frame.w[i];
  }
  if (arms && arms->side[side].carrier) hk_add_scaled(q, -arms->side[side].radius, k->frame.n);
  out->solid[side] = solid;
  for (int a = 0; a < 3; a++) {
    hk_cross(turned, q, axis[a]);
    for (int c = 0; c < 3; c++) {
      out->J[side][a][c] = sum * axis[a][c] * f->root;
      out->J[side][a][3 + c] = hk_dot(f->turn + 3 * c, turned);
    }
  }
  return true;
}

/* Whether nothing else holds its bodies. */
static bool is_free(const hk_solid_sides *s, const double G[9]) {
  double sum = 0, trace = G[0] + G[4] + G[8];
  for (int side = 0; side < 2; side++)
    for (int a = 0; a < 3 && s->solid[side] != UINT32_MAX; a++)
      for (int c = 0; c < HK_SOLID_ROWS; c++) sum += s->J[side][a][c] * s->J[side][a][c];
  return fabs(sum - trace) <= same * sum;
}

static void axes_of(const double n[3], double axis[3][3]) {
  hk_copy(axis[0], n);
  hk_vectors_across(n, axis[1], axis[2]);
}

static bool set_impact(builder *b, size_t e, hk_solid_impact *out) {
  const hk_impact *k = &b->solver->impact[e];
  const hk_impact_level *level = b->task->speeds ? &k->speed : &k->place;
  double axis[3][3], r[3];
  *out = (hk_solid_impact){.mu = hk_body_friction(b->s, b->solver, e), .mobility = k->mobility};
  axes_of(k->frame.n, axis);
  for (int side = 0; side < 2; side++)
    if (!set_side(b, e, side, (const double(*)[3])axis, &out->sides)) return false;
  hk_body_relative(b->s, b->solver, e, level, b->task->y, r);
  for (int a = 0; a < 3; a++) {
    out->u_0[a] = hk_dot(r, axis[a]) - (a == 0 ? level->target : 0);
    out->z[a] = a == 0 ? level->push : hk_dot(level->slide, axis[a]);
  }
  return is_free(&out->sides, b->s->response[e].G);
}

static bool takes_part(const hk_body_impacts *s, const hk_contact_solver *solver, size_t e) {
  return s->takes_part[e] && s->response[e].known && solver->impact[e].mobility > 0;
}

/* Sets the impacts and bodies of the program; false: some are of other things. */
static bool set_program(builder *b) {
  bool fine = true;
  b->p->solids = b->p->impacts = 0;
  for (size_t e = 0; e < b->solver->count && fine; e++)
    if (takes_part(b->s, b->solver, e)) fine = set_impact(b, e, &b->p->impact[b->p->impacts++]);
  for (size_t k = 0; k < b->p->solids; k++) b->s->place[b->s->frame[k].carrier] = 0;
  return fine;
}

/* Where they are solved, all of them are until something else moves their bodies; otherwise they are where Newton's
 * iteration and sweeps begin. */
static void take_over(const builder *b, hk_contact_solver *solver, bool solved) {
  const hk_solid_impact *from = b->p->impact;
  uint64_t now = ++solver->now;
  for (size_t e = 0; e < solver->count; e++) {
    double axis[3][3], slide[3] = {0, 0, 0};
    if (!takes_part(b->s, solver, e)) continue;
    axes_of(solver->impact[e].frame.n, axis);
    for (int a = 1; a < 3; a++) hk_add_scaled(slide, from->z[a], axis[a]);
    hk_body_impulse_set(b->s, solver, e, b->task->speeds, from->z[0], slide, b->task->y);
    (b->task->speeds ? &solver->impact[e].speed : &solver->impact[e].place)->solved = solved ? now : 0;
    from++;
  }
}

hk_status hk_solid_newton(hk_body_impacts *s, hk_contact_solver *solver, const hk_body_newton_task *task,
                          const double *at, bool *solved) {
  builder b = {s, solver, task, at, &s->program};
  size_t count = 0;
  *solved = false;
  for (size_t e = 0; e < solver->count; e++) count += takes_part(s, solver, e);
  if (count < HK_MANY_IMPACTS || s->moments) return HK_OK;
  hk_status status = hk_solid_program_reserve(&s->program, 2 * count, count);
  if (status == HK_OK) status = hk_reserve(s->host, &s->frame, &s->frame_room, 2 * count, sizeof *s->frame);
  if (status != HK_OK || !set_program(&b)) return status;
  s->program.still = task->still;
  status = hk_solid_program_solve(&s->program, task->tolerance, solved);
  if (status == HK_OK && (*solved || s->program.closer)) take_over(&b, solver, *solved);
  return status;
}
