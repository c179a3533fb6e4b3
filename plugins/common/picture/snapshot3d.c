#include "plugins/common/picture/snapshot3d.h"

#include <stdio.h>
#include <string.h>

static hk_status unknown_colour(const hk_host *host, const hk_model *m, const char *colour) {
  char list[256] = "";
  for (size_t k = 0, at = 0; k < m->channels && at < sizeof list; k++)
    at += (size_t)snprintf(list + at, sizeof list - at, ", %s", m->channel[k].name);
  return host->fail(host, HK_BAD_PARAM, "color: '%s' is not one of auto, none, strain, speed, group%s", colour, list);
}

/* Strain is shown of plain edges. */
static bool has_strain(const hk_model *m) {
  bool any = false;
  for (size_t k = 0; k < m->element_lists; k++) any |= hk_elements_are_edges(&m->element_list[k].elements);
  return any;
}

hk_status hk_look_choose(hk_look *look, const hk_host *host, const hk_model *m, const char *colour,
                         const char **label) {
  static const char *const name[] = {"none", "strain", "speed", "group"}; /* as hk_paint */
  static const char *const labels[] = {"", "strain %", "speed m/s", ""};
  if (strcmp(colour, "auto") == 0) colour = has_strain(m) ? "strain" : m->triangles.count ? "none" : "speed";
  for (int k = 0; k < 4; k++)
    if (strcmp(colour, name[k]) == 0) {
      look->paint = (hk_paint)k;
      *label = labels[k];
      return HK_OK;
    }
  for (size_t k = 0; k < m->channels; k++)
    if (strcmp(colour, m->channel[k].name) == 0) {
      look->paint = m->channel[k].size == 3 ? HK_PAINT_RGB : HK_PAINT_CHANNEL;
      look->channel = k;
      *label = m->channel[k].name;
      return HK_OK;
    }
  return unknown_colour(host, m, colour);
}

static void *renew(const hk_host *host, void *old, size_t count, size_t bytes) {
  host->release(host, old);
  return host->allocate(host, count * bytes);
}

hk_status hk_snapshot3d_reserve(hk_snapshot3d *s, size_t n, size_t triangles, size_t lines) {
  if (n >= s->room) {
    s->room = n + n / 2 + 1, s->stale = true;
    s->x = renew(s->host, s->x, s->room, sizeof *s->x);
    s->ink = renew(s->host, s->ink, s->room, sizeof *s->ink);
    s->mark = renew(s->host, s->mark, s->room, sizeof *s->mark);
    s->weight = renew(s->host, s->weight, s->room, sizeof *s->weight);
  }
  if (triangles >= s->triangle_room) {
    s->triangle_room = triangles + triangles / 2 + 1, s->stale = true;
    s->triangle = renew(s->host, s->triangle, s->triangle_room, sizeof *s->triangle);
  }
  if (lines >= s->line_room) {
    s->line_room = lines + lines / 2 + 1, s->stale = true;
    s->line = renew(s->host, s->line, s->line_room, sizeof *s->line);
  }
  if (s->x && s->ink && s->mark && s->weight && s->triangle && s->line) return HK_OK;
  s->room = s->triangle_room = s->line_room = 0;
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory for a picture of %zu particles", n);
}

void hk_snapshot3d_free(hk_snapshot3d *s) {
  if (!s->host) return;
  void *all[] = {s->x, s->ink, s->mark, s->weight, s->triangle, s->line};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) s->host->release(s->host, all[k]);
  *s = (hk_snapshot3d){.host = s->host};
}

/* A hash of the data that the copy of the topology depends on; pins are released and springs removed without births or
 * deaths. */
static uint64_t fingerprint(const hk_model *m) {
  uint64_t h = 14695981039346656037u;
  size_t counts[] = {m->n, m->edges.count, m->triangles.count, m->element_lists};
  for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) h = (h ^ counts[k]) * 1099511628211u;
  for (size_t k = 0; k < m->element_lists; k++) h = (h ^ m->element_list[k].elements.node.count) * 1099511628211u;
  for (size_t i = 0; i < m->n; i++) h = (h ^ m->pin[i]) * 1099511628211u;
  return h;
}

/* The lists of elements on pairs, or else the scene's edges: the k-th; NULL: there are no more. */
static const hk_tuples *pairs_of(const hk_model *m, size_t k) {
  size_t pairs = 0;
  for (size_t l = 0; l < m->element_lists; l++)
    if (m->element_list[l].elements.node.arity == 2 && pairs++ == k) return &m->element_list[l].elements.node;
  return pairs == 0 && k == 0 ? &m->edges : NULL;
}

/* The number of edges: those of elements on pairs or, without any, the scene's. */
static size_t all_lines(const hk_model *m) {
  size_t count = 0;
  const hk_tuples *pairs;
  for (size_t k = 0; (pairs = pairs_of(m, k)); k++) count += pairs->count;
  return count;
}

/* Appends the pairs to draw: all, or those with an end that belongs to no triangle. */
static void add_lines(hk_snapshot3d *s, const hk_tuples *edges, bool all) {
  for (size_t e = 0; e < edges->count; e++) {
    const uint32_t *pair = hk_tuple(edges, e);
    if (!all && s->weight[pair[0]] > 0 && s->weight[pair[1]] > 0) continue;
    memcpy(s->line[s->lines++], pair, sizeof s->line[0]);
  }
}

/* Copies the topology. During the call `weight` marks the particles that belong to a triangle. */
static void take_topology(hk_snapshot3d *s, const hk_model *m, const hk_look *look) {
  s->triangles = m->triangles.count;
  s->lines = 0;
  if (s->triangles) memcpy(s->triangle, m->triangles.index, s->triangles * sizeof *s->triangle);
  memset(s->weight, 0, m->n * sizeof *s->weight);
  for (size_t k = 0; k < 3 * s->triangles; k++) s->weight[m->triangles.index[k]] = 1;
  const hk_tuples *pairs;
  for (size_t k = 0; look->springs != 2 && (pairs = pairs_of(m, k)); k++) add_lines(s, pairs, look->springs == 1);
  for (size_t i = 0; i < m->n; i++) {
    bool bead = look->particles == 1 || (look->particles == 0 && s->weight[i] == 0);
    bool pin = look->particles != 2 && (m->pin[i] == HK_PIN_FIXED || m->pin[i] == HK_PIN_PATH);
    s->mark[i] = (uint8_t)((bead ? HK_MARK_BEAD : 0) | (pin ? HK_MARK_PIN : 0));
  }
}

/* Sets the origin to the middle of the finite positions. */
static void find_origin(hk_snapshot3d *s, const hk_view *view) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t k = 0; k < 3 * view->n; k++)
    if (isfinite(view->x[k])) low[k % 3] = fmin(low[k % 3], view->x[k]), high[k % 3] = fmax(high[k % 3], view->x[k]);
  for (int c = 0; c < 3; c++) s->origin[c] = low[c] <= high[c] ? low[c] / 2 + high[c] / 2 : 0;
}

static void take_positions(hk_snapshot3d *s, const hk_view *view) {
  s->reach = 0;
  for (int c = 0; c < 3; c++) s->low[c] = INFINITY, s->high[c] = -INFINITY;
  for (size_t i = 0; i < view->n; i++) {
    float *x = s->x[i];
    for (int c = 0; c < 3; c++) x[c] = (float)(view->x[3 * i + (size_t)c] - s->origin[c]);
    float reach = sqrtf(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    if (!isfinite(reach)) {
      x[0] = x[1] = x[2] = NAN;
      continue;
    }
    s->reach = fmaxf(s->reach, reach);
    for (int c = 0; c < 3; c++) s->low[c] = fminf(s->low[c], x[c]), s->high[c] = fmaxf(s->high[c], x[c]);
  }
}

static void take_strain(hk_snapshot3d *s, const hk_view *view) {
  const hk_model *m = view->model;
  for (size_t i = 0; i < view->n; i++) s->ink[i].number = s->weight[i] = 0;
  for (size_t l = 0; l < m->element_lists; l++) {
    const hk_elements *e = &m->element_list[l].elements;
    if (!hk_elements_are_edges(e) || e->rest.count == 0) continue;
    for (size_t k = 0; k < e->node.count; k++) {
      size_t i = hk_tuple(&e->node, k)[0], j = hk_tuple(&e->node, k)[1];
      const double *a = view->x + 3 * i, *b = view->x + 3 * j;
      double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
      double rest = hk_tuple_value(&e->rest, k), stiffness = hk_tuple_value(&e->stiffness, k);
      if (!(rest > 0) || !(stiffness > 0)) continue;
      double strain = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / rest - 1;
      if (!isfinite(strain)) continue;
      s->ink[i].number += (float)(stiffness * strain), s->weight[i] += (float)stiffness;
      s->ink[j].number += (float)(stiffness * strain), s->weight[j] += (float)stiffness;
    }
  }
  for (size_t i = 0; i < view->n; i++)
    if (s->weight[i] > 0) s->ink[i].number /= s->weight[i];
}

static double length(const double *value, size_t size) {
  double sum = 0;
  if (size == 1) return value[0];
  for (size_t c = 0; c < size; c++) sum += value[c] * value[c];
  return sqrt(sum);
}

static void take_colour(hk_ink *ink, const double rgb[3]) {
  for (int c = 0; c < 3; c++) ink->colour[c] = (uint8_t)(255 * fmin(fmax(rgb[c], 0), 1) + 0.5);
  ink->colour[3] = 255;
}

static void take_ink(hk_snapshot3d *s, const hk_view *view, const hk_look *look) {
  const hk_channel *channel = view->model->channel ? view->model->channel + look->channel : NULL;
  if (look->paint == HK_PAINT_STRAIN) {
    take_strain(s, view);
    return;
  }
  for (size_t i = 0; i < view->n; i++) {
    hk_ink *ink = s->ink + i;
    const double *y = channel && view->y ? view->y + channel->offset * view->n + i * channel->size : NULL;
    switch (look->paint) {
    case HK_PAINT_SPEED:
      ink->number = (float)length(view->v + 3 * i, 3);
      break;
    case HK_PAINT_GROUP:
      memcpy(ink, &view->model->group[i], sizeof *ink);
      break;
    case HK_PAINT_CHANNEL:
      ink->number = (float)length(y, channel->size);
      break;
    case HK_PAINT_RGB:
      take_colour(ink, y);
      break;
    case HK_PAINT_NONE:
    case HK_PAINT_STRAIN:
      ink->number = 0;
    }
  }
}

hk_status hk_snapshot3d_take(hk_snapshot3d *s, const hk_view *view, const hk_look *look, bool changed) {
  const hk_model *m = view->model;
  s->host = view->host;
  bool first = !s->room;
  hk_status status = hk_snapshot3d_reserve(s, view->n, m->triangles.count, look->springs == 2 ? 0 : all_lines(m));
  if (status != HK_OK) return status;
  if (first) find_origin(s, view);
  uint64_t print = fingerprint(m);
  if (changed || s->stale || print != s->fingerprint) {
    take_topology(s, m, look);
    s->fingerprint = print;
    s->stale = false;
    s->topology++;
  }
  s->n = view->n;
  take_positions(s, view);
  take_ink(s, view, look);
  return HK_OK;
}
