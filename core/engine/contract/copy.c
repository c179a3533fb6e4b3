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
  hk_field field[]; /* as long as this host knows them, too */
} plugin_copy;

/* The rows of the field table with the one that ends it; 0: it has none. */
static size_t rows_of(const hk_plugin *plugin) {
  size_t rows = 0;
  while (plugin->fields && hk_field_row(plugin, rows).name) rows++;
  return plugin->fields ? rows + 1 : 0;
}

const hk_plugin *hk_contract_copy(const hk_plugin *plugin) {
  static const size_t length[HK_KINDS] = {sizeof(hk_force),  sizeof(hk_constraint), sizeof(hk_corrector),
                                          sizeof(hk_source), sizeof(hk_integrator), sizeof(hk_solver),
                                          sizeof(hk_output), sizeof(hk_service)};
  size_t rows = rows_of(plugin);
  plugin_copy *c = calloc(1, sizeof *c + rows * sizeof *c->field);
  if (!c) return NULL;
  size_t size = plugin->force->size, known = length[plugin->kind]; /* `size` is the first member of every table */
  c->plugin = *plugin;
  c->plugin.abi = HK_ABI; /* of the tables as they are here */
  memcpy(&c->table, plugin->force, size < known ? size : known);
  hk_contract_copy_facets(plugin, &c->table);
  c->plugin.force = &c->table.force.own;
  for (size_t k = 0; k < rows; k++) c->field[k] = hk_field_row(plugin, k);
  c->plugin.fields = rows ? c->field : NULL;
  return &c->plugin;
}
