/* See body_impacts.h. */
#include "plugins/common/contact/bodies/body_impacts.h"

#include "plugins/common/contact/bodies/body_energy.h"
#include "plugins/common/contact/bodies/body_newton.h"
#include "plugins/common/contact/bodies/impact_response.h"
#include "plugins/common/contact/bodies/solid_newton.h"
#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

enum {
  ALTERNATIONS = 60 /* of sweeps and `settle` */,
  BURST = 10 /* sweeps between Newton's iterations */,
  NEWTONS = 3 /* that may fail */
};

/* Of the tolerance: what is left of places where moments hold what friction would roll, as every step adds to it. */
static const double finer = 1e-3;

/* Of the distance at which an impact's features touch: what it moves in a step at most, as of stacks at rest. */
static const double resting = 0.01;

/* Of the tolerance. */
static const double polished = 1e-3;

hk_status hk_body_impacts_open(hk_body_impacts *s, const hk_host *host) {
  s->host = host;
  s->bodies = host->query(host, "bodies/1");
  if (!s->bodies) return host->fail(host, HK_FAILED, "the host has no service bodies/1: take a newer hooke");
  return hk_solid_program_open(&s->program, host);
}

void hk_body_impacts_topology(hk_body_impacts *s) {
  s->host->release(s->host, s->column);
  s->host->release(s->host, s->place);
  s->host->release(s->host, s->before);
  s->host->release(s->host, s->start);
  s->column = s->before = s->start = NULL;
  s->place = NULL;
}

hk_status hk_body_impacts_begin(hk_body_impacts *s, const hk_view *view, bool needed) {
  hk_status status = s->bodies->count(s->bodies->self, &s->count);
  s->model = view->model;
  if (status != HK_OK || s->place || (s->count == 0 && !needed)) return status;
  s->column = s->host->allocate(s->host, (3 * view->n + 1) * sizeof *s->column);
  s->place = s->host->allocate(s->host, (view->n + 1) * sizeof *s->place);
  s->before = s->host->allocate(s->host, (6 * view->n + 1) * sizeof *s->before);
  s->start = s->host->allocate(s->host, (3 * view->n + 1) * sizeof *s->start);
  s->n = view->n;
  return s->column && s->place && s->before && s->start
             ? HK_OK
             : s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
}

/* ---- one impact ---- */

typedef struct sweeping {
  hk_body_impacts *bodies;
  hk_contact_solver *solver;
  const hk_step_move *move;
  double *y;
  double tolerance;
  bool speeds; /* which level of the impacts */
  bool moved;  /* something was moved by more than the tolerance */
  bool exact;  /* what was solved together last is solved to less than the tolerance */
  int failed;  /* Newton's iterations at this level */
} sweeping;

static hk_impact_level *level_of(const sweeping *w, hk_impact *k) { return w->speeds ? &k->speed : &k->place; }

static bool is_awake(const sweeping *w, size_t e, uint64_t solved) {
  const hk_body_response *r = &w->bodies->response[e];
  const hk_impact *k = &w->solver->impact[e];
  bool awake = solved == 0;
  for (int i = 0; i < 4; i++) awake |= w->solver->moved[k->pair.vertex[i]] > solved;
  for (size_t j = r->first; !awake && r->known && j < r->first + r->count; j++)
    awake = w->solver->moved[w->bodies->particle[j]] > solved;
  return awake;
}

static void apply(const sweeping *w, const hk_body_response *r, const double impulse[3]) {
  const hk_body_impacts *s = w->bodies;
  for (size_t j = r->first; j < r->first + r->count; j++)
    for (size_t c = 0; c < 3; c++) w->y[3 * (size_t)s->particle[j] + c] += hk_dot(s->block[j] + 3 * c, impulse);
}

static void note(const sweeping *w, const hk_body_response *r, uint64_t *when) {
  for (size_t j = r->first; j < r->first + r->count; j++) when[w->bodies->particle[j]] = w->solver->now;
}

/* Returns the size of the change of the body's place or speed, m or m/s. */
static double turn(const sweeping *w, size_t e, const hk_body_response *r, double push) {
  const hk_body_impacts *s = w->bodies;
  hk_body_moments *m = hk_body_moments_of(s, e);
  double rates[3], change[3], most = 0;
  hk_body_moments_rates(m, w->speeds, w->y, w->speeds ? NULL : s->start, rates);
  hk_body_moments_solve(m, w->speeds, rates, push, change);
  for (size_t j = r->first; j < r->first + r->count; j++) {
    double moved[3];
    for (int c = 0; c < 3; c++) moved[c] = hk_dot(s->turn[j] + 3 * c, change);
    hk_add_scaled(w->y + 3 * (size_t)s->particle[j], 1, moved);
    most = fmax(most, hk_length(moved));
  }
  return most;
}

static hk_status relax(sweeping *w, size_t e) {
  hk_impact *k = &w->solver->impact[e];
  hk_impact_level *level = level_of(w, k);
  const hk_body_response *response;
  double r[3], change[3] = {0, 0, 0};
  hk_body_relative(w->bodies, w->solver, e, level, w->y, r);
  if (level->push == 0 && !(level->target > hk_dot(r, k->frame.n))) return HK_OK;
  hk_status status = hk_body_response_find(w->bodies, w->solver, w->move, e, &response);
  if (status != HK_OK) return status;
  if (!response->gives_way) return HK_OK;
  double mu = hk_body_friction(w->bodies, w->solver, e);
  hk_body_contact_solve(k, level, response->G, &response->tangent, mu, r, change);
  double size = hk_length(change), turned = 0;
  if (size > 0) apply(w, response, change);
  if (hk_body_moments_of(w->bodies, e)) turned = turn(w, e, response, level->push);
  if (!(size > 0 || turned > 0)) return HK_OK;
  note(w, response, w->solver->touched);
  if (turned > w->tolerance) level->solved = 0; /* friction has to answer */
  if (!(fmax(turned, size * (response->G[0] + response->G[4] + response->G[8])) > w->tolerance)) return HK_OK;
  note(w, response, w->solver->moved);
  w->moved = true;
  return HK_OK;
}

/* The impulses that the impacts are given with (impulses/warm_start.h). */
static hk_status apply_given(const sweeping *w) {
  const hk_body_response *response;
  for (size_t e = 0; e < w->solver->count; e++) {
    hk_impact *k = &w->solver->impact[e];
    hk_impact_level *level = level_of(w, k);
    double given[3];
    if (!(level->push > 0)) continue;
    hk_status status = hk_body_response_find(w->bodies, w->solver, w->move, e, &response);
    if (status != HK_OK) return status;
    if (!w->bodies->takes_part[e] || !response->gives_way)
      level->push = level->slide[0] = level->slide[1] = level->slide[2] = 0;
    for (int c = 0; c < 3; c++) given[c] = level->push * k->frame.n[c] + level->slide[c];
    apply(w, response, given);
    ++w->solver->now;
    note(w, response, w->solver->touched);
    note(w, response, w->solver->moved);
  }
  return HK_OK;
}

/* ---- all of them ---- */

static hk_status sweep(sweeping *w) {
  hk_status status = HK_OK;
  w->moved = false;
  for (size_t e = 0; e < w->solver->count && status == HK_OK; e++) {
    hk_impact_level *level = level_of(w, &w->solver->impact[e]);
    if (!w->bodies->takes_part[e] || !is_awake(w, e, level->solved)) continue;
    level->solved = ++w->solver->now;
    status = relax(w, e);
  }
  return status;
}

/* Whether all impacts are of what lies still, or nearly so. */
static bool all_rest(const sweeping *w) {
  for (size_t e = 0; e < w->bodies->contacts; e++)
    if (w->solver->impact[e].motion * w->move->h > resting * w->solver->impact[e].pair.offset) return false;
  return true;
}

static hk_status solve_together(sweeping *w, const hk_body_newton_task *task, bool *solved) {
  const double *at = w->speeds ? w->move->x : w->bodies->start;
  hk_status status = hk_solid_newton(w->bodies, w->solver, task, at, solved);
  w->exact = *solved;
  return status == HK_OK && !*solved ? hk_body_newton(w->bodies, w->solver, task, solved) : status;
}

static hk_status newton(sweeping *w, bool *solved) {
  bool still = all_rest(w);
  const hk_body_newton_task task = {w->speeds, still, w->tolerance / 2, w->y, still};
  return solve_together(w, &task, solved);
}

/* What sweeps leave would add up to a creep of what lies still: Newton's iteration leaves less, where it gets there. */
static hk_status polish(sweeping *w) {
  const hk_body_newton_task task = {w->speeds, false, polished * w->tolerance, w->y, true};
  bool solved;
  return !w->exact && all_rest(w) && !w->bodies->moments ? solve_together(w, &task, &solved) : HK_OK;
}

static hk_status sweep_some(sweeping *w, size_t *sweeps, size_t until) {
  hk_status status = HK_OK;
  w->moved = true;
  for (; status == HK_OK && w->moved && *sweeps < until; ++*sweeps) status = sweep(w);
  return status;
}

/* What lies still pushes with nearly the impulses that it is given, so that many impacts are best solved together
 * before sweeps look for others. */
static hk_status begin_together(sweeping *w) {
  const hk_body_newton_task task = {w->speeds, true, w->tolerance / 2, w->y, true};
  const double *at = w->speeds ? w->move->x : w->bodies->start;
  return all_rest(w) ? hk_solid_newton(w->bodies, w->solver, &task, at, &w->exact) : HK_OK;
}

/* Sweeps find out which impacts push; where they then converge slowly, as along a chain that lies on something,
 * Newton's iteration has the last word, and a further sweep looks whether others are met now. */
static hk_status sweep_all(sweeping *w, size_t *sweeps) {
  *sweeps = 0;
  w->exact = false;
  hk_status status = begin_together(w);
  do {
    if (status == HK_OK)
      status = sweep_some(w, sweeps, *sweeps + BURST < w->solver->most ? *sweeps + BURST : w->solver->most);
    bool solved = false;
    if (status == HK_OK && !w->moved) return polish(w);
    if (status != HK_OK) return status;
    if (w->failed < NEWTONS) status = newton(w, &solved);
    w->failed += !solved;
    for (size_t e = 0; solved && !w->exact && e < w->solver->count; e++) level_of(w, &w->solver->impact[e])->solved = 0;
  } while (status == HK_OK && *sweeps < w->solver->most);
  return status;
}

/* Whether an impact is short of its target by more than the tolerance, after `settle` has moved everything. */
static bool some_fall_short(const sweeping *w) {
  for (size_t e = 0; e < w->solver->count; e++) {
    hk_impact *k = &w->solver->impact[e];
    const hk_impact_level *level = level_of(w, k);
    double r[3];
    if (!w->bodies->takes_part[e] || !(k->mobility > 0)) continue;
    hk_body_relative(w->bodies, w->solver, e, level, w->y, r);
    if (level->target - hk_dot(r, k->frame.n) > w->tolerance) return true;
  }
  return false;
}

/* ---- one-sided equations as impacts ---- */

/* Appends them at the present place, of which the solver's impacts beyond the contacts are then; their sums of impulses
 * are kept. Of speeds those take part that are closed to the tolerance of `settle`. */
static void append(hk_body_impacts *s, hk_contact_solver *solver, bool speeds, double closed) {
  const hk_one_sided *list = NULL;
  size_t count = s->count ? s->bodies->one_sided(s->bodies->self, &list) : 0;
  bool anew = solver->count != s->contacts + count;
  solver->count = s->contacts + count;
  for (size_t e = 0; e < count; e++) {
    hk_impact *k = &solver->impact[s->contacts + e];
    const hk_one_sided *q = &list[e];
    double place = anew || speeds ? 0 : k->place.push, speed = anew || !speeds ? 0 : k->speed.push;
    const uint32_t *i = q->point.particle;
    *k = (hk_impact){.pair = {{i[0], i[1], i[0], i[0]}, HK_EDGE_EDGE, 0, q->gap}};
    k->frame.w[0] = q->point.weight[0], k->frame.w[1] = q->point.weight[1];
    hk_copy(k->frame.n, q->n);
    k->place.push = place, k->speed.push = speed;
    k->speed.target = -q->speed;
    k->place.target = -q->gap; /* and the point's present place, see `aim` */
    s->takes_part[s->contacts + e] = !speeds || q->gap <= closed;
  }
}

/* The targets of one-sided equations, from gaps to places at x. */
static void aim(const hk_body_impacts *s, const hk_contact_solver *solver, const double *x) {
  for (size_t e = s->contacts; e < solver->count; e++) {
    hk_impact *k = &solver->impact[e];
    const hk_impact_level origin = {.target = 0};
    double r[3];
    hk_body_relative(s, solver, e, &origin, x, r);
    k->place.target += hk_dot(r, k->frame.n);
  }
}

static hk_status linearise(hk_body_impacts *s, const hk_step_move *m) {
  hk_body_response_forget(s);
  return s->count ? s->bodies->linearise(s->bodies->self, s->t, m->x, m->v) : HK_OK;
}

/* The impacts of positions, or of speeds, at the place of the last linearisation, x. */
static void begin_level(hk_body_impacts *s, hk_contact_solver *solver, const double *x, bool speeds) {
  append(s, solver, speeds, solver->tolerance);
  aim(s, solver, x);
  for (size_t e = 0; e < s->contacts; e++) {
    if (hk_body_arms_of(s, e)) hk_body_arms_set(&s->arms[e], x, solver->impact[e].frame.n);
    if (hk_body_moments_of(s, e)) hk_body_moments_set(&s->moments[e], x, solver->impact[e].frame.n);
  }
  for (size_t e = 0; e < s->contacts; e++)
    s->takes_part[e] = !speeds || solver->impact[e].place.push > 0 || (s->touches && s->touches[e]);
  for (size_t e = 0; e < solver->count; e++) s->response[e].known = false;
}

static hk_status settle(const hk_body_impacts *s, const hk_step_move *m) {
  return s->count ? s->bodies->settle(s->bodies->self, s->t, m->x, m->v) : HK_OK;
}

/* Equations that hold already leave everything as it is, so that a second round is rare. */
static hk_status solve_speeds(hk_body_impacts *s, sweeping *w, hk_step_move *m) {
  hk_status status = HK_OK;
  size_t sweeps = 0;
  for (int round = 0; round < ALTERNATIONS; round++) {
    status = linearise(s, m);
    if (status != HK_OK) return status;
    begin_level(s, w->solver, m->x, true);
    if (round == 0) status = apply_given(w);
    if (status == HK_OK) status = sweep_all(w, &sweeps);
    if (status == HK_OK) status = settle(s, m);
    if (status != HK_OK || !some_fall_short(w)) break;
    for (size_t e = 0; e < w->solver->count; e++) w->solver->impact[e].speed.solved = 0;
  }
  return status;
}

static hk_status solve_energy(hk_body_impacts *s, sweeping *w, hk_step_move *m) {
  hk_status status = solve_speeds(s, w, m);
  if (status != HK_OK || !hk_body_energy_grew(s, w->solver, m)) return status;
  hk_body_energy_restart(s, w->solver, m);
  status = solve_speeds(s, w, m);
  if (status == HK_OK) hk_body_energy_blend(s, m);
  return status;
}

/* Impulses on places turn bodies. Velocities that stayed what they are in space would then be another spin, by half of
 * the angle times the spin, an error of order 1, as every step does it: they are turned along, once `settle` has given
 * bodies their lengths back, which a turn by a small angle stretches by half of its square. */
static void turn_speeds(const hk_body_impacts *s, const hk_step_move *m) {
  for (size_t e = 0; e < s->contacts && s->arms; e++)
    for (int side = 0; side < 2; side++) {
      const uint32_t *carrier = s->arms[e].side[side].carrier;
      if (carrier && s->row[e].place.push > 0) hk_body_arms_carry(carrier, s->start, s->before, m->x, m->v);
    }
}

/* What moves is not pushed as it was in the last step, and few impacts need no guess. Of riders of bodies the mobility
 * is not known yet. */
static void forget_given(const sweeping *w) {
  if (w->bodies->contacts >= HK_MANY_IMPACTS && all_rest(w)) return;
  for (size_t e = 0; e < w->bodies->contacts; e++) {
    hk_impact *k = &w->solver->impact[e];
    for (int level = 0; level < 2 && !(k->mobility > 0); level++) {
      hk_impact_level *of = level ? &k->speed : &k->place;
      of->push = of->slide[0] = of->slide[1] = of->slide[2] = 0;
    }
  }
}

/* Room for the contacts and the one-sided equations, whose number is that of the topology. */
static hk_status make_room(hk_body_impacts *s, const hk_contact_solver *given) {
  const hk_one_sided *list;
  size_t most = given->count + (s->count ? s->bodies->one_sided(s->bodies->self, &list) : 0);
  hk_status status = hk_reserve(s->host, &s->response, &s->impacts, most, sizeof *s->response);
  if (status == HK_OK) status = hk_reserve(s->host, &s->row, &s->rows_room, most, sizeof *s->row);
  if (status == HK_OK) status = hk_reserve(s->host, &s->takes_part, &s->taking_room, most, sizeof *s->takes_part);
  if (status == HK_OK && given->count) memcpy(s->row, given->impact, given->count * sizeof *s->row);
  s->contacts = given->count;
  return status;
}

hk_status hk_body_gauss_seidel(hk_body_impacts *s, hk_contact_solver *given, hk_step_move *m,
                               hk_gauss_seidel_result *done) {
  hk_contact_solver solver = *given;
  sweeping w = {s, &solver, m, m->x, solver.tolerance, false, false, false, 0};
  *done = (hk_gauss_seidel_result){0};
  hk_status status = linearise(s, m);
  if (status == HK_OK) status = make_room(s, given);
  if (status != HK_OK) return status;
  solver.impact = s->row;
  if (s->moments) w.tolerance *= finer;
  begin_level(s, &solver, m->x, false);
  memcpy(s->start, m->x, 3 * s->n * sizeof *m->x);
  memcpy(s->before, m->v, 3 * s->n * sizeof *m->v);
  forget_given(&w);
  status = apply_given(&w);
  if (status == HK_OK) status = sweep_all(&w, &done->sweeps);
  if (status == HK_OK) status = settle(s, m);
  if (status == HK_OK) turn_speeds(s, m);
  w.speeds = true, w.failed = 0, w.y = m->v, w.tolerance = s->slowest > 0 ? s->slowest : solver.tolerance / m->h;
  if (status == HK_OK) status = solve_energy(s, &w, m);
  given->now = solver.now;
  if (status == HK_OK && given->count) memcpy(given->impact, s->row, given->count * sizeof *s->row);
  for (size_t e = 0; e < given->count; e++) {
    done->pushing += given->impact[e].place.push > 0;
    done->impulse += given->impact[e].speed.push;
  }
  return status;
}
