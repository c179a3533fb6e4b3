/* Surfaces that tear. Forces say which of their edges and triangles are gone for ever (facets/internal.h); these leave
 * the scene's by the rules of gone_elements.h. For the plugins it is as after births and deaths: what rests on these
 * lists is made anew. Which elements are gone is in the checkpoints of the forces, so that nothing more has to be kept.
 */
#include "core/engine/contract/contract.h"
#include "core/numerics/population/population.h"
#include "core/plugin/gone_elements.h"

#include <string.h>

static const hk_internal_facet *facet_of(const hk_loop *loop, size_t k) {
  return &hk_force_of(loop->plugins->kind[HK_FORCE].item[k]->plugin)->internal;
}

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
    for (size_t e = 0; e < lost.node.count; e++) count += hk_is_gone(&lost, e);
  }
  return count;
}

/* ---- what goes ---- */

static bool allocate(hk_gone_elements *t, const hk_model *m, size_t lost) {
  t->triangle = malloc((lost + 1) * sizeof *t->triangle);
  t->edge = malloc((lost + 1) * sizeof *t->edge);
  t->border = malloc((HK_SIDES * lost + 1) * sizeof *t->border);
  t->held = malloc((HK_SIDES * m->triangles.count + 1) * sizeof *t->held);
  return t->triangle && t->edge && t->border && t->held;
}

static void release(hk_gone_elements *t) {
  void *lists[] = {t->triangle, t->edge, t->border, t->held};
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) free(lists[k]);
}

static size_t keep_triangles(hk_gone_elements *t, hk_state *s) {
  size_t kept = 0, count = s->model.triangles.count;
  for (size_t k = 0; k < count; k++) {
    const uint32_t *corner = s->triangle[k];
    if (hk_gone_triangle(t, corner)) continue;
    hk_gone_hold(t, corner);
    memmove(s->triangle[kept++], corner, sizeof *s->triangle);
  }
  hk_corners_sort(t->held, t->holds);
  return s->model.triangles.count = kept, count - kept;
}

static size_t keep_edges(const hk_gone_elements *t, hk_state *s) {
  size_t kept = 0, count = s->model.edges.count;
  for (size_t k = 0; k < count; k++)
    if (!hk_gone_edge(t, s->edge[k])) memmove(s->edge[kept++], s->edge[k], sizeof *s->edge);
  return s->model.edges.count = kept, count - kept;
}

static bool take_out(hk_gone_elements *t, hk_loop *loop) {
  for (size_t k = 0; k < loop->plugins->kind[HK_FORCE].count; k++) {
    const hk_lost_elements lost = lost_of(loop, k);
    hk_gone_take(t, &lost);
  }
  hk_gone_sort(t);
  size_t left = keep_triangles(t, loop->state);
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
  hk_gone_elements t = {0};
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
