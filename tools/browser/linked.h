/* Plugins that are linked into the program: what `make browser` writes from the folders plugins/KIND. */
#ifndef HK_BROWSER_LINKED_H
#define HK_BROWSER_LINKED_H

#include "core/plugin.h"

typedef struct hk_linked_plugin {
  const char *file; /* "forces/drag": its folder and name below the installation's plugins */
  const hk_plugin *plugin;
} hk_linked_plugin;

extern const hk_linked_plugin hk_linked_plugins[]; /* ends with file NULL */

#endif
