#include "plugins/common/recording/h5_rows.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool hk_h5_get_rows(hid_t set, int64_t at, size_t rows, size_t width, hid_t type, void *to) {
  hsize_t size[2] = {0, 1}, from[2] = {(hsize_t)at, 0}, count[2] = {rows, width};
  if (rows == 0) return true;
  if (set < 0 || at < 0) return false;
  hid_t space = H5Dget_space(set);
  int rank = H5Sget_simple_extent_ndims(space);
  bool fine = rank == (width > 1 ? 2 : 1) && H5Sget_simple_extent_dims(space, size, NULL) == rank &&
              from[0] <= size[0] && rows <= size[0] - from[0] && (rank == 1 || size[1] == width);
  hid_t memory = fine ? H5Screate_simple(rank, count, NULL) : -1;
  fine = fine && H5Sselect_hyperslab(space, H5S_SELECT_SET, from, NULL, count, NULL) >= 0 &&
         H5Dread(set, type, memory, space, H5P_DEFAULT, to) >= 0;
  if (memory >= 0) H5Sclose(memory);
  H5Sclose(space);
  return fine;
}

bool hk_h5_get_text(hid_t object, const char *name, char *to, size_t size) {
  hid_t attribute = H5Aexists(object, name) > 0 ? H5Aopen(object, name, H5P_DEFAULT) : -1;
  hid_t type = attribute >= 0 ? H5Aget_type(attribute) : -1;
  size_t length =
      type >= 0 && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 ? H5Tget_size(type) : 0;
  char *text = length ? calloc(1, length + 1) : NULL;
  bool fine = text && H5Aread(attribute, type, text) >= 0;
  if (fine) snprintf(to, size, "%s", text);
  for (size_t k = fine ? strlen(to) : 0; k > 0 && to[k - 1] == ' '; k--) to[k - 1] = 0;
  free(text);
  if (type >= 0) H5Tclose(type);
  if (attribute >= 0) H5Aclose(attribute);
  return fine;
}
