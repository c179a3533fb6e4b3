/* Finding and loading plugins: the installation's folders, HOOKE_PLUGIN_PATH's, and files named by path.
 *
 * A plugin is opened when a scene names it, never before; the catalogue opens all. A load that failed is listed with
 * its reason. */
#ifndef HK_REGISTRY_H
#define HK_REGISTRY_H

#include "core/base/error.h"
#include "core/plugin.h"

typedef struct hk_loaded {
  char *path;
  const hk_plugin *plugin; /* NULL: the load failed */
  char *reason;            /* why */
  void *handle;
  size_t own_index;
} hk_loaded;

typedef struct hk_registry {
  char *root;   /* folder with forces/, integrators/ ...: beside the executable or in ../lib/hooke/plugins */
  char *search; /* further folders, separated by ':', or NULL */
  bool allow_script_folder; /* --trust: a path may name a file anywhere; without it only files given below the above */
  size_t count;
  hk_loaded *item;
} hk_registry;

hk_status hk_registry_open(hk_registry *, const char *root, const char *search, hk_error *error);
void hk_registry_close(hk_registry *); /* after every instance is gone */
/* "springs", or a path with a slash; the error of an unknown name offers the nearest and lists failed loads. */
hk_status hk_registry_find(hk_registry *, hk_kind kind, const char *name, const hk_plugin **plugin, hk_error *error);
/* The plugin in a file, whatever its kind; NULL with `error`. */
const hk_loaded *hk_registry_load(hk_registry *, const char *path, hk_error *error);
hk_status hk_registry_load_all(hk_registry *, hk_error *error); /* for the catalogue */
const char *hk_kind_name(hk_kind kind);                         /* "force" */
const char *hk_kind_folder(hk_kind kind);                       /* "forces" */

#endif
