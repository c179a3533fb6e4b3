/* See breakage.h. What is gone is sorted once for each list, and looked up by its particles. */
#include "plugins/common/elements/breakage.h"
#include "core/plugin/gone_elements.h"

hk_status hk_breakage_enter(const hk_host *host, const hk_breakable *breakable) {
  const hk_breakage *breakage = host->query(host, HK_BREAKAGE_INTERFACE);
  return breakage ? breakage->enter(breakage->self, breakable) : HK_FAILED;
}

static hk_lost_elements of_member(const hk_breakage *s, size_t k) {
  hk_lost_elements lost = {.stride = 1};
  s->member[k].lost(s->member[k].self, &lost);
  return lost;
}

size_t hk_breakage_count(const hk_breakage *s) {
  size_t count = 0;
  for (size_t k = 0; k < s->count; k++) {
    const hk_lost_elements lost = of_member(s, k);
    for (size_t e = 0; e < lost.node.count; e++) count += hk_is_gone(&lost, e);
  }
  return count;
}

static bool allocate(hk_gone_elements *g, const hk_host *host, size_t most) {
  g->edge = host->allocate(host, (most + 1) * sizeof *g->edge);
  g->triangle = host->allocate(host, (most + 1) * sizeof *g->triangle);
  g->border = host->allocate(host, (HK_SIDES * most + 1) * sizeof *g->border);
  g->held = host->allocate(host, (HK_SIDES * most + 1) * sizeof *g->held);
  return g->edge && g->triangle && g->border && g->held;
}

static void release(hk_gone_elements *g, const hk_host *host) {
  host->release(host, g->edge);
  host->release(host, g->triangle);
  host->release(host, g->border);
  host->release(host, g->held);
}

static void hold(hk_gone_elements *g, const hk_tuples *node) {
  for (size_t e = 0; e < node->count && node->arity == 3; e++)
    if (!hk_gone_triangle(g, hk_tuple(node, e))) hk_gone_hold(g, hk_tuple(node, e));
}

static void fill(hk_gone_elements *g, const hk_breakage *s) {
  for (size_t k = 0; k < s->count; k++) {
    const hk_lost_elements lost = of_member(s, k);
    hk_gone_take(g, &lost);
  }
  hk_gone_sort(g);
  for (size_t k = 0; k < s->count; k++) {
    const hk_lost_elements lost = of_member(s, k);
    hold(g, &lost.node);
  }
  hk_corners_sort(g->held, g->holds);
}

hk_status hk_breakage_mark(const hk_breakage *s, const hk_host *host, const hk_tuples *node, bool *gone) {
  size_t most = 0;
  hk_gone_elements g = {0};
  for (size_t k = 0; k < s->count; k++) most += of_member(s, k).node.count;
  bool room = allocate(&g, host, most);
  if (room) fill(&g, s);
  for (size_t e = 0; e < node->count && room; e++)
    gone[e] = node->arity == 2   ? hk_gone_edge(&g, hk_tuple(node, e))
              : node->arity == 3 ? hk_gone_triangle(&g, hk_tuple(node, e))
                                 : false;
  release(&g, host);
  return room ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu elements that may be gone", most);
}
