/* Buoyancy of hot gas by Boussinesq's approximation: the density is taken to be constant but in the weight, where
 * it falls by the part beta per kelvin, so that a particle of the temperature T is lifted by F = -m g beta (T - T0),
 * g being gravity's acceleration. An ideal gas has beta = 1/T0. Its own weight and that of the air it displaces are
 * equal at T0 and are no part of the force. (Boussinesq, Theorie analytique de la chaleur II, 1903; Foster and Metaxas,
 * Modeling the motion of a hot, turbulent gas, SIGGRAPH 1997.) The force has no energy, since temperatures
 * change; its power is F.v. */
#include "plugins/common/channels/find_channel.h"
#include "plugins/kit/parts/particle_sums.h"

typedef struct buoyancy {
  double g[3], beta, ambient; /* beta NAN: 1/ambient */
  const char *channel;
  const hk_channel *temperature;
} buoyancy;

static const hk_param params[] = {
    {"g", "m/s^2", "acceleration of gravity; hot particles rise against it", .vector = HK_AT(buoyancy, g),
     .initial = {0, 0, -9.81}, .flags = HK_TIMED},
    {"ambient", "K", "temperature T0 of the air around", .number = HK_AT(buoyancy, ambient), .initial = {293.15},
     .limits = HK_ABOVE(0)},
    {"beta", "1/K", "thermal expansion; left out: 1/ambient, an ideal gas", .number = HK_AT(buoyancy, beta),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"channel", "", "the channel of temperatures, of size 1", .string = HK_AT(buoyancy, channel),
     .text = "temperature"},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  buoyancy *b = self;
  if (isnan(b->beta)) b->beta = 1 / b->ambient;
  return hk_find_channel(host, view->model, b->channel, "channel", 1, &b->temperature);
}

static double lift(const void *self, const hk_view *view, size_t begin, size_t end, double *F) {
  const buoyancy *b = self;
  const double *T = view->y + b->temperature->offset * view->n;
  double power = 0;
  for (size_t k = begin; k < end; k++) {
    size_t i = hk_acting_particle(view, k);
    double up = -view->model->mass[i] * b->beta * (T[i] - b->ambient);
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
    .summary = "hot particles rise, F = -m g beta (T - T0), by their channel 'temperature'",
    .reference = "Boussinesq 1903; Foster and Metaxas, SIGGRAPH 1997",
    .instance_size = sizeof(buoyancy),
    .params = params,
    .create = create,
    .force = &force,
};
