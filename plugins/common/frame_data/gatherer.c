/* The particles that are shown are gathered from the view, with channels and forces; obstacles, wind and contacts. */
#include "plugins/common/frame_data/gatherer.h"

#include "core/plugin/strain.h"
#include "plugins/common/frame_data/cells.h"
#include "plugins/common/frame_data/obstacle_solids.h"
#include "plugins/common/frame_data/room.h"
#include "plugins/common/frame_data/skin_solids.h"
#include "plugins/common/frame_data/strain.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void name_array(hk_frame_array *a, const char *name, bool force, size_t width) {
  snprintf(a->name, sizeof a->name, "%s", name);
  a->force = force;
  a->width = width;
}

static bool has_strain(const hk_model *m) {
  for (size_t k = 0; k < m->element_lists; k++)
    if (hk_elements_strained(&m->element_list[k].elements)) return true;
  return false;
}

/* With each force those within what the scene has: as channels, whose names have the unit. */
static size_t name_stresses(hk_gatherer *s, const hk_model *m, hk_frame_array *array) {
  size_t count = 0;
  for (int kind = 0; kind < HK_STRESS_KINDS; kind++) {
    char name[HK_ARRAY_NAME];
    if (!hk_stress_any(m, (hk_stress_kind)kind)) continue;
    snprintf(name, sizeof name, "%s %s", hk_stress_names[kind], hk_stress_units[kind]);
    s->stress[count] = kind;
    name_array(&array[count++], name, false, 1);
  }
  return count;
}

static bool begin(hk_gatherer *s, const hk_view *view, const hk_frame *frame, bool forces) {
  const hk_model *m = view->model;
  hk_frame_data *data = &s->data;
  size_t channels = m->channels, count = channels + (forces ? frame->forces : 0);
  data->solids = s->obstacles->shown->count + m->skins;
  data->array = calloc(count + HK_STRESS_KINDS + 1, sizeof *data->array);
  data->solid = calloc(data->solids + 1, sizeof *data->solid);
  if (!data->array || !data->solid) return false;
  data->arrays = count;
  for (size_t k = 0; k < channels; k++) name_array(&data->array[k], m->channel[k].name, false, m->channel[k].size);
  for (size_t k = channels; k < count; k++) name_array(&data->array[k], frame->force_name[k - channels], true, 3);
  s->stresses = forces ? name_stresses(s, m, data->array + count) : 0;
  data->arrays += s->stresses;
  s->dirty = true;
  s->strained = has_strain(m);
  return true;
}

static bool reserve(hk_gatherer *s, size_t n) {
  hk_frame_data *data = &s->data;
  bool fine = hk_make_room(&s->kept, &s->room[HK_ROOM_KEPT], n, sizeof *s->kept) &&
              hk_make_room(&s->place, &s->room[HK_ROOM_PLACE], n, sizeof *s->place) &&
              hk_make_room(&data->x, &s->room[HK_ROOM_X], 3 * n, sizeof *data->x) &&
              hk_make_room(&data->v, &s->room[HK_ROOM_V], 3 * n, sizeof *data->v) &&
              hk_make_room(&data->mass, &s->room[HK_ROOM_MASS], n, sizeof *data->mass) &&
              hk_make_room(&data->id, &s->room[HK_ROOM_ID], n, sizeof *data->id) &&
              hk_make_room(&data->pin, &s->room[HK_ROOM_PIN], n, sizeof *data->pin) &&
              hk_make_room(&data->group, &s->room[HK_ROOM_GROUP], n, sizeof *data->group) &&
              (!hk_strand_radii_any(&s->radii) ||
               hk_make_room(&data->strand_radius, &s->room[HK_ROOM_STRAND_RADIUS], n, sizeof *data->strand_radius)) &&
              hk_make_room(&s->every, &s->room[HK_ROOM_EVERY], 3 * n, sizeof *s->every) &&
              (!s->strained || hk_make_room(&data->strain, &s->room[HK_ROOM_STRAIN], n, sizeof *data->strain));
  for (size_t k = 0; k < data->arrays && fine; k++) {
    double *grown = realloc(data->array[k].value, (data->array[k].width * n + 1) * sizeof *grown);
    if (grown) data->array[k].value = grown;
    fine = grown != NULL;
  }
  return fine;
}

/* Which particles are shown, in the order of their ids. */
static void choose(hk_gatherer *s, const hk_view *view) {
  const hk_model *m = view->model;
  for (size_t i = 0; i < view->n; i++)
    s->place[i] = s->only.count || (s->group != UINT32_MAX && m->group[i] != s->group) ? UINT32_MAX : 0;
  for (size_t k = 0; k < s->only.count; k++) {
    uint32_t i = s->only.index[k];
    if (i < view->n && (s->group == UINT32_MAX || m->group[i] == s->group)) s->place[i] = 0;
  }
  s->data.n = 0;
  for (size_t k = 0; k < view->n; k++) {
    size_t i = hk_model_nth(m, k);
    if (s->place[i] == 0) s->place[i] = (uint32_t)s->data.n, s->kept[s->data.n++] = (uint32_t)i;
  }
}

/* Gathers `width` numbers of each particle shown. */
static void gather(const hk_gatherer *s, const double *from, size_t width, double *to) {
  for (size_t j = 0; j < s->data.n; j++) memcpy(to + width * j, from + width * s->kept[j], width * sizeof *to);
}

/* Writes to *to. Whether it was another. */
static bool differs(double *to, double value) {
  bool other = *to != value;
  *to = value;
  return other;
}

/* True: one of the particles, masses, pins, groups or radii is another one than in the frame before. */
static bool gather_model(hk_gatherer *s, const hk_model *m, size_t n_before) {
  hk_frame_data *data = &s->data;
  bool other = data->n != n_before;
  for (size_t j = 0; j < data->n; j++) {
    size_t i = s->kept[j];
    other = other || data->id[j] != m->id[i] || data->mass[j] != m->mass[i] || data->pin[j] != m->pin[i] ||
            data->group[j] != m->group[i];
    data->id[j] = m->id[i], data->mass[j] = m->mass[i], data->pin[j] = m->pin[i], data->group[j] = m->group[i];
    if (data->strand_radius) other |= differs(&data->strand_radius[j], hk_strand_radius(&s->radii, m, i));
  }
  return other;
}

static void gather_channels(hk_gatherer *s, const hk_view *view) {
  const hk_model *m = view->model;
  for (size_t k = 0; k < m->channels; k++)
    gather(s, view->y + m->channel[k].offset * view->n, m->channel[k].size, s->data.array[k].value);
}

hk_status hk_gatherer_forces(hk_gatherer *s, const hk_view *view, const hk_frame *frame) {
  size_t channels = view->model->channels, end = s->data.arrays - s->stresses;
  hk_status status = HK_OK;
  for (size_t k = channels; k < end && status == HK_OK; k++) {
    status = frame->force(frame, k - channels, s->every);
    gather(s, s->every, 3, s->data.array[k].value);
  }
  for (size_t k = 0; k < s->stresses && status == HK_OK; k++)
    status = hk_particle_stresses(view, frame, (hk_stress_kind)s->stress[k], s->place, s->data.n,
                                  s->data.array[end + k].value);
  return status;
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

static hk_status take(hk_gatherer *s, const hk_view *view) {
  size_t before = s->data.n;
  if (!reserve(s, view->n)) return HK_NO_MEMORY;
  s->data.t = view->t;
  choose(s, view);
  gather(s, view->x, 3, s->data.x);
  gather(s, view->v, 3, s->data.v);
  s->changed = gather_model(s, view->model, before) || s->dirty || signature(view) != s->signature;
  hk_status status = s->changed ? hk_gatherer_find_cells(s, view) : HK_OK;
  if (status != HK_OK) return status;
  s->signature = signature(view);
  s->dirty = false;
  hk_gatherer_strain(s, view);
  gather_channels(s, view);
  size_t obstacles = s->obstacles->shown->count;
  hk_obstacle_solids(s->obstacles->shown, false, s->data.solid);
  hk_skin_solids(view, false, s->data.solid + obstacles, s->data.solids - obstacles);
  return HK_OK;
}

hk_status hk_gatherer_choose(hk_gatherer *s, const hk_host *host, const hk_model *m, const char *group) {
  s->obstacles = host->query(host, HK_OBSTACLES_INTERFACE);
  if (!s->obstacles) return HK_FAILED;
  s->radii = hk_strand_radii_find(host, m);
  s->data.groups = m->groups, s->data.group_name = m->group_name;
  s->group = UINT32_MAX;
  for (size_t g = 0; group && g < m->groups; g++)
    if (strcmp(m->group_name[g], group) == 0) s->group = (uint32_t)g;
  if (!group || s->group != UINT32_MAX) return HK_OK;
  return host->fail(host, HK_BAD_PARAM, "group: no particle is in a group '%s'", group);
}

hk_status hk_gatherer_open(hk_gatherer *s, const hk_view *view, const hk_frame *frame, const hk_tuples *only,
                           bool forces) {
  const hk_host *host = view->host;
  if (!begin(s, view, frame, forces)) return host->fail(host, HK_NO_MEMORY, "no memory for a frame");
  hk_status status = hk_marks_open(&s->data.marks, host, frame);
  if (status == HK_OK) status = hk_gatherer_frame(s, view, frame, only);
  return status == HK_OK ? hk_gatherer_forces(s, view, frame) : status;
}

hk_status hk_gatherer_frame(hk_gatherer *s, const hk_view *view, const hk_frame *frame, const hk_tuples *only) {
  s->only = *only;
  hk_status status = take(s, view);
  if (status == HK_NO_MEMORY) return view->host->fail(view->host, status, "no memory for %zu particles", view->n);
  return status == HK_OK ? hk_marks_take(&s->data.marks, view, frame) : status;
}

void hk_gatherer_free(hk_gatherer *s) {
  hk_frame_data *data = &s->data;
  void *const all[] = {s->kept,
                       s->place,
                       s->every,
                       s->source,
                       data->x,
                       data->v,
                       data->mass,
                       data->id,
                       data->pin,
                       data->group,
                       data->strand_radius,
                       data->cell_strain,
                       data->strain,
                       data->cells.vertex,
                       data->cells.segment,
                       data->cells.triangle};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
  for (size_t k = 0; k < data->arrays; k++) free(data->array[k].value);
  free(data->array);
  free(data->solid);
  hk_marks_free(&data->marks);
  *s = (hk_gatherer){0};
}
