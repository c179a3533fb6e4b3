/* See installation.h. A command is a file tools/NAME.lua, of which the first line says how it is called and what it
 * does: "-- hooke NAME ARGUMENTS: SUMMARY." */
#include "core/app/installation/installation.h"
#include "core/engine/text/text.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- folders ---- */

/* The first of the candidates below the executable's folder that exists: the build tree, its sanitized variant, an
 * installation. */
static bool place(char *into, const char *base, const char *const *candidates) {
  char path[PATH_MAX];
  for (; *candidates; candidates++)
    if (snprintf(path, sizeof path, "%s/%s", base, *candidates) < (int)sizeof path && realpath(path, into)) return true;
  *into = 0;
  return false;
}

hk_status hk_installation_find(hk_installation *p, const char *of, hk_error *error) {
  char base[PATH_MAX];
  if (!realpath(of ? of : "/proc/self/exe", base))
    return hk_error_set(error, HK_IO, "cannot find hooke's own folder: %s", strerror(errno));
  *strrchr(base, '/') = 0;
  static const char *const plugins[] = {"plugins", "../lib/hooke/plugins", NULL};
  static const char *const scripts[] = {"../scripts/scenes/..", "../../scripts/scenes/..", "../share/hooke/scripts",
                                        NULL};
  static const char *const tools[] = {"../tools/templates/..", "../../tools/templates/..",
                                      "../share/hooke/tools/templates/..", NULL};
  static const char *const include[] = {"../core/plugin.h", "../../core/plugin.h", "../include/hooke/core/plugin.h",
                                        NULL};
  if (!place(p->plugins, base, plugins))
    return hk_error_set(error, HK_IO, "no plugins beside %s: build with make, or install with make install", base);
  place(p->scripts, base, scripts);
  place(p->tools, base, tools);
  if (place(p->include, base, include)) *strstr(p->include, "/core/plugin.h") = 0;
  return HK_OK;
}

hk_status hk_installation_programs(hk_error *error) {
  const char *path = getenv("PATH");
  char *kept = path ? calloc(strlen(path) + 1, 1) : NULL, *end = kept;
  if (!path) return HK_OK;
  if (!kept) return hk_error_set(error, HK_NO_MEMORY, "no memory for PATH");
  for (size_t length; *path; path += length + (path[length] == ':')) {
    length = strcspn(path, ":");
    if (*path != '/') continue;
    if (end > kept) *end++ = ':';
    memcpy(end, path, length);
    end += length;
  }
  bool fine = (end > kept ? setenv("PATH", kept, 1) : unsetenv("PATH")) == 0;
  free(kept);
  return fine ? HK_OK : hk_error_set(error, HK_NO_MEMORY, "no memory for PATH");
}

hk_status hk_installation_absolute(const char *variable, const char *list, hk_error *error) {
  for (size_t length; list && *list; list += length + (list[length] == ':')) {
    length = strcspn(list, ":");
    if (length > 0 && *list != '/')
      return hk_error_set(error, HK_BAD_PARAM,
                          "%s: '%.*s' is another folder wherever hooke is called: write it from / on, "
                          "$PWD/%.*s for the one that is here",
                          variable, (int)length, list, (int)length, list);
  }
  return HK_OK;
}

/* ---- commands ---- */

enum { MOST_COMMANDS = 64 };

typedef struct commands {
  size_t count;
  char name[MOST_COMMANDS][64];
} commands;

/* The commands, and what main knows beside them. */
static const char *word_at(const void *context, size_t k) {
  static const char *const others[] = {"--help", "--version", "--cflags", NULL};
  const commands *list = context;
  return k < list->count ? list->name[k] : others[k - list->count];
}

static int by_name(const void *a, const void *b) { return strcmp(a, b); }

/* `run` first, then the tools by name. */
static void list_commands(commands *list, const char *folder) {
  strcpy(list->name[0], "run");
  list->count = 1;
  DIR *directory = *folder ? opendir(folder) : NULL;
  for (struct dirent *entry; directory && list->count < MOST_COMMANDS && (entry = readdir(directory));) {
    size_t length = strlen(entry->d_name);
    if (length < 5 || length > 60 || strcmp(entry->d_name + length - 4, ".lua") != 0) continue;
    memcpy(list->name[list->count], entry->d_name, length - 4);
    list->name[list->count++][length - 4] = 0;
  }
  if (directory) closedir(directory);
  qsort(list->name[1], list->count - 1, sizeof *list->name, by_name);
}

static bool ends_in(const char *word, const char *end) {
  size_t length = strlen(word), tail = strlen(end);
  return length > tail && strcmp(word + length - tail, end) == 0;
}

static hk_status unknown_command(const hk_installation *p, const char *name, hk_error *error) {
  commands list;
  if (ends_in(name, ".lua"))
    return hk_error_set(error, HK_BAD_PARAM, "'%s' is a scene and no command; did you mean: hooke run %s", name, name);
  if (ends_in(name, ".so"))
    return hk_error_set(error, HK_BAD_PARAM, "'%s' is a plugin and no command; did you mean: hooke check %s", name,
                        name);
  list_commands(&list, p->tools);
  const char *near = hk_nearest_name(name, word_at, &list);
  return hk_error_set(error, HK_BAD_PARAM, "unknown command '%s'%s%s%s; see: hooke --help", name,
                      near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

static bool find_tool(const hk_installation *p, const char *name, char *path) {
  snprintf(path, PATH_MAX + 128, "%s/%.100s.lua", p->tools, name);
  return !strchr(name, '/') && access(path, R_OK) == 0;
}

bool hk_installation_command(const hk_installation *p, const char *name) {
  char path[PATH_MAX + 128];
  return strcmp(name, "run") == 0 || find_tool(p, name, path);
}

hk_status hk_installation_tool(const hk_installation *p, const char *name, char *path, hk_error *error) {
  return find_tool(p, name, path) ? HK_OK : unknown_command(p, name, error);
}

/* ---- flags, help ---- */

void hk_installation_flags(const hk_installation *p, const char *numbers) {
  static const char special[] = " \t\n\"'\\$`&|;()<>*?[]{}!#~";
  printf("-I");
  for (const char *c = p->include; *c; c++) printf(strchr(special, *c) ? "\\%c" : "%c", *c);
  printf(" %s\n", numbers);
}

/* The head of a tool, "-- hooke NAME ARGUMENTS: SUMMARY.": how it is called, and what it does. */
static void print_tool(const hk_installation *p, const char *name) {
  char path[PATH_MAX + 128], line[256] = "", *summary = NULL;
  snprintf(path, sizeof path, "%s/%s.lua", p->tools, name);
  FILE *file = fopen(path, "r");
  if (file && fgets(line, sizeof line, file)) summary = strstr(line, ": ");
  if (file) fclose(file);
  for (size_t end = strlen(line); end > 0 && strchr(".\n", line[end - 1]);) line[--end] = 0;
  if (!summary || strncmp(line, "-- ", 3) != 0) {
    printf("  hooke %s\n", name);
    return;
  }
  *summary = 0;
  printf("  %s\n      %s\n", line + 3, summary + 2);
}

void hk_installation_help(const hk_installation *p) {
  commands list;
  list_commands(&list, p->tools);
  printf("  hooke run SCENE.lua [name=value ...]\n      runs a scene: pictures and files, figures, a verdict\n");
  for (size_t k = 1; k < list.count; k++) print_tool(p, list.name[k]);
  printf("\nhooke COMMAND --help says more of each; hooke --version | --cflags\n");
  printf("a first run: hooke run %s/scenes/cloth.lua\n", p->scripts);
}
