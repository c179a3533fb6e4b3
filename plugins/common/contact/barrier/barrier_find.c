/* See barrier_contacts.h: the search for candidate pairs of a move, and their gaps on it. */
#include "plugins/common/contact/barrier/barrier_contacts.h"
#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

#include <string.h>

hk_status hk_barrier_forget(hk_barrier_contacts *c) {
  c->kept = c->evaluated = false;
  c->number = 0;
  c->found = 0;
  return c->host->resize(c->host, &c->named, 0);
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
  const hk_barrier_contacts *contacts;
  hk_barrier_pair *near;
  const double *x, *x_to;
  const hk_feature_pair *pair; /* of a search: all that was found, */
  const uint32_t *order;       /* in this order; */
  const bool *is_active;       /* all particles of a pair have to be; NULL: they are */
  double reach;                /* a pair is kept that may come nearer than that */
  uint32_t *kept;              /* of the chunks */
} move;

static void measure_gap(hk_barrier_pair *p, const move *m) {
  hk_pair_path path;
  hk_pair_path_of(&path, &p->pair, m->x, m->x_to);
  hk_nearest at = hk_nearest_of_pair(p->pair.kind, path.from);
  p->pair.gap = sqrt(at.squared) - p->pair.offset;
  p->least = p->pair.gap - hk_pair_approach(p->pair.kind, &path);
  hk_copy(p->axis, hk_pair_frame_of(&at).n);
}

static void measure_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const move *m = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) measure_gap(&m->near[k], m);
}

static void measure_gaps(const hk_barrier_contacts *c, const hk_view *from, const double *x_to) {
  move m = {.near = c->near.item, .x = from->x, .x_to = x_to};
  from->host->parallel_for(from->host, c->found, HK_BARRIER_GRAIN, measure_chunk, &m);
}

/* ---- the search ---- */

/* m, at most how much two particles have moved against each other from the places b to a: the diagonal of the box of
 * all displacements, or twice the largest of them. What all have in common changes no gap. */
static double moved_apart(const double *a, const double *b, size_t n) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, most = 0;
  for (size_t i = 0; i < 3 * n; i += 3) {
    double d[3] = {a[i] - b[i], a[i + 1] - b[i + 1], a[i + 2] - b[i + 2]};
    for (int c = 0; c < 3; c++) low[c] = d[c] < low[c] ? d[c] : low[c], high[c] = d[c] > high[c] ? d[c] : high[c];
    most = fmax(most, hk_dot(d, d));
  }
  double across[3] = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
  return n ? fmin(hk_length(across), 2 * sqrt(most)) : 0;
}

static bool still_holds(const hk_barrier_contacts *c, const hk_view *from, const double *x_to) {
  double room = 2 * HK_BARRIER_MARGIN * c->law.distance;
  return c->kept && moved_apart(from->x, c->base.item, from->n) <= room &&
         moved_apart(x_to, c->base.item, from->n) <= room;
}

/* Whether an edge, of length above 0, belongs to a strand. */
static bool is_strand(const hk_barrier_contacts *c, const uint32_t edge[2]) {
  return edge[0] != edge[1] && !(c->on_surface[edge[0]] && c->on_surface[edge[1]]);
}

/* The mollifier takes the force from parallel edges. Of surfaces, points and triangles keep these apart; of strands,
 * the ends of one edge and the other edge, as pairs of an edge of length 0. */
static hk_feature_pair *put_ends(hk_feature_pair *to, const hk_feature_pair *pair) {
  for (int a = 0; a < 4; a++) {
    const uint32_t *other = pair->vertex + (a < 2 ? 2 : 0), end = pair->vertex[a];
    *to++ = (hk_feature_pair){.vertex = {end, end, other[0], other[1]}, .kind = HK_EDGE_EDGE, .offset = pair->offset};
  }
  return to;
}

static bool are_strands(const hk_barrier_contacts *c, const hk_feature_pair *p) {
  return p->kind == HK_EDGE_EDGE && is_strand(c, p->vertex) && is_strand(c, p->vertex + 2);
}

/* Adds the ends of strands to what was found. */
static hk_status add_ends(hk_barrier_contacts *c, hk_feature_pairs *found) {
  size_t strands = 0;
  for (size_t k = 0; k < found->count; k++) strands += are_strands(c, &found->pair[k]);
  if (strands == 0) return HK_OK;
  hk_status status = hk_reserve_array(c->host, &c->halves, found->count + 4 * strands);
  if (status != HK_OK) return status;
  hk_feature_pair *first = c->halves.item, *to = first + found->count;
  memcpy(first, found->pair, found->count * sizeof *first);
  for (size_t k = 0; k < found->count; k++)
    if (are_strands(c, &found->pair[k])) to = put_ends(to, &found->pair[k]);
  *found = (hk_feature_pairs){(size_t)(to - first), first};
  return HK_OK;
}

static bool acts(const bool *is_active, const hk_feature_pair *p) {
  bool all = true;
  for (int c = 0; c < 4 && is_active; c++) all = all && is_active[p->vertex[c]];
  return all;
}

/* Boxes that overlap are found; what stays farther apart than `reach` is dropped. */
static void take_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const move *m = context;
  hk_barrier_pair *to = m->near + begin;
  for (size_t k = begin; k < end; k++) {
    const hk_feature_pair *pair = &m->pair[m->order[k]];
    if (!acts(m->is_active, pair)) continue;
    *to = (hk_barrier_pair){.pair = *pair};
    measure_gap(to, m);
    if (!(to->least < m->reach)) continue;
    hk_barrier_measure(to++, (const hk_barrier_shape *)(const void *)m->contacts->shape);
  }
  m->kept[chunk] = (uint32_t)(to - m->near - begin);
}

static hk_status take_pairs(hk_barrier_contacts *c, const hk_view *from, const double *x_to, double reach,
                            hk_feature_pairs found) {
  size_t count = 0;
  hk_status status = add_ends(c, &found);
  if (status == HK_OK) status = hk_pairs_sort(&c->sorter, c->host, found.pair, found.count, from->n, &count);
  if (status == HK_OK) status = hk_reserve_array(c->host, &c->near, count);
  if (status == HK_OK) status = hk_reserve_array(c->host, &c->kept_of, count / HK_BARRIER_GRAIN + 1);
  if (status != HK_OK) return status;
  move m = {c, c->near.item, from->x, x_to, found.pair, c->sorter.order.item, from->is_active, reach, c->kept_of.item};
  c->host->parallel_for(c->host, count, HK_BARRIER_GRAIN, take_chunk, &m);
  c->found = 0;
  for (size_t k = 0; k * HK_BARRIER_GRAIN < count; k++) {
    memmove(m.near + c->found, m.near + k * HK_BARRIER_GRAIN, m.kept[k] * sizeof *m.near);
    c->found += m.kept[k];
  }
  return HK_OK;
}

/* What comes near on the move, and around its end, where an iteration goes on: so it can be kept for that. All pairs
 * are found that may get names, and these do not hang on when the last search was. */
static hk_status search(hk_barrier_contacts *c, const hk_view *from, const double *x_to) {
  hk_feature_pairs found;
  double reach = (1 + 3 * HK_BARRIER_MARGIN) * c->law.distance;
  c->evaluated = c->kept = false;
  hk_status status = hk_reserve_array(c->host, &c->base, 3 * from->n);
  if (status == HK_OK) status = c->surfaces->pairs(c->surfaces->self, from->x, x_to, reach, &found);
  if (status == HK_OK) status = take_pairs(c, from, x_to, reach, found);
  if (status != HK_OK) {
    c->found = 0;
    return status;
  }
  memcpy(c->base.item, x_to, 3 * from->n * sizeof *x_to);
  c->kept = true;
  return HK_OK;
}

/* Memory for evaluations, which must not ask for any. */
static hk_status reserve(hk_barrier_contacts *c, size_t n) {
  const size_t chunks = c->found / HK_BARRIER_GRAIN + 1;
  const struct {
    hk_array *array;
    size_t count;
  } memory[] = {{&c->sums, chunks},
                {&c->parts, 2 * chunks},
                {&c->tally, chunks},
                {&c->values, c->found},
                {&c->loads, 12 * c->found},
                {&c->acting, c->found},
                {&c->hessians, HK_BARRIER_BATCH},
                {&c->way, 3 * n},
                {&c->at, 3 * n}};
  hk_status status = HK_OK;
  for (size_t k = 0; k < sizeof memory / sizeof *memory && status == HK_OK; k++)
    status = hk_reserve_array(c->host, memory[k].array, memory[k].count);
  return status;
}

/* The safe part of the move: no method goes beyond it. */
static double safe_part(hk_barrier_contacts *c, const hk_view *from, const double *x_to) {
  double *way = c->way.item;
  for (size_t e = 0; e < 3 * from->n; e++) way[e] = x_to[e] - from->x[e];
  return hk_barrier_limit(c, from, way);
}

hk_status hk_barrier_find(hk_barrier_contacts *c, const hk_view *from, const double *x_to, bool *changed) {
  hk_status status = take_surfaces(c, from);
  if (status == HK_OK && still_holds(c, from, x_to))
    measure_gaps(c, from, x_to);
  else if (status == HK_OK)
    status = search(c, from, x_to);
  if (status == HK_OK) status = reserve(c, from->n);
  if (status != HK_OK) return status;
  return hk_barrier_update_names(c, safe_part(c, from, x_to), changed);
}
