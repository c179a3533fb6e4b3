/* Which particles equations join: the connected components of the graph whose vertices are the particles that can move
 * and whose edges are the equations. A particle that a pin holds to the end joins nothing, so that ten pendulums on one
 * nail are ten bodies. A rider is of the body of its carriers, which it joins. The lists are made when they are first
 * asked for and after births and deaths. */
#include "core/numerics/constraints/body_list.h"

#include <stdlib.h>
#include <string.h>

void hk_body_list_free(hk_body_list *s) {
  void *arrays[] = {s->of,   s->member_start, s->member, s->row_start, s->block_at, s->row,      s->block, s->local,
                    s->edge, s->factor_start, s->factor, s->factored,  s->room,     s->response, s->pair};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  *s = (hk_body_list){.table = s->table, .dynamics = s->dynamics};
}

static hk_status no_memory(const hk_body_list *s) {
  return hk_error_set(s->dynamics->error, HK_NO_MEMORY, "no memory for the bodies that %zu equations make",
                      s->equations);
}

static uint32_t root_of(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* first[k]: a movable particle of equation k, or UINT32_MAX. */
static void join(const hk_body_list *s, uint32_t *first) {
  const hk_constraints *c = s->dynamics->constraints;
  for (size_t i = 0; i < s->particles; i++) s->of[i] = (uint32_t)i;
  memset(first, 0xff, s->equations * sizeof *first);
  for (size_t b = 0; b < c->blocks; b++) {
    uint32_t k = c->list.pair[b][0], i = c->list.pair[b][1];
    if (hk_constraint_held(s->dynamics, c->pin[b])) continue;
    if (first[k] == UINT32_MAX) first[k] = i;
    uint32_t one = root_of(s->of, first[k]), other = root_of(s->of, i);
    s->of[one > other ? one : other] = one > other ? other : one;
  }
}

/* Riders with those of their carriers that are in equations; marked: room for a number per particle. */
static void join_riders(const hk_body_list *s, uint32_t *marked) {
  const hk_model *m = &s->dynamics->state->model;
  const hk_constraints *c = s->dynamics->constraints;
  if (m->riders == 0) return;
  memset(marked, 0, s->particles * sizeof *marked);
  for (size_t b = 0; b < c->blocks; b++) marked[c->list.pair[b][1]] |= !hk_constraint_held(s->dynamics, c->pin[b]);
  for (size_t r = 0; r < m->riders; r++)
    for (uint32_t k = 0; k < m->rider[r].carriers; k++) {
      if (!marked[m->rider[r].carrier[k]]) continue;
      uint32_t one = root_of(s->of, m->rider[r].carrier[k]), other = root_of(s->of, m->rider[r].particle);
      s->of[one > other ? one : other] = one > other ? other : one;
    }
}

/* From roots to numbers of bodies, by their first particles; who is in no equation is in none. */
static void number(hk_body_list *s, const uint32_t *first, uint32_t *body_at) {
  memset(body_at, 0xff, s->particles * sizeof *body_at);
  for (size_t i = 0; i < s->particles; i++) s->of[i] = root_of(s->of, (uint32_t)i);
  for (size_t k = 0; k < s->equations; k++)
    if (first[k] != UINT32_MAX) body_at[s->of[first[k]]] = 0;
  for (size_t i = 0; i < s->particles; i++)
    if (s->of[i] == i && body_at[i] == 0) body_at[i] = (uint32_t)s->count++;
  for (size_t i = 0; i < s->particles; i++) s->of[i] = body_at[s->of[i]];
}

/* The items with body[item] = b, for all b one after the other, each list rising. */
static void sort_by_body(size_t bodies, const uint32_t *body, size_t count, size_t *start, uint32_t *item) {
  for (size_t e = 0; e < count; e++)
    if (body[e] != UINT32_MAX) start[body[e] + 1]++;
  for (size_t b = 0; b < bodies; b++) start[b + 1] += start[b];
  for (size_t e = 0; e < count; e++)
    if (body[e] != UINT32_MAX) item[start[body[e]]++] = (uint32_t)e;
  for (size_t b = bodies; b > 0; b--) start[b] = start[b - 1];
  start[0] = 0;
}

/* `body`: room for as many numbers as there are equations or blocks. */
static void list(hk_body_list *s, const uint32_t *first, uint32_t *body) {
  const hk_constraints *c = s->dynamics->constraints;
  sort_by_body(s->count, s->of, s->particles, s->member_start, s->member);
  for (size_t k = 0; k < s->equations; k++) body[k] = first[k] == UINT32_MAX ? UINT32_MAX : s->of[first[k]];
  sort_by_body(s->count, body, s->equations, s->row_start, s->row);
  for (size_t b = 0; b < c->blocks; b++) {
    uint32_t k = first[c->list.pair[b][0]];
    body[b] = k == UINT32_MAX ? UINT32_MAX : s->of[k];
  }
  sort_by_body(s->count, body, c->blocks, s->block_at, s->block);
  for (size_t b = 0; b < s->count; b++)
    for (size_t e = s->row_start[b]; e < s->row_start[b + 1]; e++)
      s->local[s->row[e]] = (uint32_t)(e - s->row_start[b]);
}

/* The pairs of particles that equations of two particles join, in the order of the equations. `seen`: how many blocks
 * an equation has. */
static void find_edges(hk_body_list *s, uint32_t *seen) {
  const hk_constraints *c = s->dynamics->constraints;
  memset(seen, 0, s->equations * sizeof *seen);
  for (size_t b = 0; b < c->blocks; b++) seen[c->list.pair[b][0]]++;
  for (size_t b = 0; b + 1 < c->blocks; b++) {
    const uint32_t *one = c->list.pair[b], *other = c->list.pair[b + 1];
    if (one[0] != other[0] || seen[one[0]] != 2) continue;
    const uint32_t *last = s->edges ? s->edge[s->edges - 1] : NULL;
    if (last && last[0] == one[1] && last[1] == other[1]) continue; /* those of one place have three equations */
    s->edge[s->edges][0] = one[1];
    s->edge[s->edges++][1] = other[1];
  }
}

static hk_status find_factors(hk_body_list *s) {
  for (size_t b = 0; b < s->count; b++) {
    size_t m = s->row_start[b + 1] - s->row_start[b];
    s->factor_start[b + 1] = s->factor_start[b] + (m <= HK_DENSE_BODY ? m * m : 0);
  }
  s->factor = malloc((s->factor_start[s->count] + 1) * sizeof *s->factor);
  return s->factor ? HK_OK : no_memory(s);
}

static hk_status allocate(hk_body_list *s) {
  size_t n = s->particles, m = s->equations, blocks = s->dynamics->constraints->blocks;
  s->of = malloc((n + 1) * sizeof *s->of);
  s->member = malloc((n + 1) * sizeof *s->member);
  s->member_start = calloc(n + 2, sizeof *s->member_start);
  s->row_start = calloc(n + 2, sizeof *s->row_start);
  s->block_at = calloc(n + 2, sizeof *s->block_at);
  s->factor_start = calloc(n + 2, sizeof *s->factor_start);
  s->factored = calloc(n + 1, sizeof *s->factored);
  s->row = malloc((m + 1) * sizeof *s->row);
  s->local = calloc(m + 1, sizeof *s->local);
  s->room = malloc((m + 1) * sizeof *s->room);
  s->block = malloc((blocks + 1) * sizeof *s->block);
  s->edge = malloc((m + 1) * sizeof *s->edge);
  s->pair = malloc((m + 1) * sizeof *s->pair);
  s->response = calloc(3 * n + 1, sizeof *s->response);
  bool fine = s->of && s->member && s->member_start && s->row_start && s->block_at && s->factor_start && s->factored;
  fine &= s->row && s->local && s->room && s->block && s->edge && s->response && s->pair;
  return fine ? HK_OK : no_memory(s);
}

static hk_status build(hk_body_list *s) {
  const hk_constraints *c = s->dynamics->constraints;
  s->particles = s->dynamics->state->model.n;
  s->equations = c->equations;
  uint32_t *first = malloc((s->equations + 1) * sizeof *first);
  size_t most = s->equations + c->blocks + s->particles + 1;
  uint32_t *room = malloc(most * sizeof *room);
  hk_status status = allocate(s);
  if (!first || !room) status = no_memory(s);
  if (status == HK_OK) {
    join(s, first);
    join_riders(s, s->member);
    number(s, first, room);
    list(s, first, room);
    find_edges(s, room);
    status = find_factors(s);
  }
  free(first);
  free(room);
  return status;
}

hk_status hk_body_list_update(hk_body_list *s) {
  const hk_constraints *c = s->dynamics->constraints;
  if (s->known && s->revision == (c ? c->revision : 0)) return HK_OK;
  hk_body_list_free(s);
  hk_status status = c && c->equations ? build(s) : HK_OK;
  if (status != HK_OK) hk_body_list_free(s);
  s->known = status == HK_OK;
  s->revision = c ? c->revision : 0;
  return status;
}
