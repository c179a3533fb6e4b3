/* The force of a uniform magnetic field on moving charges, F = q v x B, with a charge q per particle or proportional to
 * its mass. It rotates velocities at the rate q B/m and does no work. With ratio = 1 and B = 2 W it is the Coriolis
 * force in a frame that rotates at W (the centrifugal force is `central` with an axis and strength -W^2).
 *
 * The Jacobian consists of -dF/dv only, which is antisymmetric, so a symmetric form is not offered: it would be 0. */
#include "plugins/kit/parts/particle_sums.h"

typedef struct magnetic {
  double B[3], charge, ratio;
} magnetic;

static const hk_param params[] = {
    {"B", "T", "the field", .vector = HK_AT(magnetic, B), .initial = {0, 0, 1}, .flags = HK_TIMED | HK_REQUIRED},
    {"charge", "C", "charge q of a particle", .number = HK_AT(magnetic, charge), .flags = HK_OPTIONAL},
    {"ratio", "C/kg", "charge over mass, q = ratio m", .number = HK_AT(magnetic, ratio), .flags = HK_OPTIONAL},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  (void)view;
  const magnetic *p = self;
  if (isnan(p->charge) == isnan(p->ratio))
    return host->fail(host, HK_BAD_PARAM, "give either charge (C, per particle) or ratio (C/kg, per mass)");
  return HK_OK;
}

static double charge_of(const magnetic *p, const hk_view *view, size_t i) {
  return isnan(p->charge) ? p->ratio * view->model->mass[i] : p->charge;
}

static double turn(const void *self, const hk_view *view, size_t begin, size_t end, double *F) {
  const magnetic *p = self;
  const double *B = p->B;
  for (size_t k = begin; k < end; k++) {
    size_t i = hk_acting_particle(view, k);
    const double *v = view->v + 3 * i;
    double q = charge_of(p, view, i);
    for (int c = 0; c < 3; c++) {
      int d = (c + 1) % 3, e = (c + 2) % 3;
      F[3 * i + (size_t)c] += q * (v[d] * B[e] - v[e] * B[d]);
    }
  }
  return 0; /* v.(v x B) */
}

static hk_status add(void *self, const hk_view *view, double *F) {
  hk_particle_sums_add(view, HK_ALL_PARTS, turn, self, F);
  return HK_OK;
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  hk_particle_sums_add(view, part, turn, self, F);
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  (void)self;
  for (size_t k = 0; k < view->acting; k++)
    p->block(p, (uint32_t)hk_acting_particle(view, k), (uint32_t)hk_acting_particle(view, k));
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const magnetic *p = self;
  for (size_t k = 0; k < view->acting; k++) {
    double *D = into->D + 9 * into->slot[k], q = charge_of(p, view, hk_acting_particle(view, k));
    for (int c = 0; c < 3; c++) {
      int d = (c + 1) % 3, e = (c + 2) % 3;
      D[3 * c + d] -= q * p->B[e];
      D[3 * c + e] += q * p->B[d];
    }
  }
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_V | HK_POWER,
    .add = add,
    .add_part = add_part,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "magnetic",
    .summary = "uniform magnetic field, F = q v x B; also the Coriolis force",
    .reference = "Lorentz 1895",
    .instance_size = sizeof(magnetic),
    .params = params,
    .create = create,
    .force = &force,
};
