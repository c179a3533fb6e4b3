/* The marks of a recording, wind and points of contact, in the group /hooke/marks: a dataset for each list, with the
 * attributes `kind` ("wind", "contact") and `label`, of rows x 6 numbers, the place (m) and the vector (m/s, or a
 * normal), and, under its name and " rows", three numbers for each frame: the first row, how many, and of how many they
 * are a part. */
#ifndef HK_MARK_SERIES_H
#define HK_MARK_SERIES_H

#include "plugins/common/frame_data/marks.h"
#include "plugins/common/hdf5/h5_series.h"

typedef struct hk_mark_series {
  size_t count;
  hk_h5_series *value, *rows; /* count */
} hk_mark_series;

/* False: the library failed, or no memory. What is zeroed may be closed. */
bool hk_mark_series_create(hk_mark_series *, hid_t own, const hk_mark_lists *, int level);
bool hk_mark_series_add(hk_mark_series *, const hk_mark_lists *);
void hk_mark_series_close(hk_mark_series *);

typedef struct hk_recorded_marks {
  char name[HK_MARK_NAME];
  bool contact;
  hid_t value;
  int64_t (*rows)[3]; /* of each frame */
} hk_recorded_marks;

typedef struct hk_recorded_mark_lists {
  size_t count;
  hk_recorded_marks *list;
} hk_recorded_mark_lists;

/* False: no memory, or the group contradicts itself. */
bool hk_recorded_marks_open(hk_recorded_mark_lists *, hid_t file, size_t frames);
/* rows[k][1] x 6 numbers of frame k (from 0). */
bool hk_recorded_marks_get(const hk_recorded_marks *, size_t k, double *to);
void hk_recorded_marks_close(hk_recorded_mark_lists *);

#endif
