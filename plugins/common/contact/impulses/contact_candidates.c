/* See contact_candidates.h. All loops over pairs are parallel and write to their own places; what follows from them is
 * collected in the order of the list. */
#include "plugins/common/contact/impulses/contact_candidates.h"

#include "plugins/common/space/reserve.h"

#include <stdlib.h>
#include <string.h>

enum { GRAIN = 256 };

typedef struct work {
  hk_contact_candidates *s;
  const hk_step_move *move;
} work;

/* ---- the narrow phase of all active pairs ---- */

/* The result of the last narrow phase, if it still holds. */
static const hk_narrow_phase *known_result(const hk_contact_candidates *s, uint32_t k) {
  uint32_t d = s->before_at[k];
  if (d >= s->befores || s->before_index[d] != k) return NULL;
  for (int i = 0; i < 4; i++)
    if (s->touched[s->cache->pair[k].vertex[i]] > s->since) return NULL;
  return &s->before[d];
}

static void examine_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const work *w = context;
  hk_pair_cache *cache = w->s->cache;
  (void)chunk;
  for (size_t d = begin; d < end; d++) {
    const hk_feature_pair *pair = &cache->pair[cache->index[d]];
    const hk_narrow_phase *known = w->s->befores ? known_result(w->s, cache->index[d]) : NULL;
    if (known) {
      w->s->result[d] = *known;
      continue;
    }
    w->s->result[d] = hk_narrow_phase_of(pair, w->move, w->s->slack, cache->reach);
    if (w->s->result[d].gap_from > 0) hk_pair_cache_set_gap(cache, cache->index[d], w->s->result[d].gap_from);
  }
}

void hk_contact_candidates_begin(hk_contact_candidates *s) {
  if (s->pushed_before) memset(s->pushed_before, 0, s->room * sizeof *s->pushed_before);
  s->pushes = 0;
  s->befores = 0;
  s->touched = NULL;
  s->solved = false;
}

/* Keeps the last results of a step beside the new ones. */
static void keep_results(hk_contact_candidates *s) {
  hk_narrow_phase *kept = s->result;
  s->result = s->before;
  s->before = kept;
  s->befores = s->touched ? s->examined : 0;
  for (size_t d = 0; d < s->befores; d++) s->before_at[s->before_index[d]] = (uint32_t)d;
}

/* ---- pairs that were pushed in this step, found again in a new list ---- */

/* A search may find an edge and another one in either order. */
static int compare_pairs(const void *a, const void *b) {
  const hk_feature_pair *pair[] = {a, b};
  uint64_t key[2][2];
  for (int k = 0; k < 2; k++) {
    const uint32_t *v = pair[k]->vertex;
    uint64_t one = (uint64_t)v[0] << 32 | v[1], other = (uint64_t)v[2] << 32 | v[3];
    bool swap = pair[k]->kind == HK_EDGE_EDGE && other < one;
    key[k][0] = swap ? other : one;
    key[k][1] = swap ? one : other;
  }
  if (pair[0]->kind != pair[1]->kind) return pair[0]->kind < pair[1]->kind ? -1 : 1;
  for (int c = 0; c < 2; c++)
    if (key[0][c] != key[1][c]) return key[0][c] < key[1][c] ? -1 : 1;
  return 0;
}

static void recall(hk_contact_candidates *s) {
  memset(s->pushed_before, 0, s->room * sizeof *s->pushed_before);
  if (s->pushes == 0) return;
  qsort(s->pushed, s->pushes, sizeof *s->pushed, compare_pairs);
  for (size_t d = 0; d < s->cache->active; d++) {
    uint32_t k = s->cache->index[d];
    s->pushed_before[k] = bsearch(&s->cache->pair[k], s->pushed, s->pushes, sizeof *s->pushed, compare_pairs);
  }
}

static hk_status make_room_for_pushed(hk_contact_candidates *s, size_t more) {
  const hk_host *host = s->cache->host;
  size_t room = s->pushes + more;
  if (room <= s->pushed_room) return HK_OK;
  room += room / 2;
  hk_feature_pair *grown = host->allocate(host, room * sizeof *grown);
  if (!grown) return host->fail(host, HK_NO_MEMORY, "no memory for %zu impacts", room);
  if (s->pushes) memcpy(grown, s->pushed, s->pushes * sizeof *grown);
  host->release(host, s->pushed);
  s->pushed = grown;
  s->pushed_room = room;
  return HK_OK;
}

/* ---- the candidates ---- */

static hk_status make_room(hk_contact_candidates *s) {
  const hk_host *host = s->cache->host;
  size_t room = s->cache->room;
  if (s->room < room) {
    hk_contact_candidates_free(s);
    s->result = host->allocate(host, room * sizeof *s->result);
    s->before = host->allocate(host, room * sizeof *s->before);
    s->before_index = host->allocate(host, room * sizeof *s->before_index);
    s->before_at = host->allocate(host, room * sizeof *s->before_at);
    s->candidate = host->allocate(host, room * sizeof *s->candidate);
    s->chosen = host->allocate(host, room * sizeof *s->chosen);
    s->pushed_before = host->allocate(host, room * sizeof *s->pushed_before);
    if (!s->result || !s->before || !s->before_index || !s->before_at || !s->candidate || !s->chosen ||
        !s->pushed_before)
      return host->fail(host, HK_NO_MEMORY, "no memory for %zu pairs", room);
    s->room = room;
  }
  if (s->searches != s->cache->searches) {
    s->touched = NULL; /* pairs are numbered anew */
    if (s->pushed_before) recall(s);
  }
  s->searches = s->cache->searches;
  return HK_OK;
}

static bool is_unsolved(const hk_contact_candidates *s, size_t d) {
  const hk_narrow_phase *p = &s->result[d];
  bool new = p->on_the_way && !s->pushed_before[s->cache->index[d]];
  return p->state == HK_PAIR_OVERLAPS || (p->state == HK_PAIR_CLOSES && new) ||
         (p->state == HK_PAIR_CLOSES && !s->solved);
}

/* Features that touch at the start have no normal: they are not safe, and no impact can help. */
static void collect(hk_contact_candidates *s) {
  s->count = s->unsafe = s->unsolved = 0;
  s->closest = INFINITY;
  for (size_t d = 0; d < s->cache->active; d++) {
    const hk_narrow_phase *p = &s->result[d];
    if (p->gap_from < s->closest) s->closest = p->gap_from;
    if (p->state == HK_PAIR_APART) continue;
    uint32_t k = s->cache->index[d];
    if (p->state == HK_PAIR_UNSAFE && s->unsafe++ == 0) s->first = k;
    s->unsolved += is_unsolved(s, d);
    if (p->gap_from > -s->cache->pair[k].offset) s->candidate[s->count++] = (uint32_t)d;
  }
}

hk_status hk_contact_candidates_find(hk_contact_candidates *s, const hk_step_move *move) {
  hk_status status = make_room(s);
  if (status != HK_OK) return status;
  work w = {s, move};
  keep_results(s);
  s->cache->host->parallel_for(s->cache->host, s->cache->active, GRAIN, examine_chunk, &w);
  s->examined = s->cache->active;
  if (s->examined) memcpy(s->before_index, s->cache->index, s->examined * sizeof *s->before_index);
  collect(s);
  return HK_OK;
}

/* ---- their impacts ---- */

static void build_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const work *w = context;
  const hk_contact_candidates *s = w->s;
  (void)chunk;
  for (size_t e = begin; e < end; e++) {
    const hk_narrow_phase *p = &s->result[s->chosen[e]];
    uint32_t k = s->cache->index[s->chosen[e]];
    s->impact[e].pair = s->cache->pair[k];
    s->impact[e].pair.gap = p->gap_from;
    s->impact[e].frame = p->frame;
    hk_impact_set(&s->impact[e], w->move, s->restitution, s->pushed_before[k]);
  }
}

static bool is_chosen(const hk_narrow_phase *p, hk_candidate_kind kind) {
  return kind == HK_CANDIDATES_ALL || (kind == HK_CANDIDATES_CLOSED ? p->gap_from < 0 : p->state == HK_PAIR_UNSAFE);
}

hk_status hk_contact_candidates_impacts(hk_contact_candidates *s, const hk_step_move *move, hk_candidate_kind kind,
                                        hk_contact_solver *out) {
  hk_status status = hk_reserve(s->cache->host, &s->impact, &s->impacts_room, s->count, sizeof *s->impact);
  if (status != HK_OK) return status;
  s->chosen_count = 0;
  for (size_t e = 0; e < s->count; e++)
    if (is_chosen(&s->result[s->candidate[e]], kind)) s->chosen[s->chosen_count++] = s->candidate[e];
  status = make_room_for_pushed(s, s->chosen_count);
  if (status != HK_OK) return status;
  work w = {s, move};
  s->cache->host->parallel_for(s->cache->host, s->chosen_count, GRAIN, build_chunk, &w);
  out->count = s->chosen_count;
  out->impact = s->impact;
  return HK_OK;
}

void hk_contact_candidates_remember(hk_contact_candidates *s, const hk_contact_solver *solved) {
  for (size_t e = 0; e < s->chosen_count; e++) {
    uint32_t k = s->cache->index[s->chosen[e]];
    bool pushes = e >= solved->count || solved->impact[e].place.push > 0;
    if (!pushes || s->pushed_before[k]) continue;
    s->pushed_before[k] = true;
    s->pushed[s->pushes++] = s->cache->pair[k];
  }
  s->solved = true;
}

bool hk_contact_candidates_return(const hk_contact_candidates *s, const uint64_t *moved, uint64_t since) {
  for (size_t e = 0; e < s->count; e++) {
    if (!s->result[s->candidate[e]].enters) continue;
    const uint32_t *vertex = s->cache->pair[s->cache->index[s->candidate[e]]].vertex;
    for (int i = 0; i < 4; i++)
      if (hk_model_moves(s->cache->model, vertex[i]) && moved[vertex[i]] > since) return true;
  }
  return false;
}

hk_closed_candidates hk_contact_candidates_closed(const hk_contact_candidates *s) {
  hk_closed_candidates all = {0};
  for (size_t d = 0; d < s->cache->active; d++) {
    double depth = -s->result[d].gap_from;
    all.count += depth > s->slack;
    if (!(depth > fmax(s->slack, all.depth))) continue;
    all.depth = depth;
    all.pair = &s->cache->pair[s->cache->index[d]];
  }
  return all;
}

void hk_contact_candidates_free(hk_contact_candidates *s) {
  const hk_host *host = s->cache->host;
  host->release(host, s->result);
  host->release(host, s->before);
  host->release(host, s->before_index);
  host->release(host, s->before_at);
  host->release(host, s->candidate);
  host->release(host, s->chosen);
  host->release(host, s->pushed_before);
  s->result = s->before = NULL, s->before_index = s->before_at = s->candidate = s->chosen = NULL,
  s->pushed_before = NULL;
  s->befores = s->examined = 0;
  s->room = 0;
}
