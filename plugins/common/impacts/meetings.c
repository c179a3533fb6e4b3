/* See meetings.h. All loops over pairs are parallel and write to their own places; what follows from them is collected
 * in the order of the list. */
#include "plugins/common/impacts/meetings.h"

#include "plugins/common/collision/ccd.h"
#include "plugins/common/space/vector3.h"

#include <stdlib.h>
#include <string.h>

enum { GRAIN = 256 };

/* Of the thickness, and of the distance at the start: a pair that comes nearer is not safe. Half leaves the next steps
 * as much; above, rounding is far away and the normal of a pair well known. */
static const double least_part = 0.1, least_of_start = 0.5;

/* Where a pair moves by more than this part of its distance, the instant of contact is searched. Else its shape at the
 * end is on the side on which it was, and good for the impact: a linear gap with the normal of the start would close
 * where features slide past each other, as edges of two meshes do that lie on each other. */
static const double fast = 0.5;

/* Of the thickness: how near to it the instant of contact is found. */
static const double instant = 0.01;

typedef enum pair_state { APART, MAY_MEET, CLOSES, OVERLAPS, UNSAFE } pair_state;

typedef struct hk_pair_look {
  double gap_from, gap_to; /* m */
  double n[3], w[4];
  pair_state state;
  bool on_the_way; /* the gap closes before the end */
  bool enters;     /* it goes into each other, fast: see goes_in */
} hk_pair_look;

typedef struct work {
  hk_meetings *s;
  const hk_step_move *move;
} work;

static void take_shape(hk_pair_look *look, const hk_nearest *near) {
  double distance = sqrt(near->squared);
  for (int c = 0; c < 3; c++) look->n[c] = near->d[c] / distance;
  memcpy(look->w, near->w, sizeof look->w);
}

static void take_shape_at(hk_pair_look *look, hk_pair_kind kind, const hk_pair_path *path, double when) {
  double x[12];
  for (int i = 0; i < 12; i++) x[i] = path->from[i] + when * (path->to[i] - path->from[i]);
  hk_nearest near = hk_nearest_of_pair(kind, x);
  take_shape(look, &near);
}

/* Of the nearest points of the look along its normal, or, for y = v, its rate. */
static double distance_along(const hk_pair_look *look, const double y[12]) {
  double sum = 0;
  for (int i = 0; i < 4; i++) sum += look->w[i] * hk_dot(look->n, y + 3 * (size_t)i);
  return sum;
}

/* A fast pair, whose shape at the end may be that of another place: it meets, with the shape of the instant at which
 * its gap closes, or it is left alone, also where it only touches at that instant. Where impulses on others turn it,
 * the next look finds what it then meets. */
static void look_at_fast(const hk_surface_pair *pair, const hk_pair_path *path, double from, double motion,
                         hk_pair_look *look) {
  double least = fmin(least_part * pair->offset, least_of_start * from), to = look->gap_to + pair->offset, when;
  hk_pair_look there = *look;
  if (from > pair->offset) {
    if (!hk_ccd(pair->kind, path->from, path->to, pair->offset, instant * pair->offset, &when)) return;
    take_shape_at(&there, pair->kind, path, when);
    there.on_the_way = distance_along(&there, path->to) < pair->offset;
  }
  if ((from + to - motion) / 2 <= least && hk_ccd(pair->kind, path->from, path->to, least, instant * least, &when)) {
    there.state = UNSAFE;
    if (!there.on_the_way) take_shape_at(&there, pair->kind, path, when);
  }
  if (there.on_the_way || there.state == UNSAFE) *look = there;
}

static pair_state state_of(const hk_meetings *s, const hk_pair_look *look, double motion, bool is_fast) {
  if (look->state == UNSAFE) return UNSAFE;
  if (look->gap_to < fmin(0, look->gap_from) / 2 - s->slack) return OVERLAPS;
  if (look->gap_to < 0 || look->on_the_way) return CLOSES;
  return is_fast || look->gap_to > motion ? APART : MAY_MEET;
}

/* It is closed at the end, and that by more than a slow pair moves, or would be after a further step with the speed of
 * the end. What rests or slides on another has no such speed. */
static bool goes_in(const hk_surface_pair *pair, const hk_pair_path *path, const hk_step_move *move,
                    const hk_pair_look *look) {
  double v[12], gap = distance_along(look, path->to) - pair->offset;
  hk_pair_gather(v, pair, move->v);
  return gap < 0 && gap + fmin(0, move->h * distance_along(look, v)) < -fast * pair->offset;
}

static void look_at(const hk_meetings *s, const hk_surface_pair *pair, const hk_step_move *move, hk_pair_look *look) {
  hk_pair_path path;
  hk_pair_path_of(&path, pair, move->x_from, move->x);
  double from = sqrt(hk_nearest_of_pair(pair->kind, path.from).squared), motion = hk_pair_motion(pair->kind, &path);
  *look = (hk_pair_look){.gap_from = from - pair->offset, .gap_to = INFINITY};
  if (look->gap_from > motion) return;
  hk_nearest end = hk_nearest_of_pair(pair->kind, path.to);
  bool is_fast = motion > fast * from;
  look->gap_to = sqrt(end.squared) - pair->offset;
  if (end.squared > 0) take_shape(look, &end);
  if (is_fast) look_at_fast(pair, &path, from, motion, look);
  look->state = state_of(s, look, motion, is_fast);
  look->enters = look->state == UNSAFE || goes_in(pair, &path, move, look);
}

/* The last look, if it still holds. */
static const hk_pair_look *known_look(const hk_meetings *s, uint32_t k) {
  uint32_t d = s->before_at[k];
  if (d >= s->befores || s->before_index[d] != k) return NULL;
  for (int i = 0; i < 4; i++)
    if (s->touched[s->nearby->pair[k].vertex[i]] > s->since) return NULL;
  return &s->before[d];
}

static void look_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const work *w = context;
  hk_nearby *near = w->s->nearby;
  (void)chunk;
  for (size_t d = begin; d < end; d++) {
    const hk_surface_pair *pair = &near->pair[near->index[d]];
    const hk_pair_look *known = w->s->befores ? known_look(w->s, near->index[d]) : NULL;
    if (known) {
      w->s->look[d] = *known;
      continue;
    }
    look_at(w->s, pair, w->move, &w->s->look[d]);
    if (w->s->look[d].gap_from > 0) hk_nearby_put_off(near, near->index[d], w->s->look[d].gap_from);
  }
}

void hk_meetings_begin(hk_meetings *s) {
  if (s->met) memset(s->met, 0, s->room * sizeof *s->met);
  s->pushes = 0;
  s->befores = 0;
  s->touched = NULL;
  s->solved = false;
}

/* Keeps the last look of a step beside the new one. */
static void keep_look(hk_meetings *s) {
  hk_pair_look *kept = s->look;
  s->look = s->before;
  s->before = kept;
  s->befores = s->touched ? s->looked : 0;
  for (size_t d = 0; d < s->befores; d++) s->before_at[s->before_index[d]] = (uint32_t)d;
}

/* ---- pairs that were pushed in this step, found again in a new list ---- */

/* A search may find an edge and another one in either order. */
static int compare_pairs(const void *a, const void *b) {
  const hk_surface_pair *pair[] = {a, b};
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

static void recall(hk_meetings *s) {
  memset(s->met, 0, s->room * sizeof *s->met);
  if (s->pushes == 0) return;
  qsort(s->pushed, s->pushes, sizeof *s->pushed, compare_pairs);
  for (size_t d = 0; d < s->nearby->dues; d++) {
    uint32_t k = s->nearby->index[d];
    s->met[k] = bsearch(&s->nearby->pair[k], s->pushed, s->pushes, sizeof *s->pushed, compare_pairs);
  }
}

static hk_status make_room_for_pushed(hk_meetings *s, size_t more) {
  const hk_host *host = s->nearby->host;
  size_t room = s->pushes + more;
  if (room <= s->pushed_room) return HK_OK;
  room += room / 2;
  hk_surface_pair *grown = host->allocate(host, room * sizeof *grown);
  if (!grown) return host->fail(host, HK_NO_MEMORY, "no memory for %zu impacts", room);
  if (s->pushes) memcpy(grown, s->pushed, s->pushes * sizeof *grown);
  host->release(host, s->pushed);
  s->pushed = grown;
  s->pushed_room = room;
  return HK_OK;
}

/* ---- what they do ---- */

static hk_status make_room(hk_meetings *s) {
  const hk_host *host = s->nearby->host;
  size_t room = s->nearby->room;
  if (s->room < room) {
    hk_meetings_free(s);
    s->look = host->allocate(host, room * sizeof *s->look);
    s->before = host->allocate(host, room * sizeof *s->before);
    s->before_index = host->allocate(host, room * sizeof *s->before_index);
    s->before_at = host->allocate(host, room * sizeof *s->before_at);
    s->meeting = host->allocate(host, room * sizeof *s->meeting);
    s->chosen = host->allocate(host, room * sizeof *s->chosen);
    s->met = host->allocate(host, room * sizeof *s->met);
    if (!s->look || !s->before || !s->before_index || !s->before_at || !s->meeting || !s->chosen || !s->met)
      return host->fail(host, HK_NO_MEMORY, "no memory for %zu pairs", room);
    s->room = room;
  }
  if (s->searches != s->nearby->searches) {
    s->touched = NULL; /* pairs are numbered anew */
    if (s->met) recall(s);
  }
  s->searches = s->nearby->searches;
  return HK_OK;
}

static bool is_unsolved(const hk_meetings *s, size_t d) {
  const hk_pair_look *look = &s->look[d];
  bool new = look->on_the_way && !s->met[s->nearby->index[d]];
  return look->state == OVERLAPS || (look->state == CLOSES && new) || (look->state == CLOSES && !s->solved);
}

/* Features that touch at the start have no normal: they are not safe, and no impact can help. */
static void collect(hk_meetings *s) {
  s->meetings = s->unsafe = s->unsolved = 0;
  s->closest = INFINITY;
  for (size_t d = 0; d < s->nearby->dues; d++) {
    const hk_pair_look *look = &s->look[d];
    if (look->gap_from < s->closest) s->closest = look->gap_from;
    if (look->state == APART) continue;
    uint32_t k = s->nearby->index[d];
    if (look->state == UNSAFE && s->unsafe++ == 0) s->first = k;
    s->unsolved += is_unsolved(s, d);
    if (look->gap_from > -s->nearby->pair[k].offset) s->meeting[s->meetings++] = (uint32_t)d;
  }
}

hk_status hk_meetings_look(hk_meetings *s, const hk_step_move *move) {
  hk_status status = make_room(s);
  if (status != HK_OK) return status;
  work w = {s, move};
  keep_look(s);
  s->nearby->host->parallel_for(s->nearby->host, s->nearby->dues, GRAIN, look_chunk, &w);
  s->looked = s->nearby->dues;
  if (s->looked) memcpy(s->before_index, s->nearby->index, s->looked * sizeof *s->before_index);
  collect(s);
  return HK_OK;
}

/* ---- their impacts ---- */

static void build_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const work *w = context;
  const hk_meetings *s = w->s;
  (void)chunk;
  for (size_t e = begin; e < end; e++) {
    const hk_pair_look *look = &s->look[s->chosen[e]];
    uint32_t k = s->nearby->index[s->chosen[e]];
    hk_meeting meeting = {.gap_from = look->gap_from, .restitution = s->restitution, .again = s->met[k]};
    memcpy(meeting.n, look->n, sizeof meeting.n);
    memcpy(meeting.w, look->w, sizeof meeting.w);
    hk_impact_of(&s->impact[e], &s->nearby->pair[k], w->move, &meeting);
  }
}

static hk_status make_room_for_impacts(hk_meetings *s) {
  const hk_host *host = s->nearby->host;
  size_t room = s->meetings + s->meetings / 2 + 1;
  if (s->impacts_room > s->meetings) return HK_OK;
  host->release(host, s->impact);
  s->impacts_room = 0;
  s->impact = host->allocate(host, room * sizeof *s->impact);
  if (!s->impact) return host->fail(host, HK_NO_MEMORY, "no memory for %zu impacts", s->meetings);
  s->impacts_room = room;
  return HK_OK;
}

static bool is_chosen(const hk_pair_look *look, hk_meetings_kind kind) {
  return kind == HK_MEETINGS_ALL || (kind == HK_MEETINGS_CLOSED ? look->gap_from < 0 : look->state == UNSAFE);
}

hk_status hk_meetings_impacts(hk_meetings *s, const hk_step_move *move, hk_meetings_kind kind, hk_impacts *out) {
  hk_status status = make_room_for_impacts(s);
  if (status != HK_OK) return status;
  s->choice = 0;
  for (size_t e = 0; e < s->meetings; e++)
    if (is_chosen(&s->look[s->meeting[e]], kind)) s->chosen[s->choice++] = s->meeting[e];
  status = make_room_for_pushed(s, s->choice);
  if (status != HK_OK) return status;
  work w = {s, move};
  s->nearby->host->parallel_for(s->nearby->host, s->choice, GRAIN, build_chunk, &w);
  out->count = s->choice;
  out->impact = s->impact;
  return HK_OK;
}

void hk_meetings_remember(hk_meetings *s, const hk_impacts *solved) {
  for (size_t e = 0; e < solved->count; e++) {
    uint32_t k = s->nearby->index[s->chosen[e]];
    if (!(solved->impact[e].place.push > 0) || s->met[k]) continue;
    s->met[k] = true;
    s->pushed[s->pushes++] = s->nearby->pair[k];
  }
  s->solved = true;
}

bool hk_meetings_again(const hk_meetings *s, const hk_step_move *move, const uint64_t *moved, uint64_t since) {
  for (size_t e = 0; e < s->meetings; e++) {
    if (!s->look[s->meeting[e]].enters) continue;
    const uint32_t *vertex = s->nearby->pair[s->nearby->index[s->meeting[e]]].vertex;
    for (int i = 0; i < 4; i++)
      if (move->inverse_mass[vertex[i]] > 0 && moved[vertex[i]] > since) return true;
  }
  return false;
}

hk_meetings_closed hk_meetings_closed_at_start(const hk_meetings *s) {
  hk_meetings_closed all = {0};
  for (size_t d = 0; d < s->nearby->dues; d++) {
    double depth = -s->look[d].gap_from;
    all.count += depth > s->slack;
    if (!(depth > fmax(s->slack, all.depth))) continue;
    all.depth = depth;
    all.pair = &s->nearby->pair[s->nearby->index[d]];
  }
  return all;
}

void hk_meetings_free(hk_meetings *s) {
  const hk_host *host = s->nearby->host;
  host->release(host, s->look);
  host->release(host, s->before);
  host->release(host, s->before_index);
  host->release(host, s->before_at);
  host->release(host, s->meeting);
  host->release(host, s->chosen);
  host->release(host, s->met);
  s->look = s->before = NULL, s->before_index = s->before_at = s->meeting = s->chosen = NULL, s->met = NULL;
  s->befores = s->looked = 0;
  s->room = 0;
}
