/* What of a recording is read when it is opened, and the rows of a frame. */
#include "plugins/common/recording/reader.h"

#include "plugins/common/hdf5/h5_reading.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what is read at the start ---- */

/* A list of one number per frame or part. */
static bool get_list(hid_t file, const char *path, size_t count, size_t width, hid_t type, void *to) {
  hid_t set = hk_h5_open_set(file, path);
  bool fine = set >= 0 && hk_h5_get_rows(set, 0, count, width, type, to);
  if (set >= 0) H5Dclose(set);
  return fine;
}

/* CellOffsets and ConnectivityIdOffsets are tables of one column. */
static bool get_column(hid_t file, const char *path, size_t count, int64_t *to) {
  hid_t set = hk_h5_open_set(file, path);
  hsize_t size[2], from[2] = {0, 0};
  bool fine = hk_h5_size(set, size) && size[1] == 1 && count <= size[0];
  size[0] = count;
  hid_t memory = H5Screate_simple(2, size, NULL), space = set >= 0 ? H5Dget_space(set) : H5I_INVALID_HID;
  fine = fine && H5Sget_simple_extent_ndims(space) == 2 &&
         H5Sselect_hyperslab(space, H5S_SELECT_SET, from, NULL, size, NULL) >= 0 &&
         (count == 0 || H5Dread(set, H5T_NATIVE_INT64, memory, space, H5P_DEFAULT, to) >= 0);
  if (space >= 0) H5Sclose(space);
  if (set >= 0) H5Dclose(set);
  if (memory >= 0) H5Sclose(memory);
  return fine;
}

static bool get_frames(hk_recording *r) {
  static const char *const names[] = {"PartOffsets", "PointOffsets", "FixedDataOffsets", "CellStrainOffsets"};
  int64_t *column[6] = {0};
  bool fine = true;
  char path[64];
  for (int k = 0; k < 6; k++) fine &= (column[k] = calloc(r->frames + 1, sizeof **column)) != NULL;
  for (int k = 0; k < 4 && fine; k++) {
    snprintf(path, sizeof path, "/VTKHDF/Steps/%s", names[k]);
    fine = get_list(r->file, path, r->frames, 0, H5T_NATIVE_INT64, column[k]);
  }
  fine = fine && get_column(r->file, "/VTKHDF/Steps/CellOffsets", r->frames, column[4]) &&
         get_column(r->file, "/VTKHDF/Steps/ConnectivityIdOffsets", r->frames, column[5]) &&
         get_list(r->file, "/VTKHDF/Steps/Values", r->frames, 0, H5T_NATIVE_DOUBLE, r->time);
  for (size_t k = 0; k < r->frames && fine; k++) {
    r->frame[k] = (hk_recorded_frame){.part = column[0][k],
                                      .points = column[1][k],
                                      .fixed = column[2][k],
                                      .strain = column[3][k],
                                      .cells = column[4][k],
                                      .connectivity = column[5][k]};
    r->frame[k].changed = k == 0 || r->frame[k].part != r->frame[k - 1].part;
    if (r->frame[k].part + 1 > (int64_t)r->parts) r->parts = (size_t)r->frame[k].part + 1;
    fine = r->frame[k].part >= 0 && r->frame[k].part < (int64_t)r->frames;
  }
  for (int k = 0; k < 6; k++) free(column[k]);
  return fine;
}

static bool get_parts(hk_recording *r) {
  int64_t(*kinds)[3] = calloc(r->parts + 1, sizeof *kinds), *n = calloc(r->parts + 1, sizeof *n);
  r->part = calloc(r->parts + 1, sizeof *r->part);
  bool fine = kinds && n && r->part && get_list(r->file, "/hooke/Cells", r->parts, 3, H5T_NATIVE_INT64, kinds) &&
              get_list(r->file, "/VTKHDF/NumberOfPoints", r->parts, 0, H5T_NATIVE_INT64, n);
  for (size_t k = 0; k < r->parts && fine; k++) {
    r->part[k] = (hk_recorded_part){n[k], kinds[k][0], kinds[k][1], kinds[k][2]};
    for (int c = 0; c < 3; c++) fine &= kinds[k][c] >= 0 && kinds[k][c] < (int64_t)1 << 32;
    fine &= n[k] >= 0 && n[k] < (int64_t)1 << 32;
  }
  free(kinds);
  free(n);
  return fine;
}

/* Whether the file has the rows of every frame; what has as many rows as there are particles is as large as the file.
 */
static bool rows_fit(const hk_recording *r) {
  for (size_t k = 0; k < r->frames; k++) {
    const hk_recorded_frame *f = &r->frame[k];
    const hk_recorded_part *p = hk_recorded_part_of(r, k);
    int64_t cells = p->vertices + p->segments + p->triangles;
    if (!hk_h5_has_rows(r->points, f->points, p->n) || !hk_h5_has_rows(r->id, f->fixed, p->n) ||
        !hk_h5_has_rows(r->connectivity, f->connectivity, p->vertices + 2 * p->segments + 3 * p->triangles) ||
        (r->cell_strain >= 0 && !hk_h5_has_rows(r->cell_strain, f->strain, cells)))
      return false;
  }
  return true;
}

/* Names for the same bytes, of which each would take its memory, are none of a recording: one may have a hundred
 * thousand. */
static bool has_bytes_of_its_own(hk_recording *r, hid_t set) {
  hsize_t whole = 0;
  r->stored += hk_h5_stored(set);
  return H5Fget_filesize(r->file, &whole) >= 0 && r->stored <= whole;
}

/* 0: it is none of the scene's; -1: it cannot be what a recording has. */
static herr_t add_array(hid_t group, const char *name, const H5L_info_t *info, void *context) {
  enum { MOST = 64 }; /* numbers of a particle */
  hk_recording *r = context;
  hk_recorded_array a = {.set = hk_h5_open_set(group, name)};
  char kind[16];
  hsize_t size[2];
  (void)info;
  if (a.set < 0) return -1;
  bool ours = H5Aexists(a.set, "kind") > 0, named = hk_h5_get_text(a.set, "kind", kind, sizeof kind) &&
                                                    hk_h5_get_text(a.set, "label", a.name, sizeof a.name);
  bool fits = hk_h5_size(a.set, size) && size[1] >= 1 && size[1] <= MOST && has_bytes_of_its_own(r, a.set);
  hk_recorded_array *more = named && fits ? realloc(r->array, (r->arrays + 1) * sizeof *more) : NULL;
  if (more) {
    a.width = (size_t)size[1], a.force = strcmp(kind, "force") == 0;
    r->array = more, r->array[r->arrays++] = a;
    return 0;
  }
  H5Dclose(a.set);
  return ours ? -1 : 0;
}

/* unit: of a measure; NULL: it is none. */
static bool add_serie(hk_recording *r, const char *name, const char *unit, const double *from, size_t stride) {
  hk_recorded_series s = {.measure = unit != NULL, .value = calloc(r->frames + 1, sizeof *s.value)};
  hk_recorded_series *more = s.value ? realloc(r->serie, (r->series + 1) * sizeof *more) : NULL;
  if (!more) {
    free(s.value);
    return false;
  }
  snprintf(s.name, sizeof s.name, "%s", name);
  snprintf(s.unit, sizeof s.unit, "%s", unit ? unit : "");
  for (size_t k = 0; k < r->frames; k++) s.value[k] = from[stride * k];
  r->serie = more;
  r->serie[r->series++] = s;
  return true;
}

/* A table of three columns becomes three lists, "momentum x" and so on. */
static herr_t add_series(hid_t group, const char *name, const H5L_info_t *info, void *context) {
  hk_recording *r = context;
  hid_t set = hk_h5_open_set(group, name);
  hsize_t size[2];
  bool fine = hk_h5_size(set, size) && size[1] <= 3 && has_bytes_of_its_own(r, set);
  size_t width = fine && size[1] == 3 ? 3 : 1;
  double *value = calloc(r->frames * width + 1, sizeof *value);
  char kind[16], unit[32];
  bool measure = set >= 0 && hk_h5_get_text(set, "kind", kind, sizeof kind);
  fine = fine && value && hk_h5_get_rows(set, 0, r->frames, width == 3 ? 3 : 0, H5T_NATIVE_DOUBLE, value);
  (void)info;
  if (!measure || !hk_h5_get_text(set, "unit", unit, sizeof unit)) *unit = 0; /* older recordings have none */
  for (size_t c = 0; c < width && fine; c++) {
    char full[256];
    snprintf(full, sizeof full, width == 3 ? "%s %c" : "%s", name, (char)('x' + c));
    fine = add_serie(r, full, measure ? unit : NULL, value + c, width);
  }
  free(value);
  if (set >= 0) H5Dclose(set);
  return fine ? 0 : -1;
}

static bool for_each(hid_t file, const char *path, herr_t (*visit)(hid_t, const char *, const H5L_info_t *, void *),
                     hk_recording *r) {
  hid_t group = hk_h5_open_group(file, path);
  bool fine = group >= 0 && H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, NULL, (H5L_iterate_t)visit, r) >= 0;
  if (group >= 0) H5Gclose(group);
  return fine;
}

/* The number of frames is that of their times, and each has a row in every list. */
static bool frames_fit(hid_t file, int64_t frames) {
  hid_t set = hk_h5_open_set(file, "/VTKHDF/Steps/Values");
  bool fine = set >= 0 && frames >= 0 && hk_h5_has_rows(set, 0, frames);
  if (set >= 0) H5Dclose(set);
  return fine;
}

static bool get_own(hk_recording *r) {
  hid_t own = hk_h5_open_group(r->file, "/hooke"), steps = hk_h5_open_group(r->file, "/VTKHDF/Steps");
  char scene[4096];
  int64_t frames = -1;
  bool fine = own >= 0 && steps >= 0 && hk_h5_get_number(steps, "NSteps", H5T_NATIVE_INT64, &frames) &&
              frames_fit(r->file, frames) && hk_h5_get_number(own, "fps", H5T_NATIVE_DOUBLE, &r->fps) &&
              hk_h5_get_number(own, "every", H5T_NATIVE_INT64, &r->every) &&
              hk_h5_get_text(own, "scene", scene, sizeof scene) &&
              hk_h5_get_text(own, "verdict", r->verdict, sizeof r->verdict);
  if (fine) r->origin = hk_h5_get_long_text(own, "origin"), r->scene = malloc(strlen(scene) + 1);
  if (fine && r->scene) strcpy(r->scene, scene);
  if (fine) fine = (r->groups = hk_h5_get_long_text(own, "groups"));
  if (own >= 0) H5Gclose(own);
  if (steps >= 0) H5Gclose(steps);
  r->frames = (size_t)frames;
  return fine && r->origin && r->scene;
}

/* A channel of the scene may have had the name in recordings of versions that did not write the list. */
static hid_t open_fixed(hid_t file, const char *path) {
  hid_t set = hk_h5_open_set(file, path);
  if (set < 0 || H5Aexists(set, "kind") <= 0) return set;
  H5Dclose(set);
  return H5I_INVALID_HID;
}

static bool get_all(hk_recording *r) {
  if (!get_own(r)) return false;
  r->time = calloc(r->frames + 1, sizeof *r->time);
  r->frame = calloc(r->frames + 1, sizeof *r->frame);
  r->points = hk_h5_open_set(r->file, "/VTKHDF/Points");
  r->velocity = hk_h5_open_set(r->file, "/VTKHDF/PointData/velocity");
  r->strain = hk_h5_open_set(r->file, "/VTKHDF/PointData/strain");
  r->id = hk_h5_open_set(r->file, "/VTKHDF/PointData/id");
  r->mass = hk_h5_open_set(r->file, "/VTKHDF/PointData/mass");
  r->pin = hk_h5_open_set(r->file, "/VTKHDF/PointData/pin");
  r->group = *r->groups ? hk_h5_open_set(r->file, "/VTKHDF/PointData/group") : H5I_INVALID_HID;
  r->strand_radius = open_fixed(r->file, "/VTKHDF/PointData/strand_radius");
  r->connectivity = hk_h5_open_set(r->file, "/VTKHDF/Connectivity");
  r->cell_strain = hk_h5_open_set(r->file, "/VTKHDF/CellData/strain");
  return r->time && r->frame && get_frames(r) && get_parts(r) && rows_fit(r) &&
         for_each(r->file, "/VTKHDF/PointData", add_array, r) &&
         for_each(r->file, "/VTKHDF/FieldData", add_series, r) && hk_recorded_solids_open(&r->solids, r->file) &&
         hk_recorded_marks_open(&r->marks, r->file, r->frames);
}

hk_recording *hk_recording_open(const char *path, char *why, size_t size) {
  hk_recording *r = calloc(1, sizeof *r);
  if (!r) {
    snprintf(why, size, "no memory");
    return NULL;
  }
  r->file = hk_h5_open_file(path);
  if (r->file >= 0 && get_all(r)) return r;
  snprintf(why, size,
           r->file < 0 ? "%s is no whole HDF5 file, as scene:output(\"trajectory\") writes them"
                       : "%s: it is no recording of hooke, or damaged",
           path);
  hk_recording_close(r);
  return NULL;
}

void hk_recording_close(hk_recording *r) {
  if (!r) return;
  const hid_t set[] = {r->points, r->velocity, r->strain,        r->id,           r->mass,
                       r->pin,    r->group,    r->strand_radius, r->connectivity, r->cell_strain};
  for (size_t k = 0; k < sizeof set / sizeof *set; k++)
    if (set[k] > 0) H5Dclose(set[k]);
  for (size_t k = 0; k < r->arrays; k++) H5Dclose(r->array[k].set);
  for (size_t k = 0; k < r->series; k++) free(r->serie[k].value);
  hk_recorded_solids_close(&r->solids);
  hk_recorded_marks_close(&r->marks);
  if (r->file >= 0) H5Fclose(r->file);
  void *const all[] = {r->array, r->serie, r->time, r->frame, r->part, r->scene, r->origin, r->groups, r};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
}

/* ---- a frame ---- */

bool hk_recording_moving(const hk_recording *r, hid_t set, size_t k, size_t width, double *to) {
  return hk_h5_get_rows(set, r->frame[k].points, (size_t)hk_recorded_part_of(r, k)->n, width, H5T_NATIVE_DOUBLE, to);
}

bool hk_recording_fixed(const hk_recording *r, hid_t set, size_t k, hid_t type, void *to) {
  return hk_h5_get_rows(set, r->frame[k].fixed, (size_t)hk_recorded_part_of(r, k)->n, 0, type, to);
}

/* Indices have to be those of particles. */
static bool within(const uint32_t *index, size_t count, int64_t n) {
  for (size_t k = 0; k < count; k++)
    if (index[k] >= n) return false;
  return true;
}

bool hk_recording_groups(const hk_recording *r, size_t k, uint32_t *to) {
  int64_t names = 0;
  for (const char *c = r->groups; *c; c++) names += *c == '\n';
  return hk_recording_fixed(r, r->group, k, H5T_NATIVE_UINT32, to) &&
         within(to, (size_t)hk_recorded_part_of(r, k)->n, names);
}

bool hk_recording_vertices(const hk_recording *r, size_t k, uint32_t *to) {
  const hk_recorded_part *p = hk_recorded_part_of(r, k);
  return hk_h5_get_rows(r->connectivity, r->frame[k].connectivity, (size_t)p->vertices, 0, H5T_NATIVE_UINT32, to) &&
         within(to, (size_t)p->vertices, p->n);
}

bool hk_recording_segments(const hk_recording *r, size_t k, uint32_t *to) {
  const hk_recorded_part *p = hk_recorded_part_of(r, k);
  size_t count = 2 * (size_t)p->segments;
  return hk_h5_get_rows(r->connectivity, r->frame[k].connectivity + p->vertices, count, 0, H5T_NATIVE_UINT32, to) &&
         within(to, count, p->n);
}

bool hk_recording_triangles(const hk_recording *r, size_t k, uint32_t *to) {
  const hk_recorded_part *p = hk_recorded_part_of(r, k);
  size_t count = 3 * (size_t)p->triangles;
  int64_t at = r->frame[k].connectivity + p->vertices + 2 * p->segments;
  return hk_h5_get_rows(r->connectivity, at, count, 0, H5T_NATIVE_UINT32, to) && within(to, count, p->n);
}

bool hk_recording_cell_strain(const hk_recording *r, size_t k, size_t first, size_t count, double *to) {
  return hk_h5_get_rows(r->cell_strain, r->frame[k].strain + (int64_t)first, count, 0, H5T_NATIVE_DOUBLE, to);
}
