/* The columns U of an impact, found when it first needs an impulse: of the particles of the bodies that its four
 * particles are of, and of those of the four that are in none. Where bodies have many impacts, those of unit impulses
 * on their carriers are found once, of which all others are sums. */
#include "plugins/common/contact/bodies/impact_response.h"
#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

#include "core/plugin/widest.h"

#include <string.h>

enum { FEW_MEMBERS = 64 /* of a body whose columns are kept */ };

/* 1/kg, relative to sum w^2/m: less is a point that bars and pins hold. */
static const double held = 1e-12;

void hk_body_relative(const hk_body_impacts *s, const hk_contact_solver *solver, size_t e, const hk_impact_level *level,
                      const double *y, double out[3]) {
  const hk_impact *k = &solver->impact[e];
  const hk_body_arms *arms = hk_body_arms_of(s, e);
  for (int c = 0; c < 3; c++) out[c] = -level->origin[c];
  for (int i = 0; i < 4; i++) hk_add_scaled(out, k->frame.w[i], y + 3 * (size_t)k->pair.vertex[i]);
  if (arms) hk_body_arms_add(arms, y, k->frame.n, out);
}

static uint32_t body_of(const hk_body_impacts *s, uint32_t particle) {
  return s->count ? s->bodies->of(s->bodies->self, particle) : UINT32_MAX;
}

/* Whether the i-th particle counts, and is the first of the impact's that is of its body, or is itself. */
static bool is_first(const hk_body_impacts *s, const hk_impact *k, int i) {
  uint32_t body = body_of(s, k->pair.vertex[i]);
  if (k->frame.w[i] == 0) return false;
  for (int j = 0; j < i; j++) {
    if (k->frame.w[j] == 0) continue;
    if (body != UINT32_MAX ? body_of(s, k->pair.vertex[j]) == body : k->pair.vertex[j] == k->pair.vertex[i])
      return false;
  }
  return true;
}

/* The particles that move with the i-th one. */
static size_t members_of(const hk_body_impacts *s, const hk_impact *k, int i, const uint32_t **list) {
  uint32_t body = body_of(s, k->pair.vertex[i]);
  *list = &k->pair.vertex[i];
  return body == UINT32_MAX ? 1 : s->bodies->members(s->bodies->self, body, list);
}

static hk_status make_room(hk_body_impacts *s, size_t more) {
  size_t room = s->used + more;
  if (room <= s->room) return HK_OK;
  room += room / 2;
  uint32_t *particle = s->host->allocate(s->host, room * sizeof *particle);
  double(*block)[9] = s->host->allocate(s->host, room * sizeof *block);
  double(*turn)[9] = s->host->allocate(s->host, room * sizeof *turn);
  if (!particle || !block || !turn) {
    s->host->release(s->host, turn);
    s->host->release(s->host, particle);
    s->host->release(s->host, block);
    return s->host->fail(s->host, HK_NO_MEMORY, "no memory for the response of %zu particles to impacts", room);
  }
  if (s->used) {
    memcpy(particle, s->particle, s->used * sizeof *particle);
    memcpy(block, s->block, s->used * sizeof *block);
    memcpy(turn, s->turn, s->used * sizeof *turn);
  }
  s->host->release(s->host, s->particle);
  s->host->release(s->host, s->block);
  s->host->release(s->host, s->turn);
  s->particle = particle;
  s->block = block;
  s->turn = turn;
  s->room = room;
  return HK_OK;
}

static hk_status list_particles(hk_body_impacts *s, const hk_impact *k, hk_body_response *r) {
  size_t count = 0;
  const uint32_t *list;
  for (int i = 0; i < 4; i++)
    if (is_first(s, k, i)) count += members_of(s, k, i, &list);
  hk_status status = make_room(s, count);
  if (status != HK_OK) return status;
  r->first = s->used;
  r->count = count;
  for (int i = 0; i < 4; i++) {
    if (!is_first(s, k, i)) continue;
    count = members_of(s, k, i, &list);
    memcpy(s->particle + s->used, list, count * sizeof *list);
    s->used += count;
  }
  return HK_OK;
}

/* The point of one side of an impact: where it is rubbed, on the carriers of its body, or where its particles are. */
static hk_weighted_point point_of(const hk_body_impacts *s, const hk_impact *k, const hk_body_arms *arms, int side) {
  int split = hk_pair_split(k->pair.kind), first = side == 0 ? 0 : split, last = side == 0 ? split : 4;
  const hk_body_arm *arm = &arms->side[side];
  uint32_t any = k->pair.vertex[first];
  hk_weighted_point p = {{any, any, any, any}, {0}};
  for (int i = first; i < last; i++) {
    if (!arm->carrier) p.particle[i - first] = k->pair.vertex[i], p.weight[i - first] = k->frame.w[i];
    if (!arm->carrier || k->frame.w[i] == 0) continue;
    const hk_rider *r = hk_model_rider(s->model, k->pair.vertex[i]);
    for (int c = 0; c < 4; c++) p.weight[c] += k->frame.w[i] * r->weight[c];
  }
  for (int c = 0; c < 4 && arm->carrier; c++) p.particle[c] = arm->carrier[c], p.weight[c] += arm->weight[c];
  return p;
}

/* s->column = the changes by a unit impulse along the axis c at the point. */
static hk_status find_column(hk_body_impacts *s, const hk_weighted_point *point, const double *inverse_mass, int c) {
  double unit[3] = {0, 0, 0};
  unit[c] = 1;
  for (int i = 0; i < 4; i++) memset(s->column + 3 * (size_t)point->particle[i], 0, 3 * sizeof *s->column);
  for (int i = 0; i < 4; i++)
    if (body_of(s, point->particle[i]) == UINT32_MAX)
      s->column[3 * (size_t)point->particle[i] + (size_t)c] += point->weight[i] * inverse_mass[point->particle[i]];
  return s->count ? s->bodies->respond(s->bodies->self, point, unit, s->column) : HK_OK;
}

/* Adds the columns of a point to the blocks. */
static hk_status add_columns(hk_body_impacts *s, const hk_body_response *r, const hk_weighted_point *point,
                             const double *inverse_mass) {
  hk_status status = HK_OK;
  for (int c = 0; c < 3 && status == HK_OK; c++) {
    for (size_t j = r->first; j < r->first + r->count; j++)
      memset(s->column + 3 * (size_t)s->particle[j], 0, 3 * sizeof *s->column);
    status = find_column(s, point, inverse_mass, c);
    for (size_t j = r->first; j < r->first + r->count; j++)
      for (int row = 0; row < 3; row++) s->block[j][3 * row + c] += s->column[3 * (size_t)s->particle[j] + (size_t)row];
  }
  return status;
}

/* ---- sums of the columns of carriers ---- */

void hk_body_response_forget(hk_body_impacts *s) {
  s->used = 0;
  s->epoch++;
}

/* A body has as many columns as four impacts have sides. */
static bool are_worth_it(const hk_body_impacts *s, const hk_body_arm *arm) {
  const uint32_t *list;
  return arm->carrier && s->contacts > 2 * s->count &&
         s->bodies->members(s->bodies->self, body_of(s, arm->carrier[0]), &list) <= FEW_MEMBERS;
}

static hk_status make_room_for_carriers(hk_body_impacts *s) {
  if (s->n <= s->carriers_room) return HK_OK;
  hk_status status = hk_reserve(s->host, &s->carrier, &s->carriers_room, s->n, sizeof *s->carrier);
  if (status == HK_OK) memset(s->carrier, 0, s->carriers_room * sizeof *s->carrier);
  return status;
}

/* *first: of the blocks of the body's members for impulses on the carrier. */
static hk_status find_carrier(hk_body_impacts *s, uint32_t carrier, const double *inverse_mass, size_t *first) {
  const uint32_t *list;
  size_t count = s->bodies->members(s->bodies->self, body_of(s, carrier), &list);
  hk_status status = make_room_for_carriers(s);
  if (status != HK_OK || s->carrier[carrier].epoch == s->epoch) {
    if (status == HK_OK) *first = s->carrier[carrier].first;
    return status;
  }
  status = make_room(s, count);
  if (status != HK_OK) return status;
  const hk_body_response r = {.first = s->used, .count = count};
  const hk_weighted_point point = {{carrier, carrier, carrier, carrier}, {1}};
  memcpy(s->particle + s->used, list, count * sizeof *list);
  memset(s->block + s->used, 0, count * sizeof *s->block);
  s->used += count;
  s->carrier[carrier].epoch = s->epoch;
  *first = s->carrier[carrier].first = r.first;
  return add_columns(s, &r, &point, inverse_mass);
}

/* to += the weighted sum of four arrays of `count` numbers. */
HK_INLINE void add_four_arrays(const double *const from[4], const double weight[4], size_t count, double *restrict to) {
  const double *a = from[0], *b = from[1], *c = from[2], *d = from[3];
  for (size_t e = 0; e < count; e++) to[e] += weight[0] * a[e] + weight[1] * b[e] + weight[2] * c[e] + weight[3] * d[e];
}

HK_VERSIONS(static void, add_four, (const double *const from[4], const double weight[4], size_t count, double *to),
            add_four_arrays(from, weight, count, to))

static hk_status add_carriers(hk_body_impacts *s, const hk_body_response *r, const hk_weighted_point *point,
                              const double *inverse_mass) {
  const uint32_t *list;
  size_t first[4], at = r->first, count = s->bodies->members(s->bodies->self, body_of(s, point->particle[0]), &list);
  for (int c = 0; c < 4; c++) {
    hk_status status = find_carrier(s, point->particle[c], inverse_mass, &first[c]);
    if (status != HK_OK) return status;
  }
  while (s->particle[at] != list[0]) at++;
  const double *const from[4] = {s->block[first[0]], s->block[first[1]], s->block[first[2]], s->block[first[3]]};
  HK_WIDEST(s->host->lanes, add_four)(from, point->weight, 9 * count, s->block[at]);
  return HK_OK;
}

static hk_status find_blocks(hk_body_impacts *s, const hk_impact *k, const hk_body_arms *arms,
                             const hk_body_response *r, const double *inverse_mass) {
  hk_status status = HK_OK;
  hk_weighted_point point;
  memset(s->block + r->first, 0, r->count * sizeof *s->block);
  for (int side = 0; side < 2 && arms && status == HK_OK; side++) {
    point = point_of(s, k, arms, side);
    if (point.weight[0] == 0 && point.weight[1] == 0 && point.weight[2] == 0 && point.weight[3] == 0) continue;
    status = are_worth_it(s, &arms->side[side]) ? add_carriers(s, r, &point, inverse_mass)
                                                : add_columns(s, r, &point, inverse_mass);
  }
  if (arms) return status;
  memcpy(point.particle, k->pair.vertex, sizeof point.particle);
  memcpy(point.weight, k->frame.w, sizeof point.weight);
  return add_columns(s, r, &point, inverse_mass);
}

/* The row of the particle in the response; SIZE_MAX: it is not in it. */
static size_t row_of(const hk_body_impacts *s, const hk_body_response *r, uint32_t particle) {
  for (size_t j = r->first; j < r->first + r->count; j++)
    if (s->particle[j] == particle) return j;
  return SIZE_MAX;
}

/* Adds the changes by a unit moment about the axis a, by its part on one side, to s->turn. */
static hk_status add_turns(hk_body_impacts *s, const hk_body_response *r, const hk_body_moments *m, int side, int a) {
  hk_weighted_point point;
  memcpy(point.particle, m->side[side].carrier, sizeof point.particle);
  memcpy(point.weight, m->side[side].weight[a], sizeof point.weight);
  for (size_t j = r->first; j < r->first + r->count; j++)
    memset(s->column + 3 * (size_t)s->particle[j], 0, 3 * sizeof *s->column);
  hk_status status = s->bodies->respond(s->bodies->self, &point, m->push[a], s->column);
  for (size_t j = r->first; j < r->first + r->count; j++)
    for (int c = 0; c < 3; c++) s->turn[j][3 * c + a] += s->column[3 * (size_t)s->particle[j] + (size_t)c];
  return status;
}

/* 1/(kg m^2): the rate of turning about the axis a by a unit moment about it. */
static double inverse_inertia(const hk_body_impacts *s, const hk_body_response *r, const hk_body_moments *m, int a) {
  double sum = 0;
  for (int side = 0; side < 2; side++)
    for (int k = 0; k < 4 && m->side[side].carrier; k++) {
      size_t j = row_of(s, r, m->side[side].carrier[k]);
      for (int c = 0; c < 3 && j != SIZE_MAX; c++)
        sum += m->side[side].weight[a][k] * m->push[a][c] * s->turn[j][3 * c + a];
    }
  return sum;
}

/* s->turn = the changes by unit moments about the axes. */
static hk_status find_turns(hk_body_impacts *s, const hk_body_response *r, hk_body_moments *m) {
  hk_status status = HK_OK;
  memset(s->turn + r->first, 0, r->count * sizeof *s->turn);
  for (int a = 0; a < 3 && status == HK_OK; a++) {
    for (int side = 0; side < 2 && status == HK_OK; side++)
      if (m->side[side].carrier) status = add_turns(s, r, m, side, a);
    m->inverse_inertia[a] = inverse_inertia(s, r, m, a);
  }
  return status;
}

/* The row of the particle in the response; NULL: it is not in it. */
static const double *block_of(const hk_body_impacts *s, const hk_body_response *r, uint32_t particle) {
  size_t j = row_of(s, r, particle);
  return j == SIZE_MAX ? NULL : s->block[j];
}

static void find_matrix(const hk_body_impacts *s, const hk_impact *k, const hk_body_arms *arms, hk_body_response *r) {
  double sum[9] = {0};
  memset(r->G, 0, sizeof r->G);
  for (int i = 0; i < 4; i++) {
    const double *block = k->frame.w[i] != 0 ? block_of(s, r, k->pair.vertex[i]) : NULL;
    for (int c = 0; c < 9 && block; c++) r->G[c] += k->frame.w[i] * block[c];
  }
  for (int side = 0; side < 2 && arms; side++)
    for (int i = 0; i < 4 && arms->side[side].carrier; i++) {
      const double *block = block_of(s, r, arms->side[side].carrier[i]);
      for (int c = 0; c < 9 && block; c++) sum[c] += arms->side[side].weight[i] * block[c];
    }
  if (arms) hk_body_arms_across(sum, k->frame.n, r->G);
}

static bool gives_way(const hk_body_impacts *s, const hk_impact *k) {
  double free_mobility = 0;
  for (int i = 0; i < 4; i++)
    if (k->frame.w[i] != 0)
      free_mobility += k->frame.w[i] * k->frame.w[i] * hk_free_mobility(s->model, k->pair.vertex[i]);
  return k->mobility > held * free_mobility;
}

hk_status hk_body_response_find(hk_body_impacts *s, const hk_contact_solver *solver, const hk_step_move *move, size_t e,
                                const hk_body_response **out) {
  hk_impact *k = &solver->impact[e];
  hk_body_response *r = &s->response[e];
  *out = r;
  if (r->known) return HK_OK;
  hk_status status = list_particles(s, k, r);
  if (status == HK_OK) status = find_blocks(s, k, hk_body_arms_of(s, e), r, move->inverse_mass);
  if (status == HK_OK && hk_body_moments_of(s, e)) status = find_turns(s, r, hk_body_moments_of(s, e));
  if (status == HK_OK) find_matrix(s, k, hk_body_arms_of(s, e), r);
  k->mobility = 0;
  for (int row = 0; row < 3; row++)
    for (int c = 0; c < 3; c++) k->mobility += k->frame.n[row] * r->G[3 * row + c] * k->frame.n[c];
  r->gives_way = gives_way(s, k);
  r->tangent = hk_contact_tangent_of(r->G, k->frame.n);
  r->known = status == HK_OK;
  return status;
}

void hk_body_impulse_set(const hk_body_impacts *s, hk_contact_solver *solver, size_t e, bool speeds, double push,
                         const double slide[3], double *y) {
  hk_impact *k = &solver->impact[e];
  hk_impact_level *level = speeds ? &k->speed : &k->place;
  const hk_body_response *r = &s->response[e];
  double change[3];
  hk_subtract(change, slide, level->slide);
  hk_add_scaled(change, push - level->push, k->frame.n);
  level->push = fmax(0, push);
  hk_copy(level->slide, slide);
  for (size_t j = r->first; j < r->first + r->count; j++) {
    for (size_t c = 0; c < 3; c++) y[3 * (size_t)s->particle[j] + c] += hk_dot(s->block[j] + 3 * c, change);
    solver->moved[s->particle[j]] = solver->touched[s->particle[j]] = solver->now;
  }
}
