/* Running a scene script: the Lua state, its limits on memory and instructions, param(), and the way errors take.
 *
 * An error raised by the engine carries a status beside its text; a plain Lua error is HK_SCRIPT. Every call into the
 * script, from the first line to a measure in the last frame, goes through hk_lua_call and starts a new budget of
 * instructions. */
#include "core/lua_internal.h"
#include "core/memory.h"

#include <errno.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const size_t default_memory = (size_t)512 << 20; /* bytes */
static const uint64_t default_instructions = 500000000; /* some three seconds */
enum { HOOK_COUNT = 10000 };

hk_script *hk_lua_script(lua_State *L) { return *(hk_script **)lua_getextraspace(L); }

/* ---- limits ---- */

static void *allocate(void *context, void *memory, size_t old, size_t size) {
  hk_script *s = context;
  size_t before = memory ? old : 0;
  if (size == 0) {
    free(memory);
    s->memory -= before;
    return NULL;
  }
  if (size > before && s->memory + (size - before) > s->memory_limit) return NULL;
  void *grown = realloc(memory, size);
  if (grown) s->memory += size - before;
  return grown;
}

static void count_instructions(lua_State *L, lua_Debug *ar) {
  hk_script *s = hk_lua_script(L);
  s->instructions += HOOK_COUNT;
  if (s->instructions > s->instruction_limit) {
    s->raised = HK_OK;
    lua_sethook(L, count_instructions, LUA_MASKCOUNT, 1); /* from now on everywhere, so that no pcall outlives it */
    lua_getinfo(L, "Sl", ar);
    lua_pushfstring(L, "%s:%d: the script ran beyond its limit of %d million instructions: is there an endless loop?",
                    ar->short_src, ar->currentline, (int)(s->instruction_limit / 1000000));
    lua_error(L);
  }
  if (s->run_options.interrupted && *s->run_options.interrupted) {
    s->raised = HK_INTERRUPTED;
    lua_sethook(L, count_instructions, LUA_MASKCOUNT, 1);
    luaL_error(L, "interrupted");
  }
}

/* ---- errors ---- */

const char *hk_lua_where(lua_State *L) {
  lua_Debug ar;
  for (int level = 1; lua_getstack(L, level, &ar); level++) {
    lua_getinfo(L, "Sl", &ar);
    if (ar.currentline > 0) return lua_pushfstring(L, "%s:%d", ar.short_src, ar.currentline);
  }
  return lua_pushfstring(L, "%s", hk_lua_script(L)->name);
}

int hk_lua_raise(lua_State *L, const hk_error *error) {
  hk_lua_script(L)->raised = error->status;
  if (strstr(error->text, ".lua:"))
    lua_pushstring(L, error->text); /* it knows its place already */
  else
    lua_pushfstring(L, "%s: %s", hk_lua_where(L), error->text);
  lua_error(L);
  abort(); /* lua_error does not return */
}

int hk_lua_fail(lua_State *L, hk_status status, const char *format, ...) {
  hk_error error = {0};
  va_list arguments;
  va_start(arguments, format);
  hk_error_setv(&error, status, format, arguments);
  va_end(arguments);
  hk_lua_raise(L, &error);
}

static hk_status take_error(lua_State *L, int code, hk_error *error) {
  hk_script *s = hk_lua_script(L);
  const char *text = lua_tostring(L, -1);
  hk_status status = s->raised != HK_OK ? s->raised : HK_SCRIPT;
  if (code == LUA_ERRMEM)
    hk_error_set(error, status = HK_SCRIPT, "%s: not enough memory: the script went beyond its limit of %zu MiB",
                 s->name, s->memory_limit >> 20);
  else
    hk_error_set(error, status, "%s", text ? text : "the script raised an error that is not a text");
  lua_pop(L, 1);
  s->raised = HK_OK;
  return status;
}

hk_status hk_lua_call(lua_State *L, int arguments, int results, hk_error *error) {
  hk_script *s = hk_lua_script(L);
  s->instructions = 0;
  s->raised = HK_OK;
  lua_sethook(L, count_instructions, LUA_MASKCOUNT, HOOK_COUNT);
  int code = lua_pcall(L, arguments, results, 0);
  return code == LUA_OK ? HK_OK : take_error(L, code, error);
}

/* ---- functions of the script that the engine calls ---- */

/* Pushes the result of a function: numbers, or one table of numbers and tables, flattened. */
static hk_status flatten(lua_State *L, int index, double *out, size_t max, size_t *count, hk_error *error) {
  if (lua_type(L, index) == LUA_TNUMBER) {
    if (*count < max) out[*count] = lua_tonumber(L, index);
    ++*count;
    return HK_OK;
  }
  if (!lua_istable(L, index) || !lua_checkstack(L, 4))
    return hk_error_set(error, HK_SCRIPT, "%s: a function of the script returned a %s where a number is needed",
                        hk_lua_script(L)->name, luaL_typename(L, index));
  hk_status status = HK_OK;
  for (lua_Integer k = 1; status == HK_OK && lua_rawgeti(L, index, k) != LUA_TNIL; k++, lua_pop(L, 1))
    status = flatten(L, lua_gettop(L), out, max, count, error);
  lua_pop(L, 1);
  return status;
}

static hk_status call_function(const hk_function *f, const double *in, size_t n_in, double *out, size_t max_out,
                               size_t *n_out, hk_error *error) {
  hk_script *s = f->context;
  lua_State *L = s->L;
  int top = lua_gettop(L);
  lua_rawgeti(L, LUA_REGISTRYINDEX, f->reference);
  for (size_t k = 0; k < n_in; k++) {
    if (k == 1)
      lua_pushinteger(L, (lua_Integer)in[k]); /* the id in a channel's rate */
    else
      lua_pushnumber(L, in[k]);
  }
  hk_status status = hk_lua_call(L, (int)n_in, LUA_MULTRET, error);
  *n_out = 0;
  for (int k = top + 1; status == HK_OK && k <= lua_gettop(L); k++) status = flatten(L, k, out, max_out, n_out, error);
  lua_settop(L, top);
  if (*n_out > max_out) *n_out = max_out == 0 ? 0 : *n_out;
  return status;
}

hk_function hk_lua_function(lua_State *L, int index) {
  luaL_checktype(L, index, LUA_TFUNCTION);
  lua_pushvalue(L, index);
  return (hk_function){call_function, hk_lua_script(L), luaL_ref(L, LUA_REGISTRYINDEX)};
}

/* ---- param() ---- */

static const char *text_of(lua_State *L, int index) {
  return lua_isnil(L, index) ? "" : luaL_tolstring(L, index, NULL);
}

static void declare(lua_State *L, const char *name, const char *help, int initial, int value) {
  hk_script *s = hk_lua_script(L);
  void *list = s->param;
  int failed = hk_array_reserve(&list, &s->param_capacity, s->params + 1, sizeof *s->param);
  s->param = list;
  if (failed) hk_lua_fail(L, HK_NO_MEMORY, "no memory for parameter '%s'", name);
  hk_param_declared *p = &s->param[s->params];
  *p = (hk_param_declared){0};
  s->params++;
  p->name = hk_string_copy(name);
  p->help = hk_string_copy(help);
  p->initial = hk_string_copy(text_of(L, initial));
  p->value = hk_string_copy(text_of(L, value));
}

/* Pushes the given text as the default's type. */
static void convert(lua_State *L, const char *name, const char *text) {
  int type = lua_type(L, 2);
  if (type == LUA_TBOOLEAN) {
    bool yes = strcmp(text, "true") == 0;
    if (!yes && strcmp(text, "false") != 0)
      hk_lua_fail(L, HK_BAD_PARAM, "parameter %s: '%s' is not true or false", name, text);
    lua_pushboolean(L, yes);
  } else if (type == LUA_TNUMBER) {
    if (lua_stringtonumber(L, text) == 0)
      hk_lua_fail(L, HK_BAD_PARAM, "parameter %s: '%s' is not a number", name, text);
    double value = lua_tonumber(L, -1);
    if (!isfinite(value)) hk_lua_fail(L, HK_BAD_PARAM, "parameter %s: '%s' is not finite", name, text);
    if (lua_isinteger(L, 2) && !lua_isinteger(L, -1) && floor(value) == value && fabs(value) < 9e15) {
      lua_pop(L, 1);
      lua_pushinteger(L, (lua_Integer)value);
    }
  } else
    lua_pushstring(L, text);
}

static int param(lua_State *L) {
  static const char *const keys[] = {"min", "max", NULL};
  hk_script *s = hk_lua_script(L);
  const char *name = luaL_checkstring(L, 1), *help = luaL_optstring(L, 3, "");
  luaL_checkany(L, 2);
  lua_settop(L, 4);
  lua_pushvalue(L, 2);
  for (size_t k = 0; k < s->options.given_count; k++) {
    if (strcmp(s->options.given[k].name, name) != 0) continue;
    s->options.given[k].used = true;
    convert(L, name, s->options.given[k].value);
  }
  int value = lua_gettop(L);
  declare(L, name, help, 2, value);
  lua_settop(L, value);
  if (lua_istable(L, 4)) {
    hk_lua_check_keys(L, 4, "param", keys);
    double low = hk_lua_field_number(L, 4, "param", "min", -INFINITY),
           high = hk_lua_field_number(L, 4, "param", "max", INFINITY);
    double number = lua_tonumber(L, value);
    if (number < low) hk_lua_fail(L, HK_BAD_PARAM, "parameter %s: %g is below the minimum %g", name, number, low);
    if (number > high) hk_lua_fail(L, HK_BAD_PARAM, "parameter %s: %g is above the maximum %g", name, number, high);
  }
  lua_pushvalue(L, value);
  return 1;
}

static const char *declared_name(const void *context, size_t k) {
  const hk_script *s = context;
  return k < s->params ? s->param[k].name : NULL;
}

static hk_status check_given(const hk_script *s, hk_error *error) {
  for (size_t k = 0; k < s->options.given_count; k++) {
    const hk_param_given *given = &s->options.given[k];
    if (given->used) continue;
    const char *near = hk_nearest_name(given->name, declared_name, s);
    if (near)
      return hk_error_set(error, HK_BAD_PARAM, "%s has no parameter '%s'; did you mean '%s'?", s->name, given->name,
                          near);
    return hk_error_set(error, HK_BAD_PARAM, "%s has no parameter '%s'; see: hooke run %s --help", s->name, given->name,
                        s->path);
  }
  return HK_OK;
}

/* ---- opening ---- */

typedef struct folder_names {
  size_t count;
  char name[256][128];
} folder_names;

static const char *folder_name(const void *context, size_t k) {
  const folder_names *names = context;
  return k < names->count ? names->name[k] : NULL;
}

static hk_status no_file(const hk_script *s, hk_error *error) {
  int cause = errno;
  folder_names *names = calloc(1, sizeof *names);
  DIR *directory = names ? opendir(s->folder) : NULL;
  for (struct dirent *entry; directory && names->count < 256 && (entry = readdir(directory));) {
    size_t length = strlen(entry->d_name);
    if (length > 4 && length < 128 && strcmp(entry->d_name + length - 4, ".lua") == 0)
      strcpy(names->name[names->count++], entry->d_name);
  }
  if (directory) closedir(directory);
  const char *near = names ? hk_nearest_name(s->name, folder_name, names) : NULL;
  hk_status status = hk_error_set(error, HK_IO, "cannot read the scene %s: %s%s%s%s", s->path, strerror(cause),
                                  near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
  free(names);
  return status;
}

static hk_status load_file(hk_script *s, hk_error *error) {
  FILE *file = fopen(s->path, "rb");
  if (!file) return no_file(s, error);
  luaL_Buffer buffer;
  luaL_buffinit(s->L, &buffer);
  size_t got;
  do {
    got = fread(luaL_prepbuffer(&buffer), 1, LUAL_BUFFERSIZE, file);
    luaL_addsize(&buffer, got);
  } while (got == LUAL_BUFFERSIZE);
  bool failed = ferror(file);
  fclose(file);
  luaL_pushresult(&buffer);
  if (failed) return hk_error_set(error, HK_IO, "cannot read the scene %s", s->path);
  size_t length;
  const char *text = lua_tolstring(s->L, -1, &length);
  size_t skip = text[0] == '#' ? strcspn(text, "\n") : 0; /* a first line for the shell */
  char chunk[300];
  snprintf(chunk, sizeof chunk, "@%s", s->name);
  int code = luaL_loadbufferx(s->L, text + skip, length - skip, chunk, "t");
  lua_remove(s->L, -2);
  return code == LUA_OK ? HK_OK : take_error(s->L, code, error);
}

void hk_lua_open_face(lua_State *L) {
  luaL_openlibs(L);
  hk_lua_open_edges(L);
  hk_lua_open_scene(L);
  hk_lua_open_state(L);
  hk_lua_open_run(L);
  lua_pushcfunction(L, param);
  lua_setglobal(L, "param");
}

static int open_libraries(lua_State *L) {
  hk_lua_open_face(L);
  hk_lua_push_sandbox(L);
  return 1;
}

static bool set_names(hk_script *s, const char *path) {
  const char *slash = strrchr(path, '/');
  s->path = hk_string_copy(path);
  s->name = hk_string_copy(slash ? slash + 1 : path);
  s->folder = hk_string_copy(slash ? path : ".");
  if (s->folder && slash) s->folder[slash == path ? 1 : slash - path] = 0;
  return s->path && s->name && s->folder;
}

hk_script *hk_script_new(const char *path, const hk_script_options *options) {
  hk_script *s = calloc(1, sizeof *s);
  if (!s) return NULL;
  s->options = *options;
  if (options->run) s->run_options = *options->run;
  s->memory_limit = options->memory_limit ? options->memory_limit : options->trust ? SIZE_MAX / 2 : default_memory;
  s->instruction_limit = options->instruction_limit ? options->instruction_limit
                         : options->trust           ? UINT64_MAX / 2
                                                    : default_instructions;
  s->worst = HK_VERDICT_OK;
  s->L = set_names(s, path) ? lua_newstate(allocate, s) : NULL;
  if (!s->L) {
    hk_script_close(s);
    return NULL;
  }
  *(hk_script **)lua_getextraspace(s->L) = s;
  lua_sethook(s->L, count_instructions, LUA_MASKCOUNT, HOOK_COUNT);
  lua_gc(s->L, LUA_GCGEN, 0, 0);
  return s;
}

static hk_status run_script(hk_script *s, hk_error *error) {
  lua_State *L = s->L;
  lua_pushcfunction(L, open_libraries);
  hk_status status = hk_lua_call(L, 0, 1, error);
  if (status == HK_OK) status = load_file(s, error);
  if (status != HK_OK) return status;
  lua_insert(L, -2); /* the environment becomes the chunk's _ENV */
  lua_setupvalue(L, -2, 1);
  status = hk_lua_call(L, 0, 1, error);
  if (status == HK_OK) status = check_given(s, error);
  if (status != HK_OK) return status;
  hk_scene **returned = luaL_testudata(L, -1, "hooke.scene");
  if (returned) s->returned = *returned;
  lua_settop(L, 0);
  if (s->returned || s->drove) return HK_OK;
  return hk_error_set(error, HK_SCRIPT, "%s returned no scene: end it with 'return scene'", s->name);
}

hk_status hk_script_open(const char *path, const hk_script_options *options, hk_script **script, hk_error *error) {
  *script = hk_script_new(path, options);
  if (!*script) return hk_error_set(error, HK_NO_MEMORY, "no memory for the script %s", path);
  return run_script(*script, error);
}

void hk_script_close(hk_script *s) {
  if (!s) return;
  for (size_t k = 0; k < s->scenes; k++) {
    hk_run *run = s->scene[k]->run;
    if (run) hk_run_close(run, NULL);
    hk_run_destroy(run);
    hk_scene_destroy(s->scene[k]);
  }
  if (s->L) lua_close(s->L);
  for (size_t k = 0; k < s->params; k++) {
    free(s->param[k].name);
    free(s->param[k].help);
    free(s->param[k].initial);
    free(s->param[k].value);
  }
  free(s->param);
  free(s->scene);
  free(s->path);
  free(s->name);
  free(s->folder);
  free(s);
}

hk_scene *hk_script_scene(hk_script *s) { return s->returned; }

bool hk_script_drove(const hk_script *s, hk_verdict *worst) {
  *worst = s->worst;
  return s->drove && !s->returned;
}

size_t hk_script_params(const hk_script *s, const hk_param_declared **params) {
  *params = s->param;
  return s->params;
}
