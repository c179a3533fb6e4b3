/* Trees of boxes for all plugins of a run (plugins/common/space/bvh.h): obstacles of triangles, and whatever looks for
 * boxes that overlap. The service owns the trees and decides whether one is fitted to boxes that moved or built anew.
 */
#include "plugins/common/space/bvh.h"

/* Searches visit nodes in proportion to the cost; building costs some ten times as much as fitting. */
static const double spread = 1.5;

typedef struct owned {
  hk_bvh tree; /* first: what callers have */
  struct owned *next;
} owned;

typedef struct bvh {
  owned *trees;
  hk_bvh_service table;
  const hk_host *host;
} bvh;

static hk_status build(void *self, const hk_box *box, size_t items, hk_bvh **tree) {
  bvh *s = self;
  if (!*tree) {
    owned *fresh = s->host->allocate(s->host, sizeof *fresh);
    if (!fresh) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for a tree");
    fresh->next = s->trees;
    s->trees = fresh;
    *tree = &fresh->tree;
  }
  return hk_bvh_build(*tree, s->host, box, items);
}

static hk_status move(void *self, const hk_box *box, hk_bvh *tree) {
  bvh *s = self;
  hk_bvh_refit(tree, s->host, box);
  return hk_bvh_cost(tree) > spread * tree->built_cost ? hk_bvh_build(tree, s->host, box, tree->items) : HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  bvh *s = self;
  (void)view;
  s->host = host;
  s->table = (hk_bvh_service){self, build, move};
  return HK_OK;
}

static const void *table(void *self) { return &((bvh *)self)->table; }

static const hk_service service = {.size = sizeof(hk_service), .interface = HK_BVH_INTERFACE, .table = table};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "bvh",
    .summary = "trees of boxes: which boxes overlap, and what is nearest, for all plugins that ask",
    .reference = "Ericson 2005, Real-Time Collision Detection, chapter 6",
    .instance_size = sizeof(bvh),
    .create = create,
    .service = &service,
};
