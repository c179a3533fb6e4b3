/* NAME: how many particles lie below a height, for the plugins that include NAME.h. Describe here what it serves. */
#include "NAME.h"

typedef struct NAME {
  NAME_table table;
} NAME;

static size_t below(void *self, const hk_view *view, double height) {
  size_t count = 0;
  (void)self;
  for (size_t i = 0; i < view->n; i++) count += view->x[3 * i + 2] < height;
  return count;
}

/* Called after `create`. */
static const void *table(void *self) {
  NAME *p = self;
  p->table = (NAME_table){p, below};
  return &p->table;
}

static const hk_service service = {.size = sizeof(hk_service), .interface = NAME_INTERFACE, .table = table};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "NAME",
    .summary = "counts the particles below a height",
    .reference = "",
    .instance_size = sizeof(NAME),
    .service = &service,
};
