/* The surface of particles: their field on the blocks that any of them reaches, marched. */
#include "plugins/common/particle_surface/particle_surface.h"
#include "plugins/common/isosurface/isosurface.h"
#include "plugins/common/particle_surface/mesh_smoothing.h"
#include "plugins/common/particle_surface/particle_kernels.h"
#include "plugins/common/particle_surface/wall_cut.h"

/* Blocks that no particle reaches are outside. */
static void bounds(const void *self, const double low[3], const double high[3], double range[2]) {
  const hk_particle_field *f = self;
  double middle[3];
  for (int c = 0; c < 3; c++) middle[c] = (low[c] + high[c]) / 2;
  size_t block = hk_particle_field_block(f, middle);
  bool reached = f->start[block + 1] > f->start[block];
  range[0] = -INFINITY, range[1] = reached ? INFINITY : -INFINITY;
}

static hk_status smooth(hk_isosurface *s, const hk_host *host, const double (*x)[3], size_t n,
                        const hk_particle_surface_options *o) {
  if (o->smoothing == 0 || s->vertices == 0) return HK_OK;
  double *weight = host->allocate(host, s->vertices * sizeof *weight);
  if (!weight) return host->fail(host, HK_NO_MEMORY, "surface of particles: no memory for %zu weights", s->vertices);
  hk_status status = hk_smoothing_weights(host, x, n, o->radius, s, weight);
  for (size_t v = 0; v < s->vertices && status == HK_OK; v++)
    if (hk_wall_distance(o->walls, s->x[v]) < o->cell / 100) weight[v] = 0; /* it stays on its wall */
  if (status == HK_OK) status = hk_mesh_smooth(s, host, weight, o->smoothing);
  host->release(host, weight);
  return status;
}

hk_status hk_particle_surface_find(hk_isosurface *surface, const hk_host *host, const double (*x)[3], size_t n,
                                   const hk_particle_surface_options *options) {
  hk_particle_field f = {.host = host, .x = x, .n = n, .o = *options};
  hk_isosurface_field field = {
      .evaluate = hk_particle_field_evaluate, .bounds = bounds, .lattice = hk_particle_field_lattice, .self = &f};
  if (options->walls) field.evaluate = hk_walled_evaluate, field.lattice = hk_walled_lattice;
  hk_isosurface_options o = {.method = options->method,
                             .margin = 1e-3,
                             .steps = options->walls ? 4 : 0, /* the smaller of two is not linear */
                             .without_normals = options->without_normals,
                             .may_be_empty = options->may_be_empty,
                             .most_bytes = options->most_bytes};
  hk_particle_kernels kernels = {0};
  hk_isosurface found = {0};
  hk_status status = hk_particle_options_complete(&f.o, host);
  if (status == HK_OK && f.o.kind == HK_ANISOTROPIC) {
    status = hk_particle_kernels_make(&kernels, host, x, n, &f.o);
    f.x = (const double(*)[3])kernels.centre, f.kernel = kernels.kernel;
  }
  if (status == HK_OK) status = hk_particle_field_open(&f);
  if (status == HK_OK) status = hk_isosurface_find(&found, host, &f.grid, &field, &o);
  if (status == HK_OK) status = smooth(&found, host, x, n, &f.o);
  hk_particle_field_close(&f);
  hk_particle_kernels_free(&kernels, host);
  hk_isosurface_free(status == HK_OK ? surface : &found, host);
  if (status == HK_OK) *surface = found;
  return status;
}
