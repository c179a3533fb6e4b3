/* What is left out of the options, and the sentence for each that is out of its range. */
#include "plugins/common/particle_surface/particle_options.h"

static hk_status check_kernels(const hk_particle_surface_options *o, const hk_host *host) {
  if (!(fabs(o->position_smoothing) <= 1))
    return host->fail(host, HK_BAD_PARAM,
                      "surface of particles: positions smoothed by %g: give a part of the way to the neighbours' mean, "
                      "from 0 to 1",
                      o->position_smoothing);
  if (!(o->stretch >= 1 && o->stretch <= 100))
    return host->fail(
        host, HK_BAD_PARAM,
        "surface of particles: kernels stretched up to %g: give the largest ratio of their axes, from 1 to "
        "100",
        o->stretch);
  if (o->lone >= 0.1 && o->lone <= 1) return HK_OK;
  return host->fail(host, HK_BAD_PARAM,
                    "surface of particles: kernels of lone particles of %g reaches: give a part from 0.1 to 1",
                    o->lone);
}

hk_status hk_particle_options_complete(hk_particle_surface_options *o, const hk_host *host) {
  bool stretched = o->kind == HK_ANISOTROPIC;
  if (!(o->radius > 0 && o->radius <= 1e100))
    return host->fail(host, HK_BAD_PARAM, "surface of particles: a radius of %g m: give one above 0", o->radius);
  if (o->reach == 0) o->reach = (stretched ? 6 : 4) * o->radius;
  if (o->cell == 0) o->cell = o->radius / 2;
  if (o->threshold == 0) o->threshold = stretched ? 0.25 : 0.6;
  if (o->position_smoothing == 0) o->position_smoothing = 0.9;
  if (o->stretch == 0) o->stretch = 4;
  if (o->lone == 0) o->lone = 0.5;
  if (o->few == 0) o->few = 25;
  if (!(o->reach >= o->radius && o->reach <= 1e100 && o->cell > 0 && o->cell <= o->reach))
    return host->fail(host, HK_BAD_PARAM,
                      "surface of particles: a reach of %g m and cells of %g m beside a radius of %g m: the reach is "
                      "no less than the radius, and cells are no larger than the reach",
                      o->reach, o->cell, o->radius);
  if (o->kind != HK_ZHU_BRIDSON && !(o->threshold > 0 && o->threshold < 1))
    return host->fail(host, HK_BAD_PARAM,
                      "surface of particles: a threshold of %g: give a part of the full liquid's density, above 0 and "
                      "below 1",
                      o->threshold);
  if (o->smoothing > 1000)
    return host->fail(host, HK_BAD_PARAM,
                      "surface of particles: %u rounds of smoothing: give at most 1000, of which 25 smooth a liquid",
                      o->smoothing);
  return stretched ? check_kernels(o, host) : HK_OK;
}
