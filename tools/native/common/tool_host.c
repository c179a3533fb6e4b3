/* An instance of no plugin, whose host table is the engine's own. */
#include "tools/native/common/tool_host.h"

#include <unistd.h>

const hk_host *hk_tool_host_open(hk_tool_host *h, const char *label) {
  long processors = sysconf(_SC_NPROCESSORS_ONLN);
  *h = (hk_tool_host){.plugin = {.kind = HK_SERVICE}};
  h->shared = (hk_shared){.error = &h->error, .allocations_left = -1, .lanes = hk_processor_lanes()};
  h->shared.threads = hk_threads_create(processors > 0 ? (int)processors : 1);
  h->instance =
      (hk_instance){.host = hk_host_table, .shared = &h->shared, .plugin = &h->plugin, .label = label, .where = ""};
  h->instance.host.lanes = h->shared.lanes;
  return h->shared.threads ? &h->instance.host : NULL;
}

void hk_tool_host_close(hk_tool_host *h) {
  hk_memory_clear(&h->instance.blocks);
  if (h->shared.threads) hk_threads_destroy(h->shared.threads);
  *h = (hk_tool_host){.plugin = {.kind = HK_SERVICE}};
}
