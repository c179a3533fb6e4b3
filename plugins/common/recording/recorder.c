/* The order in which a frame gets into a recording: its rows first, and, when these are on file, the number of frames.
 * A run that is killed between leaves rows to which nothing refers. */
#include "plugins/common/recording/layout.h"
#include "plugins/common/frame_data/room.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VTK_VERTEX = 1, VTK_LINE = 3, VTK_TRIANGLE = 5 }; /* vtkCellType.h */

/* ---- a frame ---- */

static int64_t *cell_numbers(hk_recorder *r, size_t count) {
  return hk_make_room(&r->number, &r->room, count, sizeof *r->number) ? r->number : NULL;
}

static bool put_connectivity(hk_recorder *r, const hk_frame_cells *c) {
  size_t count = c->vertices + 2 * c->segments + 3 * c->triangles;
  int64_t *to = cell_numbers(r, count);
  if (!to) return false;
  for (size_t k = 0; k < c->vertices; k++) *to++ = c->vertex[k];
  for (size_t k = 0; k < 2 * c->segments; k++) *to++ = c->segment[k / 2][k % 2];
  for (size_t k = 0; k < 3 * c->triangles; k++) *to++ = c->triangle[k / 3][k % 3];
  r->connectivity_at = r->connectivity.rows;
  return hk_h5_series_add(&r->connectivity, count, r->number);
}

static bool put_types(hk_recorder *r, const hk_frame_cells *c) {
  size_t cells = hk_cell_count(c);
  int64_t *to = cell_numbers(r, cells + 1), at = 0;
  if (!to) return false;
  uint8_t *type = (uint8_t *)to;
  for (size_t k = 0; k < cells; k++)
    type[k] = k < c->vertices ? VTK_VERTEX : k < c->vertices + c->segments ? VTK_LINE : VTK_TRIANGLE;
  r->cells_at = r->types.rows;
  if (!hk_h5_series_add(&r->types, cells, type)) return false;
  for (size_t k = 0; k <= cells; k++) {
    to[k] = at;
    at += k < c->vertices ? 1 : k < c->vertices + c->segments ? 2 : 3;
  }
  return hk_h5_series_add(&r->offsets, cells + 1, to);
}

/* VTK takes Offsets from the row CellOffsets + PartOffsets on, since each part has one offset more than cells. */
static bool put_part(hk_recorder *r, const hk_frame_data *data) {
  const hk_frame_cells *c = &data->cells;
  int64_t count[3] = {(int64_t)data->n, (int64_t)hk_cell_count(c),
                      (int64_t)(c->vertices + 2 * c->segments + 3 * c->triangles)};
  int64_t kinds[3] = {(int64_t)c->vertices, (int64_t)c->segments, (int64_t)c->triangles};
  bool fine = put_connectivity(r, c) && put_types(r, c) && hk_h5_series_add(&r->kinds, 1, kinds);
  for (int k = 0; k < 3 && fine; k++) fine = hk_h5_series_add(&r->counts[k], 1, &count[k]);
  r->fixed_at = hk_h5_series_next(&r->id);
  r->parts++;
  return fine && hk_h5_series_put(&r->id, r->fixed_at, data->n, data->id) &&
         hk_h5_series_put(&r->mass, r->fixed_at, data->n, data->mass) &&
         hk_h5_series_put(&r->pin, r->fixed_at, data->n, data->pin) &&
         (data->groups < 2 || hk_h5_series_put(&r->group, r->fixed_at, data->n, data->group)) &&
         (!data->strand_radius || hk_h5_series_put(&r->strand_radius, r->fixed_at, data->n, data->strand_radius));
}

static bool put_figures(hk_recorder *r, const hk_frame *f) {
  double scalar[SCALARS] = {f->kinetic, f->potential, f->work, f->kinetic + f->potential, f->step, f->error};
  bool fine = true;
  for (int k = 0; k < SCALARS && fine; k++) fine = hk_h5_series_add(&r->figure[k], 1, &scalar[k]);
  fine = fine && hk_h5_series_add(&r->figure[SCALARS], 1, f->momentum) &&
         hk_h5_series_add(&r->figure[SCALARS + 1], 1, f->angular_momentum);
  for (size_t k = 0; k < r->measures && fine; k++) fine = hk_h5_series_add(&r->measure[k], 1, &f->measure[k]);
  return fine;
}

static bool put_frame(hk_recorder *r, const hk_frame_data *data, const hk_frame *frame) {
  hsize_t at = r->points_at = hk_h5_series_next(&r->points),
          cells = data->cell_strain ? hk_h5_series_next(&r->cell_strain) : 0;
  int64_t step[STEPS] = {[PART_OFFSETS] = (int64_t)r->parts - 1,
                         [NUMBER_OF_PARTS] = 1,
                         [POINT_OFFSETS] = (int64_t)at,
                         [CELL_OFFSETS] = (int64_t)r->cells_at,
                         [CONNECTIVITY_OFFSETS] = (int64_t)r->connectivity_at,
                         [FIXED_OFFSETS] = (int64_t)r->fixed_at,
                         [STRAIN_OFFSETS] = (int64_t)cells,
                         [ROW] = (int64_t)r->frames};
  bool fine =
      hk_h5_series_put(&r->points, at, data->n, data->x) && hk_h5_series_put(&r->velocity, at, data->n, data->v) &&
      (!data->strain || hk_h5_series_put(&r->strain, at, data->n, data->strain)) &&
      (!data->cell_strain || hk_h5_series_put(&r->cell_strain, cells, hk_cell_count(&data->cells), data->cell_strain));
  for (size_t k = 0; k < r->arrays && fine; k++)
    fine = hk_h5_series_put(&r->array[k], at, data->n, data->array[k].value);
  fine = fine && hk_h5_series_add(&r->step[VALUES], 1, &data->t);
  for (int k = VALUES + 1; k < STEPS && fine; k++) fine = hk_h5_series_add(&r->step[k], 1, &step[k]);
  return fine && hk_solid_series_add(&r->solids, data->solid) && hk_mark_series_add(&r->marks, &data->marks) &&
         put_figures(r, frame);
}

/* The frame counts from the moment in which the file says so. */
static bool count_frame(hk_recorder *r) {
  int64_t frames = (int64_t)++r->frames;
  return hk_h5_number_again(r->steps, "NSteps", H5T_NATIVE_INT64, &frames) && hk_h5_commit(r->file);
}

/* Says in the XDMF file where the frame that was written last is. */
static bool describe(hk_recorder *r, const hk_frame_data *data) {
  const hk_frame_cells *c = &data->cells;
  hk_xdmf_frame f = {.t = data->t,
                     .n = data->n,
                     .points = r->points_at,
                     .fixed = r->fixed_at,
                     .connectivity = r->connectivity_at,
                     .points_rows = r->points.rows,
                     .fixed_rows = r->id.rows,
                     .connectivity_rows = r->connectivity.rows,
                     .vertices = c->vertices,
                     .segments = c->segments,
                     .triangles = c->triangles};
  if (hk_xdmf_add(r->xdmf, &f, r->shown, r->showns)) return true;
  r->cause = errno;
  return false;
}

static bool failed(hk_recorder *r, char *why, size_t size) {
  int cause = r->cause ? r->cause : r->file && hk_h5_cause(r->file) ? hk_h5_cause(r->file) : EIO;
  snprintf(why, size, "%s", cause == EIO ? "the HDF5 library failed" : strerror(cause));
  return false;
}

bool hk_recorder_add(hk_recorder *r, const hk_frame_data *data, bool changed, const hk_frame *frame, char *why,
                     size_t size) {
  bool fine = (!changed && r->parts > 0) || put_part(r, data);
  fine = fine && put_frame(r, data, frame) && hk_h5_commit(r->file) && count_frame(r) && describe(r, data);
  return fine || failed(r, why, size);
}

/* ---- open and close ---- */

static void close_all(hk_recorder *r) {
  hk_h5_series *const own[] = {&r->points, &r->velocity,     &r->strain,  &r->id,          &r->mass, &r->pin,
                               &r->types,  &r->connectivity, &r->offsets, &r->cell_strain, &r->kinds};
  for (size_t k = 0; k < sizeof own / sizeof *own; k++) hk_h5_series_close(own[k]);
  for (int k = 0; k < 3; k++) hk_h5_series_close(&r->counts[k]);
  for (int k = 0; k < STEPS; k++) hk_h5_series_close(&r->step[k]);
  for (int k = 0; k < FIGURES; k++) hk_h5_series_close(&r->figure[k]);
  for (size_t k = 0; k < r->arrays; k++) hk_h5_series_close(&r->array[k]);
  for (size_t k = 0; k < r->measures; k++) hk_h5_series_close(&r->measure[k]);
  hk_solid_series_close(&r->solids);
  hk_mark_series_close(&r->marks);
  const hid_t group[] = {r->steps, r->own, r->root};
  for (int k = 0; k < 3; k++)
    if (group[k] > 0) H5Gclose(group[k]);
}

bool hk_recorder_close(hk_recorder *r, const char *verdict, char *why, size_t size) {
  int cause = 0;
  if (!r) return true;
  if (verdict && r->own > 0) hk_h5_text_again(r->own, "verdict", verdict);
  close_all(r);
  if (r->file) hk_h5_close(r->file, &cause);
  if (!hk_xdmf_close(r->xdmf) && !cause) cause = errno;
  for (size_t k = 0; k < r->showns; k++) free((char *)(uintptr_t)r->shown[k].path);
  void *const all[] = {r->array, r->measure, r->number, r->shown, r};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
  if (cause) snprintf(why, size, "%s", strerror(cause));
  return cause == 0;
}

/* The arrays of the scene, and velocity, strain, id, mass, pin, group and strand_radius. */
static bool make_room(hk_recorder *r, const hk_frame_data *first, const hk_frame *frame) {
  r->array = calloc(first->arrays + 1, sizeof *r->array);
  r->measure = calloc(frame->measures + 1, sizeof *r->measure);
  r->shown = calloc(first->arrays + 7, sizeof *r->shown);
  return r->array && r->measure && r->shown;
}

static bool make_files(hk_recorder *r, const char *path, const char *xdmf, const hk_recorder_setup *setup) {
  const char *slash = strrchr(path, '/');
  r->file = hk_h5_create(path);
  r->cause = r->file ? 0 : errno;
  if (r->file) r->xdmf = hk_xdmf_create(xdmf, slash ? slash + 1 : path, setup->single ? 4 : 8);
  if (r->file && !r->xdmf) r->cause = errno;
  return r->file && r->xdmf;
}

hk_recorder *hk_recorder_open(const char *path, const char *xdmf, const hk_recorder_setup *setup,
                              const hk_frame_data *first, const hk_frame *frame, char *why, size_t size) {
  hk_recorder *r = calloc(1, sizeof *r);
  char ignored[8];
  if (r && make_room(r, first, frame) && make_files(r, path, xdmf, setup) &&
      hk_recording_layout(r, setup, first, frame) && hk_h5_seal(r->file))
    return r;
  if (r && r->array && r->measure && r->shown)
    failed(r, why, size);
  else
    snprintf(why, size, "%s", strerror(ENOMEM));
  hk_recorder_close(r, NULL, ignored, sizeof ignored);
  return NULL;
}
