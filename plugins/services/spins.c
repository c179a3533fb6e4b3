/* The first force of a scene that turns a particle has the energy of its rotation, for as long as the particle lives
 * (plugins/common/grains/spins.h). */
#include "plugins/common/grains/spins.h"

typedef struct spins {
  hk_spins table;
  double *owner; /* n */
  double forces;
} spins;

static const hk_field fields[] = {
    {"owner", .per_particle = HK_AT(spins, owner), .width = 1},
    {0},
};

static double join(void *self) { return ++((spins *)self)->forces; }

static void claim(void *self, const hk_view *view, double number) {
  spins *s = self;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = view->active ? view->active[k] : k;
    if (s->owner[i] == 0) s->owner[i] = number;
  }
}

static const double *owner(const void *self) { return ((const spins *)self)->owner; }

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  spins *s = self;
  (void)host, (void)view;
  s->table = (hk_spins){self, join, claim, owner};
  return HK_OK;
}

static const void *table(void *self) { return &((spins *)self)->table; }

static const hk_service service = {.size = sizeof(hk_service), .interface = HK_SPINS_INTERFACE, .table = table};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "spins",
    .summary = "which force has the energy of rotation of a grain, so that it is counted once",
    .reference = "",
    .instance_size = sizeof(spins),
    .fields = fields,
    .create = create,
    .service = &service,
};
