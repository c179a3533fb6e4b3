#include "plugins/common/contact/candidates/start_check.h"

#include "plugins/kit/vector3.h"
#include "plugins/common/contact/candidates/enclosure.h"
#include "plugins/common/contact/candidates/feature_pairs.h"

#include <stdlib.h>
#include <string.h>

/* ---- area ---- */

static bool has_area(const double *x, const uint32_t t[3]) {
  double a[3], b[3], normal[3];
  hk_subtract(a, x + 3 * (size_t)t[1], x + 3 * (size_t)t[0]);
  hk_subtract(b, x + 3 * (size_t)t[2], x + 3 * (size_t)t[0]);
  hk_cross(normal, a, b);
  return hk_length(normal) > 1e-12 * hk_length(a) * hk_length(b); /* a thousand times what rounding leaves */
}

static hk_status check_areas(const hk_surface_mesh *m, const hk_view *view) {
  const uint32_t *id = view->model->id;
  for (size_t k = 0; k < m->triangles; k++) {
    const uint32_t *t = m->triangle[k];
    if (!has_area(view->x, t))
      return view->host->fail(
          view->host, HK_BAD_PARAM,
          "the triangle %u %u %u has no area at the start: move its particles off one line, or remove it", id[t[0]],
          id[t[1]], id[t[2]]);
  }
  return HK_OK;
}

/* ---- heaps: particles are sorted by cells whose diagonal is the least thickness: all in one cell touch ---- */

enum { MOST = 100 /* particles in a cell; spheres that do not overlap have room for their middles only */ };

typedef struct place {
  double cell[3];
  uint32_t particle;
} place;

static int in_order(const void *left, const void *right) {
  const place *a = left, *b = right;
  for (int c = 0; c < 3; c++)
    if (a->cell[c] != b->cell[c]) return a->cell[c] < b->cell[c] ? -1 : 1;
  return (a->particle > b->particle) - (a->particle < b->particle);
}

static bool can_meet(const hk_surface_mesh *m, const hk_view *view, uint32_t i) {
  return hk_model_moves(view->model, i) && m->radius[i] > 0;
}

/* 0: no particle can meet another. */
static double least_thickness(const hk_surface_mesh *m, const hk_view *view) {
  double least = INFINITY;
  for (size_t k = 0; k < m->points; k++)
    if (can_meet(m, view, m->point[k])) least = fmin(least, 2 * m->radius[m->point[k]]);
  return isfinite(least) ? least : 0;
}

static size_t put(place *to, const hk_surface_mesh *m, const hk_view *view, double side) {
  size_t count = 0;
  for (size_t k = 0; k < m->points; k++) {
    uint32_t i = m->point[k];
    if (!can_meet(m, view, i)) continue;
    to[count] = (place){.particle = i};
    for (int c = 0; c < 3; c++) to[count].cell[c] = floor(view->x[3 * (size_t)i + (size_t)c] / side);
    count++;
  }
  qsort(to, count, sizeof *to, in_order);
  return count;
}

static hk_status refuse_heaps(const place *p, size_t count, const hk_view *view, double thickness) {
  const uint32_t *id = view->model->id;
  for (size_t begin = 0, end; begin < count; begin = end) {
    for (end = begin + 1; end < count && memcmp(p[end].cell, p[begin].cell, sizeof p->cell) == 0;) end++;
    if (end - begin > MOST)
      return view->host->fail(view->host, HK_BAD_PARAM,
                              "%zu particles, among them %u and %u, start within %.3g m of each other, all of them "
                              "nearer than their thickness: start them apart, or make thickness or radius smaller",
                              end - begin, id[p[begin].particle], id[p[begin + 1].particle], thickness);
  }
  return HK_OK;
}

static hk_status check_crowds(const hk_surface_mesh *m, const hk_view *view) {
  double thickness = least_thickness(m, view);
  if (!(thickness > 0)) return HK_OK;
  place *p = view->host->allocate(view->host, m->points * sizeof *p);
  if (!p) return view->host->fail(view->host, HK_NO_MEMORY, "no memory for %zu particles", m->points);
  size_t count = put(p, m, view, thickness / sqrt(3));
  hk_status status = refuse_heaps(p, count, view, thickness);
  view->host->release(view->host, p);
  return status;
}

/* ---- neighbours ---- */

/* Whether edges of triangles, or of strands, list the edge p q; both lists rise. */
static bool in_list(const hk_surface_mesh *m, size_t begin, size_t end, uint32_t p, uint32_t q) {
  uint32_t low = p < q ? p : q, high = p < q ? q : p;
  while (begin < end) {
    size_t middle = begin + (end - begin) / 2;
    const uint32_t *e = m->edge[middle];
    if (e[0] == low && e[1] == high) return true;
    if (e[0] < low || (e[0] == low && e[1] < high))
      begin = middle + 1;
    else
      end = middle;
  }
  return false;
}

static bool are_neighbours(const hk_surface_lists *l, const hk_feature_pair *pair) {
  int split = hk_pair_split(pair->kind);
  for (int a = 0; a < split; a++)
    for (int b = split; b < 4; b++)
      if (in_list(&l->mesh, 0, l->surface_edges, pair->vertex[a], pair->vertex[b]) ||
          in_list(&l->mesh, l->surface_edges, l->surface_edges + l->strand_edges, pair->vertex[a], pair->vertex[b]))
        return true;
  return false;
}

/* The largest part of its offset that a pair leaves room for. */
typedef struct tightest {
  double part;
  const hk_feature_pair *pair;
  double distance;
} tightest;

static void keep_tightest(const hk_surface_lists *l, const double *x, const hk_feature_pair *pair, tightest *least) {
  double distance = sqrt(hk_pair_nearest(pair, x).squared);
  if (distance > pair->offset || distance / pair->offset >= least->part || !are_neighbours(l, pair)) return;
  *least = (tightest){distance / pair->offset, pair, distance};
}

static hk_status too_thick(const hk_view *view, const hk_surface_lists *l, const hk_surface_request *request,
                           const tightest *t) {
  const hk_host *host = view->host; /* of the plugin that joins: its line is named */
  hk_pair_names pair = hk_pair_names_of(t->pair, view->model->id);
  int of_triangles = 0;
  for (int c = 0; c < 4; c++) of_triangles += l->in_triangle[t->pair->vertex[c]];
  if (of_triangles == 4)
    return host->fail(
        host, HK_BAD_PARAM,
        "the thickness of %g m is too large for the mesh: %s and %s, which are neighbours in it, are %g m apart at "
        "the start; a thickness below that fits, or a coarser mesh",
        t->pair->offset, pair.one, pair.other, t->distance);
  return host->fail(
      host, HK_BAD_PARAM,
      "the radius of %g m is too large for the strands: %s and %s, which are neighbours, are %g m apart at the "
      "start; a radius below %.6g m fits, or longer edges",
      request->radius, pair.one, pair.other, t->distance, request->radius * t->part);
}

/* ---- solids ---- */

static hk_status check_solids(const hk_surface_lists *l, const hk_host *host, const hk_view *view) {
  const uint32_t *id = view->model->id;
  hk_enclosure e;
  hk_status status = hk_enclosure_find(l, host, view->model, view->x, &e);
  if (status != HK_OK || !e.found) return status;
  return view->host->fail(view->host, HK_BAD_PARAM,
                          "particle %u and all that it is connected with start inside of something solid, by up to "
                          "%.3g m (particle %u is of its surface): contact would never let it out; start it outside, "
                          "name one of the two in `leave`, or turn the faces of what is hollow inwards",
                          id[e.particle], e.depth, id[e.solid]);
}

hk_status hk_start_check(hk_broad_phase *s, const hk_host *host, const hk_view *view, const hk_surface_request *request,
                         hk_gather *pairs) {
  tightest least = {.part = INFINITY};
  hk_surface_move none = {.x_from = view->x, .x_to = view->x};
  hk_status status = check_areas(&s->lists->mesh, view);
  if (status == HK_OK) status = check_crowds(&s->lists->mesh, view);
  if (status == HK_OK) status = check_solids(s->lists, host, view);
  if (status == HK_OK) status = hk_feature_pairs_find(s, host, &none, pairs);
  if (status != HK_OK) return status;
  const hk_feature_pair *pair = pairs->record;
  for (size_t k = 0; k < pairs->count; k++) keep_tightest(s->lists, view->x, &pair[k], &least);
  return least.pair ? too_thick(view, s->lists, request, &least) : HK_OK;
}
