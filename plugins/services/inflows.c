/* The openings in walls of a run's liquids (plugins/common/emission/inflows.h). */
#include "plugins/common/emission/inflows.h"

typedef struct inflows {
  hk_inflows table;
  const hk_host *host;
} inflows;

static hk_status enter(void *self, const hk_inflow *inflow) {
  inflows *s = self;
  if (s->table.count == HK_INFLOWS)
    return s->host->fail(s->host, HK_BAD_PARAM, "a scene has %d inflows at most: join those that are side by side",
                         HK_INFLOWS);
  s->table.member[s->table.count++] = inflow;
  return HK_OK;
}

static void take(void *self) { ((inflows *)self)->table.taken = true; }

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  inflows *s = self;
  (void)view;
  s->host = host;
  s->table = (hk_inflows){.self = self, .enter = enter, .take = take};
  return HK_OK;
}

static const void *table(void *self) { return &((inflows *)self)->table; }

static const hk_service service = {.size = sizeof(hk_service), .interface = HK_INFLOWS_INTERFACE, .table = table};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "inflows",
    .summary = "the openings in walls of a run's liquids, through which sources let liquid in",
    .reference = "",
    .instance_size = sizeof(inflows),
    .create = create,
    .service = &service,
};
