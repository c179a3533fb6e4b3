/* The layout of a recording, and the order in which a frame gets into it: its rows first, and, when these are on file,
 * the number of frames. A run that is killed between leaves rows to which nothing refers. */
#include "plugins/common/recording/recorder.h"

#include "plugins/common/recording/h5_file.h"
#include "plugins/common/recording/h5_series.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK_LEAST = 256, CHUNK_MOST = 16384, FRAMES_CHUNK = 256, VTK_VERTEX = 1, VTK_LINE = 3, VTK_TRIANGLE = 5 };

static const char *const figures[] = {"kinetic", "potential", "work",     "energy",
                                      "step",    "error",     "momentum", "angular momentum"};
enum { SCALARS = 6, FIGURES = 8 };

enum { /* /VTKHDF/Steps, a row per frame */
       VALUES,
       PART_OFFSETS,
       NUMBER_OF_PARTS,
       POINT_OFFSETS,
       CELL_OFFSETS,
       CONNECTIVITY_OFFSETS,
       FIXED_OFFSETS,
       STRAIN_OFFSETS,
       ROW,
       STEPS
};

struct hk_recorder {
  hk_h5_file *file;
  hid_t root, steps, own;
  size_t frames, parts, arrays, measures;
  hk_h5_series points, velocity, strain, id, mass, pin, *array;
  hk_h5_series types, connectivity, offsets, cell_strain, counts[3], kinds;
  hk_h5_series step[STEPS], figure[FIGURES], *measure;
  hsize_t fixed_at, cells_at, connectivity_at; /* rows of the present part */
  int64_t *number;                             /* scratch */
  size_t room;
  bool single;
};

/* ---- the layout ---- */

static hsize_t chunk_for(size_t rows) {
  return rows < CHUNK_LEAST ? CHUNK_LEAST : rows > CHUNK_MOST ? CHUNK_MOST : (hsize_t)rows;
}

/* Slashes separate groups in HDF5, and a name may be taken. */
static void name_in(hid_t group, const char *prefix, const char *wanted, char *name, size_t size) {
  snprintf(name, size, "%s%s", H5Lexists(group, wanted, H5P_DEFAULT) > 0 || *prefix == 'f' ? prefix : "", wanted);
  for (char *c = name; *c; c++)
    if (*c == '/' || (*c == '.' && c == name)) *c = '_';
  while (H5Lexists(group, name, H5P_DEFAULT) > 0 && strlen(name) + 2 < size) strcat(name, "_");
}

static bool numbers(hk_h5_series *s, hid_t group, const char *name, hid_t type, size_t width) {
  hk_h5_layout l = {.file = type, .memory = type, .width = width, .chunk = FRAMES_CHUNK};
  return hk_h5_series_create(s, group, name, &l);
}

/* VTK looks for the rows of each array under the array's name: a second name of one list of rows. */
static bool also_named(hid_t steps, const char *what, const char *folder, const char *name) {
  hid_t group = H5Gopen2(steps, folder, H5P_DEFAULT);
  bool fine = group >= 0 && H5Lcreate_hard(steps, what, group, name, H5P_DEFAULT, H5P_DEFAULT) >= 0;
  if (group >= 0) H5Gclose(group);
  return fine;
}

static bool make_steps(hk_recorder *r) {
  static const char *const names[STEPS] = {"Values",           "PartOffsets",       "NumberOfParts",
                                           "PointOffsets",     "CellOffsets",       "ConnectivityIdOffsets",
                                           "FixedDataOffsets", "CellStrainOffsets", "Row"};
  bool fine = (r->steps = hk_h5_group(r->root, "Steps")) >= 0;
  int64_t none = 0;
  fine = fine && hk_h5_attribute(r->steps, "NSteps", H5T_NATIVE_INT64, 1, &none);
  static const char *const groups[] = {"PointDataOffsets", "CellDataOffsets", "FieldDataOffsets"};
  for (int k = 0; k < 3 && fine; k++) {
    hid_t group = hk_h5_group(r->steps, groups[k]);
    fine = group >= 0 && H5Gclose(group) >= 0;
  }
  for (int k = 0; k < STEPS && fine; k++)
    fine = numbers(&r->step[k], r->steps, names[k], k == VALUES ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64,
                   k == CELL_OFFSETS || k == CONNECTIVITY_OFFSETS);
  return fine;
}

/* The arrays of particles, which move. */
typedef struct moving {
  hk_recorder *r;
  hid_t group;
  hk_h5_layout layout;
} moving;

static bool make_moving(moving *m, hk_h5_series *s, const char *name, size_t width) {
  m->layout.width = width == 1 ? 0 : width;
  return hk_h5_series_create(s, m->group, name, &m->layout) &&
         also_named(m->r->steps, "PointOffsets", "PointDataOffsets", name);
}

static bool make_array(moving *m, hk_h5_series *s, const hk_shot_array *a) {
  char name[2 * HK_ARRAY_NAME];
  name_in(m->group, a->force ? "force " : "channel ", a->name, name, sizeof name);
  return make_moving(m, s, name, a->width) && hk_h5_text(s->set, "kind", a->force ? "force" : "channel") &&
         hk_h5_text(s->set, "label", a->name);
}

static bool make_fixed(moving *m, hk_h5_series *s, const char *name, hid_t type) {
  hk_h5_layout l = m->layout;
  l.file = l.memory = type, l.width = 0;
  return hk_h5_series_create(s, m->group, name, &l) &&
         also_named(m->r->steps, "FixedDataOffsets", "PointDataOffsets", name);
}

static bool make_points(hk_recorder *r, const hk_recorder_setup *setup, const hk_shot *first) {
  moving m = {.r = r, .group = hk_h5_group(r->root, "PointData")};
  m.layout = (hk_h5_layout){.file = setup->single ? H5T_IEEE_F32LE : H5T_IEEE_F64LE,
                            .memory = H5T_NATIVE_DOUBLE,
                            .width = 3,
                            .chunk = chunk_for(first->n),
                            .level = setup->level};
  bool fine = m.group >= 0 && hk_h5_series_create(&r->points, r->root, "Points", &m.layout) &&
              make_moving(&m, &r->velocity, "velocity", 3) &&
              (!first->strain || make_moving(&m, &r->strain, "strain", 1)) &&
              make_fixed(&m, &r->id, "id", H5T_NATIVE_UINT32) && make_fixed(&m, &r->mass, "mass", H5T_NATIVE_DOUBLE) &&
              make_fixed(&m, &r->pin, "pin", H5T_NATIVE_UINT8);
  for (size_t k = 0; k < first->arrays && fine; k++, r->arrays++) fine = make_array(&m, &r->array[k], &first->array[k]);
  if (m.group >= 0) H5Gclose(m.group);
  return fine;
}

static bool make_cells(hk_recorder *r, const hk_recorder_setup *setup, const hk_shot *first) {
  hid_t group = hk_h5_group(r->root, "CellData");
  hk_h5_layout l = {.chunk = chunk_for(hk_cell_count(&first->cells)), .level = setup->level};
  l.file = l.memory = H5T_NATIVE_UINT8;
  bool fine = group >= 0 && hk_h5_series_create(&r->types, r->root, "Types", &l);
  l.file = l.memory = H5T_NATIVE_INT64;
  fine = fine && hk_h5_series_create(&r->connectivity, r->root, "Connectivity", &l) &&
         hk_h5_series_create(&r->offsets, r->root, "Offsets", &l);
  l.file = setup->single ? H5T_IEEE_F32LE : H5T_IEEE_F64LE, l.memory = H5T_NATIVE_DOUBLE;
  if (fine && first->cell_strain)
    fine = hk_h5_series_create(&r->cell_strain, group, "strain", &l) &&
           also_named(r->steps, "CellStrainOffsets", "CellDataOffsets", "strain");
  static const char *const names[] = {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"};
  for (int k = 0; k < 3 && fine; k++) fine = numbers(&r->counts[k], r->root, names[k], H5T_NATIVE_INT64, 0);
  if (group >= 0) H5Gclose(group);
  return fine && numbers(&r->kinds, r->own, "Cells", H5T_NATIVE_INT64, 3);
}

static bool make_figures(hk_recorder *r, const hk_frame *frame) {
  hid_t group = hk_h5_group(r->root, "FieldData");
  bool fine = group >= 0;
  for (int k = 0; k < FIGURES && fine; k++)
    fine = numbers(&r->figure[k], group, figures[k], H5T_NATIVE_DOUBLE, k < SCALARS ? 0 : 3) &&
           also_named(r->steps, "Row", "FieldDataOffsets", figures[k]);
  for (size_t k = 0; k < frame->measures && fine; k++, r->measures++) {
    char name[256];
    name_in(group, "measure ", frame->measure_name[k], name, sizeof name);
    fine = numbers(&r->measure[k], group, name, H5T_NATIVE_DOUBLE, 0) &&
           also_named(r->steps, "Row", "FieldDataOffsets", name) && hk_h5_text(r->measure[k].set, "kind", "measure") &&
           hk_h5_text(r->measure[k].set, "label", frame->measure_name[k]);
  }
  if (group >= 0) H5Gclose(group);
  return fine;
}

/* A text of any length; attributes end at 64 kB. */
static bool make_text(hid_t group, const char *name, const char *text) {
  hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  H5Tset_size(type, strlen(text) + (*text == 0));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  hid_t set = H5Dcreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  bool fine = set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) >= 0;
  if (set >= 0) H5Dclose(set);
  H5Sclose(space);
  H5Tclose(type);
  return fine;
}

static bool make_layout(hk_recorder *r, const hk_recorder_setup *setup, const hk_shot *first, const hk_frame *frame) {
  int64_t version[2] = {2, 0}, every = (int64_t)setup->every;
  r->root = hk_h5_group(hk_h5_id(r->file), "VTKHDF");
  r->own = hk_h5_group(hk_h5_id(r->file), "hooke");
  return r->root >= 0 && r->own >= 0 && hk_h5_attribute(r->root, "Version", H5T_NATIVE_INT64, 2, version) &&
         hk_h5_text(r->root, "Type", "UnstructuredGrid") && make_steps(r) && make_points(r, setup, first) &&
         make_cells(r, setup, first) && make_figures(r, frame) &&
         hk_h5_attribute(r->own, "fps", H5T_NATIVE_DOUBLE, 1, &frame->fps) &&
         hk_h5_attribute(r->own, "every", H5T_NATIVE_INT64, 1, &every) &&
         hk_h5_text(r->own, "verdict", "not ended yet   ") &&
         hk_h5_text(r->own, "scene", frame->scene ? frame->scene : "") &&
         make_text(r->own, "origin", frame->origin ? frame->origin : "");
}

/* ---- a frame ---- */

static int64_t *cell_numbers(hk_recorder *r, size_t count) {
  return hk_make_room(&r->number, &r->room, count, sizeof *r->number) ? r->number : NULL;
}

static bool put_connectivity(hk_recorder *r, const hk_cells *c) {
  size_t count = c->vertices + 2 * c->segments + 3 * c->triangles;
  int64_t *to = cell_numbers(r, count);
  if (!to) return false;
  for (size_t k = 0; k < c->vertices; k++) *to++ = c->vertex[k];
  for (size_t k = 0; k < 2 * c->segments; k++) *to++ = c->segment[k / 2][k % 2];
  for (size_t k = 0; k < 3 * c->triangles; k++) *to++ = c->triangle[k / 3][k % 3];
  r->connectivity_at = r->connectivity.rows;
  return hk_h5_series_add(&r->connectivity, count, r->number);
}

static bool put_types(hk_recorder *r, const hk_cells *c) {
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
static bool put_part(hk_recorder *r, const hk_shot *shot) {
  const hk_cells *c = &shot->cells;
  int64_t count[3] = {(int64_t)shot->n, (int64_t)hk_cell_count(c),
                      (int64_t)(c->vertices + 2 * c->segments + 3 * c->triangles)};
  int64_t kinds[3] = {(int64_t)c->vertices, (int64_t)c->segments, (int64_t)c->triangles};
  bool fine = put_connectivity(r, c) && put_types(r, c) && hk_h5_series_add(&r->kinds, 1, kinds);
  for (int k = 0; k < 3 && fine; k++) fine = hk_h5_series_add(&r->counts[k], 1, &count[k]);
  r->fixed_at = hk_h5_series_next(&r->id);
  r->parts++;
  return fine && hk_h5_series_put(&r->id, r->fixed_at, shot->n, shot->id) &&
         hk_h5_series_put(&r->mass, r->fixed_at, shot->n, shot->mass) &&
         hk_h5_series_put(&r->pin, r->fixed_at, shot->n, shot->pin);
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

static bool put_frame(hk_recorder *r, const hk_shot *shot, const hk_frame *frame) {
  hsize_t at = hk_h5_series_next(&r->points), cells = shot->cell_strain ? hk_h5_series_next(&r->cell_strain) : 0;
  int64_t step[STEPS] = {[PART_OFFSETS] = (int64_t)r->parts - 1,
                         [NUMBER_OF_PARTS] = 1,
                         [POINT_OFFSETS] = (int64_t)at,
                         [CELL_OFFSETS] = (int64_t)r->cells_at,
                         [CONNECTIVITY_OFFSETS] = (int64_t)r->connectivity_at,
                         [FIXED_OFFSETS] = (int64_t)r->fixed_at,
                         [STRAIN_OFFSETS] = (int64_t)cells,
                         [ROW] = (int64_t)r->frames};
  bool fine =
      hk_h5_series_put(&r->points, at, shot->n, shot->x) && hk_h5_series_put(&r->velocity, at, shot->n, shot->v) &&
      (!shot->strain || hk_h5_series_put(&r->strain, at, shot->n, shot->strain)) &&
      (!shot->cell_strain || hk_h5_series_put(&r->cell_strain, cells, hk_cell_count(&shot->cells), shot->cell_strain));
  for (size_t k = 0; k < r->arrays && fine; k++)
    fine = hk_h5_series_put(&r->array[k], at, shot->n, shot->array[k].value);
  fine = fine && hk_h5_series_add(&r->step[VALUES], 1, &shot->t);
  for (int k = VALUES + 1; k < STEPS && fine; k++) fine = hk_h5_series_add(&r->step[k], 1, &step[k]);
  return fine && put_figures(r, frame);
}

/* The frame counts from the moment in which the file says so. */
static bool count_frame(hk_recorder *r) {
  int64_t frames = (int64_t)++r->frames;
  return hk_h5_number_again(r->steps, "NSteps", H5T_NATIVE_INT64, &frames) && hk_h5_commit(r->file);
}

static bool failed(hk_recorder *r, char *why, size_t size) {
  int cause = r && r->file && hk_h5_cause(r->file) ? hk_h5_cause(r->file) : EIO;
  snprintf(why, size, "%s", cause == EIO ? "the HDF5 library failed" : strerror(cause));
  return false;
}

bool hk_recorder_add(hk_recorder *r, const hk_shot *shot, bool changed, const hk_frame *frame, char *why, size_t size) {
  bool fine = (!changed && r->parts > 0) || put_part(r, shot);
  fine = fine && put_frame(r, shot, frame) && hk_h5_commit(r->file) && count_frame(r);
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
  free(r->array);
  free(r->measure);
  free(r->number);
  free(r);
  if (cause) snprintf(why, size, "%s", strerror(cause));
  return cause == 0;
}

hk_recorder *hk_recorder_open(const char *path, const char *xdmf, const hk_recorder_setup *setup, const hk_shot *first,
                              const hk_frame *frame, char *why, size_t size) {
  hk_recorder *r = calloc(1, sizeof *r);
  (void)xdmf;
  if (r)
    r->array = calloc(first->arrays + 1, sizeof *r->array),
    r->measure = calloc(frame->measures + 1, sizeof *r->measure);
  if (!r || !r->array || !r->measure) {
    snprintf(why, size, "%s", strerror(ENOMEM));
    if (r) free(r->array), free(r->measure);
    free(r);
    return NULL;
  }
  r->single = setup->single;
  r->file = hk_h5_create(path);
  if (!r->file) snprintf(why, size, "%s", strerror(errno));
  if (r->file && make_layout(r, setup, first, frame) && hk_h5_seal(r->file)) return r;
  char ignored[8];
  if (r->file) failed(r, why, size);
  hk_recorder_close(r, NULL, ignored, sizeof ignored);
  return NULL;
}
