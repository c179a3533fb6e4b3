#include "plugins/common/recording/mark_series.h"

#include "plugins/common/hdf5/h5_reading.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS_CHUNK = 256 };

/* ---- writing ---- */

static bool create(hk_mark_series *s, hid_t group, size_t k, const hk_frame_marks *m, int level) {
  char name[24], rows[32];
  hk_h5_layout value = {.file = H5T_IEEE_F32LE,
                        .memory = H5T_NATIVE_DOUBLE,
                        .width = HK_MARK_NUMBERS,
                        .chunk = ROWS_CHUNK,
                        .level = level},
               row = {.file = H5T_NATIVE_INT64, .memory = H5T_NATIVE_INT64, .width = 3, .chunk = ROWS_CHUNK};
  snprintf(name, sizeof name, "%zu", k);
  snprintf(rows, sizeof rows, "%s rows", name);
  return hk_h5_series_create(&s->value[k], group, name, &value) &&
         hk_h5_series_create(&s->rows[k], group, rows, &row) &&
         hk_h5_text(s->value[k].set, "kind", hk_mark_kind(m->contact)) && hk_h5_text(s->value[k].set, "label", m->name);
}

bool hk_mark_series_create(hk_mark_series *s, hid_t own, const hk_mark_lists *m, int level) {
  *s = (hk_mark_series){0};
  if (m->count == 0) return true;
  hid_t group = hk_h5_group(own, "marks");
  s->value = calloc(m->count, sizeof *s->value);
  s->rows = calloc(m->count, sizeof *s->rows);
  bool fine = group >= 0 && s->value && s->rows;
  for (; s->count < m->count && fine; s->count++) fine = create(s, group, s->count, &m->list[s->count], level);
  if (group >= 0) H5Gclose(group);
  return fine;
}

bool hk_mark_series_add(hk_mark_series *s, const hk_mark_lists *m) {
  bool fine = true;
  for (size_t k = 0; k < s->count && fine; k++) {
    const hk_frame_marks *list = &m->list[k];
    int64_t rows[3] = {(int64_t)hk_h5_series_next(&s->value[k]), (int64_t)list->count, (int64_t)list->total};
    fine = hk_h5_series_put(&s->value[k], (hsize_t)rows[0], list->count, list->value) &&
           hk_h5_series_add(&s->rows[k], 1, rows);
  }
  return fine;
}

void hk_mark_series_close(hk_mark_series *s) {
  for (size_t k = 0; k < s->count; k++) {
    hk_h5_series_close(&s->value[k]);
    hk_h5_series_close(&s->rows[k]);
  }
  free(s->value);
  free(s->rows);
  *s = (hk_mark_series){0};
}

/* ---- reading ---- */

/* Each frame's rows: the first, how many, and how many marks there were in all. */
static bool rows_fit(const hk_recorded_marks *m, size_t frames) {
  for (size_t k = 0; k < frames; k++)
    if (m->rows[k][2] < 0 || !hk_h5_has_rows(m->value, m->rows[k][0], m->rows[k][1])) return false;
  return true;
}

static bool open_one(hk_recorded_marks *m, hid_t group, size_t k, size_t frames) {
  char name[24], rows[32], kind[16];
  snprintf(name, sizeof name, "%zu", k);
  snprintf(rows, sizeof rows, "%s rows", name);
  m->value = hk_h5_open_set(group, name);
  hid_t set = hk_h5_open_set(group, rows);
  m->rows = calloc(frames + 1, sizeof *m->rows);
  bool fine = m->value >= 0 && set >= 0 && m->rows && hk_h5_get_text(m->value, "kind", kind, sizeof kind) &&
              hk_h5_get_text(m->value, "label", m->name, sizeof m->name) &&
              hk_h5_get_rows(set, 0, frames, 3, H5T_NATIVE_INT64, m->rows) && rows_fit(m, frames);
  m->contact = fine && strcmp(kind, "contact") == 0;
  if (set >= 0) H5Dclose(set);
  return fine;
}

bool hk_recorded_marks_open(hk_recorded_mark_lists *m, hid_t file, size_t frames) {
  hsize_t links;
  *m = (hk_recorded_mark_lists){0};
  if (H5Lexists(file, "/hooke/marks", H5P_DEFAULT) <= 0) return true;
  hid_t group = hk_h5_open_group(file, "/hooke/marks");
  bool fine = group >= 0 && H5Gget_num_objs(group, &links) >= 0 && links % 2 == 0;
  if (fine) fine = (m->list = calloc(links / 2 + 1, sizeof *m->list)) != NULL;
  for (; fine && m->count < links / 2; m->count++) fine = open_one(&m->list[m->count], group, m->count, frames);
  if (group >= 0) H5Gclose(group);
  return fine;
}

bool hk_recorded_marks_get(const hk_recorded_marks *m, size_t k, double *to) {
  return hk_h5_get_rows(m->value, m->rows[k][0], (size_t)m->rows[k][1], HK_MARK_NUMBERS, H5T_NATIVE_DOUBLE, to);
}

void hk_recorded_marks_close(hk_recorded_mark_lists *m) {
  for (size_t k = 0; k < m->count; k++) {
    if (m->list[k].value > 0) H5Dclose(m->list[k].value);
    free(m->list[k].rows);
  }
  free(m->list);
}
