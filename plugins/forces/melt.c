/* What is molten and how it flows, of each particle by its enthalpy: it publishes `temperature`, K, `molten`, 0 to 1,
 * and `local_viscosity`, Pa s (plugins/common/heat/melt_viscosity.h), which the corrector liquid takes by its parameter
 * `viscosity_of`. Melting and freezing are the same law in both directions, and a solid is what is so viscous that it
 * does not flow (Carlson, Mucha, Van Horn, Turk 2002, Melting and flowing). It is no force: it adds nothing to F. */
#include "plugins/common/channels/no_force.h"
#include "plugins/common/heat/heat_channel.h"
#include "plugins/common/heat/melt_viscosity.h"

typedef struct melt {
  const char *name;
  const hk_channel *enthalpy;
  hk_heat_law law;
  hk_melt_viscosity flow;
  double *temperature, *molten, *viscosity; /* n */
} melt;

static const hk_param params[] = {
    {"channel", "", "with the enthalpy, J/kg; 0 is the solid at the solidus", .string = HK_AT(melt, name),
     .flags = HK_REQUIRED},
    {"viscosity", "Pa s", "of the melt, which the table and the slope multiply; water 0.0018 at its melting point",
     .number = HK_AT(melt, flow.viscosity), .limits = HK_ABOVE(0), .flags = HK_REQUIRED},
    {"slope", "K", "viscosity x exp(slope/(T - pole)): with the pole 0 the energy of activation by 8.314 J/(mol K)",
     .number = HK_AT(melt, flow.slope), .limits = HK_AT_LEAST(0)},
    {"pole", "K", "of the law of Vogel, Fulcher and Tammann", .number = HK_AT(melt, flow.pole),
     .limits = HK_AT_LEAST(0)},
    {"temperatures", "K", "rising, of a table of factors", .numbers = HK_AT(melt, flow.temperatures),
     .flags = HK_OPTIONAL},
    {"factors", "", "of the viscosity at `temperatures`; between them the logarithm is linear",
     .numbers = HK_AT(melt, flow.factors), .flags = HK_OPTIONAL},
    {"outside", "", "of the table: its end holds, or the run ends with a sentence", .choice = HK_AT(melt, flow.outside),
     .choices = "held|refused"},
    {"solid", "Pa s", "of the solid; while it melts the logarithm changes with the molten part; left out: as the melt",
     .number = HK_AT(melt, flow.solid), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"most", "Pa s", "that any viscosity is", .number = HK_AT(melt, flow.most), .initial = {1e8},
     .limits = HK_ABOVE(0)},
    HK_HEAT_CAPACITIES(melt, law),
    {0},
};

static const hk_field fields[] = {
    {"temperature", .per_particle = HK_AT(melt, temperature), .width = 1, .flags = HK_PUBLISHED},
    {"molten", .per_particle = HK_AT(melt, molten), .width = 1, .flags = HK_PUBLISHED},
    {"local_viscosity", .per_particle = HK_AT(melt, viscosity), .width = 1, .flags = HK_PUBLISHED},
    {0},
};

static hk_status find(melt *m, const hk_view *view) {
  const double *h = view->y + m->enthalpy->offset * view->n;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = view->active ? view->active[k] : k;
    m->temperature[i] = hk_heat_temperature(&m->law, h[i]);
    m->molten[i] = hk_heat_molten(&m->law, h[i]);
    m->viscosity[i] = hk_melt_viscosity_at(&m->flow, &m->law, h[i]);
    if (isnan(m->viscosity[i]) && !isnan(h[i]))
      return view->host->fail(
          view->host, HK_FAILED,
          "temperatures: particle %u has %.6g K at t = %g s, outside the table from %g to %g K: give "
          "a longer one, or outside = \"held\"",
          view->model->id[i], m->temperature[i], view->t, m->flow.temperatures.value[0],
          m->flow.temperatures.value[m->flow.temperatures.count - 1]);
  }
  return HK_OK;
}

/* The channels do not change by it; this is called with every evaluation. */
static hk_status rates(void *self, const hk_view *view, double *dy) {
  (void)dy;
  return find(self, view);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  melt *m = self;
  hk_status status = hk_heat_law_check(&m->law, host);
  if (status == HK_OK) status = hk_melt_viscosity_check(&m->flow, host);
  if (status == HK_OK) status = hk_find_channel(host, view->model, m->name, "channel", 1, &m->enthalpy);
  return status == HK_OK ? find(m, view) : status;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_CHANNELS | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_SYMMETRIC_JACOBIAN,
    .add = hk_no_force,
    .energy = hk_no_energy,
    .rates = rates,
    .facets = HK_FACETS(HK_NO_BLOCKS),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "melt",
    .summary = "what is molten and its viscosity by the enthalpy, mu = solid^(1-f) (viscosity exp(slope/(T - pole)))^f",
    .reference =
        "Carlson, Mucha, Van Horn, Turk 2002, Melting and flowing; Vogel 1921; Fulcher 1925; Tammann and Hesse 1926",
    .instance_size = sizeof(melt),
    .params = params,
    .fields = fields,
    .create = create,
    .force = &force,
};
