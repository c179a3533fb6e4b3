/* See barrier_contacts.h. */
#include "plugins/common/barrier/barrier_contacts.h"
#include "plugins/common/space/vector3.h"

#include <stdlib.h>
#include <string.h>

/* The margin of the search and of the names, in parts of the barrier's distance. */
static const double margin = 0.5;

int hk_barrier_order(const hk_surface_pair *a, const hk_surface_pair *b) {
  if (a->kind != b->kind) return a->kind < b->kind ? -1 : 1;
  for (int c = 0; c < 4; c++)
    if (a->vertex[c] != b->vertex[c]) return a->vertex[c] < b->vertex[c] ? -1 : 1;
  return 0;
}

static int by_order(const void *a, const void *b) { return hk_barrier_order(a, b); }

/* Sorts items that begin with a hk_surface_pair, and drops those that are there twice. Returns their number. */
static size_t sort_unique(void *items, size_t count, size_t size) {
  char *at = items;
  size_t kept = 0;
  if (count > 1) qsort(at, count, size, by_order);
  for (size_t k = 0; k < count; k++) {
    if (kept && by_order(at + size * (kept - 1), at + size * k) == 0) continue;
    if (kept != k) memcpy(at + size * kept, at + size * k, size);
    kept++;
  }
  return kept;
}

hk_status hk_barrier_forget(hk_barrier_contacts *c) {
  c->kept = false;
  c->number = 0;
  c->found = 0;
  return c->host->resize(c->host, &c->named, 0);
}

/* Room for `count` items, and half as many more where it has to grow: a change of size copies the array. */
static hk_status grow(const hk_barrier_contacts *c, hk_array *array, size_t count) {
  return count <= array->count ? HK_OK : c->host->resize(c->host, array, count + count / 2);
}

/* ---- surfaces ---- */

/* What is derived from the lists of the surfaces, after births and deaths. */
static hk_status take_surfaces(hk_barrier_contacts *c, const hk_view *from) {
  const hk_surface_mesh *mesh = c->surfaces->mesh(c->surfaces->self);
  if (mesh->number == c->number) return HK_OK;
  c->host->release(c->host, c->on_surface);
  c->on_surface = c->host->allocate(c->host, from->n + 1);
  if (!c->on_surface) return c->host->fail(c->host, HK_NO_MEMORY, "no memory for %zu particles", from->n);
  for (size_t k = 0; k < mesh->triangles; k++)
    for (int a = 0; a < 3; a++) c->on_surface[mesh->triangle[k][a]] = true;
  hk_barrier_shapes(mesh, from->x, from->n, c->law.distance, (hk_barrier_shape *)(void *)c->shape);
  c->number = mesh->number;
  c->kept = false;
  return HK_OK;
}

/* ---- gaps ---- */

typedef struct move {
  hk_barrier_pair *near;
  const double *x, *x_to;
} move;

/* m, how far the two features of a pair come nearer to each other on the move, at most. */
static double closing(const hk_surface_pair *p, const double x[12], const double x_to[12]) {
  double most = 0, step[12];
  int split = p->kind == HK_POINT_TRIANGLE ? 1 : 2;
  for (int e = 0; e < 12; e++) step[e] = x_to[e] - x[e];
  for (int a = 0; a < 3 * split; a += 3)
    for (int b = 3 * split; b < 12; b += 3) {
      double d[3] = {step[a] - step[b], step[a + 1] - step[b + 1], step[a + 2] - step[b + 2]};
      most = fmax(most, hk_dot(d, d));
    }
  return sqrt(most);
}

static void measure_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const move *m = context;
  double x[12], x_to[12];
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    hk_barrier_pair *p = &m->near[k];
    hk_barrier_gather(p->pair.vertex, m->x, x);
    hk_barrier_gather(p->pair.vertex, m->x_to, x_to);
    p->gap = sqrt(hk_nearest_of_pair((hk_pair_kind)p->pair.kind, x).squared) - p->pair.offset;
    p->least = p->gap - closing(&p->pair, x, x_to);
  }
}

static void measure_gaps(const hk_barrier_contacts *c, const hk_view *from, const double *x_to) {
  move m = {c->near.item, from->x, x_to};
  from->host->parallel_for(from->host, c->found, HK_BARRIER_GRAIN, measure_chunk, &m);
}

/* ---- the search ---- */

static bool acts(const hk_view *view, const hk_surface_pair *p) {
  bool all = true;
  for (int c = 0; c < 4 && view->is_active; c++) all = all && view->is_active[p->vertex[c]];
  return all;
}

/* m, the largest distance between two places of a particle. */
static double farthest(const double *a, const double *b, size_t n) {
  double most = 0;
  for (size_t i = 0; i < n; i++) {
    double d[3] = {a[3 * i] - b[3 * i], a[3 * i + 1] - b[3 * i + 1], a[3 * i + 2] - b[3 * i + 2]};
    most = fmax(most, hk_dot(d, d));
  }
  return sqrt(most);
}

static bool still_holds(const hk_barrier_contacts *c, const hk_view *from, const double *x_to) {
  double room = margin * c->law.distance;
  return c->kept && farthest(from->x, c->base.item, from->n) <= room && farthest(x_to, c->base.item, from->n) <= room;
}

/* Whether an edge, of length above 0, belongs to a strand. */
static bool is_strand(const hk_barrier_contacts *c, const uint32_t edge[2]) {
  return edge[0] != edge[1] && !(c->on_surface[edge[0]] && c->on_surface[edge[1]]);
}

static hk_barrier_pair *put(hk_barrier_pair *to, const hk_barrier_contacts *c, const hk_surface_pair *pair) {
  *to = (hk_barrier_pair){.pair = *pair};
  hk_barrier_measure(to, (const hk_barrier_shape *)(const void *)c->shape);
  return to + 1;
}

/* The mollifier takes the force from parallel edges. Of surfaces, points and triangles keep these apart; of strands,
 * the ends of one edge and the other edge, as pairs of an edge of length 0. */
static hk_barrier_pair *put_ends(hk_barrier_pair *to, const hk_barrier_contacts *c, const hk_surface_pair *pair) {
  for (int a = 0; a < 4; a++) {
    const uint32_t *other = pair->vertex + (a < 2 ? 2 : 0), end = pair->vertex[a];
    hk_surface_pair half = {.vertex = {end, end, other[0], other[1]}, .kind = HK_EDGE_EDGE, .offset = pair->offset};
    to = put(to, c, &half);
  }
  return to;
}

static hk_status take_pairs(hk_barrier_contacts *c, const hk_view *from, const hk_surface_pairs *found) {
  size_t strands = 0;
  for (size_t k = 0; k < found->count; k++) {
    const hk_surface_pair *p = &found->pair[k];
    strands += p->kind == HK_EDGE_EDGE && is_strand(c, p->vertex) && is_strand(c, p->vertex + 2);
  }
  hk_status status = grow(c, &c->near, found->count + 4 * strands);
  if (status != HK_OK) return status;
  hk_barrier_pair *first = c->near.item, *to = first;
  for (size_t k = 0; k < found->count; k++) {
    const hk_surface_pair *p = &found->pair[k];
    if (!acts(from, p)) continue;
    to = put(to, c, p);
    if (p->kind == HK_EDGE_EDGE && is_strand(c, p->vertex) && is_strand(c, p->vertex + 2)) to = put_ends(to, c, p);
  }
  c->found = (size_t)(to - first);
  return HK_OK;
}

/* Boxes that overlap are found; what stays farther apart than `reach` is dropped, and the rest is brought in order. */
static void keep_near(hk_barrier_contacts *c, double reach) {
  hk_barrier_pair *near = c->near.item;
  size_t kept = 0;
  for (size_t k = 0; k < c->found; k++)
    if (near[k].least < reach) near[kept++] = near[k];
  c->found = sort_unique(near, kept, sizeof *near);
}

/* Short moves are searched for around the present positions, so that what is found can be kept. In either case all
 * pairs are found that may get names, and these do not hang on when the last search was. */
static hk_status search(hk_barrier_contacts *c, const hk_view *from, const double *x_to) {
  hk_surface_pairs found;
  double room = margin * c->law.distance;
  c->kept = farthest(from->x, x_to, from->n) <= room;
  hk_status status = c->host->resize(c->host, &c->base, 3 * from->n);
  if (status != HK_OK) return status;
  if (c->kept) memcpy(c->base.item, from->x, 3 * from->n * sizeof(double));
  double reach = (1 + margin) * c->law.distance + (c->kept ? 2 * room : 0);
  const double *end = c->kept ? from->x : x_to;
  status = c->surfaces->pairs(c->surfaces->self, from->x, end, reach, &found);
  if (status == HK_OK) status = take_pairs(c, from, &found);
  if (status == HK_OK) measure_gaps(c, from, end);
  if (status == HK_OK) keep_near(c, reach);
  if (status != HK_OK) c->kept = false;
  return status;
}

/* ---- names ---- */

/* The place of a pair in a list that rises, from *k on; UINT32_MAX: it is not there. */
static uint32_t place(const hk_surface_pair *list, size_t count, const hk_surface_pair *pair, size_t *k) {
  while (*k < count && hk_barrier_order(&list[*k], pair) < 0) ++*k;
  return *k < count && hk_barrier_order(&list[*k], pair) == 0 ? (uint32_t)*k : UINT32_MAX;
}

/* Tells every pair its name. False: one that may act on the move has none, or one of `also`. */
static bool tell_names(hk_barrier_contacts *c, const hk_surface_pair *also, size_t also_count) {
  const hk_surface_pair *named = c->named.item;
  hk_barrier_pair *near = c->near.item;
  size_t k = 0, q = 0;
  bool all = true;
  for (size_t e = 0; e < c->found; e++) {
    near[e].name = place(named, c->named.count, &near[e].pair, &k);
    all &= near[e].name != UINT32_MAX || !(near[e].least < c->law.distance);
  }
  for (size_t e = 0; e < also_count; e++) all &= place(named, c->named.count, &also[e], &q) != UINT32_MAX;
  return all;
}

static hk_status name(hk_barrier_contacts *c, const hk_surface_pair *also, size_t also_count) {
  const hk_barrier_pair *near = c->near.item;
  hk_status status = c->host->resize(c->host, &c->named, c->found + also_count);
  if (status != HK_OK) return status;
  hk_surface_pair *named = c->named.item;
  size_t count = 0;
  for (size_t e = 0; e < c->found; e++)
    if (near[e].least < (1 + margin) * c->law.distance) named[count++] = near[e].pair;
  for (size_t e = 0; e < also_count; e++) named[count++] = also[e];
  status = c->host->resize(c->host, &c->named, sort_unique(named, count, sizeof *named));
  if (status == HK_OK) tell_names(c, also, also_count);
  return status;
}

/* Memory for evaluations, which must not ask for any. */
static hk_status reserve(hk_barrier_contacts *c) {
  hk_status status = grow(c, &c->sums, c->found / HK_BARRIER_GRAIN + 1);
  if (status == HK_OK) status = grow(c, &c->loads, 12 * c->found);
  if (status == HK_OK) status = grow(c, &c->acting, c->found);
  if (status == HK_OK) status = grow(c, &c->hessians, 144 * (size_t)HK_BARRIER_BATCH);
  return status;
}

hk_status hk_barrier_find(hk_barrier_contacts *c, const hk_view *from, const double *x_to, const hk_surface_pair *also,
                          size_t also_count, bool *changed) {
  hk_status status = take_surfaces(c, from);
  if (status == HK_OK && !still_holds(c, from, x_to)) status = search(c, from, x_to);
  if (status == HK_OK) status = reserve(c);
  if (status != HK_OK) return status;
  measure_gaps(c, from, x_to);
  if (tell_names(c, also, also_count)) return HK_OK;
  *changed = true;
  return name(c, also, also_count);
}
