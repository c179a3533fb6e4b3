/* The groups and datasets of a recording. VTK finds the rows of a frame under Steps, in a list for each array: lists
 * that are the same for several arrays are one dataset with several names (hard links). */
#include "plugins/common/recording/layout.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK_LEAST = 256, CHUNK_MOST = 16384, FRAMES_CHUNK = 256 }; /* rows */

static const char *const figures[] = {"kinetic", "potential", "work",     "energy",
                                      "step",    "error",     "momentum", "angular momentum"};
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

static bool show(hk_recorder *r, const char *name, size_t width, bool fixed) {
  char path[3 * HK_ARRAY_NAME];
  int length = snprintf(path, sizeof path, "VTKHDF/PointData/%s", name);
  char *copy = malloc((size_t)length + 1);
  if (!copy) return false;
  strcpy(copy, path);
  r->shown[r->showns++] = (hk_xdmf_array){copy + strlen("VTKHDF/PointData/"), copy, width, fixed};
  return true;
}

static bool make_moving(moving *m, hk_h5_series *s, const char *name, size_t width) {
  m->layout.width = width == 1 ? 0 : width;
  return show(m->r, name, width, false) && hk_h5_series_create(s, m->group, name, &m->layout) &&
         also_named(m->r->steps, "PointOffsets", "PointDataOffsets", name);
}

static bool make_array(moving *m, hk_h5_series *s, const hk_frame_array *a) {
  char name[2 * HK_ARRAY_NAME];
  name_in(m->group, a->force ? "force " : "channel ", a->name, name, sizeof name);
  return make_moving(m, s, name, a->width) && hk_h5_text(s->set, "kind", a->force ? "force" : "channel") &&
         hk_h5_text(s->set, "label", a->name);
}

static bool make_fixed(moving *m, hk_h5_series *s, const char *name, hid_t type) {
  hk_h5_layout l = m->layout;
  l.file = l.memory = type, l.width = 0;
  return show(m->r, name, 1, true) && hk_h5_series_create(s, m->group, name, &l) &&
         also_named(m->r->steps, "FixedDataOffsets", "PointDataOffsets", name);
}

static bool make_points(hk_recorder *r, const hk_recorder_setup *setup, const hk_frame_data *first) {
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
              make_fixed(&m, &r->pin, "pin", H5T_NATIVE_UINT8) &&
              (first->groups < 2 || make_fixed(&m, &r->group, "group", H5T_NATIVE_UINT32)) &&
              (!first->strand_radius || make_fixed(&m, &r->strand_radius, "strand_radius", H5T_NATIVE_DOUBLE));
  for (size_t k = 0; k < first->arrays && fine; k++, r->arrays++) fine = make_array(&m, &r->array[k], &first->array[k]);
  if (m.group >= 0) H5Gclose(m.group);
  return fine;
}

static bool make_cells(hk_recorder *r, const hk_recorder_setup *setup, const hk_frame_data *first) {
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
           hk_h5_text(r->measure[k].set, "label", frame->measure_name[k]) &&
           hk_h5_text(r->measure[k].set, "unit", frame->measure_unit ? frame->measure_unit[k] : "");
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
  hid_t create = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_obj_track_times(create, false); /* the same run has the same file */
  hid_t set = H5Dcreate2(group, name, type, space, H5P_DEFAULT, create, H5P_DEFAULT);
  bool fine = set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) >= 0;
  if (set >= 0) H5Dclose(set);
  H5Pclose(create);
  H5Sclose(space);
  H5Tclose(type);
  return fine;
}

/* A name a line; what would end one is a blank. */
static bool make_groups(hid_t own, const hk_frame_data *first) {
  size_t length = 0;
  for (size_t k = 0; k < first->groups; k++) length += strlen(first->group_name[k]) + 1;
  char *text = calloc(length + 1, 1), *to = text;
  for (size_t k = 0; k < first->groups && text; k++) {
    for (const char *c = first->group_name[k]; *c; c++) *to++ = *c == '\n' ? ' ' : *c;
    *to++ = '\n';
  }
  bool fine = text && make_text(own, "groups", text);
  free(text);
  return fine;
}

bool hk_recording_layout(hk_recorder *r, const hk_recorder_setup *setup, const hk_frame_data *first,
                         const hk_frame *frame) {
  int64_t version[2] = {2, 0}, every = (int64_t)setup->every;
  r->root = hk_h5_group(hk_h5_id(r->file), "VTKHDF");
  r->own = hk_h5_group(hk_h5_id(r->file), "hooke");
  return r->root >= 0 && r->own >= 0 && hk_h5_attribute(r->root, "Version", H5T_NATIVE_INT64, 2, version) &&
         hk_h5_text(r->root, "Type", "UnstructuredGrid") && make_steps(r) && make_points(r, setup, first) &&
         make_cells(r, setup, first) && make_figures(r, frame) &&
         hk_solid_series_create(&r->solids, r->own, first->solid, first->solids) &&
         hk_mark_series_create(&r->marks, r->own, &first->marks, setup->level) &&
         hk_h5_attribute(r->own, "fps", H5T_NATIVE_DOUBLE, 1, &frame->fps) &&
         hk_h5_attribute(r->own, "every", H5T_NATIVE_INT64, 1, &every) &&
         hk_h5_text(r->own, "verdict", "not ended yet   ") &&
         hk_h5_text(r->own, "scene", frame->scene ? frame->scene : "") &&
         make_text(r->own, "origin", frame->origin ? frame->origin : "") &&
         (first->groups < 2 || make_groups(r->own, first));
}
