/* The gases of a run, of which outputs draw the smoke and the flames (plugins/common/volume/volume.h). */
#include "plugins/common/volume/volume.h"

typedef struct volumes {
  hk_volumes table;
  const hk_host *host;
} volumes;

static hk_status show(void *self, const hk_volume *volume) {
  volumes *s = self;
  if (s->table.count == HK_VOLUMES)
    return s->host->fail(s->host, HK_BAD_PARAM, "a scene has %d gases at most: put them into one box", HK_VOLUMES);
  s->table.member[s->table.count++] = volume;
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  volumes *s = self;
  (void)view;
  s->host = host;
  s->table = (hk_volumes){.self = self, .show = show};
  return HK_OK;
}

static const void *table(void *self) { return &((volumes *)self)->table; }

static const hk_service service = {.size = sizeof(hk_service), .interface = HK_VOLUMES_INTERFACE, .table = table};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "volumes",
    .summary = "the gases of a run, for pictures of their smoke and flames",
    .reference = "",
    .instance_size = sizeof(volumes),
    .create = create,
    .service = &service,
};
