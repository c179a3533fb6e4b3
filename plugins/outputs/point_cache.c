/* The motion as a point cache, which Blender plays with the modifier Mesh Cache: the mesh of the first frame as an OBJ
 * file, and the positions of its vertices at all frames as a PC2 file, in 32-bit floats. */
#include "plugins/common/sequence/formats.h"
#include "plugins/common/sequence/pc2.h"
#include "plugins/common/frame_data/gatherer.h"

#include <limits.h>
#include <stdio.h>

typedef struct point_cache {
  const char *file, *group;
  int64_t every;
  hk_tuples only;

  const hk_host *host;
  hk_gatherer gatherer;
  hk_pc2 cache;
  bool ended; /* the particles are others than those of the mesh */
  char path[PATH_MAX];
} point_cache;

/* clang-format off */
static const hk_param params[] = {
    {"file", "", "name of the two files without their endings, inside the output folder",
     HK_STRING, {0}, 0, 0, offsetof(point_cache, file), 0, "mesh"},
    HK_GATHERER_ROWS(point_cache),
    {0},
};
/* clang-format on */

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  point_cache *p = self;
  p->host = host;
  return hk_gatherer_choose(&p->gatherer, host, view->model, p->group);
}

static hk_status io_error(const point_cache *p, const char *why) {
  return p->host->fail(p->host, HK_IO, "cannot write %s: %s", p->path, why);
}

static hk_status find_path(point_cache *p, const char *ending) {
  char name[PATH_MAX];
  if (snprintf(name, sizeof name, "%s.%s", p->file, ending) >= (int)sizeof name)
    return p->host->fail(p->host, HK_BAD_PARAM, "file: the name is too long");
  return p->host->path(p->host, name, p->path, sizeof p->path);
}

static hk_status open(void *self, const hk_view *view, const hk_frame *now) {
  point_cache *p = self;
  char why[256] = "";
  hk_status status = hk_gatherer_open(&p->gatherer, view, now, &p->only, false);
  if (status == HK_OK) status = find_path(p, "obj");
  if (status != HK_OK) return status;
  if (!hk_sequence_write(&hk_sequence_obj, &p->gatherer.data, p->path, why, sizeof why)) return io_error(p, why);
  status = find_path(p, "pc2");
  if (status != HK_OK) return status;
  return hk_pc2_open(&p->cache, p->path, &p->gatherer.data, why, sizeof why) ? HK_OK : io_error(p, why);
}

/* A point cache is of a mesh that stays the same; what there is of it can be played. */
static hk_status end_early(point_cache *p, double t) {
  p->ended = true;
  p->host->warn(p->host,
                "particles were born or died before t = %g s: a point cache cannot have that, and %s ends there; take "
                "the output sequence or trajectory, or keep particles that stay (only, group)",
                t, p->path);
  return HK_OK;
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *now) {
  point_cache *p = self;
  char why[256] = "";
  if (p->ended || now->index % (size_t)p->every != 0) return HK_OK;
  hk_status status = hk_gatherer_frame(&p->gatherer, view, now, &p->only);
  if (status != HK_OK) return status;
  if (!hk_pc2_fits(&p->cache, &p->gatherer.data)) return end_early(p, view->t);
  return hk_pc2_add(&p->cache, &p->gatherer.data, why, sizeof why) ? HK_OK : io_error(p, why);
}

static hk_status close(void *self, hk_verdict verdict) {
  point_cache *p = self;
  char why[256] = "";
  (void)verdict;
  return hk_pc2_close(&p->cache, why, sizeof why) ? HK_OK : io_error(p, why);
}

static void destroy(void *self, const hk_host *host) {
  point_cache *p = self;
  char why[256];
  (void)host;
  hk_pc2_close(&p->cache, why, sizeof why);
  hk_gatherer_free(&p->gatherer);
}

static hk_status topology(void *self, const hk_view *view) {
  point_cache *p = self;
  (void)view;
  p->gatherer.dirty = true;
  return HK_OK;
}

static const hk_output output = {.size = sizeof(hk_output), .open = open, .frame = frame, .close = close};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "point_cache",
    .summary = "the motion of a mesh for Blender: an OBJ file and a point cache (PC2)",
    .reference = "PC2: Autodesk 3ds Max, Point Cache modifier; Blender, MOD_meshcache_pc2.c",
    .instance_size = sizeof(point_cache),
    .params = params,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .output = &output,
};
