/* What the service NAME offers. Plugins that use it include this header and ask in their `create`, as NAME_client.c
 * does; the name of the interface is its version: change the number when you change the table. */
#ifndef NAME_H
#define NAME_H

#include "core/plugin.h"

#define NAME_INTERFACE "NAME/1"

/* The answer to host->query(host, NAME_INTERFACE), valid as long as the run. */
typedef struct NAME_table {
  void *self;
  size_t (*below)(void *self, const hk_view *view, double height); /* particles with z < height, m */
} NAME_table;

#endif
