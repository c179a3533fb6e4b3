/* Implicit surfaces for whoever has a function and wants a mesh: builders of scenes. The room common/isosurface does
 * the work. Triangles keep a thousandth of an edge of the grid away from its points, so that none is without area; that
 * moves a surface by less than 1e-6 of a cell in the mean. */
#include "plugins/common/isosurface/isosurface.h"
#include "plugins/common/isosurface/surface_fill.h"

enum { STEPS = 3 };

static const double margin = 1e-3, most_points = 1e9;

typedef struct isosurface {
  hk_isosurface surface;
  hk_filling filling;
  hk_isosurfaces table;
  const hk_host *host;
} isosurface;

static hk_status grid_of(const isosurface *s, const hk_implicit_request *r, hk_isosurface_grid *grid) {
  for (int c = 0; c < 3; c++) {
    double length = r->high[c] - r->low[c], cells = ceil(length / r->cell * (1 - 1e-12));
    if (!(r->cell > 0) || !(length > 0) || !(length < INFINITY))
      return s->host->fail(s->host, HK_BAD_PARAM,
                           "isosurface: a box from %g m to %g m along %c in cells of %g m: give a finite box with a "
                           "volume, and cells with a size",
                           r->low[c], r->high[c], 'x' + c, r->cell);
    if (!(cells < most_points))
      return s->host->fail(s->host, HK_BAD_PARAM, "isosurface: %.3g cells along %c: take a larger cell", cells,
                           'x' + c);
    cells = fmax(cells, 1);
    grid->points[c] = (size_t)cells + 1;
    grid->origin[c] = r->low[c];
    grid->spacing[c] = length / cells;
  }
  return HK_OK;
}

static hk_status find(void *self, const hk_implicit_request *r, hk_implicit_mesh *mesh) {
  isosurface *s = self;
  hk_isosurface_grid grid;
  hk_isosurface_field field = {.evaluate = r->evaluate, .bounds = r->bounds, .self = r->self};
  hk_isosurface_options options = {.method = r->cubes ? HK_MARCHING_CUBES : HK_MARCHING_TETRAHEDRA,
                                   .close = r->close,
                                   .steps = STEPS,
                                   .margin = margin,
                                   .coarse = r->bounds ? 0 : r->coarse,
                                   .without_normals = true,
                                   .most_bytes = r->most_bytes};
  hk_status status = grid_of(s, r, &grid);
  if (status != HK_OK) return status;
  status = r->solid ? hk_surface_fill(&s->filling, s->host, &grid, &field, &options)
                    : hk_isosurface_find(&s->surface, s->host, &grid, &field, &options);
  if (status != HK_OK) return status;
  const hk_filling *f = &s->filling;
  const hk_isosurface *t = &s->surface;
  *mesh = r->solid ? (hk_implicit_mesh){.vertices = f->vertices,
                                        .tetrahedra = f->tetrahedra,
                                        .x = (const double(*)[3])f->x,
                                        .tetrahedron = (const uint32_t(*)[4])f->tetrahedron}
                   : (hk_implicit_mesh){.vertices = t->vertices,
                                        .triangles = t->triangles,
                                        .x = (const double(*)[3])t->x,
                                        .triangle = (const uint32_t(*)[3])t->triangle};
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  isosurface *s = self;
  (void)view;
  s->host = host;
  s->table = (hk_isosurfaces){self, find};
  return HK_OK;
}

static const void *table(void *self) { return &((isosurface *)self)->table; }

static const hk_service service = {.size = sizeof(hk_service), .interface = "isosurface/1", .table = table};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "isosurface",
    .summary = "meshes of implicit surfaces: marching tetrahedra, marching cubes, fillings of tetrahedra",
    .reference = "Doi and Koide 1991; Lorensen and Cline 1987; Labelle and Shewchuk 2007",
    .instance_size = sizeof(isosurface),
    .create = create,
    .service = &service,
};
