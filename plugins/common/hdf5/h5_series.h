/* Datasets that grow by rows, and attributes: what a recording is made of. */
#ifndef HK_H5_SERIES_H
#define HK_H5_SERIES_H

#include <hdf5.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct hk_h5_series {
  hid_t set, memory; /* the dataset; the type of the numbers in memory */
  hsize_t width;     /* numbers per row; 0: the rows are numbers, without a second dimension */
  hsize_t rows, chunk;
} hk_h5_series;

typedef struct hk_h5_layout {
  hid_t file, memory; /* types of the numbers */
  hsize_t width, chunk;
  int level; /* of deflate, after shuffling; 0: as they are */
} hk_h5_layout;

/* False: the library failed. A zeroed series may be closed. */
bool hk_h5_series_create(hk_h5_series *, hid_t group, const char *name, const hk_h5_layout *);
/* Writes rows from `start` on, and makes the dataset as long as that takes. */
bool hk_h5_series_put(hk_h5_series *, hsize_t start, hsize_t rows, const void *from);
static inline bool hk_h5_series_add(hk_h5_series *s, hsize_t rows, const void *from) {
  return hk_h5_series_put(s, s->rows, rows, from);
}
/* The first row of the next chunk: who writes from there writes no chunk twice. */
hsize_t hk_h5_series_next(const hk_h5_series *);
void hk_h5_series_close(hk_h5_series *);

hid_t hk_h5_group(hid_t parent, const char *name); /* to be closed; negative: the library failed */
bool hk_h5_attribute(hid_t object, const char *name, hid_t type, hsize_t count, const void *value);
bool hk_h5_text(hid_t object, const char *name, const char *text);
/* One that was made with this many characters or more. */
bool hk_h5_text_again(hid_t object, const char *name, const char *text);
bool hk_h5_number_again(hid_t object, const char *name, hid_t type, const void *value);

#endif
