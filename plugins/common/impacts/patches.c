/* Particles are put in the order of a Z-curve through a grid of 2^10 cells a side, part by part, and cut into patches
 * (Morton 1966). */
#include "plugins/common/impacts/patches.h"

#include <stdlib.h>
#include <string.h>

enum { PARTICLES = 48 /* in a patch; 24 and 96 cost more where cloth slides over a ball */, GRAIN = 8, BITS = 10 };

typedef struct place {
  uint32_t part, code, particle;
} place;

static int in_order(const void *left, const void *right) {
  const place *a = left, *b = right;
  if (a->part != b->part) return a->part < b->part ? -1 : 1;
  if (a->code != b->code) return a->code < b->code ? -1 : 1;
  return (a->particle > b->particle) - (a->particle < b->particle);
}

static void box_of(const hk_view *view, double low[3], double *size) {
  double high[3];
  for (int c = 0; c < 3; c++) low[c] = INFINITY, high[c] = -INFINITY;
  for (size_t i = 0; i < 3 * view->n; i++) {
    low[i % 3] = fmin(low[i % 3], view->x[i]);
    high[i % 3] = fmax(high[i % 3], view->x[i]);
  }
  *size = 0;
  for (int c = 0; c < 3; c++) *size = fmax(*size, high[c] - low[c]);
}

static uint32_t code_of(const double x[3], const double low[3], double size) {
  uint32_t code = 0;
  for (int c = 0; c < 3; c++) {
    double part = size > 0 ? (x[c] - low[c]) / size * ((1 << BITS) - 1) : 0;
    for (int b = 0; b < BITS; b++) code |= ((uint32_t)part >> b & 1U) << (3 * b + c);
  }
  return code;
}

static void set_homes(hk_patches *p, const hk_surface_mesh *mesh, const hk_view *view, place *order) {
  double low[3], size;
  size_t inside = 0;
  box_of(view, low, &size);
  for (size_t i = 0; i < view->n; i++)
    order[i] = (place){mesh->part[i], code_of(view->x + 3 * i, low, size), (uint32_t)i};
  qsort(order, view->n, sizeof *order, in_order);
  for (size_t k = 0; k < view->n; k++) {
    bool new = k == 0 || order[k].part != order[k - 1].part || inside == PARTICLES;
    p->count += new;
    inside = new ? 1 : inside + 1;
    p->home[order[k].particle] = (uint32_t)p->count - 1;
  }
}

/* Calls for all features; counts them, or, with `member`, enters their particles. */
static void enter(const hk_patches *p, const uint32_t *vertex, int count, size_t *at, uint32_t *member) {
  uint32_t home = hk_patch_of(p, vertex, count);
  for (int i = 0; i < count; i++) {
    if (member) member[at[home]] = vertex[i];
    at[home]++;
  }
}

static void enter_all(const hk_patches *p, const hk_surface_mesh *mesh, size_t *at, uint32_t *member) {
  for (size_t k = 0; k < mesh->points; k++) enter(p, &mesh->point[k], 1, at, member);
  for (size_t k = 0; k < mesh->edges; k++) enter(p, mesh->edge[k], 2, at, member);
  for (size_t k = 0; k < mesh->triangles; k++) enter(p, mesh->triangle[k], 3, at, member);
}

static int rising(const void *a, const void *b) {
  uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
  return (p > q) - (p < q);
}

/* Every particle once in each patch. */
static void remove_doubles(hk_patches *p) {
  size_t kept = 0, begin = 0;
  for (size_t k = 0; k < p->count; k++) {
    size_t end = p->start[k + 1], first = kept;
    qsort(p->member + begin, end - begin, sizeof *p->member, rising);
    for (size_t e = begin; e < end; e++)
      if (kept == first || p->member[kept - 1] != p->member[e]) p->member[kept++] = p->member[e];
    begin = end;
    p->start[k] = first;
  }
  p->start[p->count] = kept;
}

hk_status hk_patches_open(hk_patches *p, const hk_host *host, const hk_surface_mesh *mesh, const hk_view *view) {
  size_t room = mesh->points + 2 * mesh->edges + 3 * mesh->triangles;
  hk_patches_free(p, host);
  place *order = host->allocate(host, (view->n + 1) * sizeof *order);
  size_t *at = host->allocate(host, (view->n + 2) * sizeof *at);
  p->home = host->allocate(host, (view->n + 1) * sizeof *p->home);
  p->start = host->allocate(host, (view->n + 2) * sizeof *p->start);
  p->member = host->allocate(host, (room + 1) * sizeof *p->member);
  bool fine = order && at && p->home && p->start && p->member;
  if (fine) {
    set_homes(p, mesh, view, order);
    enter_all(p, mesh, p->start + 1, NULL);
    for (size_t k = 0; k < p->count; k++) p->start[k + 1] += p->start[k];
    memcpy(at, p->start, (p->count + 1) * sizeof *at);
    enter_all(p, mesh, at, p->member);
    remove_doubles(p);
  }
  host->release(host, order);
  host->release(host, at);
  if (fine) return HK_OK;
  hk_patches_free(p, host);
  return host->fail(host, HK_NO_MEMORY, "no memory for patches of %zu particles", view->n);
}

void hk_patches_free(hk_patches *p, const hk_host *host) {
  host->release(host, p->home);
  host->release(host, p->start);
  host->release(host, p->member);
  *p = (hk_patches){0};
}

typedef struct measuring {
  const hk_patches *p;
  const double *a, *b;
  hk_patch_move *out;
} measuring;

static void measure(const measuring *m, size_t k) {
  const uint32_t *member = m->p->member + m->p->start[k];
  size_t count = m->p->start[k + 1] - m->p->start[k];
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

void hk_patches_measure(const hk_patches *p, const hk_host *host, const double *a, const double *b,
                        hk_patch_move *out) {
  measuring m = {p, a, b, out};
  host->parallel_for(host, p->count, GRAIN, measure_chunk, &m);
}
