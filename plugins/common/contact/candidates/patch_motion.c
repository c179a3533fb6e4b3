#include "plugins/common/contact/candidates/patch_motion.h"

#include <string.h>

enum { GRAIN = 16 };

hk_status hk_moving_patches_open(hk_moving_patches *p, const hk_host *host, const hk_surfaces *surfaces,
                                 const hk_model *model) {
  hk_moving_patches_free(p, host);
  p->table = surfaces->patches(surfaces->self);
  p->radius = surfaces->mesh(surfaces->self)->radius;
  p->model = model;
  p->box = host->allocate(host, (p->table->count + 1) * sizeof *p->box);
  p->held = host->allocate(host, (p->table->count + 1) * sizeof *p->held);
  p->wanted = host->allocate(host, (p->table->count + 1) * sizeof *p->wanted);
  if (p->box && p->held && p->wanted) return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory for %zu patches", p->table->count);
}

void hk_moving_patches_free(hk_moving_patches *p, const hk_host *host) {
  host->release(host, p->box);
  host->release(host, p->held);
  host->release(host, p->wanted);
  host->release(host, p->pair);
  hk_bvh_free(&p->tree, host);
  *p = (hk_moving_patches){0};
}

/* ---- moves ---- */

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

double hk_largest_displacement(const hk_host *host, size_t n, const double *a, const double *b, double *chunk) {
  comparison c = {a, b, chunk};
  double most2 = 0, zero = 0;
  host->parallel_for(host, n, HK_DISPLACEMENT_CHUNK, compare_chunk, &c);
  for (size_t k = 0; k * HK_DISPLACEMENT_CHUNK < n; k++) {
    most2 = chunk[k] > most2 ? chunk[k] : most2;
    zero += 0 * chunk[k];
  }
  return isnan(most2 + zero) ? INFINITY : sqrt(most2);
}

typedef struct measuring {
  const hk_moving_patches *p;
  const double *a, *b;
  hk_patch_move *out;
} measuring;

static void measure(const measuring *m, size_t k) {
  const hk_surface_patches *t = m->p->table;
  const uint32_t *member = t->member + t->start[k];
  size_t count = t->start[k + 1] - t->start[k];
  hk_patch_move move = {{0}, 0};
  double most2 = 0, zero = 0; /* NaN where a place is not finite */
  for (size_t e = 0; e < count; e++) {
    const double *a = m->a + 3 * (size_t)member[e], *b = m->b + 3 * (size_t)member[e];
    for (int c = 0; c < 3; c++) move.mean[c] += b[c] - a[c];
  }
  for (int c = 0; c < 3 && count > 0; c++) move.mean[c] /= (double)count;
  for (size_t e = 0; e < count; e++) {
    const double *a = m->a + 3 * (size_t)member[e], *b = m->b + 3 * (size_t)member[e];
    double x = b[0] - a[0] - move.mean[0], y = b[1] - a[1] - move.mean[1], z = b[2] - a[2] - move.mean[2];
    double square = x * x + y * y + z * z;
    most2 = square > most2 ? square : most2;
    zero += 0 * square;
  }
  move.spread = sqrt(most2 + zero);
  m->out[k] = move;
}

static void measure_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  for (size_t k = begin; k < end; k++) measure(context, k);
}

void hk_moving_patches_measure(const hk_moving_patches *p, const hk_host *host, const double *a, const double *b,
                               hk_patch_move *out) {
  measuring m = {p, a, b, out};
  host->parallel_for(host, p->table->count, GRAIN, measure_chunk, &m);
}

/* ---- places ---- */

typedef struct moving {
  hk_moving_patches *p;
  const double *x_from, *x_to;
} moving;

static void widen(hk_box *box, const double *x, double radius) {
  for (int c = 0; c < 3; c++) {
    double low = x[c] - radius, high = x[c] + radius;
    box->low[c] = low < box->low[c] ? low : box->low[c];
    box->high[c] = high > box->high[c] ? high : box->high[c];
  }
}

static void move_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const moving *w = context;
  const hk_surface_patches *t = w->p->table;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    hk_box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    bool held = true;
    if (!w->p->wanted[k]) continue;
    for (size_t e = t->start[k]; e < t->start[k + 1]; e++) {
      size_t i = t->member[e];
      widen(&box, w->x_from + 3 * i, w->p->radius[i]);
      widen(&box, w->x_to + 3 * i, w->p->radius[i]);
      held &= !hk_model_moves(w->p->model, i);
    }
    w->p->box[k] = box;
    w->p->held[k] = held;
    w->p->wanted[k] = false;
  }
}

static double longest(const hk_box *box) {
  return fmax(box->high[0] - box->low[0], fmax(box->high[1] - box->low[1], box->high[2] - box->low[2]));
}

void hk_moving_patches_box(hk_moving_patches *p, const hk_host *host, const double *x_from, const double *x_to) {
  moving w = {p, x_from, x_to};
  host->parallel_for(host, p->table->count, GRAIN, move_chunk, &w);
}

double hk_moving_patches_size(const hk_moving_patches *p) {
  double sum = 0;
  for (size_t k = 0; k < p->table->count; k++) sum += longest(&p->box[k]);
  return p->table->count ? sum / (double)p->table->count : 0;
}

double hk_moving_patches_distance(const hk_moving_patches *p, uint32_t a, uint32_t b) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double d = fmax(0, fmax(p->box[a].low[c] - p->box[b].high[c], p->box[b].low[c] - p->box[a].high[c]));
    sum += d * d;
  }
  return sqrt(sum);
}

typedef struct pairing {
  hk_moving_patches *p;
  const hk_host *host;
  double distance;
  uint32_t a;
  bool failed;
} pairing;

static bool make_room(hk_moving_patches *p, const hk_host *host) {
  if (p->pairs < p->room) return true;
  size_t room = p->room + p->room / 2 + 64;
  hk_patch_pair *grown = host->allocate(host, room * sizeof *grown);
  if (!grown) return false;
  if (p->pairs) memcpy(grown, p->pair, p->pairs * sizeof *grown);
  host->release(host, p->pair);
  p->pair = grown;
  p->room = room;
  return true;
}

static void visit(void *context, uint32_t b) {
  pairing *w = context;
  hk_moving_patches *p = w->p;
  if (b < w->a || (p->held[w->a] && p->held[b]) || !(hk_moving_patches_distance(p, w->a, b) < w->distance)) return;
  if (make_room(p, w->host))
    p->pair[p->pairs++] = (hk_patch_pair){w->a, b};
  else
    w->failed = true;
}

/* By b, as a is the same. */
static void sort(hk_patch_pair *pair, size_t count) {
  for (size_t k = 1; k < count; k++) {
    hk_patch_pair kept = pair[k];
    size_t to = k;
    for (; to > 0 && pair[to - 1].b > kept.b; to--) pair[to] = pair[to - 1];
    pair[to] = kept;
  }
}

hk_status hk_moving_patches_pair(hk_moving_patches *p, const hk_host *host, double distance) {
  pairing w = {.p = p, .host = host, .distance = distance};
  p->pairs = 0;
  hk_status status = hk_bvh_build(&p->tree, host, p->box, p->table->count);
  for (uint32_t a = 0; a < p->table->count && status == HK_OK; a++) {
    hk_box wide = p->box[a];
    size_t first = p->pairs;
    for (int c = 0; c < 3; c++) wide.low[c] -= distance, wide.high[c] += distance;
    w.a = a;
    hk_bvh_overlaps(&p->tree, p->box, &wide, visit, &w);
    if (w.failed) status = host->fail(host, HK_NO_MEMORY, "no memory for %zu pairs of patches", p->pairs);
    sort(p->pair + first, p->pairs - first);
  }
  return status;
}
