#include "plugins/common/recording/solid_series.h"

#include "plugins/common/hdf5/h5_reading.h"

#include <stdlib.h>
#include <string.h>

/* Places are not compressed: a chunk that is written anew at every frame would take other room each time. */
enum { FRAMES_CHUNK = 32, LEVEL = 1 };

/* ---- writing ---- */

/* A list that is written once, as one chunk. */
static bool put_list(hid_t group, const char *name, hid_t type, size_t rows, size_t width, const void *from) {
  hk_h5_series s;
  hk_h5_layout l = {.file = type, .memory = type, .width = width, .chunk = rows + 1, .level = LEVEL};
  bool fine = hk_h5_series_create(&s, group, name, &l) && hk_h5_series_add(&s, rows, from);
  hk_h5_series_close(&s);
  return fine;
}

static bool put_kinds(hid_t group, const hk_frame_solid *solid, size_t count) {
  uint8_t *byte = malloc(2 * count);
  uint64_t(*mesh)[2] = malloc(count * sizeof *mesh);
  uint32_t *of = malloc(count * sizeof *of);
  for (size_t k = 0; k < count && byte && mesh && of; k++) {
    of[k] = solid[k].group;
    byte[k] = (uint8_t)solid[k].kind, byte[count + k] = (uint8_t)(solid[k].hollow | solid[k].body << 1);
    mesh[k][0] = solid[k].vertices, mesh[k][1] = solid[k].faces;
  }
  bool fine = byte && mesh && of && put_list(group, "kind", H5T_NATIVE_UINT8, count, 0, byte) &&
              put_list(group, "hollow", H5T_NATIVE_UINT8, count, 0, byte + count) &&
              put_list(group, "mesh", H5T_NATIVE_UINT64, count, 2, mesh) &&
              put_list(group, "group", H5T_NATIVE_UINT32, count, 0, of);
  free(byte);
  free(of);
  free(mesh);
  return fine;
}

static bool put_meshes(hid_t group, const hk_frame_solid *solid, size_t count) {
  hk_h5_series vertex, face = {.set = -1};
  hk_h5_layout l = {.file = H5T_NATIVE_DOUBLE, .memory = H5T_NATIVE_DOUBLE, .width = 3, .chunk = 1024, .level = LEVEL};
  bool fine = hk_h5_series_create(&vertex, group, "vertex", &l);
  l.file = l.memory = H5T_NATIVE_UINT32;
  fine = fine && hk_h5_series_create(&face, group, "face", &l);
  for (size_t k = 0; k < count && fine; k++)
    fine = hk_h5_series_add(&vertex, solid[k].vertices, solid[k].vertex) &&
           hk_h5_series_add(&face, solid[k].faces, solid[k].face);
  hk_h5_series_close(&vertex);
  hk_h5_series_close(&face);
  return fine;
}

bool hk_solid_series_create(hk_solid_series *s, hid_t own, const hk_frame_solid *solid, size_t count) {
  *s = (hk_solid_series){.count = count};
  if (count == 0) return true;
  hid_t group = hk_h5_group(own, "solids");
  hk_h5_layout l = {
      .file = H5T_NATIVE_DOUBLE, .memory = H5T_NATIVE_DOUBLE, .width = HK_SOLID_NUMBERS * count, .chunk = FRAMES_CHUNK};
  s->row = malloc(HK_SOLID_NUMBERS * count * sizeof *s->row);
  bool fine = s->row && group >= 0 && put_kinds(group, solid, count) && put_meshes(group, solid, count) &&
              hk_h5_series_create(&s->place, group, "place", &l);
  if (group >= 0) H5Gclose(group);
  return fine;
}

bool hk_solid_series_add(hk_solid_series *s, const hk_frame_solid *solid) {
  for (size_t k = 0; k < s->count; k++) {
    memcpy(s->row + HK_SOLID_NUMBERS * k, solid[k].centre, sizeof solid[k].centre);
    memcpy(s->row + HK_SOLID_NUMBERS * k + 3, solid[k].axis, sizeof solid[k].axis);
  }
  return s->count == 0 || hk_h5_series_add(&s->place, 1, s->row);
}

void hk_solid_series_close(hk_solid_series *s) {
  hk_h5_series_close(&s->place);
  free(s->row);
  s->row = NULL;
}

/* ---- reading ---- */

static bool get_kinds(hk_recorded_solids *s, hid_t group, uint64_t total[2]) {
  enum { MOST = 1 << 28 }; /* of a mesh, so that sums cannot overflow */
  uint8_t *kind = hk_h5_get_list(group, "kind", H5T_NATIVE_UINT8, s->count, 1, 1);
  uint8_t *hollow = hk_h5_get_list(group, "hollow", H5T_NATIVE_UINT8, s->count, 1, 1);
  uint64_t(*mesh)[2] = hk_h5_get_list(group, "mesh", H5T_NATIVE_UINT64, s->count, 2, sizeof(uint64_t));
  bool grouped = H5Lexists(group, "group", H5P_DEFAULT) > 0; /* those of versions up to 0.3.0 have none */
  uint32_t *of = grouped ? hk_h5_get_list(group, "group", H5T_NATIVE_UINT32, s->count, 1, sizeof *of) : NULL;
  bool fine = kind && hollow && mesh && (of || !grouped) && (s->solid = calloc(s->count, sizeof *s->solid));
  for (size_t k = 0; k < s->count && fine; k++) {
    s->solid[k] = (hk_frame_solid){
        .kind = kind[k], .hollow = hollow[k] & 1, .body = hollow[k] & 2, .vertices = mesh[k][0], .faces = mesh[k][1]};
    if (of) s->solid[k].group = of[k];
    fine = kind[k] <= HK_SHAPE_MESH && mesh[k][0] <= MOST && mesh[k][1] <= MOST;
    total[0] += mesh[k][0], total[1] += mesh[k][1];
  }
  free(kind);
  free(of);
  free(hollow);
  free(mesh);
  return fine;
}

/* Corners have to be those of vertices. */
static bool get_meshes(hk_recorded_solids *s, hid_t group, const uint64_t total[2]) {
  s->vertex = hk_h5_get_list(group, "vertex", H5T_NATIVE_DOUBLE, total[0], 3, sizeof *s->vertex);
  s->face = hk_h5_get_list(group, "face", H5T_NATIVE_UINT32, total[1], 3, sizeof(uint32_t));
  if (!s->vertex || !s->face) return false;
  const double *vertex = s->vertex;
  const uint32_t(*face)[3] = (const uint32_t(*)[3])s->face;
  for (size_t k = 0; k < s->count; k++) {
    s->solid[k].vertex = vertex, s->solid[k].face = face;
    vertex += 3 * s->solid[k].vertices, face += s->solid[k].faces;
    for (size_t f = 0; f < 3 * s->solid[k].faces; f++)
      if (s->solid[k].face[f / 3][f % 3] >= s->solid[k].vertices) return false;
  }
  return true;
}

bool hk_recorded_solids_open(hk_recorded_solids *s, hid_t file) {
  static const char path[] = "/hooke/solids";
  hsize_t size[2];
  uint64_t total[2] = {0};
  *s = (hk_recorded_solids){0};
  if (H5Lexists(file, path, H5P_DEFAULT) <= 0) return true;
  hid_t group = hk_h5_open_group(file, path);
  s->place = group >= 0 ? hk_h5_open_set(group, "place") : H5I_INVALID_HID;
  bool fine = hk_h5_size(s->place, size) && size[1] > 0 && size[1] % HK_SOLID_NUMBERS == 0;
  s->count = fine ? size[1] / HK_SOLID_NUMBERS : 0;
  fine = fine && get_kinds(s, group, total) && get_meshes(s, group, total);
  if (group >= 0) H5Gclose(group);
  return fine;
}

bool hk_recorded_solids_place(const hk_recorded_solids *s, size_t k, double *to) {
  hsize_t size[2], from[2] = {k, 0}, count[2] = {1, HK_SOLID_NUMBERS * s->count};
  if (s->count == 0) return true;
  if (!hk_h5_size(s->place, size) || k >= size[0]) return false;
  hid_t space = H5Dget_space(s->place), memory = H5Screate_simple(2, count, NULL);
  bool fine = H5Sselect_hyperslab(space, H5S_SELECT_SET, from, NULL, count, NULL) >= 0 &&
              H5Dread(s->place, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, to) >= 0;
  H5Sclose(space);
  H5Sclose(memory);
  return fine;
}

bool hk_recorded_solids_move(hk_recorded_solids *s, size_t k) {
  double *number = malloc((s->count + 1) * HK_SOLID_NUMBERS * sizeof *number);
  bool fine = number && hk_recorded_solids_place(s, k, number);
  for (size_t i = 0; i < s->count && fine; i++) {
    memcpy(s->solid[i].centre, number + HK_SOLID_NUMBERS * i, sizeof s->solid[i].centre);
    memcpy(s->solid[i].axis, number + HK_SOLID_NUMBERS * i + 3, sizeof s->solid[i].axis);
  }
  free(number);
  return fine;
}

void hk_recorded_solids_close(hk_recorded_solids *s) {
  if (s->place > 0) H5Dclose(s->place);
  free(s->solid);
  free(s->vertex);
  free(s->face);
}
