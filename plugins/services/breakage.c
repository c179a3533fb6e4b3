/* Who in a run has elements that may be gone (plugins/common/elements/breakage.h). */
#include "plugins/common/elements/breakage.h"

typedef struct breakage {
  hk_breakage table;
  const hk_host *host;
} breakage;

static hk_status enter(void *self, const hk_breakable *breakable) {
  breakage *s = self;
  if (s->table.count == HK_BREAKAGE)
    return s->host->fail(s->host, HK_BAD_PARAM,
                         "a scene has %d plugins with elements that melt or break at most: join their lists",
                         HK_BREAKAGE);
  s->table.member[s->table.count++] = *breakable;
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  breakage *s = self;
  (void)view;
  s->host = host;
  s->table = (hk_breakage){.self = self, .enter = enter};
  return HK_OK;
}

static const void *table(void *self) { return &((breakage *)self)->table; }

static const hk_service service = {.size = sizeof(hk_service), .interface = HK_BREAKAGE_INTERFACE, .table = table};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "breakage",
    .summary = "the edges and triangles of a run that have molten or broken",
    .reference = "",
    .instance_size = sizeof(breakage),
    .create = create,
    .service = &service,
};
