/* Surfaces that tear. Forces say which of their edges and triangles are gone for ever (facets/internal.h); these leave
 * the scene's:
 * - a triangle that is gone, or of which a side is;
 * - an edge that is gone, or that is a side of triangles that are gone and of none that stays.
 * For the plugins it is as after births and deaths: what rests on these lists is made anew. Which elements are gone is
 * in the checkpoints of the forces, so that nothing more has to be kept. */
#include "core/engine/contract/contract.h"
#include "core/numerics/population/population.h"

#include <stdlib.h>
#include <string.h>

enum { SIDES = 3 };

typedef struct triple {
  uint32_t corner[3]; /* rising */
} triple;

typedef struct torn {
  triple *triangle;        /* sorted, those that are gone */
  uint64_t *edge, *border; /* sorted: edges that are gone; sides of triangles that are gone */
  uint64_t *held;          /* sorted, sides of triangles that stay */
  size_t triangles, edges, borders, holds;
} torn;

static const hk_internal_facet *facet_of(const hk_loop *loop, size_t k) {
  return &hk_force_of(loop->plugins->kind[HK_FORCE].item[k]->plugin)->internal;
}

static bool gone(const hk_lost_elements *l, size_t k) { return l->gone[k * l->stride] > 0; }

/* Those of force k; none: it has no such elements. */
static hk_lost_elements lost_of(const hk_loop *loop, size_t k) {
  hk_lost_elements lost = {.stride = 1};
  const hk_instance *force = loop->plugins->kind[HK_FORCE].item[k];
  if (!facet_of(loop, k)->lost) return lost;
  const hk_instance *outer = hk_enter(force);
  facet_of(loop, k)->lost(force->self, &lost);
  hk_leave(force, outer);
  return lost;
}

static size_t count_lost(const hk_loop *loop) {
  size_t count = 0;
  for (size_t k = 0; k < loop->plugins->kind[HK_FORCE].count; k++) {
    const hk_lost_elements lost = lost_of(loop, k);
    for (size_t e = 0; e < lost.node.count; e++) count += gone(&lost, e);
  }
  return count;
}

/* ---- sorted lists ---- */

static uint64_t pair_of(uint32_t a, uint32_t b) { return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a; }

static triple triple_of(const uint32_t *t) {
  uint32_t a = t[0], b = t[1], c = t[2], low = a < b ? a : b, high = a < b ? b : a;
  return (triple){{c < low ? c : low, c < low ? low : c < high ? c : high, c < high ? high : c}};
}

static int by_pair(const void *a, const void *b) {
  const uint64_t *p = a, *q = b;
  return (*p > *q) - (*p < *q);
}

static int by_corners(const void *a, const void *b) {
  const triple *p = a, *q = b;
  for (int c = 0; c < 3; c++)
    if (p->corner[c] != q->corner[c]) return p->corner[c] < q->corner[c] ? -1 : 1;
  return 0;
}

static bool has(const uint64_t *list, size_t count, uint64_t pair) {
  return count > 0 && bsearch(&pair, list, count, sizeof pair, by_pair);
}

static void sort_pairs(uint64_t *list, size_t count) {
  if (count) qsort(list, count, sizeof *list, by_pair);
}

static size_t put_sides(uint64_t *list, size_t count, const uint32_t *t) {
  for (int c = 0; c < SIDES; c++) list[count++] = pair_of(t[c], t[(c + 1) % SIDES]);
  return count;
}

/* ---- what goes ---- */

static bool allocate(torn *t, const hk_model *m, size_t lost) {
  t->triangle = malloc((lost + 1) * sizeof *t->triangle);
  t->edge = malloc((lost + 1) * sizeof *t->edge);
  t->border = malloc((SIDES * lost + 1) * sizeof *t->border);
  t->held = malloc((SIDES * m->triangles.count + 1) * sizeof *t->held);
  return t->triangle && t->edge && t->border && t->held;
}

static void release(torn *t) {
  void *lists[] = {t->triangle, t->edge, t->border, t->held};
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) free(lists[k]);
}

static void take_lost(torn *t, const hk_lost_elements *lost) {
  for (size_t e = 0; e < lost->node.count; e++) {
    const uint32_t *node = hk_tuple(&lost->node, e);
    if (!gone(lost, e)) continue;
    if (lost->node.arity == 2) t->edge[t->edges++] = pair_of(node[0], node[1]);
    if (lost->node.arity != 3) continue;
    t->triangle[t->triangles++] = triple_of(node);
    t->borders = put_sides(t->border, t->borders, node);
  }
}

static bool triangle_goes(const torn *t, const uint32_t *corner) {
  const triple key = triple_of(corner);
  bool goes = t->triangles > 0 && bsearch(&key, t->triangle, t->triangles, sizeof key, by_corners);
  for (int c = 0; c < SIDES && !goes; c++) goes = has(t->edge, t->edges, pair_of(corner[c], corner[(c + 1) % SIDES]));
  return goes;
}

static size_t keep_triangles(torn *t, hk_state *s) {
  size_t kept = 0, count = s->model.triangles.count;
  for (size_t k = 0; k < count; k++) {
    const uint32_t *corner = s->triangle[k];
    if (triangle_goes(t, corner)) continue;
    t->holds = put_sides(t->held, t->holds, corner);
    memmove(s->triangle[kept++], corner, sizeof *s->triangle);
  }
  return s->model.triangles.count = kept, count - kept;
}

static bool edge_goes(const torn *t, const uint32_t *end) {
  const uint64_t pair = pair_of(end[0], end[1]);
  return has(t->edge, t->edges, pair) || (has(t->border, t->borders, pair) && !has(t->held, t->holds, pair));
}

static size_t keep_edges(const torn *t, hk_state *s) {
  size_t kept = 0, count = s->model.edges.count;
  for (size_t k = 0; k < count; k++)
    if (!edge_goes(t, s->edge[k])) memmove(s->edge[kept++], s->edge[k], sizeof *s->edge);
  return s->model.edges.count = kept, count - kept;
}

static bool take_out(torn *t, hk_loop *loop) {
  for (size_t k = 0; k < loop->plugins->kind[HK_FORCE].count; k++) {
    const hk_lost_elements lost = lost_of(loop, k);
    take_lost(t, &lost);
  }
  if (t->triangles) qsort(t->triangle, t->triangles, sizeof *t->triangle, by_corners);
  sort_pairs(t->edge, t->edges);
  size_t left = keep_triangles(t, loop->state);
  sort_pairs(t->border, t->borders);
  sort_pairs(t->held, t->holds);
  return left + keep_edges(t, loop->state) > 0;
}

/* ---- the loop's ---- */

static hk_status no_memory(const hk_loop *loop) {
  return hk_error_set(loop->error, HK_NO_MEMORY, "no memory for a surface that tears, of %zu triangles",
                      loop->state->model.triangles.count);
}

bool hk_surfaces_may_tear(const hk_loop *loop) {
  for (size_t k = 0; k < loop->plugins->kind[HK_FORCE].count; k++)
    if (facet_of(loop, k)->lost) return true;
  return false;
}

static hk_status tell(hk_loop *loop) {
  size_t n = loop->state->model.n;
  hk_status status = hk_population_begin(loop->population, loop->error);
  for (size_t i = 0; i < n && status == HK_OK; i++) loop->population->map[i] = (uint32_t)i;
  return status == HK_OK ? hk_dynamics_remap(loop->dynamics, loop->population->map, n) : status;
}

hk_status hk_surfaces_tear(hk_loop *loop, bool *torn_any) {
  size_t lost = count_lost(loop);
  torn t = {0};
  *torn_any = false;
  if (lost == loop->population->lost) return HK_OK;
  loop->population->lost = lost;
  bool room = allocate(&t, &loop->state->model, lost);
  if (room) *torn_any = take_out(&t, loop);
  release(&t);
  if (!room) return no_memory(loop);
  return *torn_any ? tell(loop) : HK_OK;
}

hk_status hk_emit_and_tear(hk_loop *loop, double h, unsigned when) {
  bool any;
  hk_status status = hk_sources_emit(loop, h, when);
  if (status != HK_OK || count_lost(loop) == loop->population->lost) return status;
  hk_state *s = loop->state;
  double before = hk_query_potential(loop->dynamics, s->t, s->X);
  status = hk_surfaces_tear(loop, &any);
  if (status != HK_OK || !any) return status;
  loop->record->dissipated += before - hk_query_potential(loop->dynamics, s->t, s->X);
  hk_step_reset(loop, HK_PARTICLES_CHANGED);
  return HK_OK;
}

hk_status hk_surfaces_resume(hk_loop *loop) {
  bool any;
  hk_status status = hk_surfaces_tear(loop, &any);
  for (size_t k = 0; k < loop->plugins->kind[HK_FORCE].count && status == HK_OK && !any; k++) {
    hk_instance *force = loop->plugins->kind[HK_FORCE].item[k];
    if (!facet_of(loop, k)->lost || !force->plugin->topology) continue;
    hk_view view = hk_instance_view(force, &loop->state->view);
    const hk_instance *outer = hk_enter(force);
    status = hk_leave_with(force, outer, "topology", force->plugin->topology(force->self, &view));
  }
  return status;
}
