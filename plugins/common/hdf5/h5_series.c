/* Growing datasets, a chunk being the part that is compressed at a time. */
#include "plugins/common/hdf5/h5_series.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool set_filters(hid_t properties, int level) {
  if (level == 0) return true;
  return H5Pset_shuffle(properties) >= 0 && H5Pset_deflate(properties, (unsigned)level) >= 0;
}

/* A chunk stays in memory until it is full: the library's 1 MB would not hold the larger ones. */
static hid_t keep_chunk(size_t bytes) {
  hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
  if (access >= 0) H5Pset_chunk_cache(access, 101, 2 * bytes + 4096, 1);
  return access;
}

bool hk_h5_series_create(hk_h5_series *s, hid_t group, const char *name, const hk_h5_layout *l) {
  int rank = l->width ? 2 : 1;
  hsize_t size[2] = {0, l->width}, most[2] = {H5S_UNLIMITED, l->width}, chunk[2] = {l->chunk, l->width};
  hid_t space = H5Screate_simple(rank, size, most), create = H5Pcreate(H5P_DATASET_CREATE);
  hid_t access = keep_chunk((size_t)l->chunk * (l->width ? (size_t)l->width : 1) * H5Tget_size(l->file));
  *s = (hk_h5_series){.set = -1, .memory = l->memory, .width = l->width, .chunk = l->chunk};
  H5Pset_obj_track_times(create, false); /* the same run has the same file */
  if (H5Pset_chunk(create, rank, chunk) >= 0 && set_filters(create, l->level))
    s->set = H5Dcreate2(group, name, l->file, space, H5P_DEFAULT, create, access);
  H5Sclose(space);
  H5Pclose(create);
  H5Pclose(access);
  return s->set >= 0;
}

bool hk_h5_series_put(hk_h5_series *s, hsize_t start, hsize_t rows, const void *from) {
  int rank = s->width ? 2 : 1;
  hsize_t size[2] = {start + rows, s->width}, at[2] = {start, 0}, count[2] = {rows, s->width};
  if (rows == 0) return true;
  if (size[0] > s->rows) {
    if (H5Dset_extent(s->set, size) < 0) return false;
    s->rows = size[0];
  }
  hid_t space = H5Dget_space(s->set), memory = H5Screate_simple(rank, count, NULL);
  bool fine = H5Sselect_hyperslab(space, H5S_SELECT_SET, at, NULL, count, NULL) >= 0 &&
              H5Dwrite(s->set, s->memory, memory, space, H5P_DEFAULT, from) >= 0;
  H5Sclose(space);
  H5Sclose(memory);
  return fine;
}

hsize_t hk_h5_series_next(const hk_h5_series *s) { return (s->rows + s->chunk - 1) / s->chunk * s->chunk; }

void hk_h5_series_close(hk_h5_series *s) {
  if (s->set > 0) H5Dclose(s->set);
  s->set = -1;
}

hid_t hk_h5_group(hid_t parent, const char *name) {
  hid_t create = H5Pcreate(H5P_GROUP_CREATE);
  H5Pset_obj_track_times(create, false);
  hid_t group = H5Gcreate2(parent, name, H5P_DEFAULT, create, H5P_DEFAULT);
  H5Pclose(create);
  return group;
}

static bool write_attribute(hid_t attribute, hid_t type, const void *value) {
  bool fine = attribute >= 0 && H5Awrite(attribute, type, value) >= 0;
  if (attribute >= 0) H5Aclose(attribute);
  return fine;
}

bool hk_h5_attribute(hid_t object, const char *name, hid_t type, hsize_t count, const void *value) {
  hid_t space = count > 1 ? H5Screate_simple(1, &count, NULL) : H5Screate(H5S_SCALAR);
  hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Sclose(space);
  return write_attribute(attribute, type, value);
}

/* Of fixed length, which VTK asks for. */
bool hk_h5_text(hid_t object, const char *name, const char *text) {
  hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, strlen(text) + (*text == 0));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  bool plain = true;
  for (const char *c = text; *c; c++) plain = plain && (*c & 0x80) == 0;
  if (!plain) H5Tset_cset(type, H5T_CSET_UTF8);
  bool fine = hk_h5_attribute(object, name, type, 1, text);
  H5Tclose(type);
  return fine;
}

bool hk_h5_number_again(hid_t object, const char *name, hid_t type, const void *value) {
  return write_attribute(H5Aopen(object, name, H5P_DEFAULT), type, value);
}

bool hk_h5_text_again(hid_t object, const char *name, const char *text) {
  char padded[64] = "";
  hid_t attribute = H5Aopen(object, name, H5P_DEFAULT), type = attribute < 0 ? -1 : H5Aget_type(attribute);
  bool fits = type >= 0 && H5Tget_size(type) <= sizeof padded && strlen(text) <= H5Tget_size(type);
  if (fits) memcpy(padded, text, strlen(text));
  bool fine = write_attribute(attribute, type, padded) && fits;
  if (type >= 0) H5Tclose(type);
  return fine;
}
