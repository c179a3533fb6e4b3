/* The columns U of an impact, found when it first needs an impulse: of the particles of the bodies that its four
 * particles are of, and of those of the four that are in none. */
#include "plugins/common/contact/bodies/impact_response.h"

#include <string.h>

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
  if (!particle || !block) {
    s->host->release(s->host, particle);
    s->host->release(s->host, block);
    return s->host->fail(s->host, HK_NO_MEMORY, "no memory for the response of %zu particles to impacts", room);
  }
  if (s->used) {
    memcpy(particle, s->particle, s->used * sizeof *particle);
    memcpy(block, s->block, s->used * sizeof *block);
  }
  s->host->release(s->host, s->particle);
  s->host->release(s->host, s->block);
  s->particle = particle;
  s->block = block;
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

/* s->column = the changes by a unit impulse along the axis c. */
static hk_status find_column(hk_body_impacts *s, const hk_impact *k, const double *inverse_mass, int c) {
  hk_weighted_point point;
  double unit[3] = {0, 0, 0};
  unit[c] = 1;
  for (int i = 0; i < 4; i++) {
    point.particle[i] = k->pair.vertex[i];
    point.weight[i] = k->frame.w[i];
    memset(s->column + 3 * (size_t)k->pair.vertex[i], 0, 3 * sizeof *s->column);
  }
  for (int i = 0; i < 4; i++)
    if (body_of(s, k->pair.vertex[i]) == UINT32_MAX)
      s->column[3 * (size_t)k->pair.vertex[i] + (size_t)c] += k->frame.w[i] * inverse_mass[k->pair.vertex[i]];
  return s->count ? s->bodies->respond(s->bodies->self, &point, unit, s->column) : HK_OK;
}

hk_status hk_body_response_find(hk_body_impacts *s, const hk_contact_solver *solver, const hk_step_move *move, size_t e,
                                const hk_body_response **out) {
  hk_impact *k = &solver->impact[e];
  hk_body_response *r = &s->response[e];
  *out = r;
  if (r->known) return HK_OK;
  hk_status status = list_particles(s, k, r);
  memset(r->G, 0, sizeof r->G);
  for (int c = 0; c < 3 && status == HK_OK; c++) {
    status = find_column(s, k, move->inverse_mass, c);
    for (size_t j = r->first; j < r->first + r->count; j++)
      for (int row = 0; row < 3; row++) s->block[j][3 * row + c] = s->column[3 * (size_t)s->particle[j] + (size_t)row];
    for (int i = 0; i < 4; i++)
      for (int row = 0; row < 3; row++)
        r->G[3 * row + c] += k->frame.w[i] * s->column[3 * (size_t)k->pair.vertex[i] + (size_t)row];
  }
  k->mobility = 0;
  for (int row = 0; row < 3; row++)
    for (int c = 0; c < 3; c++) k->mobility += k->frame.n[row] * r->G[3 * row + c] * k->frame.n[c];
  r->known = status == HK_OK;
  return status;
}
