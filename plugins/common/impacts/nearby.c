/* Two bounds by the moves of patches (patches.h). The list: a pair that is not in it was at least the skin apart on all
 * of the moves of the search, and at least as far as its patches' boxes, swept by them; while the two have come nearer
 * by less since, at the same part of the same step or else since its end, its gap is open. Pairs in the list: on the
 * way from a look to now their distance has changed by the sum of what their patches came nearer from one measurement
 * to the next, at most; a pair's path counts from the measurement before its look. */
#include "plugins/common/impacts/nearby.h"

#include <string.h>

enum { PAIRS = 256, PARTICLES = 4096 };

/* Relative, of distances: far above rounding, far below what shows. */
static const double margin = 1e-9;

/* Of the skin: particles may have moved by so much, both of a pair together, before patches are measured again. */
static const double worth_measuring = 0.25;

typedef struct hk_patch_box {
  double low[3], high[3]; /* m, swept by the moves of the search, with the radii of its particles */
} hk_patch_box;

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

/* m: twice the largest distance of a particle between two states; NAN where one is not finite. */
static double twice_the_largest(const hk_nearby *s, const double *a, const double *b) {
  comparison c = {a, b, s->chunk};
  double most2 = 0, zero = 0;
  s->host->parallel_for(s->host, s->n, PARTICLES, compare_chunk, &c);
  for (size_t k = 0; k * PARTICLES < s->n; k++) {
    most2 = s->chunk[k] > most2 ? s->chunk[k] : most2;
    zero += 0 * s->chunk[k];
  }
  return 2 * sqrt(most2 + zero) * (1 + margin);
}

static hk_status no_memory(const hk_nearby *s, size_t count, const char *what) {
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu %s", count, what);
}

hk_status hk_nearby_open(hk_nearby *s, const hk_host *host, const hk_view *view, const hk_surfaces *surfaces,
                         hk_nearby_found *found, double skin) {
  void *old[] = {s->last, s->moves, s->box, s->seen, s->by_home, s->at, s->chunk};
  for (int k = 0; k < 7; k++) host->release(host, old[k]);
  s->host = host;
  s->surfaces = surfaces;
  s->found = found;
  s->skin = skin;
  s->n = view->n;
  s->count = s->dues = s->groups = 0;
  s->listed = false;
  hk_status status = hk_patches_open(&s->patches, host, surfaces->mesh(surfaces->self), view);
  if (status != HK_OK) return status;
  size_t patches = s->patches.count + 1;
  s->last = host->allocate(host, (3 * s->n + 1) * sizeof *s->last);
  s->at = host->allocate(host, (3 * s->n + 1) * sizeof *s->at);
  s->chunk = host->allocate(host, (s->n / PARTICLES + 1) * sizeof *s->chunk);
  s->moves = host->allocate(host, patches * sizeof *s->moves);
  s->box = host->allocate(host, patches * sizeof *s->box);
  s->seen = host->allocate(host, patches * sizeof *s->seen);
  s->by_home = host->allocate(host, patches * sizeof *s->by_home);
  if (!s->last || !s->at || !s->chunk || !s->moves || !s->box || !s->seen || !s->by_home)
    return no_memory(s, s->n, "particles");
  memcpy(s->last, view->x, 3 * s->n * sizeof *s->last);
  return HK_OK;
}

static hk_status make_room(hk_nearby *s, size_t count) {
  const hk_host *host = s->host;
  if (count < s->room) return HK_OK;
  size_t room = count + count / 2 + 1;
  void *old[] = {s->pair, s->due, s->index, s->group_of, s->in_group, s->sorted, s->group, s->marks};
  for (int k = 0; k < 8; k++) host->release(host, old[k]);
  s->room = 0;
  s->pair = host->allocate(host, room * sizeof *s->pair);
  s->due = host->allocate(host, room * sizeof *s->due);
  s->index = host->allocate(host, room * sizeof *s->index);
  s->group_of = host->allocate(host, room * sizeof *s->group_of);
  s->in_group = host->allocate(host, room * sizeof *s->in_group);
  s->sorted = host->allocate(host, room * sizeof *s->sorted);
  s->group = host->allocate(host, (room + 1) * sizeof *s->group);
  s->marks = host->allocate(host, (room / 64 + 1) * sizeof *s->marks);
  if (!s->pair || !s->due || !s->index || !s->group_of || !s->in_group || !s->sorted || !s->group || !s->marks)
    return no_memory(s, count, "pairs");
  s->room = room;
  return HK_OK;
}

/* ---- groups of pairs ---- */

static void homes_of(const hk_nearby *s, size_t k, uint32_t *a, uint32_t *b) {
  const hk_surface_pair *pair = &s->pair[k];
  int first = pair->kind == HK_POINT_TRIANGLE ? 1 : 2;
  *a = hk_patch_of(&s->patches, pair->vertex, first);
  *b = hk_patch_of(&s->patches, pair->vertex + first, 4 - first);
}

static void sort_by_first(hk_nearby *s) {
  size_t *at = s->by_home;
  uint32_t a, b;
  memset(at, 0, (s->patches.count + 1) * sizeof *at);
  for (size_t k = 0; k < s->count; k++) {
    homes_of(s, k, &a, &b);
    at[a + 1]++;
  }
  for (size_t p = 0; p < s->patches.count; p++) at[p + 1] += at[p];
  for (size_t k = 0; k < s->count; k++) {
    homes_of(s, k, &a, &b);
    s->sorted[at[a]++] = (uint32_t)k;
  }
}

/* seen[b]: 1 + the last group with b as its second patch. */
static void number_groups(hk_nearby *s) {
  memset(s->seen, 0, s->patches.count * sizeof *s->seen);
  for (size_t e = 0; e < s->count; e++) {
    uint32_t k = s->sorted[e], a, b;
    homes_of(s, k, &a, &b);
    if (!s->seen[b] || s->group[s->seen[b] - 1].a != a) {
      s->group[s->groups] = (hk_near_group){.a = a, .b = b, .due = -INFINITY};
      s->seen[b] = (uint32_t)++s->groups;
    }
    s->group_of[k] = s->seen[b] - 1;
    s->group[s->group_of[k]].start++;
  }
}

/* Sorts pairs by the patch of their first feature, by counting, and those of one such patch by when the other was seen
 * first. All pairs are due. */
static void make_groups(hk_nearby *s) {
  size_t sum = 0;
  s->groups = 0;
  sort_by_first(s);
  number_groups(s);
  for (size_t g = 0; g < s->groups; g++) sum = s->group[g].start += sum;
  s->group[s->groups].start = sum;
  for (size_t e = s->count; e-- > 0;) s->in_group[--s->group[s->group_of[s->sorted[e]]].start] = s->sorted[e];
  for (size_t k = 0; k < s->count; k++) s->due[k] = -INFINITY;
}

static void mark_group(hk_nearby *s, size_t g, double more) {
  hk_near_group *group = &s->group[g];
  double least = INFINITY;
  for (size_t e = group->start; e < group[1].start; e++) {
    uint32_t k = s->in_group[e];
    if (!(s->due[k] > group->path + more)) s->marks[k / 64] |= (uint64_t)1 << k % 64;
    least = s->due[k] < least ? s->due[k] : least;
  }
  group->due = least;
}

/* Fills `index` with the pairs that are due when all patches have come nearer by `more` beside the groups' paths. */
static void mark_groups(hk_nearby *s, double more) {
  size_t words = (s->count + 63) / 64;
  memset(s->marks, 0, words * sizeof *s->marks);
  for (size_t g = 0; g < s->groups; g++)
    if (!(s->group[g].due > s->group[g].path + more)) mark_group(s, g, more);
  s->dues = 0;
  for (size_t w = 0; w < words; w++)
    for (uint64_t left = s->marks[w]; left; left &= left - 1) {
      uint32_t k = (uint32_t)(64 * w) + (uint32_t)__builtin_ctzll(left);
      if (!s->surfaces->leaves(s->surfaces->self, &s->pair[k])) s->index[s->dues++] = k;
    }
}

/* ---- boxes of patches ---- */

static void widen(hk_patch_box *box, const double *x, double radius) {
  for (int c = 0; c < 3; c++) {
    box->low[c] = fmin(box->low[c], x[c] - radius);
    box->high[c] = fmax(box->high[c], x[c] + radius);
  }
}

static void make_boxes(hk_nearby *s) {
  const double *radius = s->surfaces->mesh(s->surfaces->self)->radius;
  for (size_t k = 0; k < s->patches.count; k++) {
    hk_patch_box *box = &s->box[k];
    *box = (hk_patch_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t e = s->patches.start[k]; e < s->patches.start[k + 1]; e++) {
      size_t i = s->patches.member[e];
      widen(box, s->found->from + 3 * i, radius[i]);
      widen(box, s->found->to + 3 * i, radius[i]);
    }
  }
}

static double square_between(const hk_patch_box *a, const hk_patch_box *b) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double d = fmax(0, fmax(a->low[c] - b->high[c], b->low[c] - a->high[c]));
    sum += d * d;
  }
  return sum;
}

/* m: twice the largest move of a particle; NAN where one is not finite. */
static double largest_approach(const hk_nearby *s) {
  double most = 0, zero = 0;
  for (size_t k = 0; k < s->patches.count; k++) {
    const hk_patch_move *m = &s->moves[k];
    double way = sqrt(m->mean[0] * m->mean[0] + m->mean[1] * m->mean[1] + m->mean[2] * m->mean[2]) + m->spread;
    most = fmax(most, way);
    zero += 0 * way;
  }
  return 2 * most + zero;
}

/* m: of how much all pairs of patches have left, after their `moves` since the search, of the skin, or of the distance
 * of their boxes less the reach. Below 0: a pair that is not listed may be within reach. */
static double boxes_slack(const hk_nearby *s) {
  double least = s->skin - largest_approach(s);
  if (!(least < s->skin / 2)) return least;
  least = INFINITY;
  for (size_t a = 0; a < s->patches.count; a++)
    for (size_t b = 0; b <= a; b++) {
      double nearer = hk_patch_approach(&s->moves[a], &s->moves[b]);
      if (s->skin - nearer >= least) continue;
      double apart = sqrt(square_between(&s->box[a], &s->box[b])) - s->reach;
      least = fmin(least, fmax(s->skin, apart) - nearer);
    }
  return least;
}

/* ---- searches ---- */

static hk_status list_pairs(hk_nearby *s) {
  hk_surface_pairs pairs = {0};
  s->count = s->groups = s->dues = 0;
  s->listed = false;
  hk_status status = s->surfaces->pairs(s->surfaces->self, s->found->from, s->found->to, s->reach + s->skin, &pairs);
  if (status == HK_OK) status = make_room(s, pairs.count);
  if (status != HK_OK) return status;
  s->count = pairs.count;
  if (s->count) memcpy(s->pair, pairs.pair, s->count * sizeof *s->pair);
  make_groups(s);
  make_boxes(s);
  s->listed = true;
  s->searches++;
  return HK_OK;
}

static hk_status search(hk_nearby *s, const double *x_from, const double *x_to) {
  memcpy(s->found->from, x_from, 3 * s->n * sizeof *x_from);
  memcpy(s->found->to, x_to, 3 * s->n * sizeof *x_to);
  s->found->good = s->fresh = true;
  return list_pairs(s);
}

/* What is left at x of the list's slack. */
static double slack_at(hk_nearby *s, const double *x) {
  hk_patches_measure(&s->patches, s->host, s->found->to, x, s->moves);
  return boxes_slack(s) * (1 - margin);
}

/* Measures all patches at x. */
static void measure(hk_nearby *s, const double *x) {
  hk_patches_measure(&s->patches, s->host, s->at, x, s->moves);
  for (hk_near_group *g = s->group; g < s->group + s->groups; g++)
    g->path += hk_patch_approach(&s->moves[g->a], &s->moves[g->b]) * (1 + margin);
  memcpy(s->at, x, 3 * s->n * sizeof *x);
  s->loose = 0;
  s->slack = slack_at(s, x);
}

/* The list is new: its paths begin at x. */
static void begin_paths(hk_nearby *s, const double *x) {
  memcpy(s->at, x, 3 * s->n * sizeof *x);
  s->loose = 0;
  s->slack = s->fresh ? 0 : slack_at(s, x);
}

void hk_nearby_begin(hk_nearby *s, const double *x_from) {
  s->loose += twice_the_largest(s, s->last, x_from);
  memcpy(s->last, x_from, 3 * s->n * sizeof *x_from);
  if (s->listed && (s->fresh || !(s->loose < worth_measuring * s->skin))) measure(s, x_from);
  s->fresh = false;
}

/* In the step of a search the list is complete for its moves, and for others by what they differ from these. */
static bool is_complete(hk_nearby *s, const double *x_from, const double *x_to) {
  if (!s->found->good) return false;
  if (s->fresh) return slack_at(s, x_to) > 0;
  if (s->loose + s->step < s->slack) return true;
  if (s->loose > 0) measure(s, x_from);
  return s->step < s->slack || (s->slack > 0 && slack_at(s, x_to) > 0);
}

hk_status hk_nearby_reach(hk_nearby *s, const double *x_from, const double *x_to) {
  hk_status status = HK_OK;
  s->step = twice_the_largest(s, x_from, x_to);
  if (s->found->good && !s->listed) {
    status = list_pairs(s);
    if (status == HK_OK) begin_paths(s, x_from);
  }
  if (status == HK_OK && !is_complete(s, x_from, x_to)) {
    status = search(s, x_from, x_to);
    if (status == HK_OK) begin_paths(s, x_from);
  }
  if (status == HK_OK) mark_groups(s, s->loose + s->step);
  return status;
}

void hk_nearby_end(hk_nearby *s, const double *x_to) {
  s->loose += s->step;
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
    if (!(s->due[k] > s->group[s->group_of[k]].path + s->loose + s->step)) s->index[kept++] = k;
  }
  s->dues = kept;
}
