/* The surface of particles: their field on the blocks that any of them reaches, marched. */
#include "plugins/common/isosurface/isosurface.h"
#include "plugins/common/particle_surface/particle_field.h"

/* Blocks that no particle reaches are outside. */
static void bounds(const void *self, const double low[3], const double high[3], double range[2]) {
  const hk_particle_field *f = self;
  double middle[3];
  for (int c = 0; c < 3; c++) middle[c] = (low[c] + high[c]) / 2;
  size_t block = hk_particle_field_block(f, middle);
  bool reached = f->start[block + 1] > f->start[block];
  range[0] = -INFINITY, range[1] = reached ? INFINITY : -INFINITY;
}

static hk_status check(hk_particle_field *f) {
  hk_particle_surface_options *o = &f->o;
  if (!(o->radius > 0 && o->radius <= 1e100))
    return f->host->fail(f->host, HK_BAD_PARAM, "surface of particles: a radius of %g m: give one above 0", o->radius);
  if (o->reach == 0) o->reach = 4 * o->radius;
  if (o->cell == 0) o->cell = o->radius / 2;
  if (o->threshold == 0) o->threshold = 0.6;
  if (!(o->reach >= o->radius && o->reach <= 1e100 && o->cell > 0 && o->cell <= o->reach))
    return f->host->fail(
        f->host, HK_BAD_PARAM,
        "surface of particles: a reach of %g m and cells of %g m beside a radius of %g m: the reach is "
        "no less than the radius, and cells are no larger than the reach",
        o->reach, o->cell, o->radius);
  if (f->n == 0) return f->host->fail(f->host, HK_BAD_PARAM, "surface of particles: there are none");
  return HK_OK;
}

hk_status hk_particle_surface_find(hk_isosurface *surface, const hk_host *host, const double (*x)[3], size_t n,
                                   const hk_particle_surface_options *options) {
  hk_particle_field f = {.host = host, .x = x, .n = n, .o = *options};
  hk_isosurface_field field = {
      .evaluate = hk_particle_field_evaluate, .bounds = bounds, .lattice = hk_particle_field_lattice, .self = &f};
  hk_isosurface_options o = {.method = options->method,
                             .margin = 1e-3,
                             .without_normals = options->without_normals,
                             .most_bytes = options->most_bytes};
  hk_status status = check(&f);
  if (status == HK_OK) status = hk_particle_field_open(&f);
  if (status == HK_OK) status = hk_isosurface_find(surface, host, &f.grid, &field, &o);
  hk_particle_field_close(&f);
  return status;
}
