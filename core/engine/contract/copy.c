/* A constant whose tables are as long as this host knows them, whatever version of the interface the plugin was built
 * for. */
#include "core/engine/contract/contract.h"

#include <stdlib.h>
#include <string.h>

typedef struct plugin_copy {
  hk_plugin plugin;
  union {
    hk_force_tables force;
    hk_constraint constraint;
    hk_corrector corrector;
    hk_source source;
    hk_integrator_tables integrator;
    hk_solver solver;
    hk_output output;
    hk_service service;
  } table;
} plugin_copy;

const hk_plugin *hk_contract_copy(const hk_plugin *plugin) {
  static const size_t length[HK_KINDS] = {sizeof(hk_force),  sizeof(hk_constraint), sizeof(hk_corrector),
                                          sizeof(hk_source), sizeof(hk_integrator), sizeof(hk_solver),
                                          sizeof(hk_output), sizeof(hk_service)};
  plugin_copy *c = calloc(1, sizeof *c);
  if (!c) return NULL;
  size_t size = plugin->force->size, known = length[plugin->kind]; /* `size` is the first member of every table */
  c->plugin = *plugin;
  memcpy(&c->table, plugin->force, size < known ? size : known);
  hk_contract_copy_facets(plugin, &c->table);
  c->plugin.force = &c->table.force.own;
  return &c->plugin;
}
