/* Running a scene script: the Lua state, its limits on memory and instructions, and the way errors take.
 *
 * An error raised by the engine carries a status beside its text; a plain Lua error is HK_SCRIPT. Every call into the
 * script, from the first line to a measure in the last frame, goes through hk_lua_call and starts a new budget of
 * instructions, to which memory asked for is charged as well. A script that went beyond a limit once is spent: nothing
 * it catches saves it. */
#include "core/lua/internal.h"
#include "core/base/memory.h"

#include <errno.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const size_t default_memory = (size_t)512 << 20; /* bytes */
static const uint64_t default_instructions = 500000000; /* some three seconds */
/* Lua 5.4.4 reads a stale pointer when the stack moves inside a __concat of a chain, a .. b .. c, as scripts write with
 * edges; room reserved at the bottom of the stack is never given back, so it does not move at ordinary depths. */
enum { STACK_SLOTS = 4000 };

enum { HOOK_COUNT = 10000, BYTES_PER_INSTRUCTION = 16, LARGE = 65536 };

hk_script *hk_lua_script(lua_State *L) { return *(hk_script **)lua_getextraspace(L); }

/* ---- limits ---- */

/* Lua asks once more after it collected garbage: the second refusal of the same request, not granted since, is final.
 */
static bool refused(hk_script *s, const void *memory, size_t size, size_t more) {
  bool over = s->instructions > s->instruction_limit && more > LARGE; /* small ones are left for the message */
  bool full = s->memory + more > s->memory_limit;
  bool same = s->refused_size == size && s->refused == memory;
  if (full && same) s->spent = s->memory_spent = true;
  if (full || same) {
    s->refused = full ? memory : NULL;
    s->refused_size = full ? size : 0;
  }
  if (!full) s->instructions += more / BYTES_PER_INSTRUCTION;
  return full || over;
}

static void *allocate(void *context, void *memory, size_t old, size_t size) {
  hk_script *s = context;
  size_t before = memory ? old : 0;
  if (size == 0) {
    free(memory);
    s->memory -= before;
    return NULL;
  }
  if (size > before && refused(s, memory, size, size - before)) return NULL;
  void *grown = realloc(memory, size);
  if (grown) s->memory += size - before;
  return grown;
}

static void say_limit(hk_script *s, const char *place, int line) {
  s->limit = (hk_error){0};
  if (s->memory_spent)
    hk_error_set(&s->limit, HK_SCRIPT, "%s: not enough memory: the script went beyond its limit of %zu MiB", s->name,
                 s->memory_limit >> 20);
  else
    hk_error_set(&s->limit, HK_SCRIPT,
                 "%s:%d: the script ran beyond its limit of %d million instructions: is there an endless loop?", place,
                 line, (int)(s->instruction_limit / 1000000));
}

static void count_instructions(lua_State *L, lua_Debug *ar) {
  hk_script *s = hk_lua_script(L);
  s->instructions += HOOK_COUNT;
  bool interrupted = s->run_options.interrupted && *s->run_options.interrupted;
  if (!s->spent && !interrupted && s->instructions <= s->instruction_limit) return;
  s->spent = true;
  lua_sethook(L, count_instructions, LUA_MASKCOUNT, 1); /* from now on everywhere, so that no pcall outlives it */
  lua_getinfo(L, "Sl", ar);
  if (interrupted)
    s->limit = (hk_error){HK_INTERRUPTED, "interrupted"};
  else if (s->limit.status == HK_OK)
    say_limit(s, ar->short_src, ar->currentline);
  lua_pushstring(L, s->limit.text);
  lua_error(L);
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

/* Is there "file.lua:12:" in it? */
static bool has_place(const hk_script *s, const char *text) {
  size_t length = strlen(s->name);
  if (strncmp(text, s->name, length) == 0 && text[length] == ':') return true;
  for (const char *at = strstr(text, ".lua:"); at; at = strstr(at + 1, ".lua:"))
    if (at[5] >= '0' && at[5] <= '9') return true;
  return false;
}

int hk_lua_raise(lua_State *L, const hk_error *error) {
  hk_script *s = hk_lua_script(L);
  s->raised = *error;
  if (has_place(s, error->text))
    lua_pushstring(L, error->text);
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
  const char *text = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : NULL;
  bool ours = s->raised.status != HK_OK && text && strstr(text, s->raised.text);
  hk_status status = ours ? s->raised.status : HK_SCRIPT;
  if (code == LUA_ERRMEM) s->spent = true;
  if (s->spent) { /* whatever the script made of it on the way */
    if (s->instructions <= s->instruction_limit) s->memory_spent = true;
    if (s->limit.status == HK_OK) say_limit(s, s->name, 1);
    hk_error_set(error, status = s->limit.status, "%s", s->limit.text);
  } else if (text)
    hk_error_set(error, status, "%s", text);
  else
    hk_error_set(error, status, "%s: the script raised an error that is a %s, not a text", s->name,
                 luaL_typename(L, -1));
  lua_pop(L, 1);
  return status;
}

/* Calls nest: a script that drives calls scene:run, which calls its measures. Each has a budget of its own. */
hk_status hk_lua_call(lua_State *L, int arguments, int results, hk_error *error) {
  hk_script *s = hk_lua_script(L);
  uint64_t outer = s->instructions;
  s->instructions = 0;
  s->raised.status = HK_OK;
  lua_sethook(L, count_instructions, LUA_MASKCOUNT, HOOK_COUNT);
  int code = lua_pcall(L, arguments, results, 0);
  hk_status status = code == LUA_OK ? HK_OK : take_error(L, code, error);
  s->instructions = outer;
  return status;
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

int hk_lua_load(lua_State *L, const char *path, const char *name) {
  source from = {.file = fopen(path, "rb")};
  if (!from.file) return LUA_ERRFILE;
  lua_pushfstring(L, "@%s", name);
  int first = getc(from.file); /* a line for the shell is left out, its end is not */
  for (bool shell = first == '#'; shell && first != EOF && first != '\n';) first = getc(from.file);
  if (first != EOF) ungetc(first, from.file);
  int code = lua_load(L, next_block, &from, lua_tostring(L, -1), "t"); /* catches errors itself */
  int cause = ferror(from.file) ? errno : 0;
  fclose(from.file);
  lua_remove(L, -2);
  if (!cause) return code;
  lua_pop(L, 1);
  errno = cause;
  return LUA_ERRFILE;
}

void hk_lua_open_face(lua_State *L) {
  luaL_openlibs(L);
  hk_lua_open_edges(L);
  hk_lua_open_scene(L);
  hk_lua_open_state(L);
  hk_lua_open_run(L);
  lua_pushcfunction(L, hk_lua_param);
  lua_setglobal(L, "param");
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
  s->current = s->L;
  lua_sethook(s->L, count_instructions, LUA_MASKCOUNT, HOOK_COUNT);
  lua_gc(s->L, LUA_GCGEN, 0, 0);
  lua_checkstack(s->L, STACK_SLOTS);
  return s;
}

/* Pushes the script as a function in its environment, or nil when the file cannot be read. */
static int prepare(lua_State *L) {
  const hk_script *s = hk_lua_script(L);
  hk_lua_open_face(L);
  hk_lua_push_sandbox(L);
  int code = hk_lua_load(L, s->path, s->name);
  if (code == LUA_ERRFILE) return 0;
  if (code != LUA_OK) return lua_error(L);
  lua_insert(L, -2);
  lua_setupvalue(L, -2, 1); /* _ENV */
  return 1;
}

/* What a script that drove left open ends with it. */
static hk_status close_runs(hk_script *s, hk_error *error) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < s->scenes; k++) {
    hk_run *run = s->scene[k]->run;
    if (!run) continue;
    hk_status closed = hk_run_close(run, error);
    if (status == HK_OK) status = closed;
    hk_lua_note_verdict(s, run);
  }
  return status;
}

static hk_status run_script(hk_script *s, hk_error *error) {
  lua_State *L = s->L;
  lua_pushcfunction(L, prepare);
  hk_status status = hk_lua_call(L, 0, 1, error);
  if (status == HK_OK && lua_isnil(L, -1)) return no_file(s, error);
  if (status == HK_OK) status = hk_lua_call(L, 0, 1, error);
  s->finished = true;
  if (status == HK_OK) status = hk_lua_check_given(s, error);
  if (status != HK_OK) return status;
  hk_scene **returned = luaL_testudata(L, -1, "hooke.scene");
  if (returned) s->returned = *returned;
  lua_settop(L, 0);
  lua_gc(L, LUA_GCCOLLECT, 0); /* lists of edges, which the plugins have copied, before the run asks for memory */
  if (s->returned) return HK_OK;
  if (s->drove) return close_runs(s, error);
  return hk_error_set(error, HK_SCRIPT, "%s returned no scene: end it with 'return scene'", s->name);
}

hk_status hk_script_open(const char *path, const hk_script_options *options, hk_script **script, hk_error *error) {
  hk_registry *registry = options->registry;
  bool outer = registry->allow_script_folder;
  *script = hk_script_new(path, options);
  if (!*script) return hk_error_set(error, HK_NO_MEMORY, "no memory for the script %s", path);
  registry->allow_script_folder = options->trust;
  hk_status status = run_script(*script, error);
  registry->allow_script_folder = outer;
  return status;
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
