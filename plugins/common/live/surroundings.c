#include "plugins/common/live/surroundings.h"

enum { HEAD = 4 }; /* numbers that S begins with for each */

static void put_float(char **at, double value) { hk_live_put(at, &(float){(float)value}, sizeof(float)); }

static void put_count(char **at, size_t count) { hk_live_put(at, &(uint32_t){(uint32_t)count}, sizeof(uint32_t)); }

void hk_live_send_solids(hk_live_queue *q, const hk_frame_data *s) {
  size_t vertices = 0, faces = 0;
  for (size_t k = 0; k < s->solids; k++) vertices += s->solid[k].vertices, faces += s->solid[k].faces;
  hk_live_lock(q);
  char *at = hk_live_begin(q, 'S', (1 + HEAD * s->solids + 3 * vertices + 3 * faces) * sizeof(uint32_t));
  if (at) put_count(&at, s->solids);
  for (size_t k = 0; k < s->solids && at; k++) {
    const hk_frame_solid *solid = &s->solid[k];
    const size_t head[HEAD] = {(size_t)solid->kind,
                               (size_t)(solid->hollow | solid->body << 1) | (size_t)solid->group << 2, solid->vertices,
                               solid->faces};
    for (int c = 0; c < HEAD; c++) put_count(&at, head[c]);
  }
  for (size_t k = 0; k < s->solids && at; k++)
    for (size_t c = 0; c < 3 * s->solid[k].vertices; c++) put_float(&at, s->solid[k].vertex[c]);
  for (size_t k = 0; k < s->solids && at; k++)
    hk_live_put(&at, s->solid[k].face, 3 * s->solid[k].faces * sizeof(uint32_t));
  hk_live_unlock(q);
}

size_t hk_live_surroundings_size(const hk_frame_data *s) {
  size_t numbers = HK_SOLID_NUMBERS * s->solids;
  for (size_t k = 0; k < s->marks.count; k++) numbers += 2 + HK_MARK_NUMBERS * s->marks.list[k].count;
  return numbers * sizeof(float);
}

static void put_marks(char **at, const hk_frame_marks *m, const double origin[3]) {
  put_count(at, m->count);
  put_count(at, m->total);
  for (size_t half = 0; half < HK_MARK_NUMBERS; half += 3)
    for (size_t i = 0; i < m->count; i++)
      for (size_t c = 0; c < 3; c++) put_float(at, m->value[HK_MARK_NUMBERS * i + half + c] - (half ? 0 : origin[c]));
}

void hk_live_put_surroundings(char **at, const hk_frame_data *s, const double origin[3]) {
  for (size_t k = 0; k < s->solids; k++) {
    for (int c = 0; c < 3; c++) put_float(at, s->solid[k].centre[c] - origin[c]);
    for (int c = 0; c < 9; c++) put_float(at, s->solid[k].axis[c / 3][c % 3]);
  }
  for (size_t k = 0; k < s->marks.count; k++) put_marks(at, &s->marks.list[k], origin);
}
