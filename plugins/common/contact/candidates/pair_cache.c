/* Three budgets of approach. Of the pairing: patches that are not paired were farther apart than reach and
 * pairing_skin. Of a group: pairs that are not in its list were farther apart than reach and skin, or the boxes of its
 * patches were. Of a pair: its last gap. All are compared with a path that only grows, the sum of the patches'
 * approaches from one measurement to the next. What a search finds is complete for its own move, however fast, and for
 * moves from the same start whose ends differ from it by less than the skin. */
#include "plugins/common/contact/candidates/pair_cache.h"

#include "plugins/common/space/reserve.h"

#include <string.h>

enum { PAIRS = 256 };

/* Relative, of distances: far above rounding, far below what shows. */
static const double margin = 1e-9;

/* Of the mean size of a patch: how far beyond reach patches are paired. Further, more of them are paired; nearer, more
 * often. */
static const double pairing_part = 0.25;

static double twice_the_largest(const hk_pair_cache *s, const double *a, const double *b) {
  return 2 * hk_largest_displacement(s->host, s->n, a, b, s->chunk) * (1 + margin);
}

static hk_status no_memory(const hk_pair_cache *s, size_t count, const char *what) {
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu %s", count, what);
}

static void forget(hk_pair_cache *s) {
  s->count = s->groups = s->active = 0;
  s->paired = false;
  s->searches++;
}

hk_status hk_pair_cache_open(hk_pair_cache *s, const hk_host *host, const hk_view *view, const hk_surfaces *surfaces,
                             double skin) {
  void *old[] = {s->last, s->at, s->end, s->moves, s->end_moves, s->held, s->chunk};
  for (int k = 0; k < 7; k++) host->release(host, old[k]);
  s->host = host;
  s->surfaces = surfaces;
  s->model = view->model;
  s->skin = skin;
  s->n = view->n;
  s->loose = 0;
  forget(s);
  hk_status status = hk_moving_patches_open(&s->patches, host, surfaces, view->model);
  if (status != HK_OK) return status;
  size_t patches = s->patches.table->count + 1, size = (3 * s->n + 1) * sizeof(double);
  s->last = host->allocate(host, size);
  s->at = host->allocate(host, size);
  s->end = host->allocate(host, size);
  s->chunk = host->allocate(host, (s->n / HK_DISPLACEMENT_CHUNK + 1) * sizeof *s->chunk);
  s->moves = host->allocate(host, patches * sizeof *s->moves);
  s->end_moves = host->allocate(host, patches * sizeof *s->end_moves);
  s->held = host->allocate(host, s->n + 1);
  if (!s->last || !s->at || !s->end || !s->chunk || !s->moves || !s->end_moves || !s->held)
    return no_memory(s, s->n, "particles");
  memcpy(s->last, view->x, 3 * s->n * sizeof *s->last);
  memcpy(s->at, view->x, 3 * s->n * sizeof *s->at);
  return HK_OK;
}

/* ---- memory of pairs ---- */

/* Moves the pairs of all groups together, into memory with room for more. */
static hk_status repack(hk_pair_cache *s, size_t more) {
  const hk_host *host = s->host;
  size_t count = 0, live = 0;
  for (size_t g = 0; g < s->groups; g++) live += s->group[g].count;
  size_t room = 2 * (live + more) + 64;
  hk_feature_pair *pair = host->allocate(host, room * sizeof *pair);
  double *budget = host->allocate(host, room * sizeof *budget);
  uint32_t *group_of = host->allocate(host, room * sizeof *group_of);
  bool fine = pair && budget && group_of;
  for (size_t g = 0; fine && g < s->groups; g++) {
    hk_pair_group *group = &s->group[g];
    if (group->count) {
      memcpy(pair + count, s->pair + group->start, group->count * sizeof *pair);
      memcpy(budget + count, s->budget + group->start, group->count * sizeof *budget);
    }
    for (size_t k = 0; k < group->count; k++) group_of[count + k] = (uint32_t)g;
    group->start = count;
    group->room = group->count;
    count += group->count;
  }
  void *old[] = {fine ? (void *)s->pair : pair, fine ? (void *)s->budget : budget,
                 fine ? (void *)s->group_of : group_of};
  for (int k = 0; k < 3; k++) host->release(host, old[k]);
  if (!fine) return no_memory(s, room, "pairs");
  s->pair = pair, s->budget = budget, s->group_of = group_of;
  s->count = count;
  s->room = room;
  s->searches++;
  return HK_OK;
}

static hk_status make_room(hk_pair_cache *s, hk_pair_group *group, size_t count) {
  size_t room = count + count / 4 + 4;
  if (count <= group->room) return HK_OK;
  group->count = group->room = 0;
  if (s->count + room > s->room) {
    hk_status status = repack(s, room);
    if (status != HK_OK) return status;
  }
  group->start = s->count;
  group->room = (uint32_t)room;
  s->count += room;
  return HK_OK;
}

static hk_status make_room_for_groups(hk_pair_cache *s, size_t count) {
  const hk_host *host = s->host;
  if (count <= s->group_room) return HK_OK;
  size_t room = count + count / 2;
  void *old[] = {s->former, s->task, s->task_group};
  for (int k = 0; k < 3; k++) host->release(host, old[k]);
  s->group_room = 0;
  hk_pair_group *group = host->allocate(host, room * sizeof *group);
  s->former = host->allocate(host, room * sizeof *s->former);
  s->task = host->allocate(host, room * sizeof *s->task);
  s->task_group = host->allocate(host, room * sizeof *s->task_group);
  if (group && s->groups) memcpy(group, s->group, s->groups * sizeof *group);
  host->release(host, s->group);
  s->group = group;
  if (!group) s->groups = 0;
  if (!group || !s->former || !s->task || !s->task_group) return no_memory(s, count, "pairs of patches");
  s->group_room = room;
  return HK_OK;
}

/* ---- pairs of patches ---- */

static bool precedes(const hk_pair_group *g, const hk_patch_pair *p) {
  return g->a != p->a ? g->a < p->a : g->b < p->b;
}

/* Those that were paired before keep what they have. */
static void take_pairs(hk_pair_cache *s) {
  hk_pair_group *former = s->group;
  const hk_pair_group *old = former, *end = former + s->groups;
  s->group = s->former;
  s->former = former;
  s->groups = s->patches.pairs;
  for (size_t g = 0; g < s->groups; g++) {
    const hk_patch_pair *pair = &s->patches.pair[g];
    while (old < end && precedes(old, pair)) old++;
    bool known = old < end && old->a == pair->a && old->b == pair->b;
    s->group[g] = known ? *old : (hk_pair_group){.a = pair->a, .b = pair->b, .complete = -INFINITY, .budget = INFINITY};
  }
}

static hk_status pair_up(hk_pair_cache *s, const double *x_from, const double *x_to) {
  s->paired = false;
  memset(s->patches.wanted, true, s->patches.table->count);
  hk_moving_patches_box(&s->patches, s->host, x_from, x_to);
  s->pairing_skin = fmax(s->skin, pairing_part * hk_moving_patches_size(&s->patches));
  hk_status status = hk_moving_patches_pair(&s->patches, s->host, s->reach + s->pairing_skin);
  if (status == HK_OK) status = make_room_for_groups(s, s->patches.pairs > s->groups ? s->patches.pairs : s->groups);
  if (status != HK_OK) return status;
  take_pairs(s);
  status = repack(s, 0);
  if (status != HK_OK) return status;
  s->paired = true;
  s->unpaired = s->pairing_skin;
  s->spare = -INFINITY;
  return HK_OK;
}

/* ---- searches ---- */

/* Of a group to be searched, the boxes may say that there is nothing to be found for long. */
static bool boxes_do(hk_pair_cache *s, hk_pair_group *group) {
  double apart = hk_moving_patches_distance(&s->patches, group->a, group->b) * (1 - margin) - s->reach;
  if (!(apart > s->skin)) return false;
  group->complete = group->path + apart;
  group->count = 0;
  group->budget = INFINITY;
  group->end = s->end_number;
  return true;
}

static hk_status take_found(hk_pair_cache *s, uint32_t g, const hk_feature_pair *near, size_t count) {
  hk_pair_group *group = &s->group[g];
  group->count = 0;
  hk_status status = make_room(s, group, count);
  if (status != HK_OK) return status;
  group->count = (uint32_t)count;
  group->complete = group->path + s->skin * (1 - margin);
  group->budget = INFINITY;
  group->end = s->end_number;
  for (size_t k = 0; k < count; k++) {
    size_t to = group->start + k;
    s->pair[to] = near[k];
    s->group_of[to] = g;
    s->budget[to] = group->path + (near[k].gap - s->reach) * (1 - margin);
    group->budget = fmin(group->budget, s->budget[to]);
  }
  return HK_OK;
}

/* The boxes of the patches that are searched. */
static void move_tasks(hk_pair_cache *s, const double *x_from, const double *x_to, size_t tasks) {
  for (size_t k = 0; k < tasks; k++) {
    const hk_pair_group *group = &s->group[s->task_group[k]];
    s->patches.wanted[group->a] = s->patches.wanted[group->b] = true;
  }
  hk_moving_patches_box(&s->patches, s->host, x_from, x_to);
}

static hk_status search(hk_pair_cache *s, const double *x_from, const double *x_to, size_t tasks) {
  hk_patch_feature_pairs found;
  size_t count = 0;
  if (s->end_number != s->paired_at) move_tasks(s, x_from, x_to, tasks);
  for (size_t k = 0; k < tasks; k++) {
    hk_pair_group *group = &s->group[s->task_group[k]];
    if (boxes_do(s, group)) continue;
    s->task[count] = (hk_patch_pair){group->a, group->b};
    s->task_group[count++] = s->task_group[k];
  }
  if (count == 0) return HK_OK;
  double begin = hk_own_time();
  hk_status status = s->surfaces->between(s->surfaces->self, x_from, x_to, s->reach + s->skin, s->task, count, &found);
  s->seconds += hk_own_time() - begin;
  for (size_t k = 0; k < count && status == HK_OK; k++)
    status = take_found(s, s->task_group[k], found.pair + found.start[k], found.start[k + 1] - found.start[k]);
  s->searches++;
  return status;
}

/* Lists the groups that may not be complete for the move. */
static size_t list_tasks(hk_pair_cache *s, bool has_aside) {
  size_t count = 0;
  for (uint32_t g = 0; g < s->groups; g++) {
    const hk_pair_group *group = &s->group[g];
    double motion = hk_patch_motion(&s->moves[group->a], &s->moves[group->b]);
    if (group->path + motion * (1 + margin) < group->complete) continue;
    if (has_aside && group->end == s->end_number &&
        hk_patch_approach(&s->end_moves[group->a], &s->end_moves[group->b]) * (1 + margin) < s->skin)
      continue;
    s->task_group[count++] = g;
  }
  return count;
}

/* A new move, from the start of the step, that searches are for. */
static void begin_end(hk_pair_cache *s, const double *x_to) {
  memcpy(s->end, x_to, 3 * s->n * sizeof *x_to);
  s->end_number++;
}

static bool pairing_holds(const hk_pair_cache *s, const double *x_to) {
  if (!s->paired) return false;
  if (s->step < s->unpaired) return true;
  return s->paired_at == s->end_number && twice_the_largest(s, s->end, x_to) < s->pairing_skin;
}

static hk_status complete(hk_pair_cache *s, const double *x_from, const double *x_to) {
  bool begun = !pairing_holds(s, x_to);
  if (begun) {
    begin_end(s, x_to);
    hk_status status = pair_up(s, x_from, x_to);
    if (status != HK_OK) return status;
    s->paired_at = s->end_number;
  }
  hk_moving_patches_measure(&s->patches, s->host, x_from, x_to, s->moves);
  size_t tasks = list_tasks(s, false);
  if (tasks > 0 && !begun) {
    hk_moving_patches_measure(&s->patches, s->host, s->end, x_to, s->end_moves);
    tasks = list_tasks(s, true);
    if (tasks > 0) begin_end(s, x_to);
  }
  return tasks > 0 ? search(s, x_from, x_to, tasks) : HK_OK;
}

/* ---- paths ---- */

/* To x, by `moves` from `at`. What is spare is what this way has left: the next step may be shorter than this one. */
static void go_on(hk_pair_cache *s, const double *x) {
  s->spare = INFINITY;
  for (hk_pair_group *g = s->group; g < s->group + s->groups; g++) {
    g->path += hk_patch_approach(&s->moves[g->a], &s->moves[g->b]) * (1 + margin);
    s->spare = fmin(s->spare, fmin(g->budget, g->complete) - g->path);
  }
  memcpy(s->at, x, 3 * s->n * sizeof *x);
  s->loose = 0;
}

static void measure(hk_pair_cache *s, const double *x) {
  hk_moving_patches_measure(&s->patches, s->host, s->at, x, s->moves);
  go_on(s, x);
}

static bool pins_kept(hk_pair_cache *s) {
  bool kept = true;
  for (size_t i = 0; i < s->n; i++) {
    bool held = !hk_model_moves(s->model, i);
    kept &= held == s->held[i];
    s->held[i] = held;
  }
  return kept;
}

void hk_pair_cache_begin(hk_pair_cache *s, const double *x_from) {
  double way = twice_the_largest(s, s->last, x_from);
  s->loose += way;
  s->unpaired -= way;
  s->end_number++;
  memcpy(s->last, x_from, 3 * s->n * sizeof *x_from);
  if (!pins_kept(s)) forget(s);
}

/* ---- the active pairs ---- */

/* Adds the pairs of a group whose budgets a path spends. */
static void list_group(hk_pair_cache *s, hk_pair_group *group, double path) {
  double least = INFINITY;
  for (size_t k = group->start; k < group->start + group->count; k++) {
    least = s->budget[k] < least ? s->budget[k] : least;
    if (s->budget[k] > path || s->surfaces->leaves(s->surfaces->self, &s->pair[k])) continue;
    s->index[s->active++] = (uint32_t)k;
  }
  group->budget = least;
}

static void list_active(hk_pair_cache *s) {
  double spare = INFINITY;
  for (hk_pair_group *g = s->group; g < s->group + s->groups; g++) {
    double path = g->path + hk_patch_motion(&s->moves[g->a], &s->moves[g->b]) * (1 + margin);
    if (!(g->budget > path)) list_group(s, g, path);
    spare = fmin(spare, fmin(g->budget, g->complete) - g->path);
  }
  s->spare = spare;
}

/* Where a position is not finite the service names it. hk_pair_motion is at most three times the largest move, and
 * `step` two times that. */
hk_status hk_pair_cache_find(hk_pair_cache *s, const double *x_from, const double *x_to) {
  hk_status status = HK_OK;
  hk_patch_feature_pairs none;
  s->step = twice_the_largest(s, x_from, x_to);
  s->active = 0;
  s->measured = false;
  if (isinf(s->step)) status = s->surfaces->between(s->surfaces->self, x_from, x_to, s->reach, NULL, 0, &none);
  if (status != HK_OK) return status;
  if (s->paired && s->step < s->unpaired && s->loose + 1.5 * s->step < s->spare) return HK_OK;
  if (s->loose > 0) measure(s, x_from);
  status = complete(s, x_from, x_to);
  if (status == HK_OK) status = hk_reserve(s->host, &s->index, &s->index_room, s->room, sizeof *s->index);
  if (status == HK_OK) list_active(s);
  s->measured = status == HK_OK;
  return status;
}

void hk_pair_cache_end(hk_pair_cache *s, const double *x_to) {
  if (s->measured)
    go_on(s, x_to);
  else
    s->loose += s->step;
  s->measured = false;
  s->unpaired -= s->step;
  memcpy(s->last, x_to, 3 * s->n * sizeof *x_to);
}

void hk_pair_cache_set_gap(hk_pair_cache *s, size_t k, double gap) {
  s->budget[k] = s->group[s->group_of[k]].path + (gap - s->reach) * (1 - margin);
}

typedef struct sifting {
  hk_pair_cache *s;
  const double *x;
} sifting;

static void sift_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const sifting *w = context;
  (void)chunk;
  for (size_t d = begin; d < end; d++) {
    const hk_feature_pair *pair = &w->s->pair[w->s->index[d]];
    double gap = sqrt(hk_pair_nearest(pair, w->x).squared) - pair->offset;
    if (gap > w->s->reach) hk_pair_cache_set_gap(w->s, w->s->index[d], gap);
  }
}

void hk_pair_cache_filter(hk_pair_cache *s, const double *x) {
  sifting w = {s, x};
  size_t kept = 0;
  s->host->parallel_for(s->host, s->active, PAIRS, sift_chunk, &w);
  for (size_t d = 0; d < s->active; d++) {
    uint32_t k = s->index[d];
    const hk_pair_group *g = &s->group[s->group_of[k]];
    if (!(s->budget[k] > g->path + hk_patch_motion(&s->moves[g->a], &s->moves[g->b]))) s->index[kept++] = k;
  }
  s->active = kept;
}

void hk_pair_cache_points(const hk_pair_cache *s, const double *x, double slack, const hk_contact_points *points) {
  for (size_t d = 0; d < s->active; d++) {
    const hk_feature_pair *pair = &s->pair[s->index[d]];
    hk_pair_contact_point(pair, x, slack * pair->offset, points);
  }
}
