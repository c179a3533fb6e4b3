/* The whole motion in one file, trajectory.h5: HDF5 in the layout of VTKHDF 2.0, which ParaView 5.12 and h5py read, and
 * beside it trajectory.xdmf, for programs that do not know this layout. Every frame is on file before the next step,
 * and the file can be read at any time, whatever ends the run (plugins/common/hdf5/h5_file.h). A run that goes on
 * from a checkpoint writes a file of its own, in the folder of that part. */
#include "plugins/common/recording/recording.h"
#include "plugins/common/frame_data/gatherer.h"

#include <limits.h>
#include <stdio.h>

typedef struct trajectory {
  const char *file, *group;
  int64_t every, level;
  int precision;
  bool forces;
  hk_tuples only;

  const hk_host *host;
  hk_gatherer gatherer;
  hk_recorder *recorder;
  char path[PATH_MAX], xdmf[PATH_MAX];
} trajectory;

enum { DOUBLE, SINGLE };

static const hk_param params[] = {
    {"file", "", "name of the file without its ending, inside the output folder", .string = HK_AT(trajectory, file),
     .text = "trajectory"},
    {"every", "frames", "a frame is kept every so many", .integer = HK_AT(trajectory, every), .initial = {1},
     .limits = HK_WITHIN(1, 1e9)},
    {"only", "", "particles to keep; left out: all", .particles = HK_AT(trajectory, only),
     .flags = HK_OPTIONAL | HK_NOT_EMPTY},
    {"group", "", "keep the particles of this group; left out: of all groups", .string = HK_AT(trajectory, group)},
    {"forces", "", "keep the force of every plugin on every particle, tension and stress: evaluations more per frame",
     .boolean = HK_AT(trajectory, forces)},
    {"precision", "", "of the numbers of particles: 64 or 32 bits", .choice = HK_AT(trajectory, precision),
     .initial = {DOUBLE}, .choices = "double|single"},
    {"compression", "", "effort of deflate; 0: none", .integer = HK_AT(trajectory, level), .initial = {1},
     .limits = HK_WITHIN(0, 9)},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  trajectory *t = self;
  t->host = host;
  return hk_gatherer_choose(&t->gatherer, host, view->model, t->group);
}

static hk_status io_error(const trajectory *t, const char *why) {
  return t->host->fail(t->host, HK_IO, "cannot write %s: %s", t->path, why);
}

static hk_status find_paths(trajectory *t) {
  char name[NAME_MAX];
  if (snprintf(name, sizeof name, "%s.xdmf", t->file) >= (int)sizeof name)
    return t->host->fail(t->host, HK_BAD_PARAM, "file: the name is too long");
  hk_status status = t->host->path(t->host, name, t->xdmf, sizeof t->xdmf);
  snprintf(name, sizeof name, "%s.h5", t->file);
  return status == HK_OK ? t->host->path(t->host, name, t->path, sizeof t->path) : status;
}

static hk_status open(void *self, const hk_view *view, const hk_frame *now) {
  trajectory *t = self;
  char why[256] = "";
  hk_recorder_setup setup = {.single = t->precision == SINGLE, .level = (int)t->level, .every = (size_t)t->every};
  hk_status status = find_paths(t);
  if (status == HK_OK) status = hk_gatherer_open(&t->gatherer, view, now, &t->only, t->forces);
  if (status != HK_OK) return status;
  t->recorder = hk_recorder_open(t->path, t->xdmf, &setup, &t->gatherer.data, now, why, sizeof why);
  return t->recorder ? HK_OK : io_error(t, why);
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *now) {
  trajectory *t = self;
  char why[256] = "";
  if (now->index % (size_t)t->every != 0) return HK_OK;
  hk_status status = hk_gatherer_frame(&t->gatherer, view, now, &t->only);
  if (status == HK_OK) status = hk_gatherer_forces(&t->gatherer, view, now);
  if (status != HK_OK) return status;
  bool written = hk_recorder_add(t->recorder, &t->gatherer.data, t->gatherer.changed, now, why, sizeof why);
  return written ? HK_OK : io_error(t, why);
}

static hk_status close(void *self, hk_verdict verdict) {
  static const char *const names[] = {NULL, "ok", "inaccurate", "diverged", "interrupted"}; /* as hk_verdict */
  trajectory *t = self;
  char why[256] = "";
  hk_recorder *recorder = t->recorder;
  t->recorder = NULL;
  return hk_recorder_close(recorder, names[verdict], why, sizeof why) ? HK_OK : io_error(t, why);
}

static void destroy(void *self, const hk_host *host) {
  trajectory *t = self;
  char why[256];
  hk_recorder_close(t->recorder, NULL, why, sizeof why);
  (void)host;
  hk_gatherer_free(&t->gatherer);
}

static hk_status topology(void *self, const hk_view *view) {
  trajectory *t = self;
  (void)view;
  t->gatherer.dirty = true;
  return HK_OK;
}

static const hk_output output = {.size = sizeof(hk_output), .open = open, .frame = frame, .close = close};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "trajectory",
    .summary = "the motion in one HDF5 file that ParaView and h5py read, at any time",
    .reference = "VTKHDF file format 2.0, docs.vtk.org; XDMF 2, xdmf.org",
    .instance_size = sizeof(trajectory),
    .params = params,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .output = &output,
};
