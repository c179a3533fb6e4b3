/* NAME: the interface "NAME/1": how many particles lie below a height. Describe here what it serves. Plugins that use it
 * include the declaration of NAME_table; its name is its version: change the number when you change the table. */
#include "core/plugin.h"

typedef struct NAME_table {
  void *self;
  size_t (*below)(void *self, const hk_view *view, double height); /* particles with z < height, m */
} NAME_table;

typedef struct NAME {
  NAME_table table;
} NAME;

static size_t below(void *self, const hk_view *view, double height) {
  size_t count = 0;
  (void)self;
  for (size_t i = 0; i < view->n; i++) count += view->x[3 * i + 2] < height;
  return count;
}

/* The answer to host->query("NAME/1"), after `create`; valid as long as the run. */
static const void *table(void *self) {
  NAME *p = self;
  p->table = (NAME_table){p, below};
  return &p->table;
}

static const hk_service service = {.size = sizeof(hk_service), .interface = "NAME/1", .table = table};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "NAME",
    .summary = "counts the particles below a height",
    .reference = "",
    .instance_size = sizeof(NAME),
    .service = &service,
};
