/* Links are walked one by one, since HDF5 follows them all when it is given a path of several parts. */
#include "plugins/common/hdf5/h5_reading.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- files, groups and datasets ---- */

hid_t hk_h5_open_file(const char *path) {
  struct stat info;
  H5dont_atexit(); /* all is closed here, and after a lack of memory HDF5 1.10 crashes in what it does at exit */
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* messages are made by the callers */
  H5PLset_loading_state(0);              /* no file names a shared object that HDF5 would load */
  if (stat(path, &info) != 0 || !S_ISREG(info.st_mode)) return H5I_INVALID_HID;
  return H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
}

bool hk_h5_has(hid_t at, const char *path) {
  char prefix[512];
  H5L_info_t info;
  if (strlen(path) >= sizeof prefix) return false;
  for (size_t k = 1; k <= strlen(path); k++) {
    if (path[k] != '/' && path[k] != 0) continue;
    snprintf(prefix, sizeof prefix, "%.*s", (int)k, path);
    if (H5Lexists(at, prefix, H5P_DEFAULT) <= 0 || H5Lget_info(at, prefix, &info, H5P_DEFAULT) < 0 ||
        info.type != H5L_TYPE_HARD)
      return false;
  }
  return *path != 0;
}

hid_t hk_h5_open_group(hid_t at, const char *path) {
  return hk_h5_has(at, path) ? H5Gopen2(at, path, H5P_DEFAULT) : H5I_INVALID_HID;
}

enum {
  MOST_FROM_A_BYTE = 1100, /* deflate makes of one at most 1032 (zlib's technical notes) */
  UNSTORED = 1 << 16       /* bytes that may be fill values, of which nothing is stored */
};

hsize_t hk_h5_stored(hid_t set) {
  hsize_t stored = H5Dget_storage_size(set), whole = 0;
  hid_t file = H5Iget_file_id(set);
  if (file >= 0 && H5Fget_filesize(file, &whole) < 0) whole = 0;
  if (file >= 0) H5Fclose(file);
  return stored <= whole ? stored : 0; /* what it says of itself may be anything */
}

/* Whether as many bytes can come of what is stored. */
static bool is_stored(hid_t set, hsize_t count, size_t item) {
  hsize_t stored = hk_h5_stored(set), most = INT64_MAX / MOST_FROM_A_BYTE - UNSTORED;
  return count <= (MOST_FROM_A_BYTE * (stored < most ? stored : most) + UNSTORED) / item;
}

/* Each filter multiplies what a byte may become, and others than hooke's are more code of which a file makes use. */
static bool has_plain_filters(hid_t made) {
  int count = H5Pget_nfilters(made);
  unsigned seen = 0, flags, what;
  for (int k = 0; k < count; k++) {
    size_t numbers = 0;
    H5Z_filter_t filter = H5Pget_filter2(made, (unsigned)k, &flags, &numbers, NULL, 0, NULL, &what);
    bool known = filter == H5Z_FILTER_DEFLATE || filter == H5Z_FILTER_SHUFFLE || filter == H5Z_FILTER_FLETCHER32;
    if (!known || seen & 1u << filter) return false;
    seen |= 1u << filter;
  }
  return count >= 0;
}

/* A chunk is unpacked whole, however few of its numbers are asked for. */
static bool has_stored_chunks(hid_t set, hid_t made, size_t item) {
  hsize_t size[2] = {1, 1}, count;
  if (H5Pget_layout(made) != H5D_CHUNKED) return true;
  int rank = H5Pget_chunk(made, 2, size);
  if (rank < 1 || rank > 2) return false;
  count = rank == 2 ? size[0] * size[1] : size[0]; /* each below 2^32 (File Format Specification 3.0, IV.A.2.i) */
  return is_stored(set, count, item);
}

/* The bytes are in this file, as hooke writes them, and as many as the dataset claims. */
static bool is_own(hid_t set, size_t item) {
  hid_t made = H5Dget_create_plist(set), space = H5Dget_space(set);
  hssize_t count = space >= 0 ? H5Sget_simple_extent_npoints(space) : -1;
  bool own = made >= 0 && H5Pget_external_count(made) == 0 && H5Pget_layout(made) != H5D_VIRTUAL && count >= 0 &&
             has_plain_filters(made) && is_stored(set, (hsize_t)count, item) &&
             (count == 0 || has_stored_chunks(set, made, item));
  if (space >= 0) H5Sclose(space);
  if (made >= 0) H5Pclose(made);
  return own;
}

/* Numbers of up to 8 bytes, or text of fixed length. *item: the bytes of one. */
static bool is_plain(hid_t type, size_t *item) {
  H5T_class_t class = type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS;
  *item = type >= 0 ? H5Tget_size(type) : 0;
  if (class == H5T_INTEGER || class == H5T_FLOAT) return *item <= 8;
  return class == H5T_STRING && H5Tis_variable_str(type) == 0;
}

hid_t hk_h5_open_set(hid_t at, const char *path) {
  hid_t set = hk_h5_has(at, path) ? H5Dopen2(at, path, H5P_DEFAULT) : H5I_INVALID_HID;
  if (set < 0) return set;
  hid_t type = H5Dget_type(set);
  size_t item;
  bool fine = is_plain(type, &item) && item > 0 && is_own(set, item);
  if (type >= 0) H5Tclose(type);
  if (fine) return set;
  H5Dclose(set);
  return H5I_INVALID_HID;
}

/* ---- their numbers ---- */

bool hk_h5_size(hid_t set, hsize_t size[2]) {
  hid_t space = set >= 0 ? H5Dget_space(set) : H5I_INVALID_HID;
  int rank = space >= 0 ? H5Sget_simple_extent_ndims(space) : 0;
  size[0] = 0, size[1] = 1;
  if (rank == 1 || rank == 2) H5Sget_simple_extent_dims(space, size, NULL);
  if (space >= 0) H5Sclose(space);
  return rank == 1 || rank == 2;
}

bool hk_h5_has_rows(hid_t set, int64_t at, int64_t rows) {
  hsize_t size[2];
  if (rows == 0) return true;
  return at >= 0 && rows > 0 && hk_h5_size(set, size) && (hsize_t)at <= size[0] &&
         (hsize_t)rows <= size[0] - (hsize_t)at;
}

bool hk_h5_get_rows(hid_t set, int64_t at, size_t rows, size_t width, hid_t type, void *to) {
  hsize_t size[2], from[2] = {(hsize_t)at, 0}, count[2] = {rows, width};
  if (rows == 0) return true;
  if (!hk_h5_has_rows(set, at, (int64_t)rows) || !hk_h5_size(set, size)) return false;
  hid_t space = H5Dget_space(set);
  int rank = H5Sget_simple_extent_ndims(space);
  bool fine = rank == (width > 1 ? 2 : 1) && (rank == 1 || size[1] == width);
  hid_t memory = fine ? H5Screate_simple(rank, count, NULL) : H5I_INVALID_HID;
  fine = fine && H5Sselect_hyperslab(space, H5S_SELECT_SET, from, NULL, count, NULL) >= 0 &&
         H5Dread(set, type, memory, space, H5P_DEFAULT, to) >= 0;
  if (memory >= 0) H5Sclose(memory);
  H5Sclose(space);
  return fine;
}

void *hk_h5_get_list(hid_t at, const char *path, hid_t type, hsize_t rows, hsize_t columns, size_t item) {
  hid_t set = hk_h5_open_set(at, path);
  hsize_t size[2];
  bool fits = hk_h5_size(set, size) && size[0] == rows && size[1] == columns;
  void *list = fits ? calloc(rows * columns + 1, item) : NULL;
  bool fine = list && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, list) >= 0;
  if (set >= 0) H5Dclose(set);
  if (!fine) free(list);
  return fine ? list : NULL;
}

/* The length of a text of which there is one, 0 otherwise. */
static size_t text_length(hid_t type, hid_t space) {
  bool one = type >= 0 && space >= 0 && H5Sget_simple_extent_npoints(space) == 1;
  return one && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 ? H5Tget_size(type) : 0;
}

char *hk_h5_get_long_text(hid_t at, const char *path) {
  hid_t set = hk_h5_open_set(at, path), type = set >= 0 ? H5Dget_type(set) : H5I_INVALID_HID;
  if (set < 0 && H5Lexists(at, path, H5P_DEFAULT) > 0) return NULL;
  hid_t space = set >= 0 ? H5Dget_space(set) : H5I_INVALID_HID;
  size_t length = text_length(type, space);
  char *text = calloc(1, length + 1);
  if (text && length && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) < 0) *text = 0;
  if (space >= 0) H5Sclose(space);
  if (type >= 0) H5Tclose(type);
  if (set >= 0) H5Dclose(set);
  return text;
}

/* ---- attributes ---- */

typedef struct attribute {
  hid_t id, type, space;
} attribute;

static attribute open_attribute(hid_t object, const char *name) {
  attribute a = {H5I_INVALID_HID, H5I_INVALID_HID, H5I_INVALID_HID};
  if (object >= 0 && H5Aexists(object, name) > 0) a.id = H5Aopen(object, name, H5P_DEFAULT);
  if (a.id >= 0) a.type = H5Aget_type(a.id), a.space = H5Aget_space(a.id);
  return a;
}

static void close_attribute(const attribute *a) {
  if (a->space >= 0) H5Sclose(a->space);
  if (a->type >= 0) H5Tclose(a->type);
  if (a->id >= 0) H5Aclose(a->id);
}

bool hk_h5_get_text(hid_t object, const char *name, char *to, size_t size) {
  attribute a = open_attribute(object, name);
  size_t length = text_length(a.type, a.space);
  char *text = length ? calloc(1, length + 1) : NULL;
  bool fine = text && H5Aread(a.id, a.type, text) >= 0;
  if (fine) snprintf(to, size, "%s", text);
  for (size_t k = fine ? strlen(to) : 0; k > 0 && to[k - 1] == ' '; k--) to[k - 1] = 0;
  free(text);
  close_attribute(&a);
  return fine;
}

bool hk_h5_get_number(hid_t object, const char *name, hid_t type, void *to) {
  attribute a = open_attribute(object, name);
  size_t item;
  bool fine = a.space >= 0 && H5Sget_simple_extent_npoints(a.space) == 1 && is_plain(a.type, &item) &&
              H5Tget_class(a.type) != H5T_STRING && H5Aread(a.id, type, to) >= 0;
  close_attribute(&a);
  return fine;
}
