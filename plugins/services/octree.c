/* Octrees for all plugins of a run: of gravitation, and of whoever looks for what is near (boxes of cells that do not
 * touch are passed over whole). A tree is a function of the places alone; that of the last call is kept, since at the
 * same places there are often several questions: force, energy, encounters. */
#include "plugins/common/space/octree_builder.h"

#include <string.h>

typedef struct octree {
  hk_octree_builder builder;
  hk_octree tree;
  bool built;
  bool listed;    /* of a list; else of all */
  double *at;     /* n x 3: the places of the tree */
  uint32_t *list; /* its particles, as asked */
  hk_octrees table;
  const hk_host *host;
} octree;

static bool is_kept(const octree *s, const hk_view *view, const double *x, const uint32_t *list, size_t count) {
  if (!s->built || s->listed != (list != NULL) || s->tree.points != count) return false;
  if (list && count && memcmp(s->list, list, count * sizeof *list) != 0) return false;
  return view->n == 0 || memcmp(s->at, x, 3 * view->n * sizeof *x) == 0;
}

static void keep(octree *s, const hk_view *view, const double *x, const uint32_t *list, size_t count) {
  s->built = true;
  s->listed = list != NULL;
  if (list && count) memcpy(s->list, list, count * sizeof *list);
  if (view->n) memcpy(s->at, x, 3 * view->n * sizeof *x);
}

static hk_status tree(void *self, const hk_view *view, const double *x, const uint32_t *list, size_t count,
                      hk_octree *out) {
  octree *s = self;
  uint32_t i;
  if (!is_kept(s, view, x, list, count)) {
    s->built = false;
    if (!hk_octree_build(&s->builder, x, list, count, &s->tree, &i))
      return s->host->fail(s->host, HK_NOT_FINITE,
                           "particle %u is at (%g, %g, %g) m at t = %g s: an octree has no cell there",
                           view->model->id[i], x[3 * (size_t)i], x[3 * (size_t)i + 1], x[3 * (size_t)i + 2], view->t);
    keep(s, view, x, list, count);
  }
  *out = s->tree;
  return HK_OK;
}

static hk_status topology(void *self, const hk_view *view) {
  octree *s = self;
  s->built = false;
  s->host->release(s->host, s->at);
  s->host->release(s->host, s->list);
  s->at = s->host->allocate(s->host, 3 * view->n * sizeof *s->at);
  s->list = s->host->allocate(s->host, view->n * sizeof *s->list);
  if (!s->at || !s->list || hk_octree_reserve(&s->builder, s->host, view->n) != HK_OK)
    return s->host->fail(s->host, HK_NO_MEMORY, "no memory for the octree of %zu particles", view->n);
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  octree *s = self;
  s->host = host;
  s->table = (hk_octrees){self, tree};
  if (view->model->box)
    return host->fail(host, HK_BAD_PARAM,
                      "trees see no images across the faces of a periodic box, so that what asks for one would miss "
                      "them: leave scene:periodic out");
  return topology(self, view);
}

static const void *table(void *self) { return &((octree *)self)->table; }

static const hk_service service = {.size = sizeof(hk_service), .interface = "octree/1", .table = table};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "octree",
    .summary = "octrees of particles, for all plugins that ask: sorted along Morton's curve, few points to a cell",
    .reference = "Morton 1966; Warren and Salmon 1993, Supercomputing '93",
    .instance_size = sizeof(octree),
    .create = create,
    .topology = topology,
    .service = &service,
};
