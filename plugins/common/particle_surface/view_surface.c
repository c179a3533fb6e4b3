/* Chooses the particles of a liquid in a view, and makes the solid that is drawn of their surface. */
#include "plugins/common/particle_surface/view_surface.h"
#include "plugins/common/frame_data/obstacle_solids.h"
#include "plugins/common/isosurface/isosurface.h"
#include "plugins/common/particle_surface/particle_surface.h"
#include "plugins/common/snapshot/appearance.h"

#include <string.h>

hk_status hk_view_surface_choose(hk_view_surface *s, const hk_host *host, const hk_model *m,
                                 const hk_surface_wanted *wanted) {
  if (isnan(wanted->radius)) {
    bool more = wanted->of || wanted->clear || wanted->field || wanted->smoothing || wanted->cut;
    if (!more && isnan(wanted->cell) && isnan(wanted->reach)) return HK_OK;
    return host->fail(host, HK_BAD_PARAM,
                      "surface: it is required beside surface_of, surface_look, surface_field, surface_smoothing, "
                      "surface_cut, surface_cell and surface_reach: the radius of the liquid's particles, m");
  }
  s->options = (hk_particle_surface_options){.kind = (hk_particle_field_kind)wanted->field,
                                             .smoothing = (unsigned)wanted->smoothing,
                                             .radius = wanted->radius,
                                             .cell = isnan(wanted->cell) ? 0 : wanted->cell,
                                             .reach = isnan(wanted->reach) ? 0 : wanted->reach};
  s->smooth = wanted->clear;
  s->group = UINT32_MAX;
  for (size_t g = 0; wanted->of && g < m->groups; g++)
    if (strcmp(m->group_name[g], wanted->of) == 0) s->group = (uint32_t)g;
  if (!wanted->of || s->group != UINT32_MAX) return HK_OK;
  return host->fail(host, HK_BAD_PARAM, "surface_of: there is no group '%s'", wanted->of);
}

static void bind(hk_view_surface *s, const hk_tuples *list) {
  for (size_t k = 0; k < list->count * list->arity; k++) s->bound[list->index[k]] = true;
}

static hk_status reserve(hk_view_surface *s, const hk_view *view) {
  if (view->n <= s->room) return HK_OK;
  hk_view_surface_free(s, view->host);
  s->bound = view->host->allocate(view->host, view->n * sizeof *s->bound);
  s->x = view->host->allocate(view->host, view->n * sizeof *s->x);
  if (!s->bound || !s->x)
    return view->host->fail(view->host, HK_NO_MEMORY, "surface: no memory for %zu particles", view->n);
  s->room = view->n;
  return HK_OK;
}

/* Copies the places of the liquid's particles in the order of their ids; returns how many. */
static size_t gather(hk_view_surface *s, const hk_view *view) {
  const hk_model *m = view->model;
  size_t n = 0;
  memset(s->bound, 0, view->n * sizeof *s->bound);
  if (s->group == UINT32_MAX) {
    bind(s, &m->edges);
    bind(s, &m->triangles);
    for (size_t k = 0; k < m->element_lists; k++) bind(s, &m->element_list[k].elements.node);
  }
  for (size_t k = 0; k < view->n; k++) {
    size_t i = hk_model_nth(m, k);
    if (s->bound[i] || (s->group != UINT32_MAX && m->group[i] != s->group)) continue;
    memcpy(s->x[n++], view->x + 3 * i, sizeof *s->x);
  }
  return n;
}

hk_status hk_view_surface_take(hk_view_surface *s, const hk_view *view, bool y_up) {
  static const double axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  hk_status status = reserve(s, view);
  s->solid.kind = HK_SHAPE_MESH;
  s->solid.vertices = s->solid.faces = 0;
  size_t n = status == HK_OK ? gather(s, view) : 0;
  if (n == 0) return status;
  hk_frame_solid solid[HK_OBSTACLES];
  hk_solid_list solids = {s->walls ? s->walls->count : 0, solid};
  hk_particle_walls walls = {hk_solids_distance, &solids};
  if (s->walls) hk_obstacle_solids(s->walls, false, solid);
  hk_particle_surface_options options = s->options;
  options.without_normals = !s->smooth;
  options.may_be_empty = true; /* a liquid whose drops are too small for its field, for a while */
  options.walls = solids.count > 0 ? &walls : NULL;
  status = hk_particle_surface_find(&s->surface, view->host, (const double(*)[3])s->x, n, &options);
  if (status != HK_OK || s->surface.vertices == 0) return status;
  for (int k = 0; k < 3; k++) hk_to_z_up(y_up, axis[k], s->solid.axis[k]);
  s->solid.vertices = s->surface.vertices, s->solid.faces = s->surface.triangles;
  s->solid.vertex = s->surface.x[0];
  s->solid.face = (const uint32_t(*)[3])s->surface.triangle;
  return HK_OK;
}

void hk_view_surface_free(hk_view_surface *s, const hk_host *host) {
  host->release(host, s->bound);
  host->release(host, s->x);
  hk_isosurface_free(&s->surface, host);
  s->bound = NULL, s->x = NULL, s->room = 0;
  s->solid.vertices = s->solid.faces = 0;
}
