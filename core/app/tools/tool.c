/* Tools: Lua scripts with full rights, the Lua interface of scenes, and functions for tools only. */
#include "core/app/tools/tools.h"
#include "core/run/storage/storage.h"
#include "core/engine/text/text.h"

#include <errno.h>
#include <lauxlib.h>
#include <math.h>
#include <string.h>

/* hooke.nearest(word, list): a synonym in the list, or the closest name */
static const char *item_at(const void *context, size_t k) {
  lua_State *L = *(lua_State *const *)context;
  lua_rawgeti(L, 2, (lua_Integer)k + 1);
  const char *text = lua_tostring(L, -1); /* the list keeps the text alive */
  lua_pop(L, 1);
  return text;
}

static int nearest(lua_State *L) {
  luaL_checktype(L, 2, LUA_TTABLE);
  lua_pushstring(L,
                 hk_registry_meant(hk_script_asked(hk_lua_script(L))->registry, luaL_checkstring(L, 1), item_at, &L));
  return 1;
}

/* hooke.plain(text [, line]): as text.h says, for people, at most 4 kB of it; true: in one line. */
static int plain(lua_State *L) {
  char text[4096];
  bool line = lua_toboolean(L, 2);
  (line ? hk_plain_line : hk_plain_copy)(text, sizeof text, luaL_checkstring(L, 1));
  lua_pushstring(L, text);
  return 1;
}

/* print: as Lua's, but what a tool prints may be names from scenes, files and folders of others. */
static int print(lua_State *L) {
  int count = lua_gettop(L);
  for (int k = 1; k <= count; k++) {
    if (k > 1) fputc('\t', stdout);
    hk_print_plain(stdout, luaL_tolstring(L, k, NULL));
    lua_pop(L, 1);
  }
  fputc('\n', stdout);
  return 0;
}

/* hooke.chosen(integrator, dt, tol): the choice that tools/auto.lua made; dt and tol may be nil. */
static int chosen(lua_State *L) {
  hk_choice *choice = lua_touserdata(L, lua_upvalueindex(1));
  const char *name = luaL_checkstring(L, 1);
  luaL_argcheck(L, strlen(name) < sizeof choice->integrator, 1, "too long");
  strcpy(choice->integrator, name);
  choice->dt = luaL_optnumber(L, 2, NAN);
  choice->tol = luaL_optnumber(L, 3, NAN);
  return 0;
}

/* hooke.confine(path [, other, folder]): the process gives up, for good, the network, programs, and all files but those
 * in the folder of `path` and `other`, to be read, and in `folder`, to be written. Before anything from a stranger is
 * read: a scene's script, a recording. nil, or what this system cannot give up. */
static int confine(lua_State *L) {
  const hk_confiner *c = &hk_script_asked(hk_lua_script(L))->confiner;
  const char *path = luaL_checkstring(L, 1), *other = luaL_optstring(L, 2, NULL), *folder = luaL_optstring(L, 3, NULL);
  lua_pushstring(L, c->confine ? c->confine(c->context, path, other, folder) : NULL);
  return 1;
}

/* hooke.create(path): a new file to write, as io.open gives it; what has the name already, a link perhaps, goes first.
 * nil and the reason where it cannot be made. */
static int close_created(lua_State *L) {
  luaL_Stream *stream = luaL_checkudata(L, 1, LUA_FILEHANDLE);
  return luaL_fileresult(L, fclose(stream->f) == 0, NULL);
}

static int create(lua_State *L) {
  const char *path = luaL_checkstring(L, 1);
  luaL_Stream *stream = lua_newuserdatauv(L, sizeof *stream, 0);
  *stream = (luaL_Stream){0}; /* closed */
  luaL_setmetatable(L, LUA_FILEHANDLE);
  stream->f = hk_file_create(path);
  if (!stream->f) return luaL_fileresult(L, 0, path);
  stream->closef = close_created;
  return 1;
}

/* hooke.read(path, folder, folder): the text of a plain file whose real path is inside one of the folders; or nil and
 * the reason. For names that come from scenes. */
static int read_inside(lua_State *L) {
  const char *within[3] = {luaL_checkstring(L, 2), luaL_optstring(L, 3, NULL), NULL};
  FILE *file = hk_file_read(luaL_checkstring(L, 1), within);
  luaL_Buffer text;
  if (!file) {
    lua_pushnil(L);
    lua_pushstring(L, hk_file_reason(errno));
    return 2;
  }
  luaL_buffinit(L, &text);
  for (size_t got = 1; got > 0; luaL_addsize(&text, got)) got = fread(luaL_prepbuffer(&text), 1, LUAL_BUFFERSIZE, file);
  fclose(file);
  luaL_pushresult(&text);
  return 1;
}

/* hooke.checksum(path): of a file's bytes, 64 bits, as FNV-1a (Fowler, Noll and Vo) on words of eight bytes, the last
 * one filled up with zeros, of which every product's high half is folded onto the low one; nil where it cannot be read.
 */
static int checksum(lua_State *L) {
  uint64_t block[1 << 11], hash = 1469598103934665603u;
  FILE *file = fopen(luaL_checkstring(L, 1), "rb");
  if (!file) return 0;
  for (size_t got; (got = fread(block, 1, sizeof block, file)) > 0;) {
    memset((unsigned char *)block + got, 0, sizeof block - got);
    for (size_t k = 0; k < (got + 7) / 8; k++) {
      hash = (hash ^ block[k]) * 1099511628211u;
      hash ^= hash >> 32;
    }
  }
  fclose(file);
  lua_pushinteger(L, (lua_Integer)hash);
  return 1;
}

typedef struct tool {
  int argc;
  char **argv;
  int exit_code;
  hk_choice choice; /* the arguments of hooke.chosen() */
} tool;

static void open_functions(lua_State *L, tool *t) {
  static const luaL_Reg functions[] = {{"catalogue", hk_tool_catalogue},
                                       {"describe", hk_tool_describe},
                                       {"explain", hk_tool_explain},
                                       {"load", hk_tool_load},
                                       {"definition", hk_tool_definition},
                                       {"ask", hk_tool_ask},
                                       {"nearest", nearest},
                                       {"plain", plain},
                                       {"confine", confine},
                                       {"create", create},
                                       {"read", read_inside},
                                       {"checksum", checksum},
                                       {NULL, NULL}};
  const hk_script *s = hk_lua_script(L);
  lua_getglobal(L, "hooke");
  luaL_setfuncs(L, functions, 0);
  lua_pushlightuserdata(L, &t->choice);
  lua_pushcclosure(L, chosen, 1);
  lua_setfield(L, -2, "chosen");
  hk_tool_set_text(L, "plugins", hk_script_asked(s)->registry->root);
  hk_tool_set_text(L, "library", hk_script_asked(s)->library);
  hk_tool_set_text(L, "folder", hk_script_folder(s));
  lua_pop(L, 1);
  hk_tool_open_verify(L);
  lua_pushcfunction(L, print);
  lua_setglobal(L, "print");
}

static void open_arguments(lua_State *L, const tool *t) {
  lua_createtable(L, t->argc, 0);
  for (int k = 0; k < t->argc; k++) {
    lua_pushstring(L, t->argv[k]);
    lua_rawseti(L, -2, k);
  }
  lua_setglobal(L, "arg");
}

/* Replaces package[field]: these folders, and of Lua's own those that are absolute. Without a folder that depends on
 * where the tool is called, a file there is never a module. */
static void set_search(lua_State *L, const char *field, const char *own) {
  luaL_Buffer list;
  lua_getglobal(L, "package");
  lua_getfield(L, -1, field);
  const char *part = lua_tostring(L, -1);
  luaL_buffinit(L, &list);
  luaL_addstring(&list, own);
  for (size_t length; *part; part += length + (part[length] == ';')) {
    length = strcspn(part, ";");
    if (*part != '/') continue;
    luaL_addchar(&list, ';');
    luaL_addlstring(&list, part, length);
  }
  luaL_pushresult(&list);
  lua_setfield(L, -3, field);
  lua_pop(L, 2);
}

/* Lua modules are in the tool's folder and in scripts/lib, native modules beside the plugins' folder, and both in the
 * system's folders. */
static void open_modules(lua_State *L) {
  const hk_script *s = hk_lua_script(L);
  const hk_script_options *options = hk_script_asked(s);
  set_search(L, "path",
             lua_pushfstring(L, "%s/?.lua;%s/?.lua", hk_script_folder(s),
                             options->library ? options->library : hk_script_folder(s)));
  set_search(L, "cpath", lua_pushfstring(L, "%s/../tools/?.so", options->registry->root));
  lua_pop(L, 2);
}

static int run_tool(lua_State *L) {
  tool *t = lua_touserdata(L, 1);
  lua_settop(L, 0);
  open_functions(L, t);
  open_arguments(L, t);
  open_modules(L);
  if (luaL_loadfilex(L, hk_script_path(hk_lua_script(L)), "t") != LUA_OK) return lua_error(L);
  lua_call(L, 0, 1);
  t->exit_code = (int)luaL_optinteger(L, -1, 0);
  return 0;
}

hk_status hk_tool_run(const char *path, int argc, char **argv, const hk_script_options *options, int *exit_code,
                      hk_choice *choice, hk_error *error) {
  tool t = {.argc = argc, .argv = argv};
  hk_status status = hk_script_host(path, options, run_tool, &t, error);
  *exit_code = t.exit_code;
  if (choice) *choice = t.choice;
  return status;
}
