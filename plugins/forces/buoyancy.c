/* Buoyancy of hot gas by Boussinesq's approximation: the density is taken to be constant but in the weight, where
 * it falls by the part beta per kelvin, so that a particle of the temperature T is lifted by F = -m g beta (T - T0),
 * g being gravity's acceleration. An ideal gas has beta = 1/T0. Its own weight and that of the air it displaces are
 * equal at T0 and are no part of the force. (Boussinesq, Theorie analytique de la chaleur II, 1903; Foster and Metaxas,
 * Modeling the motion of a hot, turbulent gas, SIGGRAPH 1997.) The force has no energy, since temperatures
 * change; its power is F.v.
 *
 * What melts has its temperature from the force melt, `of`: with the molten part f, 0 to 1, F = -m g (f beta (T - T0) +
 * (1 - f) lighter), so that a solid of the density rho (1 - lighter) floats in its melt of the density rho at T0, and
 * melting between is linear in the mass that has molten. As all of Boussinesq's approximation it is for small parts. */
#include "plugins/common/channels/find_channel.h"
#include "plugins/common/channels/find_published.h"
#include "plugins/kit/parts/particle_sums.h"

typedef struct buoyancy {
  double g[3], beta, ambient; /* beta NAN: 1/ambient */
  double lighter;
  const char *channel, *of;
  const hk_channel *temperature;             /* NULL: they are those of `of` */
  const double *const *warm, *const *molten; /* n, K and 0 to 1, published by `of` */
} buoyancy;

static const hk_param params[] = {
    {"g", "m/s^2", "acceleration of gravity; hot particles rise against it", .vector = HK_AT(buoyancy, g),
     .initial = {0, 0, -9.81}, .flags = HK_TIMED},
    {"ambient", "K", "temperature T0 of the air around", .number = HK_AT(buoyancy, ambient), .initial = {293.15},
     .limits = HK_ABOVE(0)},
    {"beta", "1/K", "thermal expansion; left out: 1/ambient, an ideal gas", .number = HK_AT(buoyancy, beta),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"channel", "", "the channel of temperatures, of size 1; left out: temperature, or those of `of`",
     .string = HK_AT(buoyancy, channel), .flags = HK_OPTIONAL},
    {"of", "", "label of a force melt in front of this, of what melts: it has the temperatures",
     .string = HK_AT(buoyancy, of), .flags = HK_OPTIONAL},
    {"lighter", "", "part by which the solid of `of` is lighter than its melt: ice 0.083; below 0 it is heavier",
     .number = HK_AT(buoyancy, lighter), .limits = HK_WITHIN(-1, 1)},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  buoyancy *b = self;
  if (isnan(b->beta)) b->beta = 1 / b->ambient;
  if (b->of && b->channel)
    return host->fail(host, HK_BAD_PARAM,
                      "channel: '%s' and '%s' would both be the temperature: give one of channel, of", b->channel,
                      b->of);
  if (!b->of && b->lighter != 0)
    return host->fail(host, HK_BAD_PARAM,
                      "lighter: without `of` nothing is known to be solid: give the label of a force melt by of");
  if (!b->of)
    return hk_find_channel(host, view->model, b->channel ? b->channel : "temperature", "channel", 1, &b->temperature);
  hk_status status = hk_find_published(host, view->model, b->of, "temperature", "of", true, &b->warm);
  return status == HK_OK ? hk_find_published(host, view->model, b->of, "molten", "of", true, &b->molten) : status;
}

/* The part by which particle i is lighter than at T0. */
static double lightness(const buoyancy *b, const double *T, size_t i) {
  if (T) return b->beta * (T[i] - b->ambient);
  double f = (*b->molten)[i];
  return f * b->beta * ((*b->warm)[i] - b->ambient) + (1 - f) * b->lighter;
}

static double lift(const void *self, const hk_view *view, size_t begin, size_t end, double *F) {
  const buoyancy *b = self;
  const double *T = b->temperature ? view->y + b->temperature->offset * view->n : NULL;
  double power = 0;
  for (size_t k = begin; k < end; k++) {
    size_t i = hk_acting_particle(view, k);
    double up = -view->model->mass[i] * lightness(b, T, i);
    for (size_t c = 0; c < 3; c++) {
      double f = up * b->g[c];
      F[3 * i + c] += f;
      power += f * view->v[3 * i + c];
    }
  }
  return power;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  hk_particle_sums_add(view, HK_ALL_PARTS, lift, self, F);
  return HK_OK;
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  hk_particle_sums_add(view, part, lift, self, F);
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) { (void)self, (void)view, (void)p; }

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  (void)self, (void)view, (void)into; /* it depends on neither x nor v: no blocks */
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_CHANNELS | HK_SYMMETRIC_JACOBIAN | HK_POWER,
    .add = add,
    .add_part = add_part,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "buoyancy",
    .summary = "hot particles rise, F = -m g beta (T - T0), and solids that are lighter than their melt",
    .reference = "Boussinesq 1903; Foster and Metaxas, SIGGRAPH 1997",
    .instance_size = sizeof(buoyancy),
    .params = params,
    .create = create,
    .force = &force,
};
