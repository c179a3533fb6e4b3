/* Two bounds. The list: a pair that is not in it was at least the skin apart on all of the moves of the search; while
 * each of its particles is within half a skin of where it was, at the same part of the same step or else at its end,
 * their gap is open. Pairs in the list: on the way from a look to now each particle has moved by the sum of the largest
 * moves, `travelled`, at most. */
#include "plugins/common/impacts/nearby.h"

#include <string.h>

enum { GRAIN = 2048 /* particles */, PAIRS = 256 };

/* Relative, of distances: far above rounding, far below what shows. */
static const double margin = 1e-9;

typedef struct comparison {
  const double *a, *b; /* n x 3 */
  double *most2;       /* m^2, of each chunk */
} comparison;

static void compare_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const comparison *c = context;
  double most2 = 0;
  for (size_t i = 3 * begin; i < 3 * end; i += 3) {
    double x = c->a[i] - c->b[i], y = c->a[i + 1] - c->b[i + 1], z = c->a[i + 2] - c->b[i + 2];
    double square = x * x + y * y + z * z;
    most2 = square <= most2 ? most2 : square; /* NaN stays */
  }
  c->most2[chunk] = most2;
}

/* The largest distance of a particle between two states; NAN where one is not finite. */
static double largest_move(const hk_nearby *s, const double *a, const double *b) {
  comparison c = {a, b, s->chunk};
  s->host->parallel_for(s->host, s->n, GRAIN, compare_chunk, &c);
  double most2 = 0;
  for (size_t k = 0; k < (s->n + GRAIN - 1) / GRAIN; k++) most2 = s->chunk[k] <= most2 ? most2 : s->chunk[k];
  return sqrt(most2) * (1 + margin);
}

hk_status hk_nearby_open(hk_nearby *s, const hk_host *host, const hk_view *view, const hk_surfaces *surfaces,
                         hk_nearby_found *found, double skin) {
  host->release(host, s->last);
  host->release(host, s->chunk);
  s->host = host;
  s->surfaces = surfaces;
  s->found = found;
  s->skin = skin;
  s->n = view->n;
  s->count = s->dues = 0;
  s->listed = false;
  s->last = host->allocate(host, (3 * s->n + 1) * sizeof *s->last);
  s->chunk = host->allocate(host, ((s->n + GRAIN - 1) / GRAIN + 1) * sizeof *s->chunk);
  if (!s->last || !s->chunk) return host->fail(host, HK_NO_MEMORY, "no memory for %zu particles", s->n);
  memcpy(s->last, view->x, 3 * s->n * sizeof *s->last);
  return HK_OK;
}

static hk_status make_room(hk_nearby *s, size_t count) {
  const hk_host *host = s->host;
  if (count <= s->room) return HK_OK;
  size_t room = count + count / 2;
  host->release(host, s->pair);
  host->release(host, s->due);
  host->release(host, s->index);
  s->room = 0;
  s->pair = host->allocate(host, room * sizeof *s->pair);
  s->due = host->allocate(host, room * sizeof *s->due);
  s->index = host->allocate(host, room * sizeof *s->index);
  if (!s->pair || !s->due || !s->index) return host->fail(host, HK_NO_MEMORY, "no memory for %zu pairs", count);
  s->room = room;
  return HK_OK;
}

static hk_status list_pairs(hk_nearby *s) {
  hk_surface_pairs pairs = {0};
  s->count = 0;
  hk_status status = s->surfaces->pairs(s->surfaces->self, s->found->from, s->found->to, s->reach + s->skin, &pairs);
  if (status == HK_OK) status = make_room(s, pairs.count);
  if (status != HK_OK) return status;
  s->count = pairs.count;
  if (s->count) memcpy(s->pair, pairs.pair, s->count * sizeof *s->pair);
  for (size_t k = 0; k < s->count; k++) s->due[k] = -1;
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

void hk_nearby_begin(hk_nearby *s, const double *x_from) {
  s->travelled += largest_move(s, s->last, x_from);
  memcpy(s->last, x_from, 3 * s->n * sizeof *x_from);
  s->fresh = false;
}

static bool is_complete(const hk_nearby *s, const double *x_from, const double *x_to) {
  if (!s->found->good) return false;
  double half = s->skin / 2 * (1 - margin);
  return largest_move(s, s->found->to, x_to) <= half && (s->fresh || largest_move(s, s->found->to, x_from) <= half);
}

hk_status hk_nearby_reach(hk_nearby *s, const double *x_from, const double *x_to) {
  hk_status status = HK_OK;
  bool complete = is_complete(s, x_from, x_to);
  if (!complete)
    status = search(s, x_from, x_to);
  else if (!s->listed)
    status = list_pairs(s);
  if (status != HK_OK) return status;
  s->reached = s->travelled + largest_move(s, x_from, x_to);
  s->dues = 0;
  for (size_t k = 0; k < s->count; k++)
    if (!(s->due[k] > s->reached) && !s->surfaces->leaves(s->surfaces->self, &s->pair[k]))
      s->index[s->dues++] = (uint32_t)k;
  return HK_OK;
}

void hk_nearby_end(hk_nearby *s, const double *x_to) {
  s->travelled += largest_move(s, s->last, x_to);
  memcpy(s->last, x_to, 3 * s->n * sizeof *x_to);
}

void hk_nearby_put_off(hk_nearby *s, size_t k, double gap) {
  s->due[k] = s->travelled + (gap - s->reach) / 2 * (1 - margin);
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
  for (size_t d = 0; d < s->dues; d++)
    if (!(s->due[s->index[d]] > s->reached)) s->index[kept++] = s->index[d];
  s->dues = kept;
}
