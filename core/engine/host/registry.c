/* Plugins are found by folder and file name: KIND/NAME.so below the root and below each folder of the search path; a
 * name with a slash is a file. The exported constant is read before any code of the plugin runs (except constructors,
 * which the project's style forbids). Invariant: an item's plugin is NULL exactly when its reason is set. */
#include "core/engine/contract/contract.h"
#include "core/engine/host/host.h"
#include "core/engine/text/text.h"

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

/* False: it is not there. */
static bool look_at_file(const char *path, uint64_t file[4]) {
  struct stat now;
  if (stat(path, &now) != 0) return false;
  file[0] = now.st_dev, file[1] = now.st_ino, file[2] = (uint64_t)now.st_size;
  file[3] = (uint64_t)now.st_mtim.tv_sec * 1000000000u + (uint64_t)now.st_mtim.tv_nsec;
  return true;
}

/* A file that was put in its place by renaming has another node, and the old one is still what is loaded. */
const char *hk_registry_overwritten(const hk_registry *registry) {
  uint64_t now[4];
  for (size_t k = 0; k < registry->count; k++) {
    const hk_loaded *item = &registry->item[k];
    if (!item->handle || !look_at_file(item->path, now)) continue;
    bool same_node = now[0] == item->file[0] && now[1] == item->file[1];
    if (same_node && (now[2] != item->file[2] || now[3] != item->file[3])) return item->path;
  }
  return NULL;
}

static void open_file(hk_registry *registry, hk_loaded *item) {
  hk_reason_text why = {""};
  const hk_plugin *plugin = NULL;
  look_at_file(item->path, item->file);
  registry->opening = item->path; /* constructors run now */
  /* RTLD_NODELETE: some libraries that plugins load (threads of a BLAS, the compiler of a graphics driver) crash when
   * they are unloaded. */
  if (hk_contract_file(item->path, &why) && !(item->handle = dlopen(item->path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE)))
    hk_wrong(&why, "%s", dlerror());
  if (item->handle && !(plugin = dlsym(item->handle, "hk_plugin_main")))
    hk_wrong(&why, "it exports no hk_plugin_main: it is not a plugin of hooke");
  if (plugin && hk_contract_plugin(plugin, item->path, &why) && !(item->plugin = hk_contract_copy(plugin)))
    hk_wrong(&why, "there is no memory for it");
  if (!item->plugin) item->reason = hk_string_copy(why.text);
  registry->opening = NULL;
}

static hk_loaded *append(hk_registry *registry, const char *path, hk_error *error) {
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
  return item;
}

const hk_plugin *hk_registry_add(hk_registry *registry, const hk_plugin *constant, hk_error *error) {
  hk_loaded *item = append(registry, constant->name, error);
  if (!item) return NULL;
  item->plugin = hk_contract_copy(constant);
  if (item->plugin) return item->plugin;
  item->reason = hk_string_copy("there is no memory for it");
  hk_error_set(error, HK_NO_MEMORY, "%s: no memory for the plugin", constant->name);
  return NULL;
}

static hk_loaded *load(hk_registry *registry, const char *path, hk_error *error) {
  for (size_t k = 0; k < registry->count; k++)
    if (strcmp(registry->item[k].path, path) == 0) return &registry->item[k];
  hk_loaded *item = append(registry, path, error);
  if (item) open_file(registry, item);
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

/* The file of a name; *path is empty when there is none. Two files of one name are an error: which of them is meant is
 * not for the host to guess. */
static hk_status find_file(const hk_registry *registry, hk_kind kind, const char *name, char *path, hk_error *error) {
  char folder[PATH_MAX - 64], next[PATH_MAX], real[2][PATH_MAX];
  *path = 0;
  for (size_t k = 0; folder_at(registry, k, folder, sizeof folder); k++) {
    if (snprintf(next, sizeof next, "%s/%s/%s.so", folder, kind_folder[kind], name) >= (int)sizeof next) continue;
    if (access(next, F_OK) != 0) continue;
    if (*path && realpath(path, real[0]) && realpath(next, real[1]) && strcmp(real[0], real[1]) != 0)
      return hk_error_set(error, HK_FAILED,
                          "there are two plugins of the name '%s', %s and %s: rename yours, or name it by its path in "
                          "the scene",
                          name, path, next);
    if (!*path) strcpy(path, next);
  }
  return HK_OK;
}

const char *hk_registry_meant(const hk_registry *registry, const char *wrong, hk_name_at *name, const void *context) {
  const char *same = hk_synonym(registry->root, wrong, name, context);
  if (!same) same = hk_nearest_name(wrong, name, context);
  return same ? same : hk_near_synonym(registry->root, wrong, name, context);
}

/* A synonym of this kind or of another counts for more than a name that looks alike. */
static hk_status unknown(const hk_registry *registry, hk_kind kind, const char *name, hk_error *error) {
  const char *near = NULL;
  name_list list = {0};
  char note[256];
  hk_kind its = kind;
  hk_synonym_note(registry->root, name, note, sizeof note);
  for (int k = 0; k < HK_KINDS && !near; k++) {
    its = (hk_kind)(((int)kind + k) % HK_KINDS);
    free_names(&list);
    list = collect(registry, its);
    near = hk_synonym(registry->root, name, name_at, &list);
  }
  if (!near) {
    free_names(&list);
    list = collect(registry, its = kind);
    near = hk_nearest_name(name, name_at, &list);
    if (!near) near = hk_near_synonym(registry->root, name, name_at, &list);
  }
  if (near && its != kind)
    hk_error_set(error, HK_BAD_PARAM, "there is no %s '%s'; did you mean the %s '%s'?", kind_name[kind], name,
                 kind_name[its], near);
  else
    hk_error_set(error, HK_BAD_PARAM,
                 near ? "there is no %s '%s'; did you mean '%s'%s?" : "there is no %s '%s'; see: hooke plugins",
                 kind_name[kind], name, near, note);
  free_names(&list);
  return HK_BAD_PARAM;
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
  else if (find_file(registry, kind, name, path, error) != HK_OK)
    item = NULL;
  else
    item = *path ? load_usable(registry, path, name, error) : NULL;
  if (!item && error->status == HK_OK) return unknown(registry, kind, name, error);
  if (!item) return error->status;
  if (item->plugin->kind != kind)
    return hk_error_set(error, HK_BAD_PARAM, "the plugin %s is of the kind '%s', not '%s'", name,
                        kind_name[item->plugin->kind], kind_name[kind]);
  *plugin = item->plugin;
  return HK_OK;
}

static hk_status load_name(hk_registry *registry, hk_kind kind, const char *name, hk_loaded **item, hk_error *error) {
  char path[PATH_MAX];
  hk_status status = find_file(registry, kind, name, path, error);
  *item = NULL;
  if (status == HK_OK && *path && !(*item = load(registry, path, error))) status = HK_NO_MEMORY;
  return status;
}

hk_status hk_registry_load_all(hk_registry *registry, hk_error *error) {
  hk_loaded *item;
  hk_status status = HK_OK;
  for (int kind = 0; kind < HK_KINDS && status == HK_OK; kind++) {
    name_list list = collect(registry, (hk_kind)kind);
    for (size_t k = 0; k < list.count && status == HK_OK; k++) {
      hk_error why = {0};
      if (k > 0 && strcmp(list.name[k], list.name[k - 1]) == 0) continue;
      status = load_name(registry, (hk_kind)kind, list.name[k], &item, &why);
      if (status == HK_FAILED && (item = append(registry, list.name[k], error))) {
        item->reason = hk_string_copy(why.text);
        status = HK_OK;
      }
    }
    free_names(&list);
  }
  return status;
}

static hk_status try_name(hk_registry *registry, hk_kind kind, const char *name,
                          bool (*suits)(const hk_plugin *, const void *), const void *context, const hk_plugin **plugin,
                          hk_error *error) {
  hk_loaded *item;
  hk_status status = load_name(registry, kind, name, &item, error);
  if (item && item->plugin && item->plugin->kind == kind && suits(item->plugin, context)) *plugin = item->plugin;
  return status;
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
