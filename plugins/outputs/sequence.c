/* The motion as files of one frame each, 000000.ply and so on, which Blender (PLY, OBJ) and ParaView (VTK) read as a
 * sequence. A file is whole before the next step. */
#include "plugins/common/sequence/formats.h"
#include "plugins/common/frame_data/gatherer.h"

#include <limits.h>
#include <stdio.h>

typedef struct sequence {
  const char *folder, *group;
  int64_t every;
  int format;
  bool forces;
  hk_tuples only;

  const hk_host *host;
  hk_gatherer gatherer;
  char path[PATH_MAX];
} sequence;

static const hk_sequence_format *const formats[] = {&hk_sequence_ply, &hk_sequence_obj,
                                                    &hk_sequence_vtk}; /* as in `format` */

/* clang-format off */
static const hk_param params[] = {
    {"format", "", "of the files",
     HK_CHOICE, {0}, 0, 0, offsetof(sequence, format), 0, "ply|obj|vtk"},
    {"folder", "", "folder of the files, inside the output folder",
     HK_STRING, {0}, 0, 0, offsetof(sequence, folder), 0, "sequence"},
    HK_GATHERER_ROWS(sequence),
    {"forces", "", "keep the force of every plugin on every particle: an evaluation more per frame (ply, vtk)",
     HK_BOOLEAN, {0}, 0, 0, offsetof(sequence, forces), 0, NULL},
    {0},
};
/* clang-format on */

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  sequence *p = self;
  p->host = host;
  return hk_gatherer_choose(&p->gatherer, host, view->model, p->group);
}

static hk_status io_error(const sequence *p, const char *why) {
  return p->host->fail(p->host, HK_IO, "cannot write %s: %s", p->path, why);
}

static hk_status open(void *self, const hk_view *view, const hk_frame *now) {
  sequence *p = self;
  return hk_gatherer_open(&p->gatherer, view, now, &p->only, p->forces);
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *now) {
  sequence *p = self;
  const hk_sequence_format *format = formats[p->format];
  char name[NAME_MAX], why[256] = "";
  if (now->index % (size_t)p->every != 0) return HK_OK;
  if (snprintf(name, sizeof name, "%s/%06zu.%s", p->folder, now->index / (size_t)p->every, format->name) >= NAME_MAX)
    return p->host->fail(p->host, HK_BAD_PARAM, "folder: the name is too long");
  hk_status status = p->host->path(p->host, name, p->path, sizeof p->path);
  if (status == HK_OK) status = hk_gatherer_frame(&p->gatherer, view, now, &p->only);
  if (status != HK_OK) return status;
  return hk_sequence_write(format, &p->gatherer.data, p->path, why, sizeof why) ? HK_OK : io_error(p, why);
}

/* Every file is closed when it is written. */
static hk_status close(void *self, hk_verdict verdict) {
  (void)self, (void)verdict;
  return HK_OK;
}

static void destroy(void *self, const hk_host *host) {
  sequence *p = self;
  (void)host;
  hk_gatherer_free(&p->gatherer);
}

static hk_status topology(void *self, const hk_view *view) {
  sequence *p = self;
  (void)view;
  p->gatherer.dirty = true;
  return HK_OK;
}

static const hk_output output = {.size = sizeof(hk_output), .open = open, .frame = frame, .close = close};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "sequence",
    .summary = "the motion as a sequence of PLY, OBJ or VTK files, one per frame",
    .reference = "Turk 1994, The PLY Polygon File Format; The VTK User's Guide, Simple Legacy Formats",
    .instance_size = sizeof(sequence),
    .params = params,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .output = &output,
};
