/* The heat of friction within a liquid: what its viscosity takes from the motion its particles get as enthalpy,
 *     dh/dt = d,   d = (mu/rho) sum of (dv_a/db + dv_b/da)^2/2,
 * with d, W/kg, as another plugin publishes it by the name `dissipation`: the force viscosity, behind which it
 * has to stand in the scene, for what it does now, the corrector liquid (with heats = true) for its last step, so that
 * of its heat one step is behind. For the `account` it comes from outside: it was motion before. It is no force: it
 * adds nothing to F. */
#include "plugins/common/channels/find_published.h"
#include "plugins/common/channels/no_force.h"
#include "plugins/common/heat/heat_channel.h"

typedef struct viscous_heating {
  hk_heat_channel heat;
  const char *label;
  const double *const *dissipation; /* n, W/kg */
} viscous_heating;

static const hk_param params[] = {
    {"of", "", "label of the plugin whose dissipation it is: the force viscosity, or liquid with heats = true",
     .string = HK_AT(viscous_heating, label), .flags = HK_REQUIRED},
    HK_HEAT_CHANNELS(viscous_heating, heat),
    {0},
};

static hk_status rates(void *self, const hk_view *view, double *dy) {
  const viscous_heating *s = self;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = view->active ? view->active[k] : k;
    double heat = (*s->dissipation)[i];
    if (isnan(heat))
      return view->host->fail(view->host, HK_FAILED,
                              "of: '%s' has not found what its viscosity takes: a corrector liquid needs heats = true, "
                              "a force viscosity has to stand in front of this in the scene",
                              s->label);
    hk_heat_give(&s->heat, view, i, heat, dy);
  }
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  viscous_heating *s = self;
  hk_status status = hk_heat_channel_find(&s->heat, host, view->model);
  if (status == HK_OK)
    status = hk_find_published(host, view->model, s->label, "dissipation", "of", false, &s->dissipation);
  return status;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_CHANNELS | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_SYMMETRIC_JACOBIAN |
             HK_PERIODIC,
    .add = hk_no_force,
    .energy = hk_no_energy,
    .rates = rates,
    .facets = HK_FACETS(HK_NO_BLOCKS),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "viscous_heating",
    .summary = "what viscosity takes from a liquid's motion becomes its heat: dh/dt = dissipation",
    .reference = "Bird, Stewart, Lightfoot 2002, Transport phenomena, section 10.4; Gruntfest 1963",
    .instance_size = sizeof(viscous_heating),
    .params = params,
    .create = create,
    .force = &force,
};
