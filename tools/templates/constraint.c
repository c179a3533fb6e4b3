/* NAME: keeps particles at a distance from a point, g = |x - centre| - radius. Describe here the equations and their
 * source. */
#include "core/plugin.h"

typedef struct NAME {
  hk_tuples particles;
  double centre[3]; /* m */
  double radius;    /* m */
} NAME;

static const hk_param params[] = {
    {"particles", "", "those that are kept", .particles = HK_AT(NAME, particles), .flags = HK_REQUIRED},
    {"centre", "m", "of the sphere", .vector = HK_AT(NAME, centre)},
    {"radius", "m", "of the sphere", .number = HK_AT(NAME, radius), .initial = {1}, .limits = HK_ABOVE(0)},
    {0},
};

/* The distance of the k-th particle, and the direction from the centre to it. */
static double distance(const NAME *p, const double *x, size_t k, double n[3]) {
  const double *at = x + 3 * (size_t)p->particles.index[k];
  double r = 0;
  for (int c = 0; c < 3; c++) {
    n[c] = at[c] - p->centre[c];
    r += n[c] * n[c];
  }
  r = sqrt(r);
  for (int c = 0; c < 3; c++) n[c] = r > 0 ? n[c] / r : 0;
  return r;
}

static size_t count(void *self) { return ((const NAME *)self)->particles.count; }

/* Names the blocks (equation, particle) of J = dg/dx; `jacobian` gives them in this order. */
static void pattern(void *self, hk_pattern *into) {
  const NAME *p = self;
  for (size_t k = 0; k < p->particles.count; k++) into->block(into, (uint32_t)k, p->particles.index[k]);
}

static hk_status value(void *self, const hk_view *view, double *g) {
  const NAME *p = self;
  double n[3];
  for (size_t k = 0; k < p->particles.count; k++) g[k] = distance(p, view->x, k, n) - p->radius;
  return HK_OK;
}

static hk_status jacobian(void *self, const hk_view *view, double (*J)[3]) {
  for (size_t k = 0; k < count(self); k++) distance(self, view->x, k, J[k]);
  return HK_OK;
}

/* d^2 g/dt^2 without the acceleration: (v.v - (n.v)^2) / |x - centre|. */
static hk_status curvature(void *self, const hk_view *view, double *c) {
  const NAME *p = self;
  for (size_t k = 0; k < p->particles.count; k++) {
    const double *v = view->v + 3 * (size_t)p->particles.index[k];
    double n[3], r = distance(p, view->x, k, n), along = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
    c[k] = r > 0 ? (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] - along * along) / r : 0;
  }
  return HK_OK;
}

static const hk_constraint constraint = {.size = sizeof(hk_constraint),
                                         .count = count,
                                         .pattern = pattern,
                                         .value = value,
                                         .jacobian = jacobian,
                                         .curvature = curvature};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CONSTRAINT,
    .name = "NAME",
    .summary = "keeps particles on a sphere, |x - centre| = radius",
    .reference = "",
    .instance_size = sizeof(NAME),
    .params = params,
    .constraint = &constraint,
};
