/* Taking a shot: the particles that are shown are gathered from the view, with channels and forces. */
#include "plugins/common/shot/shooting.h"

#include "plugins/common/shot/cells.h"
#include "plugins/common/shot/room.h"
#include "plugins/common/shot/strain.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void name_array(hk_shot_array *a, const char *name, bool force, size_t width) {
  snprintf(a->name, sizeof a->name, "%s", name);
  a->force = force;
  a->width = width;
}

hk_status hk_shooting_begin(hk_shooting *s, const hk_view *view, const hk_frame *frame, bool forces) {
  const hk_model *m = view->model;
  size_t channels = m->channels, count = channels + (forces ? frame->forces : 0);
  s->shot.array = calloc(count + 1, sizeof *s->shot.array);
  if (!s->shot.array) return HK_NO_MEMORY;
  s->shot.arrays = count;
  for (size_t k = 0; k < channels; k++) name_array(&s->shot.array[k], m->channel[k].name, false, m->channel[k].size);
  for (size_t k = channels; k < count; k++) name_array(&s->shot.array[k], frame->force_name[k - channels], true, 3);
  s->dirty = true;
  s->strained = m->element_lists > 0;
  return HK_OK;
}

static bool reserve(hk_shooting *s, size_t n) {
  hk_shot *shot = &s->shot;
  bool fine = hk_make_room(&s->kept, &s->room[HK_ROOM_KEPT], n, sizeof *s->kept) &&
              hk_make_room(&s->place, &s->room[HK_ROOM_PLACE], n, sizeof *s->place) &&
              hk_make_room(&shot->x, &s->room[HK_ROOM_X], 3 * n, sizeof *shot->x) &&
              hk_make_room(&shot->v, &s->room[HK_ROOM_V], 3 * n, sizeof *shot->v) &&
              hk_make_room(&shot->mass, &s->room[HK_ROOM_MASS], n, sizeof *shot->mass) &&
              hk_make_room(&shot->id, &s->room[HK_ROOM_ID], n, sizeof *shot->id) &&
              hk_make_room(&shot->pin, &s->room[HK_ROOM_PIN], n, sizeof *shot->pin) &&
              hk_make_room(&s->every, &s->room[HK_ROOM_EVERY], 3 * n, sizeof *s->every) &&
              (!s->strained || hk_make_room(&shot->strain, &s->room[HK_ROOM_STRAIN], n, sizeof *shot->strain));
  for (size_t k = 0; k < shot->arrays && fine; k++) {
    double *grown = realloc(shot->array[k].value, (shot->array[k].width * n + 1) * sizeof *grown);
    if (grown) shot->array[k].value = grown;
    fine = grown != NULL;
  }
  return fine;
}

/* Which particles are shown, in their order. */
static void choose(hk_shooting *s, const hk_view *view) {
  const hk_model *m = view->model;
  for (size_t i = 0; i < view->n; i++)
    s->place[i] = s->only.count || (s->group != UINT32_MAX && m->group[i] != s->group) ? UINT32_MAX : 0;
  for (size_t k = 0; k < s->only.count; k++) {
    uint32_t i = s->only.index[k];
    if (i < view->n && (s->group == UINT32_MAX || m->group[i] == s->group)) s->place[i] = 0;
  }
  s->shot.n = 0;
  for (size_t i = 0; i < view->n; i++)
    if (s->place[i] == 0) s->place[i] = (uint32_t)s->shot.n, s->kept[s->shot.n++] = (uint32_t)i;
}

/* Gathers `width` numbers of each particle shown. */
static void gather(const hk_shooting *s, const double *from, size_t width, double *to) {
  for (size_t j = 0; j < s->shot.n; j++) memcpy(to + width * j, from + width * s->kept[j], width * sizeof *to);
}

/* True: one of the particles, masses or pins is another one than in the shot before. */
static bool gather_model(hk_shooting *s, const hk_model *m, size_t n_before) {
  hk_shot *shot = &s->shot;
  bool other = shot->n != n_before;
  for (size_t j = 0; j < shot->n; j++) {
    size_t i = s->kept[j];
    other = other || shot->id[j] != m->id[i] || shot->mass[j] != m->mass[i] || shot->pin[j] != m->pin[i];
    shot->id[j] = m->id[i], shot->mass[j] = m->mass[i], shot->pin[j] = m->pin[i];
  }
  return other;
}

static hk_status gather_arrays(hk_shooting *s, const hk_view *view, const hk_frame *frame) {
  const hk_model *m = view->model;
  for (size_t k = 0; k < m->channels; k++)
    gather(s, view->y + m->channel[k].offset * view->n, m->channel[k].size, s->shot.array[k].value);
  for (size_t k = m->channels; k < s->shot.arrays; k++) {
    hk_status status = frame->force(frame, k - m->channels, s->every);
    if (status != HK_OK) return status;
    gather(s, s->every, 3, s->shot.array[k].value);
  }
  return HK_OK;
}

/* Changes with the lists that cells are made of, even where nobody was told of a change. */
static uint64_t signature(const hk_view *view) {
  const hk_model *m = view->model;
  uint64_t sum = view->n;
  sum = sum * 31 + m->edges.count, sum = sum * 31 + m->triangles.count;
  for (size_t k = 0; k < m->element_lists; k++) sum = sum * 31 + m->element_list[k].elements.node.count;
  for (size_t k = 0; k < m->join_lists; k++) sum = sum * 31 + m->join[k]->count;
  return sum;
}

hk_status hk_shooting_take(hk_shooting *s, const hk_view *view, const hk_frame *frame) {
  size_t before = s->shot.n;
  if (!reserve(s, view->n)) return HK_NO_MEMORY;
  s->shot.t = view->t;
  choose(s, view);
  gather(s, view->x, 3, s->shot.x);
  gather(s, view->v, 3, s->shot.v);
  s->changed = gather_model(s, view->model, before) || s->dirty || signature(view) != s->signature;
  hk_status status = s->changed ? hk_shooting_find_cells(s, view) : HK_OK;
  if (status != HK_OK) return status;
  s->signature = signature(view);
  s->dirty = false;
  hk_shooting_strain(s, view);
  return gather_arrays(s, view, frame);
}

hk_status hk_shooting_choose(hk_shooting *s, const hk_host *host, const hk_model *m, const char *group) {
  s->group = UINT32_MAX;
  for (size_t g = 0; group && g < m->groups; g++)
    if (strcmp(m->group_name[g], group) == 0) s->group = (uint32_t)g;
  if (!group || s->group != UINT32_MAX) return HK_OK;
  return host->fail(host, HK_BAD_PARAM, "group: no particle is in a group '%s'", group);
}

hk_status hk_shooting_open(hk_shooting *s, const hk_view *view, const hk_frame *frame, const hk_tuples *only,
                           bool forces) {
  const hk_host *host = view->host;
  if (hk_shooting_begin(s, view, frame, forces) != HK_OK)
    return host->fail(host, HK_NO_MEMORY, "no memory for a frame");
  return hk_shooting_frame(s, view, frame, only);
}

hk_status hk_shooting_frame(hk_shooting *s, const hk_view *view, const hk_frame *frame, const hk_tuples *only) {
  s->only = *only;
  hk_status status = hk_shooting_take(s, view, frame);
  if (status != HK_NO_MEMORY) return status;
  return view->host->fail(view->host, status, "no memory for %zu particles", view->n);
}

void hk_shooting_free(hk_shooting *s) {
  hk_shot *shot = &s->shot;
  void *const all[] = {s->kept,
                       s->place,
                       s->every,
                       s->source,
                       shot->x,
                       shot->v,
                       shot->mass,
                       shot->id,
                       shot->pin,
                       shot->cell_strain,
                       shot->strain,
                       shot->cells.vertex,
                       shot->cells.segment,
                       shot->cells.triangle};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
  for (size_t k = 0; k < shot->arrays; k++) free(shot->array[k].value);
  free(shot->array);
  *s = (hk_shooting){0};
}
