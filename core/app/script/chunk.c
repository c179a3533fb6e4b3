/* Reading a script's file and compiling it: text only, no bytecode; a first line for the shell (#!) is skipped. When
 * the file does not exist, the error suggests the nearest name in its folder. */
#include "core/app/script/script.h"
#include "core/run/storage/storage.h"
#include "core/engine/text/text.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct source {
  FILE *file;
  char block[4096];
} source;

static const char *next_block(lua_State *L, void *context, size_t *size) {
  source *from = context;
  (void)L;
  *size = fread(from->block, 1, sizeof from->block, from->file);
  return *size ? from->block : NULL;
}

const char *const *hk_lua_readable(const hk_script *s, const char *folders[3]) {
  folders[0] = s->folder;
  folders[1] = s->options.library;
  folders[2] = NULL;
  return s->options.trust ? NULL : folders;
}

void hk_lua_note_file(lua_State *L, const char *what, const char *path, const char *name) {
  char line[512];
  snprintf(line, sizeof line, "%s %s", what, name);
  if (!hk_origin_add_file(&hk_lua_script(L)->origin, line, path))
    hk_lua_fail(L, HK_NO_MEMORY, "no memory for the list of files");
}

/* What is no text, or is not called .lua, is probably no script at all: says so behind the error on top of the stack.
 */
static void doubt(lua_State *L, const char *name, int first) {
  enum { OBJECT = 0x7f }; /* the first byte of ELF */
  size_t length = strlen(name);
  bool script = length > 4 && strcmp(name + length - 4, ".lua") == 0;
  if (first == OBJECT)
    lua_pushfstring(L,
                    "%s is a shared object and no script: hooke check ./%s tries a plugin, and a scene names it by its "
                    "path",
                    name, name);
  else if (!script)
    lua_pushfstring(L, "%s; a scene is a Lua script, NAME.lua", lua_tostring(L, -1));
  else
    return;
  lua_replace(L, -2);
}

/* Pushes the compiled script and returns Lua's code, or LUA_ERRFILE with nothing pushed and errno. Closes the file. */
static int load(lua_State *L, source *from, const char *name) {
  lua_pushfstring(L, "@%s", name);
  int first = getc(from->file); /* a first line for the shell is skipped, but not its newline */
  for (bool shell = first == '#'; shell && first != EOF && first != '\n';) first = getc(from->file);
  if (first != EOF) ungetc(first, from->file);
  int code = lua_load(L, next_block, from, lua_tostring(L, -1), "t"); /* lua_load catches errors */
  int cause = ferror(from->file) ? errno : 0;
  fclose(from->file);
  lua_remove(L, -2);
  if (code == LUA_ERRSYNTAX) doubt(L, name, first);
  if (!cause) return code;
  lua_pop(L, 1);
  errno = cause;
  return LUA_ERRFILE;
}

int hk_lua_load(lua_State *L, const char *path, const char *name, const char *const *within) {
  source from = {.file = hk_file_read(path, within)};
  int code = from.file ? load(L, &from, name) : LUA_ERRFILE;
  if (code != LUA_ERRFILE) hk_lua_note_file(L, "the script", path, name);
  return code;
}

int hk_lua_load_script(lua_State *L) {
  hk_script *s = hk_lua_script(L);
  const char *text = s->options.text;
  char line[512];
  if (!text) return hk_lua_load(L, s->path, s->name, NULL);
  snprintf(line, sizeof line, "the script %s", s->name);
  if (!hk_origin_add_text(&s->origin, line, text)) hk_lua_fail(L, HK_NO_MEMORY, "no memory for the list of files");
  int code = luaL_loadbufferx(L, text, strlen(text), lua_pushfstring(L, "@%s", s->name), "t");
  lua_remove(L, -2);
  return code;
}

typedef struct folder_names {
  size_t count;
  char name[256][128];
} folder_names;

static const char *folder_name(const void *context, size_t k) {
  const folder_names *names = context;
  return k < names->count ? names->name[k] : NULL;
}

hk_status hk_lua_no_file(const hk_script *s, hk_error *error) {
  int cause = errno;
  if (cause == EISDIR)
    return hk_error_set(error, HK_IO, "cannot read the scene %s: it is a folder, and a scene is a file NAME.lua",
                        s->path);
  folder_names *names = calloc(1, sizeof *names);
  DIR *directory = names ? opendir(s->folder) : NULL;
  for (struct dirent *entry; directory && names->count < 256 && (entry = readdir(directory));) {
    size_t length = strlen(entry->d_name);
    if (length > 4 && length < 128 && strcmp(entry->d_name + length - 4, ".lua") == 0)
      strcpy(names->name[names->count++], entry->d_name);
  }
  if (directory) closedir(directory);
  const char *near = names ? hk_nearest_name(s->name, folder_name, names) : NULL;
  hk_status status =
      hk_error_set(error, cause == ENOMEM ? HK_NO_MEMORY : HK_IO, "cannot read the scene %s: %s%s%s%s", s->path,
                   strerror(cause), near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
  free(names);
  return status;
}
