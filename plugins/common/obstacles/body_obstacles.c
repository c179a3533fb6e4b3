/* See body_obstacles.h. */
#include "plugins/common/obstacles/body_obstacles.h"

#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

enum { ROUNDS = 12, SWEEPS = 200, GRAIN = 256 };

/* Of the gap of contact, and of the largest speed: what sweeps leave. Of a step: a landing is at its end from here on,
 * and at its start before 1 less that. m, of an overlap that nothing can open: what is worth an end. Of a speed: what
 * is none, as of the change in a step without forces. */
static const double left_by_sweeps = 0.05, left_of_speeds = 1e-12, at_end = 1 - 1e-9, worth_saying = 1e-6,
                    worth_a_cut = 1e3, rounding = 1e-9;

hk_status hk_body_obstacles_open(hk_body_obstacles *s, const hk_host *host, const hk_obstacle_set *set) {
  s->set = set;
  return hk_body_impacts_open(&s->impacts, host);
}

void hk_body_obstacles_topology(hk_body_obstacles *s) {
  const hk_host *host = s->impacts.host;
  host->release(host, s->taken);
  host->release(host, s->moved);
  host->release(host, s->touched);
  host->release(host, s->end);
  s->taken = NULL;
  s->moved = s->touched = NULL;
  s->end = NULL;
  s->features = 0;
  hk_body_impacts_topology(&s->impacts);
}

/* Of particles, where there is something to do. */
static hk_status make_room(hk_body_obstacles *s, const hk_view *view) {
  const hk_host *host = s->impacts.host;
  if (s->end) return HK_OK;
  s->taken = host->allocate(host, view->n + 1);
  s->moved = host->allocate(host, (view->n + 1) * sizeof *s->moved);
  s->touched = host->allocate(host, (view->n + 1) * sizeof *s->touched);
  s->end = host->allocate(host, (6 * view->n + 1) * sizeof *s->end);
  if (s->taken && s->moved && s->touched && s->end) return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
}

/* ---- the features ---- */

static void add(hk_body_obstacles *s, const hk_model *model, uint32_t i, uint32_t j, const hk_obstacle *against) {
  bool within = model->inside && (model->inside[i] || model->inside[j]);
  if (!within && (hk_model_moves(model, i) || hk_model_moves(model, j)))
    s->feature[s->features++] = (hk_obstacle_feature){{i, j}, against};
}

/* The edges that the script names for single obstacles. */
static void add_named(hk_body_obstacles *s, const hk_model *model) {
  for (size_t k = 0; k < s->set->count; k++) {
    const hk_tuples *edges = s->set->member[k]->edges;
    for (size_t e = 0; edges && e < edges->count; e++)
      add(s, model, hk_tuple(edges, e)[0], hk_tuple(edges, e)[1], s->set->member[k]);
  }
}

static void take_particles(hk_body_obstacles *s, size_t n) {
  const hk_body_service *bodies = s->impacts.bodies;
  for (uint32_t i = 0; i < n; i++) s->taken[i] = s->impacts.count && bodies->of(bodies->self, i) != UINT32_MAX;
  for (size_t k = 0; k < s->set->count; k++) {
    const hk_tuples *edges = s->set->member[k]->edges;
    for (size_t e = 0; edges && e < edges->count; e++)
      for (int c = 0; c < 2; c++) s->taken[hk_tuple(edges, e)[c]] = true;
  }
}

hk_status hk_body_obstacles_begin(hk_body_obstacles *s, const hk_view *view) {
  const hk_body_service *bodies = s->impacts.bodies;
  const uint32_t(*edge)[2];
  s->features = s->further = 0;
  for (size_t k = 0; k < s->set->count; k++)
    if (s->set->member[k]->edges) s->further += s->set->member[k]->edges->count;
  hk_status status = hk_body_impacts_begin(&s->impacts, view, s->further > 0);
  if (status != HK_OK || (s->impacts.count == 0 && s->further == 0)) return status;
  status = make_room(s, view);
  if (status != HK_OK) return status;
  size_t edges = s->impacts.count ? bodies->edges(bodies->self, &edge) : 0, most = view->n + edges + s->further;
  status = hk_reserve(s->impacts.host, &s->feature, &s->feature_room, most, sizeof *s->feature);
  if (status != HK_OK) return status;
  take_particles(s, view->n);
  for (uint32_t i = 0; i < view->n; i++)
    if (s->taken[i]) add(s, view->model, i, i, NULL);
  for (size_t e = 0; e < edges; e++) add(s, view->model, edge[e][0], edge[e][1], NULL);
  add_named(s, view->model);
  size_t pairs = s->features * s->set->count;
  status = hk_reserve(s->impacts.host, &s->solved, &s->solved_room, pairs, sizeof *s->solved);
  if (status == HK_OK) status = hk_reserve(s->impacts.host, &s->near, &s->near_room, pairs, sizeof *s->near);
  for (size_t k = 0; k < pairs && status == HK_OK; k++) s->solved[k] = false;
  return status;
}

/* ---- what touches ---- */

static hk_status add_contact(hk_body_obstacles *s, const hk_body_contact *k) {
  if (s->contacts == s->contact_room) {
    const hk_host *host = s->impacts.host;
    size_t room = 2 * s->contact_room + 16;
    hk_body_contact *grown = host->allocate(host, room * sizeof *grown);
    if (!grown) return host->fail(host, HK_NO_MEMORY, "no memory for %zu contacts of bodies with obstacles", room);
    if (s->contacts) memcpy(grown, s->contact, s->contacts * sizeof *grown);
    host->release(host, s->contact);
    s->contact = grown;
    s->contact_room = room;
  }
  s->contact[s->contacts++] = *k;
  return HK_OK;
}

typedef struct sifting {
  const hk_body_obstacles *self;
  const hk_obstacle_moves *moves;
} sifting;

static void sift_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const sifting *t = context;
  const hk_body_obstacles *s = t->self;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    const hk_obstacle_feature *f = &s->feature[k / s->set->count];
    const hk_obstacle *o = s->set->member[k % s->set->count];
    bool meets = !f->against || f->against == o;
    s->near[k] = meets && hk_feature_may_touch(o, t->moves, f, hk_body_contact_touching(o, t->moves, f));
  }
}

/* Without friction it does not matter where it acts. */
static const uint32_t *round_body(const hk_body_obstacles *s, const hk_body_contact *k) {
  const double both[2] = {1, 1};
  const hk_obstacle *o = k->obstacle;
  bool rubs = o->friction + o->rolling + o->spinning > 0 && hk_obstacle_radius(k->obstacle, k->feature.end[0]) > 0;
  return rubs ? hk_body_arm_carriers(s->impacts.model, k->feature.end, both, 2) : NULL;
}

static hk_status find_contacts(hk_body_obstacles *s, const hk_obstacle_moves *m) {
  hk_status status = HK_OK;
  const hk_host *host = s->impacts.host;
  sifting t = {s, m};
  s->contacts = 0;
  host->parallel_for(host, s->features * s->set->count, GRAIN, sift_chunk, &t);
  for (size_t f = 0; f < s->features; f++)
    for (size_t o = 0; o < s->set->count && status == HK_OK; o++) {
      hk_body_contact k = {s->set->member[o], f * s->set->count + o, s->feature[f], NULL, {.touches = false}};
      if (!s->near[k.index]) continue;
      k.carrier = round_body(s, &k);
      k.way = hk_feature_way_of(k.obstacle, m, &k.feature, hk_body_contact_touching(k.obstacle, m, &k.feature));
      bool edge = k.feature.end[0] != k.feature.end[1];
      if (!k.way.touches || (edge && !k.way.to.inside_of_edge && !k.way.at.inside_of_edge)) continue;
      status = add_contact(s, &k);
    }
  return status;
}

/* Whether the velocity at the start is not that of the way: of methods of order 1, whose steps are not cut. */
static bool first_order(const hk_obstacle_moves *m, size_t i) {
  double drift[3], change[3];
  for (size_t c = 3 * i; c < 3 * i + 3; c++) {
    change[c - 3 * i] = m->v[c] - m->v_from[c];
    drift[c - 3 * i] = m->v_from[c] - (m->x[c] - m->x_from[c]) / m->h + change[c - 3 * i] / 2;
  }
  return hk_length(drift) > 0.1 * hk_length(change) + rounding * hk_length(m->v_from + 3 * i);
}

/* Whether the step is to end where this contact begins: it closes faster than the step changes its speed. */
static bool lands(const hk_body_contact *k, const hk_obstacle_moves *m) {
  double touching = hk_body_contact_touching(k->obstacle, m, &k->feature), s = k->way.landing;
  if (!(s > 1 - at_end) || !(s < at_end) || fabs(k->way.to.gap) <= touching) return false;
  if (first_order(m, k->feature.end[0]) || first_order(m, k->feature.end[1])) return false;
  const double *n = k->way.at.n;
  double u = hk_body_contact_speed(k, m, &k->way.at, n, s);
  double change = hk_body_contact_speed(k, m, &k->way.at, n, 1) - hk_body_contact_speed(k, m, &k->way.at, n, 0);
  return u < -fabs(change);
}

hk_status hk_body_obstacles_find(hk_body_obstacles *s, const hk_obstacle_moves *m, hk_body_landing *out) {
  *out = (hk_body_landing){.part = 1};
  hk_status status = find_contacts(s, m);
  for (size_t e = 0; e < s->contacts && status == HK_OK; e++) {
    const hk_body_contact *k = &s->contact[e];
    double touching = hk_body_contact_touching(k->obstacle, m, &k->feature);
    if (lands(k, m)) out->landings++, out->part = fmin(out->part, k->way.landing);
    if (k->way.landing > 0 || !(-k->way.from.gap > fmax(touching, out->depth))) continue;
    out->depth = -k->way.from.gap;
    out->deepest = k->feature.end[k->way.from.place > 0.5];
  }
  return status;
}

/* ---- the solution ---- */

static hk_status build(hk_body_obstacles *s, const hk_obstacle_moves *m, hk_contact_solver *solver) {
  const hk_host *host = s->impacts.host;
  hk_status status = hk_reserve(host, &s->impact, &s->impact_room, s->contacts, sizeof *s->impact);
  if (status == HK_OK) status = hk_reserve(host, &s->friction, &s->friction_room, s->contacts, sizeof *s->friction);
  if (status == HK_OK) status = hk_reserve(host, &s->touch, &s->touch_room, s->contacts, sizeof *s->touch);
  if (status == HK_OK) status = hk_reserve(host, &s->arms, &s->arms_room, s->contacts, sizeof *s->arms);
  if (status == HK_OK) status = hk_reserve(host, &s->slip, &s->slip_room, s->contacts, sizeof *s->slip);
  if (status == HK_OK) status = hk_reserve(host, &s->moments, &s->moments_room, s->contacts, sizeof *s->moments);
  if (status != HK_OK) return status;
  size_t count = 0;
  bool resists = false;
  for (size_t e = 0; e < s->contacts; e++) {
    const hk_body_contact *k = &s->contact[e];
    if (k->way.to.gap > hk_body_contact_touching(k->obstacle, m, &k->feature)) continue; /* it passed a corner */
    s->touch[count] = hk_body_obstacle_impact(&s->impact[count], &s->arms[count], k, m, s->solved[k->index]);
    hk_body_obstacle_slides(k, m, s->slip[count]);
    hk_body_obstacle_moments(&s->moments[count], k, m);
    resists |= hk_body_moments_any(&s->moments[count]);
    s->friction[count++] = k->obstacle->friction;
    s->solved[k->index] = true;
  }
  solver->count = count;
  solver->impact = s->impact;
  s->impacts.frictions = s->friction;
  s->impacts.touches = s->touch;
  s->impacts.arms = s->arms;
  s->impacts.moments = resists ? s->moments : NULL;
  return HK_OK;
}

/* The contact with the largest overlap beyond what counts as contact; NULL: there is none. */
static const hk_body_contact *worst_of(const hk_body_obstacles *s, const hk_obstacle_moves *m) {
  const hk_body_contact *worst = NULL;
  for (size_t e = 0; e < s->contacts; e++) {
    const hk_body_contact *k = &s->contact[e];
    if (!(k->way.to.gap < -hk_body_contact_touching(k->obstacle, m, &k->feature))) continue;
    if (!worst || k->way.to.gap < worst->way.to.gap) worst = k;
  }
  return worst;
}

static hk_status contradiction(const hk_body_obstacles *s, const hk_view *view, const hk_body_contact *worst,
                               double most, bool *reject) {
  const uint32_t *id = view->model->id, *end = worst->feature.end;
  hk_weighted_point point = {{end[0], end[1], end[0], end[0]}, {1 - worst->way.to.place, worst->way.to.place, 0, 0}};
  double mobility = 1;
  hk_status status = HK_OK;
  if (!(-worst->way.to.gap > most)) return HK_OK; /* the next step goes on with it */
  *reject = worst->way.from.gap > -most;          /* what starts inside comes out in some steps */
  if (s->impacts.count)
    status = s->impacts.bodies->mobility(s->impacts.bodies->self, &point, worst->way.to.n, &mobility);
  double free_mobility = fmax(hk_free_mobility(view->model, end[0]), hk_free_mobility(view->model, end[1]));
  if (status != HK_OK || mobility > 1e-9 * free_mobility || !(-worst->way.to.gap > worth_saying)) return status;
  return s->impacts.host->fail(
      s->impacts.host, HK_FAILED,
      "particles %u and %u are inside an obstacle by %.3g m at t = %g s, and pins and constraints let nothing move "
      "there: "
      "they contradict the obstacle; free a pin, make a bar a cable, or keep the obstacle away",
      id[end[0]], id[end[1]], -worst->way.to.gap, view->t);
}

static double work_of(const hk_body_obstacles *s, const hk_view *view, const hk_correction *c) {
  const double *x = s->end, *v = s->end + 3 * view->n;
  double sum = 0;
  for (size_t i = 0; i < 3 * view->n; i++) {
    if (c->x[i] == x[i] && c->v[i] == v[i]) continue;
    double a = (v[i] - c->v_before[i]) / c->h;
    sum += view->model->mass[i / 3] * ((c->v[i] * c->v[i] - v[i] * v[i]) / 2 - a * (c->x[i] - x[i]));
  }
  return sum;
}

/* m/s, of the particles in contact, with and without the step's change of them. */
static double largest_speed(const hk_body_obstacles *s, const hk_obstacle_moves *m) {
  double most = 0;
  for (size_t e = 0; e < s->contacts; e++)
    for (int c = 0; c < 2; c++) {
      size_t i = s->contact[e].feature.end[c];
      most = fmax(most, fmax(hk_length(m->v_from + 3 * i), hk_length(m->v + 3 * i)));
    }
  return most;
}

/* Whether nothing that bodies touch can give them energy. */
static bool all_still(const hk_body_obstacles *s) {
  bool still = true;
  for (size_t e = 0; e < s->contacts; e++) still &= s->contact[e].obstacle->motion.still;
  return still;
}

/* Painleve's paradox: a contact that lasts and slides, whose friction presses the body into the obstacle by more than
 * the normal force pushes it out (n.G.(n - mu t) <= 0; Genot and Brogliato 1999, Eur. J. Mech. A 18, 653). Rigid bodies
 * then have no acceleration, or two. The slip has to be far above what a step changes, so that sticking is none. */
static hk_status refuse_paradox(const hk_body_obstacles *s, const hk_contact_solver *solver) {
  for (size_t e = 0; e < solver->count; e++) {
    const hk_impact *k = &solver->impact[e];
    const hk_body_response *r = &s->impacts.response[e];
    double G[3], slip[3], size = hk_length(s->slip[e]);
    if (!(size > 0) || !r->known || !(k->speed.push > 0)) continue;
    for (int c = 0; c < 3; c++) slip[c] = s->slip[e][c] / size;
    for (int c = 0; c < 3; c++)
      G[c] = k->frame.n[0] * r->G[c] + k->frame.n[1] * r->G[3 + c] + k->frame.n[2] * r->G[6 + c];
    if (hk_dot(G, k->frame.n) > s->friction[e] * hk_dot(G, slip)) continue;
    return s->impacts.host->fail(
        s->impacts.host, HK_FAILED,
        "particle %u slides on an obstacle at t = %g s with a friction of %g that jams its body (Painleve's paradox): "
        "rigid bodies have no motion there that the laws determine; lower the friction, or tilt the body less",
        s->impacts.model->id[k->pair.vertex[0]], s->impacts.t, s->friction[e]);
  }
  return HK_OK;
}

static hk_status one_round(hk_body_obstacles *s, const hk_obstacle_moves *m, const hk_view *view, hk_correction *c) {
  hk_step_move move = {c->h, c->x_before, c->v_before, c->x, c->v, view->model->inverse_mass};
  hk_contact_solver solver = {.most = SWEEPS, .moved = s->moved, .touched = s->touched, .now = s->now};
  hk_gauss_seidel_result done = {0};
  solver.tolerance = left_by_sweeps * hk_body_contact_touching(s->contact->obstacle, m, &s->contact->feature);
  s->impacts.keeps_energy = all_still(s);
  s->impacts.slowest = left_of_speeds * largest_speed(s, m) + 2e-3 * solver.tolerance / c->h;
  hk_status status = build(s, m, &solver);
  if (status == HK_OK && solver.count) status = hk_body_gauss_seidel(&s->impacts, &solver, &move, &done);
  if (status == HK_OK && solver.count) status = refuse_paradox(s, &solver);
  if (status == HK_OK) hk_impact_add_forces(s->impact, solver.count, c->h, s->force);
  s->now = solver.now;
  c->changed |= done.pushing > 0 || done.impulse > 0;
  return status;
}

hk_status hk_body_obstacles_solve(hk_body_obstacles *s, const hk_view *view, hk_correction *c) {
  const hk_obstacle_moves m = {c->h, c->x_before, c->v_before, c->x, c->v};
  const hk_body_contact *worst = NULL;
  hk_status status = HK_OK;
  memset(s->force, 0, 3 * view->n * sizeof *s->force);
  if (s->contacts == 0) return HK_OK;
  memcpy(s->end, c->x, 3 * view->n * sizeof *c->x);
  memcpy(s->end + 3 * view->n, c->v, 3 * view->n * sizeof *c->v);
  s->impacts.t = view->t;
  for (int round = 0; round < ROUNDS && status == HK_OK && (round == 0 || worst); round++) {
    status = one_round(s, &m, view, c);
    if (status == HK_OK) status = find_contacts(s, &m);
    if (status == HK_OK) worst = worst_of(s, &m);
  }
  if (status == HK_OK && worst) {
    double touching = hk_body_contact_touching(worst->obstacle, &m, &worst->feature);
    status = contradiction(s, view, worst, fmin(worth_saying, worth_a_cut * touching), &c->reject);
    c->reject &= !c->last; /* the next steps go on with what is left, and the verdict has what they leave */
  }
  c->work += work_of(s, view, c);
  return status;
}

double hk_body_obstacles_depth(const hk_body_obstacles *s, const hk_view *view) {
  const hk_obstacle_moves m = {0, view->x, view->v, view->x, view->v};
  double depth = 0;
  for (size_t k = 0; k < s->features * s->set->count; k++) {
    const hk_obstacle_feature *f = &s->feature[k / s->set->count];
    const hk_obstacle *o = s->set->member[k % s->set->count];
    bool edge = f->end[0] != f->end[1];
    if (edge && (!f->against || f->against == o)) depth = fmax(depth, -hk_feature_gap_at(o, &m, f, 1, 0).gap);
  }
  return depth;
}
