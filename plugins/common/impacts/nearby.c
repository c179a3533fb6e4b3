/* Three budgets, each of how much nearer things may come to each other before it is spent. Of the pairing: patches that
 * are not paired were farther apart than reach and pairing_skin. Of a group: pairs that are not in its list were
 * farther apart than reach and skin, or the boxes of its patches were. Of a pair: its gap when it was looked at. All
 * are bounds along the whole way from where they were found, kept as a path that only grows: the sum of what the
 * patches came nearer from one measurement to the next.
 *
 * What is found in a step holds for its own move as well, however fast, and for others from the same start by what
 * their ends differ from its own. */
#include "plugins/common/impacts/nearby.h"

#include <string.h>

enum { PAIRS = 256, PARTICLES = 4096 };

/* Relative, of distances: far above rounding, far below what shows. */
static const double margin = 1e-9;

/* Of the mean size of a patch: how far beyond reach patches are paired. Further, more of them are paired; nearer, more
 * often. */
static const double pairing_part = 0.25;

typedef struct comparison {
  const double *a, *b; /* n x 3 */
  double *most2;       /* m^2, of each chunk */
} comparison;

static void compare_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const comparison *c = context;
  double most2 = 0, zero = 0; /* NaN where a place is not finite */
  for (size_t i = 3 * begin; i < 3 * end; i += 3) {
    double x = c->a[i] - c->b[i], y = c->a[i + 1] - c->b[i + 1], z = c->a[i + 2] - c->b[i + 2];
    double square = x * x + y * y + z * z;
    most2 = square > most2 ? square : most2;
    zero += 0 * square;
  }
  c->most2[chunk] = most2 + zero;
}

/* m: twice the largest distance of a particle between two states, by which two of them come nearer to each other at
 * most; INFINITY where one is not finite. */
static double twice_the_largest(const hk_nearby *s, const double *a, const double *b) {
  comparison c = {a, b, s->chunk};
  double most2 = 0, zero = 0;
  s->host->parallel_for(s->host, s->n, PARTICLES, compare_chunk, &c);
  for (size_t k = 0; k * PARTICLES < s->n; k++) {
    most2 = s->chunk[k] > most2 ? s->chunk[k] : most2;
    zero += 0 * s->chunk[k];
  }
  return isnan(most2 + zero) ? INFINITY : 2 * sqrt(most2) * (1 + margin);
}

static hk_status no_memory(const hk_nearby *s, size_t count, const char *what) {
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu %s", count, what);
}

static void forget(hk_nearby *s) {
  s->count = s->groups = s->dues = 0;
  s->paired = false;
  s->searches++;
}

hk_status hk_nearby_open(hk_nearby *s, const hk_host *host, const hk_view *view, const hk_surfaces *surfaces,
                         double skin) {
  void *old[] = {s->last, s->at, s->end, s->moves, s->aside, s->held, s->chunk};
  for (int k = 0; k < 7; k++) host->release(host, old[k]);
  s->host = host;
  s->surfaces = surfaces;
  s->model = view->model;
  s->skin = skin;
  s->n = view->n;
  s->loose = 0;
  forget(s);
  hk_status status = hk_patches_open(&s->patches, host, surfaces, view->model);
  if (status != HK_OK) return status;
  size_t patches = s->patches.table->count + 1, size = (3 * s->n + 1) * sizeof(double);
  s->last = host->allocate(host, size);
  s->at = host->allocate(host, size);
  s->end = host->allocate(host, size);
  s->chunk = host->allocate(host, (s->n / PARTICLES + 1) * sizeof *s->chunk);
  s->moves = host->allocate(host, patches * sizeof *s->moves);
  s->aside = host->allocate(host, patches * sizeof *s->aside);
  s->held = host->allocate(host, s->n + 1);
  if (!s->last || !s->at || !s->end || !s->chunk || !s->moves || !s->aside || !s->held)
    return no_memory(s, s->n, "particles");
  memcpy(s->last, view->x, 3 * s->n * sizeof *s->last);
  memcpy(s->at, view->x, 3 * s->n * sizeof *s->at);
  return HK_OK;
}

/* ---- memory of pairs ---- */

/* Moves the pairs of all groups together, into memory with room for more. */
static hk_status repack(hk_nearby *s, size_t more) {
  const hk_host *host = s->host;
  size_t count = 0, live = 0;
  for (size_t g = 0; g < s->groups; g++) live += s->group[g].count;
  size_t room = 2 * (live + more) + 64;
  hk_surface_pair *pair = host->allocate(host, room * sizeof *pair);
  double *due = host->allocate(host, room * sizeof *due);
  uint32_t *group_of = host->allocate(host, room * sizeof *group_of);
  bool fine = pair && due && group_of;
  for (size_t g = 0; fine && g < s->groups; g++) {
    hk_near_group *group = &s->group[g];
    if (group->count) {
      memcpy(pair + count, s->pair + group->start, group->count * sizeof *pair);
      memcpy(due + count, s->due + group->start, group->count * sizeof *due);
    }
    for (size_t k = 0; k < group->count; k++) group_of[count + k] = (uint32_t)g;
    group->start = count;
    group->room = group->count;
    count += group->count;
  }
  void *old[] = {fine ? (void *)s->pair : pair, fine ? (void *)s->due : due, fine ? (void *)s->group_of : group_of};
  for (int k = 0; k < 3; k++) host->release(host, old[k]);
  if (!fine) return no_memory(s, room, "pairs");
  s->pair = pair, s->due = due, s->group_of = group_of;
  s->count = count;
  s->room = room;
  s->searches++;
  return HK_OK;
}

static hk_status make_room(hk_nearby *s, hk_near_group *group, size_t count) {
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

static hk_status make_room_for_groups(hk_nearby *s, size_t count) {
  const hk_host *host = s->host;
  if (count <= s->group_room) return HK_OK;
  size_t room = count + count / 2;
  void *old[] = {s->former, s->task, s->task_group};
  for (int k = 0; k < 3; k++) host->release(host, old[k]);
  s->group_room = 0;
  hk_near_group *group = host->allocate(host, room * sizeof *group);
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

static bool precedes(const hk_near_group *g, const hk_patch_pair *p) {
  return g->a != p->a ? g->a < p->a : g->b < p->b;
}

/* Those that were paired before keep what they have. */
static void take_pairs(hk_nearby *s) {
  hk_near_group *former = s->group;
  const hk_near_group *old = former, *end = former + s->groups;
  s->group = s->former;
  s->former = former;
  s->groups = s->patches.pairs;
  for (size_t g = 0; g < s->groups; g++) {
    const hk_patch_pair *pair = &s->patches.pair[g];
    while (old < end && precedes(old, pair)) old++;
    bool known = old < end && old->a == pair->a && old->b == pair->b;
    s->group[g] = known ? *old : (hk_near_group){.a = pair->a, .b = pair->b, .complete = -INFINITY, .due = INFINITY};
  }
}

static hk_status pair_up(hk_nearby *s, const double *x_from, const double *x_to) {
  s->paired = false;
  hk_patches_sweep(&s->patches, s->host, x_from, x_to);
  s->pairing_skin = fmax(s->skin, pairing_part * s->patches.size);
  hk_status status = hk_patches_pair_up(&s->patches, s->host, s->reach + s->pairing_skin);
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
static bool boxes_do(hk_nearby *s, hk_near_group *group) {
  double apart = hk_patches_apart(&s->patches, group->a, group->b) * (1 - margin) - s->reach;
  if (!(apart > s->skin)) return false;
  group->complete = group->path + apart;
  group->count = 0;
  group->due = INFINITY;
  group->end = s->end_number;
  return true;
}

static hk_status take_found(hk_nearby *s, uint32_t g, const hk_near_pair *near, size_t count) {
  hk_near_group *group = &s->group[g];
  group->count = 0;
  hk_status status = make_room(s, group, count);
  if (status != HK_OK) return status;
  group->count = (uint32_t)count;
  group->complete = group->path + s->skin * (1 - margin);
  group->due = INFINITY;
  group->end = s->end_number;
  for (size_t k = 0; k < count; k++) {
    size_t to = group->start + k;
    s->pair[to] = near[k].pair;
    s->group_of[to] = g;
    s->due[to] = group->path + (near[k].gap - s->reach) * (1 - margin);
    group->due = fmin(group->due, s->due[to]);
  }
  return HK_OK;
}

static hk_status search(hk_nearby *s, const double *x_from, const double *x_to, size_t tasks) {
  hk_near_pairs found;
  size_t count = 0;
  if (s->end_number != s->paired_at) hk_patches_sweep(&s->patches, s->host, x_from, x_to);
  for (size_t k = 0; k < tasks; k++) {
    hk_near_group *group = &s->group[s->task_group[k]];
    if (boxes_do(s, group)) continue;
    s->task[count] = (hk_patch_pair){group->a, group->b};
    s->task_group[count++] = s->task_group[k];
  }
  if (count == 0) return HK_OK;
  double begin = hk_own_time();
  hk_status status = s->surfaces->between(s->surfaces->self, x_from, x_to, s->reach + s->skin, s->task, count, &found);
  s->seconds += hk_own_time() - begin;
  for (size_t k = 0; k < count && status == HK_OK; k++)
    status = take_found(s, s->task_group[k], found.near + found.start[k], found.start[k + 1] - found.start[k]);
  s->searches++;
  return status;
}

/* Lists the groups that may not be complete for the move. */
static size_t list_tasks(hk_nearby *s, bool has_aside) {
  size_t count = 0;
  for (uint32_t g = 0; g < s->groups; g++) {
    const hk_near_group *group = &s->group[g];
    double nearer = hk_patch_approach(&s->moves[group->a], &s->moves[group->b]);
    if (group->path + nearer * (1 + margin) < group->complete) continue;
    if (has_aside && group->end == s->end_number &&
        hk_patch_approach(&s->aside[group->a], &s->aside[group->b]) * (1 + margin) < s->skin)
      continue;
    s->task_group[count++] = g;
  }
  return count;
}

/* A new move, from the start of the step, that searches are for. */
static void begin_end(hk_nearby *s, const double *x_to) {
  memcpy(s->end, x_to, 3 * s->n * sizeof *x_to);
  s->end_number++;
}

static bool pairing_holds(const hk_nearby *s, const double *x_to) {
  if (!s->paired) return false;
  if (s->step < s->unpaired) return true;
  return s->paired_at == s->end_number && twice_the_largest(s, s->end, x_to) < s->pairing_skin;
}

static hk_status complete(hk_nearby *s, const double *x_from, const double *x_to) {
  bool begun = !pairing_holds(s, x_to);
  if (begun) {
    begin_end(s, x_to);
    hk_status status = pair_up(s, x_from, x_to);
    if (status != HK_OK) return status;
    s->paired_at = s->end_number;
  }
  hk_patches_measure(&s->patches, s->host, x_from, x_to, s->moves);
  size_t tasks = list_tasks(s, false);
  if (tasks > 0 && !begun) {
    hk_patches_measure(&s->patches, s->host, s->end, x_to, s->aside);
    tasks = list_tasks(s, true);
    if (tasks > 0) begin_end(s, x_to);
  }
  return tasks > 0 ? search(s, x_from, x_to, tasks) : HK_OK;
}

/* ---- paths ---- */

static void measure(hk_nearby *s, const double *x) {
  hk_patches_measure(&s->patches, s->host, s->at, x, s->moves);
  for (hk_near_group *g = s->group; g < s->group + s->groups; g++)
    g->path += hk_patch_approach(&s->moves[g->a], &s->moves[g->b]) * (1 + margin);
  memcpy(s->at, x, 3 * s->n * sizeof *x);
  s->loose = 0;
}

static bool pins_kept(hk_nearby *s) {
  bool kept = true;
  for (size_t i = 0; i < s->n; i++) {
    bool held = s->model->inverse_mass[i] == 0;
    kept &= held == s->held[i];
    s->held[i] = held;
  }
  return kept;
}

void hk_nearby_begin(hk_nearby *s, const double *x_from) {
  double way = twice_the_largest(s, s->last, x_from);
  s->loose += way;
  s->unpaired -= way;
  s->end_number++;
  memcpy(s->last, x_from, 3 * s->n * sizeof *x_from);
  if (!pins_kept(s)) forget(s);
}

/* ---- what is looked at ---- */

static hk_status make_room_for_index(hk_nearby *s) {
  if (s->index_room >= s->room) return HK_OK;
  s->host->release(s->host, s->index);
  s->index_room = 0;
  s->index = s->host->allocate(s->host, s->room * sizeof *s->index);
  if (!s->index) return no_memory(s, s->room, "pairs");
  s->index_room = s->room;
  return HK_OK;
}

/* Adds the pairs of a group that are due at a path. */
static void take_due(hk_nearby *s, hk_near_group *group, double path) {
  double least = INFINITY;
  for (size_t k = group->start; k < group->start + group->count; k++) {
    least = s->due[k] < least ? s->due[k] : least;
    if (s->due[k] > path || s->surfaces->leaves(s->surfaces->self, &s->pair[k])) continue;
    s->index[s->dues++] = (uint32_t)k;
  }
  group->due = least;
}

static void take_all_due(hk_nearby *s) {
  double spare = INFINITY;
  for (hk_near_group *g = s->group; g < s->group + s->groups; g++) {
    double path = g->path + hk_patch_motion(&s->moves[g->a], &s->moves[g->b]) * (1 + margin);
    if (!(g->due > path)) take_due(s, g, path);
    spare = fmin(spare, fmin(g->due, g->complete) - g->path);
  }
  s->spare = spare;
}

/* Where a position is not finite the service names it. hk_pair_motion is at most three times the largest move, and
 * `step` two times that. */
hk_status hk_nearby_reach(hk_nearby *s, const double *x_from, const double *x_to) {
  hk_status status = HK_OK;
  hk_near_pairs none;
  s->step = twice_the_largest(s, x_from, x_to);
  s->dues = 0;
  if (isinf(s->step)) status = s->surfaces->between(s->surfaces->self, x_from, x_to, s->reach, NULL, 0, &none);
  if (status != HK_OK) return status;
  if (s->paired && s->step < s->unpaired && s->loose + 1.5 * s->step < s->spare) return HK_OK;
  if (s->loose > 0) measure(s, x_from);
  status = complete(s, x_from, x_to);
  if (status == HK_OK) status = make_room_for_index(s);
  if (status == HK_OK) take_all_due(s);
  return status;
}

void hk_nearby_end(hk_nearby *s, const double *x_to) {
  s->loose += s->step;
  s->unpaired -= s->step;
  memcpy(s->last, x_to, 3 * s->n * sizeof *x_to);
}

void hk_nearby_put_off(hk_nearby *s, size_t k, double gap) {
  s->due[k] = s->group[s->group_of[k]].path + (gap - s->reach) * (1 - margin);
}

typedef struct sifting {
  hk_nearby *s;
  const double *x;
} sifting;

static void sift_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const sifting *w = context;
  (void)chunk;
  for (size_t d = begin; d < end; d++) {
    const hk_surface_pair *pair = &w->s->pair[w->s->index[d]];
    double x[12];
    for (size_t i = 0; i < 12; i++) x[i] = w->x[3 * (size_t)pair->vertex[i / 3] + i % 3];
    double gap = sqrt(hk_nearest_of_pair(pair->kind, x).squared) - pair->offset;
    if (gap > w->s->reach) hk_nearby_put_off(w->s, w->s->index[d], gap);
  }
}

void hk_nearby_sift(hk_nearby *s, const double *x) {
  sifting w = {s, x};
  size_t kept = 0;
  s->host->parallel_for(s->host, s->dues, PAIRS, sift_chunk, &w);
  for (size_t d = 0; d < s->dues; d++) {
    uint32_t k = s->index[d];
    const hk_near_group *g = &s->group[s->group_of[k]];
    if (!(s->due[k] > g->path + hk_patch_motion(&s->moves[g->a], &s->moves[g->b]))) s->index[kept++] = k;
  }
  s->dues = kept;
}
