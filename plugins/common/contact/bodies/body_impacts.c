/* See body_impacts.h. */
#include "plugins/common/contact/bodies/body_impacts.h"

#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

enum { ALTERNATIONS = 60 /* of sweeps and `settle` */, BURST = 40 /* sweeps between Newton's iterations */ };

/* 1/kg, relative to sum w^2/m: less is a point that bars and pins hold. */
static const double held = 1e-12;

hk_status hk_body_impacts_open(hk_body_impacts *s, const hk_host *host) {
  s->host = host;
  s->bodies = host->query(host, "bodies/1");
  return s->bodies ? HK_OK : host->fail(host, HK_FAILED, "the host has no service bodies/1: take a newer hooke");
}

hk_status hk_body_impacts_topology(hk_body_impacts *s, const hk_view *view) {
  s->host->release(s->host, s->column);
  s->host->release(s->host, s->place);
  s->column = s->host->allocate(s->host, (3 * view->n + 1) * sizeof *s->column);
  s->place = s->host->allocate(s->host, (view->n + 1) * sizeof *s->place);
  return s->column && s->place ? HK_OK : s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
}

hk_status hk_body_impacts_count(hk_body_impacts *s) { return s->bodies->count(s->bodies->self, &s->count); }

/* ---- one impact ---- */

typedef struct sweeping {
  hk_body_impacts *bodies;
  hk_contact_solver *solver;
  const hk_step_move *move;
  double *y;
  double tolerance;
  bool speeds; /* which level of the impacts */
  bool moved;  /* something was moved by more than the tolerance */
} sweeping;

static hk_impact_level *level_of(const sweeping *w, hk_impact *k) { return w->speeds ? &k->speed : &k->place; }

static void relative(double out[3], const hk_impact *k, const hk_impact_level *level, const double *y) {
  for (int c = 0; c < 3; c++) out[c] = -level->origin[c];
  for (int i = 0; i < 4; i++) hk_add_scaled(out, k->frame.w[i], y + 3 * (size_t)k->pair.vertex[i]);
}

static bool takes_part(const sweeping *w, size_t e) {
  if (!w->speeds || w->solver->impact[e].place.push > 0) return true;
  return w->bodies->touches && w->bodies->touches[e];
}

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

static hk_status relax(sweeping *w, size_t e) {
  hk_impact *k = &w->solver->impact[e];
  hk_impact_level *level = level_of(w, k);
  const hk_body_response *response;
  double r[3], change[3] = {0, 0, 0}, free_mobility = 0;
  relative(r, k, level, w->y);
  if (level->push == 0 && !(level->target > hk_dot(r, k->frame.n))) return HK_OK;
  hk_status status = hk_body_response_find(w->bodies, w->solver, w->move, e, &response);
  if (status != HK_OK) return status;
  for (int i = 0; i < 4; i++) free_mobility += k->frame.w[i] * k->frame.w[i] * w->move->inverse_mass[k->pair.vertex[i]];
  if (!(k->mobility > held * free_mobility)) return HK_OK; /* pins and constraints hold it */
  double mu = w->bodies->frictions ? w->bodies->frictions[e] : w->solver->friction;
  hk_body_contact_solve(k, level, response->G, mu, r, change);
  double size = hk_length(change);
  if (!(size > 0)) return HK_OK;
  apply(w, response, change);
  note(w, response, w->solver->touched);
  if (!(size * (response->G[0] + response->G[4] + response->G[8]) > w->tolerance)) return HK_OK;
  note(w, response, w->solver->moved);
  w->moved = true;
  return HK_OK;
}

/* ---- all of them ---- */

static hk_status sweep(sweeping *w) {
  hk_status status = HK_OK;
  w->moved = false;
  for (size_t e = 0; e < w->solver->count && status == HK_OK; e++) {
    hk_impact_level *level = level_of(w, &w->solver->impact[e]);
    if (!takes_part(w, e) || !is_awake(w, e, level->solved)) continue;
    level->solved = ++w->solver->now;
    status = relax(w, e);
  }
  return status;
}

static hk_status sweep_some(sweeping *w, size_t *sweeps, size_t until) {
  hk_status status = HK_OK;
  w->moved = true;
  for (; status == HK_OK && w->moved && *sweeps < until; ++*sweeps) status = sweep(w);
  return status;
}

/* Sweeps find out which impacts push; where they then converge slowly, as along a chain that lies on something,
 * Newton's iteration has the last word, and a further sweep looks whether others are met now. */
static hk_status sweep_all(sweeping *w, size_t *sweeps) {
  hk_status status = HK_OK;
  *sweeps = 0;
  do {
    status = sweep_some(w, sweeps, *sweeps + BURST < w->solver->most ? *sweeps + BURST : w->solver->most);
    bool solved = false;
    if (status != HK_OK || !w->moved) return status;
    status = hk_body_newton(w->bodies, w->solver, w->speeds, w->tolerance / 2, w->y, &solved);
    for (size_t e = 0; solved && e < w->solver->count; e++) level_of(w, &w->solver->impact[e])->solved = 0;
  } while (status == HK_OK && *sweeps < w->solver->most);
  return status;
}

/* Whether an impact is short of its target by more than the tolerance, after `settle` has moved everything. */
static bool some_fall_short(const sweeping *w) {
  for (size_t e = 0; e < w->solver->count; e++) {
    hk_impact *k = &w->solver->impact[e];
    const hk_impact_level *level = level_of(w, k);
    double r[3];
    if (!takes_part(w, e) || !(k->mobility > 0)) continue;
    relative(r, k, level, w->y);
    if (level->target - hk_dot(r, k->frame.n) > w->tolerance) return true;
  }
  return false;
}

static hk_status linearise(hk_body_impacts *s, const hk_contact_solver *solver, const hk_step_move *m) {
  for (size_t e = 0; e < solver->count; e++) s->response[e].known = false;
  s->used = 0;
  return s->count ? s->bodies->linearise(s->bodies->self, s->t, m->x, m->v) : HK_OK;
}

static hk_status settle(const hk_body_impacts *s, const hk_step_move *m) {
  return s->count ? s->bodies->settle(s->bodies->self, s->t, m->x, m->v) : HK_OK;
}

/* Equations that hold already leave everything as it is, so that without one-sided ones a second round is rare. */
static hk_status solve_speeds(hk_body_impacts *s, sweeping *w, hk_step_move *m) {
  hk_status status = HK_OK;
  size_t sweeps = 0;
  for (int round = 0; round < ALTERNATIONS; round++) {
    status = linearise(s, w->solver, m);
    if (status == HK_OK) status = sweep_all(w, &sweeps);
    if (status == HK_OK) status = settle(s, m);
    if (status != HK_OK || !some_fall_short(w)) break;
    for (size_t e = 0; e < w->solver->count; e++) w->solver->impact[e].speed.solved = 0;
  }
  return status;
}

hk_status hk_body_gauss_seidel(hk_body_impacts *s, hk_contact_solver *solver, hk_step_move *m,
                               hk_gauss_seidel_result *done) {
  sweeping w = {s, solver, m, m->x, solver->tolerance, false, false};
  *done = (hk_gauss_seidel_result){0};
  hk_status status = hk_reserve(s->host, &s->response, &s->impacts, solver->count, sizeof *s->response);
  if (status == HK_OK) status = linearise(s, solver, m);
  if (status == HK_OK) status = sweep_all(&w, &done->sweeps);
  if (status == HK_OK) status = settle(s, m);
  w.speeds = true, w.y = m->v, w.tolerance = s->slowest > 0 ? s->slowest : solver->tolerance / m->h;
  if (status == HK_OK) status = solve_speeds(s, &w, m);
  for (size_t e = 0; e < solver->count; e++) {
    done->pushing += solver->impact[e].place.push > 0;
    done->impulse += solver->impact[e].speed.push;
  }
  return status;
}
