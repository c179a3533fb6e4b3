/* NAME: drag relative to moving air, F = d (wind - v). Describe here the force, its formula and its source. */
#include "core/plugin.h"

typedef struct NAME {
  double wind[3]; /* m/s */
  double d;       /* N s/m */
} NAME;

static const hk_param params[] = {
    {"wind", "m/s", "velocity of the air", .vector = HK_AT(NAME, wind), .initial = {1, 0, 0}, .flags = HK_TIMED},
    {"d", "N s/m", "drag of one particle", .number = HK_AT(NAME, d), .initial = {0.1}, .limits = HK_AT_LEAST(0)},
    {0},
};

/* Adds to F for the particles that the force acts on. Nothing may be allocated or printed here. */
static hk_status add(void *self, const hk_view *view, double *F) {
  const NAME *p = self;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = view->active ? view->active[k] : k;
    for (int c = 0; c < 3; c++) {
      double f = p->d * (p->wind[c] - view->v[3 * i + c]);
      F[3 * i + c] += f;
      /* power of the part of F that is no gradient of an energy */
      if (view->power) *view->power += f * view->v[3 * i + c];
    }
  }
  return HK_OK;
}

/* Jacobian, first phase: names the blocks. Second phase: adds their values, D = -dF/dv. */
static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  (void)self;
  for (size_t k = 0; k < view->acting; k++) {
    uint32_t i = view->active ? view->active[k] : (uint32_t)k;
    p->block(p, i, i);
  }
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const NAME *p = self;
  for (size_t k = 0; k < view->acting; k++)
    for (int c = 0; c < 3; c++) into->D[9 * into->slot[k] + 4 * c] += p->d;
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_V | HK_SYMMETRIC_JACOBIAN | HK_POWER,
    .add = add,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "NAME",
    .summary = "drag against moving air, F = d (wind - v)",
    .reference = "",
    .instance_size = sizeof(NAME),
    .params = params,
    .force = &force,
};
