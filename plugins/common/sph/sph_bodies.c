#include "plugins/common/sph/sph_bodies.h"

#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

enum { MOST_CARRIERS = 64 }; /* of a group: its answers are a dense matrix */

static const double still = 1e-12; /* of the largest answer: ways in which carriers do not move */

void hk_sph_bodies_open(hk_sph_bodies *b, const hk_host *host) { b->service = host->query(host, "bodies/1"); }

/* ---- who moves ---- */

static hk_status reserve_lists(hk_sph_bodies *b, const hk_host *host, size_t n) {
  hk_status status = hk_reserve(host, &b->mover, &b->mover_room, n, sizeof *b->mover);
  if (status == HK_OK) status = hk_reserve(host, &b->group, &b->group_room, n, sizeof *b->group);
  if (status == HK_OK) status = hk_reserve(host, &b->carrier, &b->carrier_room, n, sizeof *b->carrier);
  if (status == HK_OK) status = hk_reserve(host, &b->owner, &b->owner_room, n, sizeof *b->owner);
  if (status == HK_OK) status = hk_reserve(host, &b->mover_of, &b->mover_of_room, n, sizeof *b->mover_of);
  if (status == HK_OK) status = hk_reserve(host, &b->carrier_of, &b->carrier_of_room, n, sizeof *b->carrier_of);
  if (status == HK_OK) status = hk_reserve(host, &b->wet, &b->wet_room, n, sizeof *b->wet);
  if (status == HK_OK) status = hk_reserve(host, &b->touched, &b->touched_room, n, sizeof *b->touched);
  if (status == HK_OK) status = hk_reserve(host, &b->push, &b->push_room, n, sizeof *b->push);
  if (status == HK_OK) status = hk_reserve(host, &b->start, &b->start_room, n, sizeof *b->start);
  if (status == HK_OK) status = hk_reserve(host, &b->share, &b->share_room, n, sizeof *b->share);
  if (status == HK_OK) status = hk_reserve(host, &b->coupling, &b->coupling_room, n, sizeof *b->coupling);
  return status == HK_OK ? hk_reserve(host, &b->response, &b->response_room, 3 * n, sizeof *b->response) : status;
}

static void say(hk_sph_bodies *b, const hk_host *host, size_t count) {
  if (b->said) return;
  b->said = true;
  host->warn(host,
             "constraints join %zu particles to a wall of the liquid, more than the %d whose answer to its pressure is "
             "known: they are walls that the liquid does not move; join fewer to one another, or take the force sph",
             count, MOST_CARRIERS);
}

static void add_carrier(hk_sph_bodies *b, uint32_t particle) {
  b->carrier[b->carriers] = particle;
  b->owner[b->carriers] = (uint32_t)b->groups;
  b->carrier_of[particle] = (uint32_t)++b->carriers;
}

/* All that moves with the particle, unless it is known already. */
static void add_group(hk_sph_bodies *b, const hk_view *view, uint32_t particle) {
  const hk_model *m = view->model;
  const uint32_t *member = &particle;
  uint32_t body = b->joined ? b->service->of(b->service->self, particle) : UINT32_MAX;
  size_t count = 1, first = b->carriers, moving = 0;
  if (b->carrier_of[particle] || !(m->inverse_mass[particle] > 0)) return;
  if (body != UINT32_MAX) count = b->service->members(b->service->self, body, &member);
  for (size_t e = 0; e < count; e++) moving += m->inverse_mass[member[e]] > 0;
  if (moving > MOST_CARRIERS) {
    say(b, view->host, moving);
    return;
  }
  for (size_t e = 0; e < count; e++)
    if (m->inverse_mass[member[e]] > 0) add_carrier(b, member[e]);
  b->group[b->groups++] = (hk_sph_group){.first = first, .carriers = b->carriers - first, .alone = body == UINT32_MAX};
}

static void add_weight(const hk_sph_bodies *b, hk_sph_mover *to, uint32_t particle, double weight) {
  if (!b->carrier_of[particle]) return;
  to->carrier[to->carriers] = b->carrier_of[particle] - 1;
  to->weight[to->carriers++] = weight;
}

static void add_mover(hk_sph_bodies *b, const hk_view *view, uint32_t particle) {
  const hk_rider *r = view->model->pin[particle] == HK_PIN_RIDES ? hk_model_rider(view->model, particle) : NULL;
  hk_sph_mover to = {.particle = particle};
  if (!r) add_group(b, view, particle);
  if (!r) add_weight(b, &to, particle, 1);
  for (uint32_t k = 0; r && k < r->carriers; k++) add_group(b, view, r->carrier[k]);
  for (uint32_t k = 0; r && k < r->carriers; k++) add_weight(b, &to, r->carrier[k], r->weight[k]);
  if (to.carriers == 0) return;
  b->mover[b->movers++] = to;
  b->mover_of[particle] = (uint32_t)b->movers;
}

static hk_status find_movers(hk_sph_bodies *b, const hk_sph *s, const hk_view *view) {
  size_t bodies = 0, room = 0;
  hk_status status = reserve_lists(b, view->host, view->n);
  if (status == HK_OK && b->service) status = b->service->count(b->service->self, &bodies);
  if (status != HK_OK) return status;
  b->joined = bodies > 0;
  b->movers = b->groups = b->carriers = b->wets = 0;
  memset(b->mover_of, 0, view->n * sizeof *b->mover_of);
  memset(b->carrier_of, 0, view->n * sizeof *b->carrier_of);
  memset(b->coupling, 0, view->n * sizeof *b->coupling);
  for (size_t i = 0; i < view->n; i++)
    if (s->role[i] == HK_SPH_WALL && hk_model_moves(view->model, i)) add_mover(b, view, (uint32_t)i);
  for (size_t g = 0; g < b->groups; g++) {
    b->group[g].L = room;
    room += 9 * b->group[g].carriers * b->group[g].carriers;
  }
  status = hk_reserve(view->host, &b->L, &b->L_room, room, sizeof *b->L);
  if (status == HK_OK)
    status = hk_reserve(view->host, &b->R, &b->R_room, 9 * MOST_CARRIERS * MOST_CARRIERS, sizeof *b->R);
  if (status == HK_OK) b->n = view->n;
  return status;
}

/* ---- answers ---- */

/* R = L L^T, by the largest pivot that is left; R is lost. */
static void factorize(hk_sph_bodies *b, hk_sph_group *g) {
  size_t m = 3 * g->carriers;
  double *R = b->R, most = 0;
  g->modes = 0;
  for (size_t e = 0; e < m; e++) most = fmax(most, R[e * m + e]);
  for (; g->modes < m; g->modes++) {
    double *l = b->L + g->L + g->modes * m;
    size_t pivot = 0;
    for (size_t e = 1; e < m; e++)
      if (R[e * m + e] > R[pivot * m + pivot]) pivot = e;
    double by = R[pivot * m + pivot];
    if (!(by > still * most)) break;
    for (size_t e = 0; e < m; e++) l[e] = R[e * m + pivot] / sqrt(by);
    for (size_t e = 0; e < m; e++)
      for (size_t f = 0; f < m; f++) R[e * m + f] -= l[e] * l[f];
  }
}

/* Carriers that no constraint joins, whose pins may let them slide: modes are the ways that are left. */
static void find_alone(hk_sph_bodies *b, const hk_view *view, const hk_correction *c, size_t axis) {
  memset(b->response, 0, 3 * view->n * sizeof *b->response);
  for (size_t k = 0; k < b->carriers; k++) b->response[3 * (size_t)b->carrier[k] + axis] = 1;
  if (c->filter) c->filter(c, b->response);
  for (size_t g = 0; g < b->groups; g++) {
    const hk_sph_group *one = &b->group[g];
    size_t i = b->carrier[one->first];
    if (!one->alone) continue;
    for (size_t a = 0; a < 3; a++) b->L[one->L + 3 * axis + a] = view->model->inverse_mass[i] * b->response[3 * i + a];
  }
}

/* Rows of R of the group, what a unit impulse on a carrier along an axis gives to all. */
static hk_status ask(hk_sph_bodies *b, const hk_sph_group *g) {
  size_t m = 3 * g->carriers;
  hk_status status = HK_OK;
  for (size_t e = 0; e < m && status == HK_OK; e++) {
    uint32_t i = b->carrier[g->first + e / 3];
    const hk_weighted_point at = {{i, i, i, i}, {1, 0, 0, 0}};
    const double along[3] = {e % 3 == 0, e % 3 == 1, e % 3 == 2};
    status = b->service->respond(b->service->self, &at, along, b->response);
    for (size_t f = 0; f < m; f++) b->R[e * m + f] = b->response[3 * (size_t)b->carrier[g->first + f / 3] + f % 3];
  }
  return status;
}

hk_status hk_sph_bodies_begin(hk_sph_bodies *b, const hk_sph *s, const hk_view *view, const hk_correction *c) {
  hk_status status = b->n == view->n && view->n > 0 ? HK_OK : find_movers(b, s, view);
  if (status != HK_OK || b->movers == 0) return status;
  for (size_t axis = 0; axis < 3; axis++) find_alone(b, view, c, axis);
  if (b->joined) status = b->service->linearise(b->service->self, view->t, c->x, c->v);
  for (size_t g = 0; g < b->groups && status == HK_OK; g++) {
    hk_sph_group *group = &b->group[g];
    if (group->alone) memcpy(b->R, b->L + group->L, 9 * sizeof *b->R);
    if (!group->alone) status = ask(b, group);
    factorize(b, group);
  }
  for (size_t k = 0; k < b->carriers; k++) memcpy(b->start[k], c->v + 3 * (size_t)b->carrier[k], sizeof *b->start);
  return status;
}

/* ---- the bound ---- */

/* What a unit multiplier of the particle gives to the carriers that it touches. */
static void touch(hk_sph_bodies *b, const hk_sph *s, const hk_sph_list *l, const hk_periodic_box *box, size_t i) {
  double scale = hk_sph_list_scale(s) / s->point[i][3], d[3];
  b->touches = 0;
  for (size_t e = l->start[i]; e < l->start[i] + l->count[i]; e++) {
    size_t j = l->other[e];
    if (!b->mover_of[j]) continue;
    const hk_sph_mover *to = &b->mover[b->mover_of[j] - 1];
    hk_subtract(d, s->point[i], s->point[j]);
    if (box) hk_nearest_image(box, d);
    for (uint32_t k = 0; k < to->carriers; k++) {
      uint32_t g = b->owner[to->carrier[k]];
      hk_add_scaled(b->push[to->carrier[k]], to->weight[k] * scale * (double)l->weight[e], d);
      if (!b->group[g].touched) b->touched[b->touches++] = g;
      b->group[g].touched = true;
    }
  }
}

/* What the mode has of the pushes on its carriers. */
static double part_of(const hk_sph_bodies *b, const hk_sph_group *g, size_t mode) {
  const double *l = b->L + g->L + mode * 3 * g->carriers, *p = b->push[g->first];
  double sum = 0;
  for (size_t e = 0; e < 3 * g->carriers; e++) sum += l[e] * p[e];
  return sum;
}

/* Adds the particle's parts of all modes to `share`, or, where `bound`, takes its bound from there. */
static double add_shares(hk_sph_bodies *b, bool bound) {
  double sum = 0;
  for (size_t k = 0; k < b->touches; k++) {
    hk_sph_group *g = &b->group[b->touched[k]];
    double *share = b->share[g->first];
    for (size_t mode = 0; mode < g->modes; mode++) {
      double part = fabs(part_of(b, g, mode));
      if (bound) sum += part * share[mode];
      if (!bound) share[mode] += part;
    }
    memset(b->push[g->first], 0, g->carriers * sizeof *b->push);
    g->touched = false;
  }
  return sum;
}

static void find_wet(hk_sph_bodies *b, const hk_sph *s, const hk_sph_list *l) {
  for (size_t k = 0; k < b->wets; k++) b->coupling[b->wet[k]] = 0;
  b->wets = 0;
  for (size_t k = 0; k < b->movers; k++) {
    size_t j = b->mover[k].particle;
    for (size_t e = l->start[j]; e < l->start[j] + l->count[j]; e++) {
      uint32_t i = l->other[e];
      if (s->role[i] != HK_SPH_LIQUID || b->coupling[i] != 0) continue;
      b->coupling[i] = INFINITY;
      b->wet[b->wets++] = i;
    }
  }
}

void hk_sph_bodies_couple(hk_sph_bodies *b, const hk_sph *s, const hk_sph_list *l, const hk_periodic_box *box) {
  if (b->movers == 0) return;
  find_wet(b, s, l);
  memset(b->share, 0, b->carriers * sizeof *b->share);
  memset(b->push, 0, b->carriers * sizeof *b->push);
  for (int bound = 0; bound < 2; bound++)
    for (size_t k = 0; k < b->wets; k++) {
      touch(b, s, l, box, b->wet[k]);
      double sum = add_shares(b, bound);
      if (bound) b->coupling[b->wet[k]] = sum;
    }
}

/* ---- motion ---- */

static void answer_group(const hk_sph_bodies *b, const hk_sph_group *g, const double *before, double (*v)[4]) {
  for (size_t k = g->first; k < g->first + g->carriers; k++)
    memcpy(v[b->carrier[k]], before + 3 * (size_t)b->carrier[k], 3 * sizeof(double));
  for (size_t mode = 0; mode < g->modes; mode++) {
    const double *l = b->L + g->L + mode * 3 * g->carriers;
    double by = part_of(b, g, mode);
    for (size_t k = 0; k < g->carriers; k++) hk_add_scaled(v[b->carrier[g->first + k]], by, l + 3 * k);
  }
}

void hk_sph_bodies_answer(hk_sph_bodies *b, const double *before, double (*v)[4]) {
  if (b->movers == 0) return;
  memset(b->push, 0, b->carriers * sizeof *b->push);
  for (size_t k = 0; k < b->movers; k++) {
    hk_sph_mover *to = &b->mover[k];
    memcpy(to->pressed, v[to->particle], sizeof to->pressed);
    for (uint32_t c = 0; c < to->carriers; c++) hk_add_scaled(b->push[to->carrier[c]], to->weight[c], to->pressed);
  }
  for (size_t g = 0; g < b->groups; g++) answer_group(b, &b->group[g], before, v);
  for (size_t k = 0; k < b->movers; k++) {
    const hk_sph_mover *to = &b->mover[k];
    double u[3], change[3];
    memcpy(u, before + 3 * (size_t)to->particle, sizeof u);
    for (uint32_t c = 0; c < to->carriers; c++) {
      size_t i = b->carrier[to->carrier[c]];
      hk_subtract(change, v[i], before + 3 * i);
      hk_add_scaled(u, to->weight[c], change);
    }
    memcpy(v[to->particle], u, sizeof u);
  }
  memset(b->push, 0, b->carriers * sizeof *b->push);
}

void hk_sph_bodies_clear(hk_sph_bodies *b) {
  for (size_t k = 0; k < b->movers; k++) memset(b->mover[k].impulse, 0, sizeof b->mover[k].impulse);
}

void hk_sph_bodies_keep(hk_sph_bodies *b) {
  for (size_t k = 0; k < b->movers; k++) hk_add_scaled(b->mover[k].impulse, 1, b->mover[k].pressed);
}

/* Points of bodies are where their carriers have them. */
static void follow(const hk_sph_bodies *b, const hk_view *view, double *y) {
  for (size_t k = 0; k < b->movers; k++) {
    size_t i = b->mover[k].particle;
    const hk_rider *r = view->model->pin[i] == HK_PIN_RIDES ? hk_model_rider(view->model, i) : NULL;
    if (!r) continue;
    y[3 * i] = y[3 * i + 1] = y[3 * i + 2] = 0;
    for (uint32_t c = 0; c < r->carriers; c++) hk_add_scaled(y + 3 * i, r->weight[c], y + 3 * (size_t)r->carrier[c]);
  }
}

hk_status hk_sph_bodies_move(hk_sph_bodies *b, const hk_view *view, hk_correction *c, bool *moved) {
  hk_status status = HK_OK;
  bool any = false;
  if (b->movers == 0) return HK_OK;
  for (size_t k = 0; k < b->carriers; k++) {
    size_t i = b->carrier[k];
    double change[3];
    hk_subtract(change, c->v + 3 * i, b->start[k]);
    any |= change[0] != 0 || change[1] != 0 || change[2] != 0;
    hk_add_scaled(c->x + 3 * i, c->h, change);
  }
  if (!any) return HK_OK;
  *moved = true;
  if (b->joined) status = b->service->settle(b->service->self, view->t, c->x, c->v);
  follow(b, view, c->x);
  follow(b, view, c->v);
  return status;
}

void hk_sph_bodies_forces(const hk_sph_bodies *b, double h, double *F) {
  for (size_t k = 0; k < b->movers && h > 0; k++)
    hk_add_scaled(F + 3 * (size_t)b->mover[k].particle, 1 / h, b->mover[k].impulse);
}
