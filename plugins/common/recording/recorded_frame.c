/* Whole frames of a recording, for the writers of other formats. */
#include "plugins/common/recording/recorded_frame.h"

#include "plugins/common/frame_data/room.h"

#include <string.h>

bool hk_recording_frame_open(const hk_recording *r, hk_gatherer *s) {
  hk_frame_array *array = calloc(r->arrays + 1, sizeof *array);
  *s = (hk_gatherer){.strained = r->strain >= 0};
  if (!array) return false;
  s->data.array = array;
  s->data.arrays = r->arrays;
  for (size_t a = 0; a < r->arrays; a++) {
    array[a] = (hk_frame_array){.force = r->array[a].force, .width = r->array[a].width};
    memcpy(array[a].name, r->array[a].name, sizeof array[a].name);
  }
  return true;
}

static bool reserve(hk_gatherer *s, const hk_recorded_part *p) {
  hk_frame_data *data = &s->data;
  hk_frame_cells *c = &data->cells;
  size_t n = (size_t)p->n, cells = (size_t)(p->vertices + p->segments + p->triangles);
  bool fine = hk_make_room(&data->x, &s->room[HK_ROOM_X], 3 * n, sizeof *data->x) &&
              hk_make_room(&data->v, &s->room[HK_ROOM_V], 3 * n, sizeof *data->v) &&
              hk_make_room(&data->mass, &s->room[HK_ROOM_MASS], n, sizeof *data->mass) &&
              hk_make_room(&data->id, &s->room[HK_ROOM_ID], n, sizeof *data->id) &&
              hk_make_room(&data->pin, &s->room[HK_ROOM_PIN], n, sizeof *data->pin) &&
              hk_make_room(&c->vertex, &s->room[HK_ROOM_VERTEX], (size_t)p->vertices, sizeof *c->vertex) &&
              hk_make_room(&c->segment, &s->room[HK_ROOM_SEGMENT], (size_t)p->segments, sizeof *c->segment) &&
              hk_make_room(&c->triangle, &s->room[HK_ROOM_TRIANGLE], (size_t)p->triangles, sizeof *c->triangle) &&
              (!s->strained ||
               (hk_make_room(&data->strain, &s->room[HK_ROOM_STRAIN], n, sizeof *data->strain) &&
                hk_make_room(&data->cell_strain, &s->room[HK_ROOM_CELL_STRAIN], cells, sizeof *data->cell_strain)));
  for (size_t a = 0; a < data->arrays && fine; a++) {
    double *grown = realloc(data->array[a].value, (data->array[a].width * n + 1) * sizeof *grown);
    if (grown) data->array[a].value = grown;
    fine = grown != NULL;
  }
  return fine;
}

static bool read_cells(const hk_recording *r, size_t k, hk_frame_data *data) {
  const hk_recorded_part *p = hk_recorded_part_of(r, k);
  hk_frame_cells *c = &data->cells;
  c->vertices = (size_t)p->vertices, c->segments = (size_t)p->segments, c->triangles = (size_t)p->triangles;
  return hk_recording_vertices(r, k, c->vertex) && hk_recording_segments(r, k, (uint32_t *)c->segment) &&
         hk_recording_triangles(r, k, (uint32_t *)c->triangle) &&
         (!data->cell_strain || hk_recording_cell_strain(r, k, 0, hk_cell_count(c), data->cell_strain));
}

bool hk_recording_frame_read(const hk_recording *r, size_t k, hk_gatherer *s) {
  hk_frame_data *data = &s->data;
  const hk_recorded_part *p = hk_recorded_part_of(r, k);
  if (!reserve(s, p)) return false;
  data->n = (size_t)p->n;
  data->t = r->time[k];
  bool fine = hk_recording_moving(r, r->points, k, 3, data->x) && hk_recording_moving(r, r->velocity, k, 3, data->v) &&
              hk_recording_fixed(r, r->mass, k, H5T_NATIVE_DOUBLE, data->mass) &&
              hk_recording_fixed(r, r->id, k, H5T_NATIVE_UINT32, data->id) &&
              hk_recording_fixed(r, r->pin, k, H5T_NATIVE_UINT8, data->pin) && read_cells(r, k, data) &&
              (!data->strain || hk_recording_moving(r, r->strain, k, 1, data->strain));
  for (size_t a = 0; a < data->arrays && fine; a++)
    fine = hk_recording_moving(r, r->array[a].set, k, data->array[a].width, data->array[a].value);
  return fine;
}
