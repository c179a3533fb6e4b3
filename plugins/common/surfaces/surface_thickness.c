#include "plugins/common/surfaces/surface_thickness.h"

#include "plugins/common/space/vector3.h"
#include "plugins/common/surfaces/surface_crowd.h"
#include "plugins/common/surfaces/surface_pair_names.h"
#include "plugins/common/surfaces/surface_pairs.h"

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

static bool are_neighbours(const hk_surface_lists *l, const hk_surface_pair *pair) {
  int first = pair->kind == HK_POINT_TRIANGLE ? 1 : 2;
  for (int a = 0; a < first; a++)
    for (int b = first; b < 4; b++)
      if (in_list(&l->mesh, 0, l->surface_edges, pair->vertex[a], pair->vertex[b]) ||
          in_list(&l->mesh, l->surface_edges, l->surface_edges + l->strand_edges, pair->vertex[a], pair->vertex[b]))
        return true;
  return false;
}

/* The largest part of its offset that a pair leaves room for. */
typedef struct tightest {
  double part;
  const hk_surface_pair *pair;
  double distance;
} tightest;

static void look(const hk_surface_lists *l, const double *x, const hk_surface_pair *pair, tightest *least) {
  double at[12];
  for (int c = 0; c < 4; c++) memcpy(at + 3 * c, x + 3 * (size_t)pair->vertex[c], 3 * sizeof *at);
  double distance = sqrt(hk_nearest_of_pair(pair->kind, at).squared);
  if (distance > pair->offset || distance / pair->offset >= least->part || !are_neighbours(l, pair)) return;
  *least = (tightest){distance / pair->offset, pair, distance};
}

static hk_status too_thick(const hk_view *view, const hk_surface_lists *l, const hk_surface_request *request,
                           const tightest *t) {
  const hk_host *host = view->host; /* of the plugin that joins: its line is named */
  hk_surface_pair_names pair = hk_surface_pair_name(t->pair, view->model->id);
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

hk_status hk_surface_thickness_check(hk_surface_search *s, const hk_host *host, const hk_view *view,
                                     const hk_surface_request *request, hk_gather *pairs) {
  tightest least = {.part = INFINITY};
  hk_surface_move none = {.x_from = view->x, .x_to = view->x};
  hk_status status = check_areas(&s->lists->mesh, view);
  if (status == HK_OK) status = hk_surface_crowd_check(&s->lists->mesh, view);
  if (status == HK_OK) status = hk_surface_pairs_find(s, host, &none, pairs);
  if (status != HK_OK) return status;
  const hk_surface_pair *pair = pairs->record;
  for (size_t k = 0; k < pairs->count; k++) look(s->lists, view->x, &pair[k], &least);
  return least.pair ? too_thick(view, s->lists, request, &least) : HK_OK;
}
