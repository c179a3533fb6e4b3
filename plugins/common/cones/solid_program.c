/* See solid_program.h. Newton's iteration, (1 + J^T P' J/R) dw = -(w - J^T z), with a search for the least f along dw,
 * finds the optimum from anywhere; f is nearly quadratic in pieces, so that it ends in the piece of the optimum. As its
 * matrix is not below 1, an error of w is not above what is left of w - J^T z, which is looked at before a matrix is
 * made. */
#include "plugins/common/cones/solid_program.h"
#include "plugins/common/cones/cone_program.h"
#include "plugins/common/space/reserve.h"

#include <math.h>
#include <string.h>

enum {
  ROUNDS = 60,
  PROGRAMS = 60,
  SEARCHES = 40,
  WINDOW = 5 /* differences of Anderson's */,
  STATE = 4 /* of an impact: what it slides, and R z */,
  STUCK = 3 /* programs in turn that bring nothing, before sweeps take over */
};

/* R over the mobility; of the largest u, what rounding leaves of a change; of a slope, what is none; of the tolerance,
 * what programs are to leave, as that of every step adds up; of what the last program left, to what the next one is
 * solved, and what the next one has to get below where the tolerance is met, or all lies still; of the least left so
 * far, what brings something; times that, where Anderson's differences mislead; of what the impulses given left, what
 * makes others a better guess. Chosen by heaps of 27 and 64 boxes: R ten times smaller, and windows of 0, 3 and 10,
 * took 1.2 to 1.7 times the time. */
static const double regular = 1e-4, rounding = 2e-15, level = 1e-3, finer = 1e-5, inexact = 0.3, slow = 0.5,
                    better = 0.9, astray = 3, much_better = 0.1;

hk_status hk_solid_program_open(hk_solid_program *p, const hk_host *host) {
  p->host = p->matrix.host = host;
  p->solvers = host->query(host, "solvers/1");
  if (!p->solvers) return host->fail(host, HK_FAILED, "the host has no service solvers/1: take a newer hooke");
  return p->solvers->open(p->solvers->self, host, NULL, 0, &p->linear);
}

hk_status hk_solid_program_reserve(hk_solid_program *p, size_t solids, size_t impacts) {
  size_t size = HK_SOLID_ROWS * solids;
  hk_status status = hk_reserve(p->host, &p->impact, &p->impact_room, impacts, sizeof *p->impact);
  if (status == HK_OK) status = hk_reserve(p->host, &p->w, &p->w_room, size, sizeof *p->w);
  if (status == HK_OK) status = hk_reserve(p->host, &p->rhs, &p->rhs_room, size, sizeof *p->rhs);
  return status == HK_OK ? hk_reserve(p->host, &p->dw, &p->dw_room, size, sizeof *p->dw) : status;
}

static size_t unknowns(const hk_solid_impact *k) { return k->mu > 0 ? 3 : 1; }

/* out = J w */
static void relative(const hk_solid_impact *k, const double *w, double out[3]) {
  for (size_t r = 0; r < 3; r++) out[r] = 0;
  for (int side = 0; side < 2; side++) {
    if (k->sides.solid[side] == UINT32_MAX) continue;
    const double *of = w + HK_SOLID_ROWS * (size_t)k->sides.solid[side];
    for (size_t r = 0; r < unknowns(k); r++)
      for (int c = 0; c < HK_SOLID_ROWS; c++) out[r] += k->sides.J[side][r][c] * of[c];
  }
}

/* w += factor J^T z */
static void push(const hk_solid_impact *k, double factor, const double z[3], double *w) {
  for (int side = 0; side < 2; side++) {
    if (k->sides.solid[side] == UINT32_MAX) continue;
    double *of = w + HK_SOLID_ROWS * (size_t)k->sides.solid[side];
    for (size_t r = 0; r < unknowns(k); r++)
      for (int c = 0; c < HK_SOLID_ROWS; c++) of[c] += factor * k->sides.J[side][r][c] * z[r];
  }
}

/* u - R centre at w, and P of it. */
static void find_place(const hk_solid_program *p, hk_solid_impact *k, double *J) {
  double R = regular * k->mobility;
  relative(k, p->w, k->u);
  for (size_t r = 0; r < unknowns(k); r++) k->u[r] += k->u_0[r] + (r == 0 ? k->slide : 0) - R * k->centre[r];
  hk_cone_project(k->u, unknowns(k), k->mu, k->P, J);
}

/* The right-hand side J^T z - w; returns by how much u is off at most. */
static double find_rest(hk_solid_program *p) {
  size_t size = HK_SOLID_ROWS * p->solids;
  double sum = 0, most = 0;
  for (size_t i = 0; i < size; i++) p->rhs[i] = -p->w[i];
  for (size_t e = 0; e < p->impacts; e++) {
    hk_solid_impact *k = &p->impact[e];
    find_place(p, k, NULL);
    push(k, 1 / (regular * k->mobility), k->P, p->rhs);
    most = fmax(most, k->mobility);
  }
  for (size_t i = 0; i < size; i++) sum += p->rhs[i] * p->rhs[i];
  return sqrt(most * sum);
}

static void set_matrix(hk_solid_program *p) {
  hk_solid_matrix_clear(&p->matrix);
  for (size_t e = 0; e < p->impacts; e++) {
    hk_solid_impact *k = &p->impact[e];
    double J[9];
    hk_cone_project(k->u, unknowns(k), k->mu, k->P, J);
    for (int c = 0; c < 9; c++) J[c] /= regular * k->mobility;
    if (k->P[0] != 0) hk_solid_matrix_add(&p->matrix, &k->sides, J);
  }
}

/* The derivative of f at w + t dw, along dw, and its own. */
static double slope(const hk_solid_program *p, double t, double *bend) {
  double sum = 0;
  *bend = 0;
  for (size_t i = 0; i < HK_SOLID_ROWS * p->solids; i++) {
    sum += p->dw[i] * (p->w[i] + t * p->dw[i]);
    *bend += p->dw[i] * p->dw[i];
  }
  for (size_t e = 0; e < p->impacts; e++) {
    const hk_solid_impact *k = &p->impact[e];
    double u[3], P[3], J[9], R = regular * k->mobility;
    for (size_t r = 0; r < unknowns(k); r++) u[r] = k->u[r] + t * k->du[r];
    hk_cone_project(u, unknowns(k), k->mu, P, J);
    for (size_t r = 0; r < unknowns(k); r++) {
      sum -= k->du[r] * P[r] / R;
      for (size_t c = 0; c < unknowns(k); c++) *bend += k->du[r] * J[3 * r + c] * k->du[c] / R;
    }
  }
  return sum;
}

/* How far to go along dw: f is least there, or nearly. Newton's iteration between bounds, from the whole step on. */
static double length_of_step(const hk_solid_program *p) {
  double low = 0, high = INFINITY, t = 1, bend, start = fabs(slope(p, 0, &bend));
  for (int k = 0; k < SEARCHES; k++) {
    double now = slope(p, t, &bend);
    if (!(fabs(now) > level * start)) return t;
    if (now > 0)
      high = t;
    else
      low = t;
    t -= now / bend;
    if (!(t > low && t < high)) t = isfinite(high) ? (low + high) / 2 : 2 * low;
  }
  return t;
}

static void find_changes(hk_solid_program *p) {
  for (size_t e = 0; e < p->impacts; e++) relative(&p->impact[e], p->dw, p->impact[e].du);
}

/* What is left of u where it is known to the tolerance, or to rounding. */
static double finest_rest(const hk_solid_program *p, double tolerance) {
  double most = 0;
  for (size_t e = 0; e < p->impacts; e++)
    for (size_t r = 0; r < unknowns(&p->impact[e]); r++) most = fmax(most, fabs(p->impact[e].u_0[r]));
  return fmax(tolerance, rounding * most);
}

static hk_status solve_program(hk_solid_program *p, double tolerance, bool *solved) {
  double finest = finest_rest(p, tolerance);
  *solved = false;
  for (int round = 0; round < ROUNDS; round++) {
    double rest = find_rest(p);
    *solved = rest <= finest;
    if (*solved || !isfinite(rest)) return HK_OK;
    set_matrix(p);
    hk_status status = p->solvers->factorize(p->linear, &p->matrix.A);
    if (status == HK_OK) status = p->solvers->solve(p->linear, p->rhs, p->dw, NULL);
    if (status != HK_OK) return status;
    find_changes(p);
    double t = length_of_step(p);
    for (size_t i = 0; i < HK_SOLID_ROWS * p->solids; i++) p->w[i] += t * p->dw[i];
  }
  return HK_OK;
}

/* What Coulomb's law wants of u beyond mu |u_t| of the program. */
static double slide_on(hk_solid_program *p) {
  double most = 0;
  for (size_t e = 0; e < p->impacts; e++) {
    hk_solid_impact *k = &p->impact[e];
    double along[3];
    relative(k, p->w, along);
    double u = along[1] + k->u_0[1], v = along[2] + k->u_0[2], next = k->mu > 0 ? k->mu * sqrt(u * u + v * v) : 0;
    most = fmax(most, fabs(next - k->slide));
    k->slide = next;
  }
  return most;
}

/* What the law leaves of u beside z = P(R centre - u)/R: R times the change from the centre, which becomes z. */
static double go_on(hk_solid_program *p) {
  double most = slide_on(p);
  for (size_t e = 0; e < p->impacts; e++) {
    hk_solid_impact *k = &p->impact[e];
    double R = regular * k->mobility;
    for (size_t r = 0; r < unknowns(k); r++) {
      most = fmax(most, fabs(k->P[r] - R * k->centre[r]));
      k->z[r] = k->centre[r] = k->P[r] / R;
    }
  }
  return most;
}

/* The same of the impulses that it begins with, which stay what they are. */
static double left_at_first(hk_solid_program *p) {
  double most = slide_on(p);
  for (size_t e = 0; e < p->impacts; e++) {
    hk_solid_impact *k = &p->impact[e];
    find_place(p, k, NULL);
    for (size_t r = 0; r < unknowns(k); r++) most = fmax(most, fabs(k->P[r] - regular * k->mobility * k->centre[r]));
  }
  return most;
}

/* What the impulses that it begins with do is in w, and no longer in u_0. */
static void begin(hk_solid_program *p) {
  memset(p->w, 0, HK_SOLID_ROWS * p->solids * sizeof *p->w);
  for (size_t e = 0; e < p->impacts; e++) push(&p->impact[e], 1, p->impact[e].z, p->w);
  for (size_t e = 0; e < p->impacts; e++) {
    hk_solid_impact *k = &p->impact[e];
    relative(k, p->w, k->u);
    for (size_t r = 0; r < 3; r++) {
      if (r >= unknowns(k)) k->z[r] = k->u[r] = 0;
      k->u_0[r] -= k->u[r];
      k->centre[r] = k->z[r];
    }
    k->slide = 0;
  }
}

/* ---- one program after the other ---- */

static void write_state(const hk_solid_program *p, double *x) {
  for (size_t e = 0; e < p->impacts; e++) {
    const hk_solid_impact *k = &p->impact[e];
    x[STATE * e] = k->slide;
    for (size_t r = 0; r < 3; r++) x[STATE * e + 1 + r] = regular * k->mobility * k->centre[r];
  }
}

static void read_state(hk_solid_program *p, const double *x) {
  for (size_t e = 0; e < p->impacts; e++) {
    hk_solid_impact *k = &p->impact[e];
    k->slide = fmax(0, x[STATE * e]);
    for (size_t r = 0; r < 3; r++) k->centre[r] = x[STATE * e + 1 + r] / (regular * k->mobility);
  }
}

/* What the next program begins with, from what the last one began with, the first of `state`, and came to. */
static void accelerate(hk_solid_program *p) {
  size_t size = STATE * p->impacts;
  double *x = p->state, *g = x + size, *f = g + size;
  write_state(p, g);
  for (size_t i = 0; i < size; i++) f[i] = g[i] - x[i];
  hk_anderson_next(&p->anderson, f, g, f, x);
  read_state(p, x);
}

static hk_status make_room(hk_solid_program *p) {
  hk_status status = hk_solid_matrix_shape(&p->matrix, p->solids, p->impact, p->impacts, sizeof *p->impact);
  if (status == HK_OK)
    status = hk_reserve(p->host, &p->state, &p->state_room, 3 * STATE * p->impacts, sizeof *p->state);
  return status == HK_OK ? hk_anderson_reserve(&p->anderson, p->host, STATE * p->impacts, WINDOW) : status;
}

static hk_status solve_programs(hk_solid_program *p, double tolerance, double *left, bool *solved) {
  double wanted = finer * tolerance, least = INFINITY;
  hk_status status = HK_OK;
  for (int k = 0, stuck = 0; k < PROGRAMS && stuck < STUCK; k++) {
    double before = *left;
    if (before <= wanted) break;
    write_state(p, p->state);
    status = solve_program(p, p->still || before <= tolerance ? wanted : fmax(wanted, inexact * before), solved);
    if (status != HK_OK || !*solved) return status;
    *left = go_on(p);
    if ((p->still || *left <= tolerance) && *left > slow * before) break;
    stuck = *left < better * least ? 0 : stuck + 1;
    if (*left > astray * least) hk_anderson_clear(&p->anderson);
    least = fmin(least, *left);
    if (!p->still && *left > tolerance) accelerate(p);
  }
  *solved = *left <= tolerance;
  return status;
}

hk_status hk_solid_program_solve(hk_solid_program *p, double tolerance, bool *solved) {
  begin(p);
  double given = left_at_first(p), left = given;
  p->closer = false;
  *solved = given <= finer * tolerance;
  if (*solved) return HK_OK;
  hk_status status = make_room(p);
  for (size_t e = 0; e < p->impacts && p->still; e++) p->impact[e].slide = 0;
  if (status == HK_OK) status = solve_programs(p, tolerance, &left, solved);
  p->closer = left <= much_better * given;
  return status;
}
