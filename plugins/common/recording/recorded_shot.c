/* Whole shots of a recording, for the writers of other formats. */
#include "plugins/common/recording/recorded_shot.h"

#include "plugins/common/shot/room.h"

#include <string.h>

bool hk_recording_shot_open(const hk_recording *r, hk_shooting *s) {
  hk_shot_array *array = calloc(r->arrays + 1, sizeof *array);
  *s = (hk_shooting){.strained = r->strain >= 0};
  if (!array) return false;
  s->shot.array = array;
  s->shot.arrays = r->arrays;
  for (size_t a = 0; a < r->arrays; a++) {
    array[a] = (hk_shot_array){.force = r->array[a].force, .width = r->array[a].width};
    memcpy(array[a].name, r->array[a].name, sizeof array[a].name);
  }
  return true;
}

static bool reserve(hk_shooting *s, const hk_recorded_part *p) {
  hk_shot *shot = &s->shot;
  hk_cells *c = &shot->cells;
  size_t n = (size_t)p->n, cells = (size_t)(p->vertices + p->segments + p->triangles);
  bool fine = hk_make_room(&shot->x, &s->room[HK_ROOM_X], 3 * n, sizeof *shot->x) &&
              hk_make_room(&shot->v, &s->room[HK_ROOM_V], 3 * n, sizeof *shot->v) &&
              hk_make_room(&shot->mass, &s->room[HK_ROOM_MASS], n, sizeof *shot->mass) &&
              hk_make_room(&shot->id, &s->room[HK_ROOM_ID], n, sizeof *shot->id) &&
              hk_make_room(&shot->pin, &s->room[HK_ROOM_PIN], n, sizeof *shot->pin) &&
              hk_make_room(&c->vertex, &s->room[HK_ROOM_VERTEX], (size_t)p->vertices, sizeof *c->vertex) &&
              hk_make_room(&c->segment, &s->room[HK_ROOM_SEGMENT], (size_t)p->segments, sizeof *c->segment) &&
              hk_make_room(&c->triangle, &s->room[HK_ROOM_TRIANGLE], (size_t)p->triangles, sizeof *c->triangle) &&
              (!s->strained ||
               (hk_make_room(&shot->strain, &s->room[HK_ROOM_STRAIN], n, sizeof *shot->strain) &&
                hk_make_room(&shot->cell_strain, &s->room[HK_ROOM_CELL_STRAIN], cells, sizeof *shot->cell_strain)));
  for (size_t a = 0; a < shot->arrays && fine; a++) {
    double *grown = realloc(shot->array[a].value, (shot->array[a].width * n + 1) * sizeof *grown);
    if (grown) shot->array[a].value = grown;
    fine = grown != NULL;
  }
  return fine;
}

static bool read_cells(const hk_recording *r, size_t k, hk_shot *shot) {
  const hk_recorded_part *p = hk_recorded_part_of(r, k);
  hk_cells *c = &shot->cells;
  c->vertices = (size_t)p->vertices, c->segments = (size_t)p->segments, c->triangles = (size_t)p->triangles;
  return hk_recording_vertices(r, k, c->vertex) && hk_recording_segments(r, k, (uint32_t *)c->segment) &&
         hk_recording_triangles(r, k, (uint32_t *)c->triangle) &&
         (!shot->cell_strain || hk_recording_cell_strain(r, k, 0, hk_cell_count(c), shot->cell_strain));
}

bool hk_recording_shot(const hk_recording *r, size_t k, hk_shooting *s) {
  hk_shot *shot = &s->shot;
  const hk_recorded_part *p = hk_recorded_part_of(r, k);
  if (!reserve(s, p)) return false;
  shot->n = (size_t)p->n;
  shot->t = r->time[k];
  bool fine = hk_recording_moving(r, r->points, k, 3, shot->x) && hk_recording_moving(r, r->velocity, k, 3, shot->v) &&
              hk_recording_fixed(r, r->mass, k, H5T_NATIVE_DOUBLE, shot->mass) &&
              hk_recording_fixed(r, r->id, k, H5T_NATIVE_UINT32, shot->id) &&
              hk_recording_fixed(r, r->pin, k, H5T_NATIVE_UINT8, shot->pin) && read_cells(r, k, shot) &&
              (!shot->strain || hk_recording_moving(r, r->strain, k, 1, shot->strain));
  for (size_t a = 0; a < shot->arrays && fine; a++)
    fine = hk_recording_moving(r, r->array[a].set, k, shot->array[a].width, shot->array[a].value);
  return fine;
}
