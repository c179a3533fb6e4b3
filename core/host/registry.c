/* Plugins are found by folder and file name: KIND/NAME.so below the root and below each folder of the search path; a
 * name with a slash is a file. The exported constant is read before any code of the plugin runs (except constructors,
 * which the project's style forbids). Invariant: an item's plugin is NULL exactly when its reason is set. */
#include "core/host/host.h"
#include "core/base/base.h"

#include <dirent.h>
#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *const kind_name[HK_KINDS] = {"force",      "constraint", "corrector", "source",
                                                "integrator", "solver",     "output",    "service"};
static const char *const kind_folder[HK_KINDS] = {"forces",      "constraints", "correctors", "sources",
                                                  "integrators", "solvers",     "outputs",    "services"};

const char *hk_kind_name(hk_kind kind) { return kind_name[kind]; }
const char *hk_kind_folder(hk_kind kind) { return kind_folder[kind]; }

hk_status hk_registry_open(hk_registry *registry, const char *root, const char *search, hk_error *error) {
  *registry = (hk_registry){.root = hk_string_copy(root), .search = hk_string_copy(search)};
  if (!registry->root || (search && !registry->search)) {
    hk_registry_close(registry);
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the list of plugins");
  }
  return HK_OK;
}

void hk_registry_close(hk_registry *registry) {
  for (size_t k = 0; k < registry->count; k++) {
    if (registry->item[k].handle) dlclose(registry->item[k].handle);
    free((void *)(uintptr_t)registry->item[k].plugin);
    free(registry->item[k].path);
    free(registry->item[k].reason);
  }
  free(registry->item);
  free(registry->root);
  free(registry->search);
  *registry = (hk_registry){0};
}

/* Writes the reason why a plugin's constant cannot be used, or an empty text. */
static void check_constant(const hk_plugin *p, char *reason, size_t size) {
  unsigned major = p->abi >> 16, minor = p->abi & 0xffff;
  *reason = 0;
  if (major != HK_ABI_MAJOR || minor > HK_ABI_MINOR)
    snprintf(reason, size, "it was built for plugin interface %u.%u and this hooke has %d.%d: build it again", major,
             minor, HK_ABI_MAJOR, HK_ABI_MINOR);
  else if ((unsigned)p->kind >= HK_KINDS)
    snprintf(reason, size, "its kind, %d, is unknown", (int)p->kind);
  else if (!p->name || !p->summary || !p->force)
    snprintf(reason, size, "its name, summary or functions are missing");
}

typedef struct plugin_copy {
  hk_plugin plugin;
  union {
    hk_force force;
    hk_constraint constraint;
    hk_corrector corrector;
    hk_source source;
    hk_integrator integrator;
    hk_solver solver;
    hk_output output;
    hk_service service;
  } table;
} plugin_copy;

/* A copy of the constant with a table of this host's length; members that the plugin's table lacks are zero. */
static const hk_plugin *copy_plugin(const hk_plugin *plugin) {
  static const size_t length[HK_KINDS] = {sizeof(hk_force),  sizeof(hk_constraint), sizeof(hk_corrector),
                                          sizeof(hk_source), sizeof(hk_integrator), sizeof(hk_solver),
                                          sizeof(hk_output), sizeof(hk_service)};
  plugin_copy *c = calloc(1, sizeof *c);
  if (!c) return NULL;
  size_t size = plugin->force->size, known = length[plugin->kind]; /* `size` is the first member of every table */
  c->plugin = *plugin;
  memcpy(&c->table, plugin->force, size < known ? size : known);
  c->plugin.force = &c->table.force;
  return &c->plugin;
}

static void open_file(hk_loaded *item) {
  char reason[1200] = "";
  /* RTLD_NODELETE: some libraries that plugins load (threads of a BLAS, the compiler of a graphics driver) crash when
   * they are unloaded. */
  item->handle = dlopen(item->path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (!item->handle) {
    snprintf(reason, sizeof reason, "%s", dlerror());
  } else {
    const hk_plugin *plugin = dlsym(item->handle, "hk_plugin_main");
    if (!plugin)
      snprintf(reason, sizeof reason, "it exports no hk_plugin_main: it is not a plugin of hooke");
    else
      check_constant(plugin, reason, sizeof reason);
    if (!*reason && !(item->plugin = copy_plugin(plugin))) snprintf(reason, sizeof reason, "there is no memory for it");
  }
  if (!item->plugin) item->reason = hk_string_copy(reason);
}

static hk_loaded *load(hk_registry *registry, const char *path, hk_error *error) {
  for (size_t k = 0; k < registry->count; k++)
    if (strcmp(registry->item[k].path, path) == 0) return &registry->item[k];
  hk_loaded *grown = realloc(registry->item, (registry->count + 1) * sizeof *grown);
  char *copy = hk_string_copy(path);
  if (grown) registry->item = grown;
  if (!grown || !copy) {
    free(copy);
    hk_error_set(error, HK_NO_MEMORY, "%s: no memory to load the plugin", path);
    return NULL;
  }
  hk_loaded *item = &registry->item[registry->count++];
  *item = (hk_loaded){.path = copy};
  open_file(item);
  return item;
}

/* The k-th folder of root and search path; false: no such folder. */
static bool folder_at(const hk_registry *registry, size_t k, char *folder, size_t size) {
  const char *part = registry->root;
  size_t length = strlen(part);
  if (k > 0) {
    part = registry->search;
    while (part && *part && --k > 0) {
      part = strchr(part, ':');
      if (part) part++;
    }
    if (!part || !*part) return false;
    length = strcspn(part, ":");
  }
  return snprintf(folder, size, "%.*s", (int)length, part) < (int)size;
}

typedef struct name_list {
  size_t count;
  char **name;
} name_list;

static void collect_folder(name_list *list, const char *folder) {
  DIR *directory = opendir(folder);
  if (!directory) return;
  for (struct dirent *entry; (entry = readdir(directory));) {
    size_t length = strlen(entry->d_name);
    if (length < 4 || strcmp(entry->d_name + length - 3, ".so") != 0) continue;
    char **grown = realloc(list->name, (list->count + 1) * sizeof *grown);
    if (!grown) break;
    list->name = grown;
    char *copy = hk_string_copy(entry->d_name);
    if (!copy) break;
    copy[length - 3] = 0;
    list->name[list->count++] = copy;
  }
  closedir(directory);
}

static int by_name(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

static name_list collect(const hk_registry *registry, hk_kind kind) {
  name_list list = {0};
  char folder[PATH_MAX - 64], path[PATH_MAX];
  for (size_t k = 0; folder_at(registry, k, folder, sizeof folder); k++) {
    snprintf(path, sizeof path, "%s/%s", folder, kind_folder[kind]);
    collect_folder(&list, path);
  }
  if (list.count) qsort(list.name, list.count, sizeof *list.name, by_name);
  return list;
}

static void free_names(name_list *list) {
  for (size_t k = 0; k < list->count; k++) free(list->name[k]);
  free(list->name);
}

static const char *name_at(const void *context, size_t k) {
  const name_list *list = context;
  return k < list->count ? list->name[k] : NULL;
}

static bool find_file(const hk_registry *registry, hk_kind kind, const char *name, char *path, size_t size) {
  char folder[PATH_MAX - 64];
  for (size_t k = 0; folder_at(registry, k, folder, sizeof folder); k++)
    if (snprintf(path, size, "%s/%s/%s.so", folder, kind_folder[kind], name) < (int)size && access(path, F_OK) == 0)
      return true;
  return false;
}

static hk_status unknown(const hk_registry *registry, hk_kind kind, const char *name, hk_error *error) {
  name_list list = collect(registry, kind);
  const char *near = hk_nearest_name(name, name_at, &list);
  hk_status status =
      near ? hk_error_set(error, HK_BAD_PARAM, "there is no %s '%s'; did you mean '%s'?", kind_name[kind], name, near)
           : hk_error_set(error, HK_BAD_PARAM, "there is no %s '%s'; see: hooke plugins", kind_name[kind], name);
  free_names(&list);
  return status;
}

/* A file named by its path: only below the installation's or the search path's folders, unless trusted. */
static hk_status find_path(const hk_registry *registry, const char *name, bool trusted, char *path, hk_error *error) {
  char folder[PATH_MAX - 64], real[PATH_MAX];
  if (!realpath(name, path)) return hk_error_set(error, HK_FAILED, "the plugin %s does not exist", name);
  if (trusted) return HK_OK;
  for (size_t k = 0; folder_at(registry, k, folder, sizeof folder); k++)
    if (realpath(folder, real) && strncmp(path, real, strlen(real)) == 0 && path[strlen(real)] == '/') return HK_OK;
  return hk_error_set(
      error, HK_FAILED,
      "the plugin %s is native code outside the installation: run with --trust to allow it, or name its "
      "folder in HOOKE_PLUGIN_PATH",
      name);
}

static const hk_loaded *load_usable(hk_registry *registry, const char *path, const char *name, hk_error *error) {
  const hk_loaded *item = load(registry, path, error);
  if (!item || item->plugin) return item;
  hk_error_set(error, HK_FAILED, "the plugin %s cannot be loaded: %s", name, item->reason);
  return NULL;
}

const hk_loaded *hk_registry_load(hk_registry *registry, const char *name, bool trusted, hk_error *error) {
  char path[PATH_MAX];
  return find_path(registry, name, trusted, path, error) == HK_OK ? load_usable(registry, path, name, error) : NULL;
}

hk_status hk_registry_find(hk_registry *registry, hk_kind kind, const char *name, bool trusted,
                           const hk_plugin **plugin, hk_error *error) {
  char path[PATH_MAX];
  const hk_loaded *item;
  if (strchr(name, '/'))
    item = hk_registry_load(registry, name, trusted, error);
  else if (find_file(registry, kind, name, path, sizeof path))
    item = load_usable(registry, path, name, error);
  else
    return unknown(registry, kind, name, error);
  if (!item) return error->status;
  if (item->plugin->kind != kind)
    return hk_error_set(error, HK_BAD_PARAM, "the plugin %s is of the kind '%s', not '%s'", name,
                        kind_name[item->plugin->kind], kind_name[kind]);
  *plugin = item->plugin;
  return HK_OK;
}

hk_status hk_registry_load_all(hk_registry *registry, hk_error *error) {
  char path[PATH_MAX];
  for (int kind = 0; kind < HK_KINDS; kind++) {
    name_list list = collect(registry, (hk_kind)kind);
    bool loaded = true;
    for (size_t k = 0; loaded && k < list.count; k++)
      if (find_file(registry, (hk_kind)kind, list.name[k], path, sizeof path))
        loaded = load(registry, path, error) != NULL;
    free_names(&list);
    if (!loaded) return HK_NO_MEMORY;
  }
  return HK_OK;
}

static hk_status try_name(hk_registry *registry, hk_kind kind, const char *name,
                          bool (*suits)(const hk_plugin *, const void *), const void *context, const hk_plugin **plugin,
                          hk_error *error) {
  char path[PATH_MAX];
  if (!find_file(registry, kind, name, path, sizeof path)) return HK_OK;
  const hk_loaded *item = load(registry, path, error);
  if (!item) return HK_NO_MEMORY;
  if (item->plugin && item->plugin->kind == kind && suits(item->plugin, context)) *plugin = item->plugin;
  return HK_OK;
}

hk_status hk_registry_prefer(hk_registry *registry, hk_kind kind, bool (*suits)(const hk_plugin *, const void *context),
                             const void *context, const hk_plugin **plugin, hk_error *error) {
  char path[PATH_MAX], name[64];
  hk_status status = HK_OK;
  *plugin = NULL;
  snprintf(path, sizeof path, "%s/%s/default", registry->root, kind_folder[kind]);
  FILE *file = fopen(path, "r");
  while (file && !*plugin && status == HK_OK && fscanf(file, "%63s", name) == 1)
    status = try_name(registry, kind, name, suits, context, plugin, error);
  if (file) fclose(file);
  if (status != HK_OK || *plugin) return status;
  name_list list = collect(registry, kind);
  for (size_t k = 0; k < list.count && !*plugin && status == HK_OK; k++)
    status = try_name(registry, kind, list.name[k], suits, context, plugin, error);
  free_names(&list);
  if (status != HK_OK || *plugin) return status;
  return hk_error_set(error, HK_FAILED, "no %s that suits this scene is installed; see: hooke plugins",
                      kind_name[kind]);
}
