/* The Lua face: runs a scene script in its sandbox and yields the scene it returns. The second part is for rooms that
 * extend the face with functions of their own, as core/tools does. */
#ifndef HK_LUA_FACE_H
#define HK_LUA_FACE_H

#include "core/run/run.h"

#include <lua.h>

typedef struct hk_param_given {
  const char *name, *value; /* name=value of the command line */
  bool used;
} hk_param_given;

typedef struct hk_param_declared { /* by param() in the script */
  char *name, *help;
  char *initial, *value; /* as text */
} hk_param_declared;

typedef struct hk_script_options {
  hk_registry *registry;
  const char *library;        /* folder of scripts/lib; NULL: none */
  bool trust;                 /* lifts the sandbox */
  size_t memory_limit;        /* bytes, 0: the default of 512 MiB */
  uint64_t instruction_limit; /* Lua VM instructions in one call into the script, 0: the default of 5e8 */
  const hk_run_options *run;  /* for scene:run{} in scripts that drive */
  int threads;
  uint64_t seed;
  size_t given_count;
  hk_param_given *given;
} hk_script_options;

typedef struct hk_script hk_script;

/* Runs the script. When it returns a scene, `hk_script_scene` has it; a script that drove its own runs returns nothing
 * and hk_script_drove says so. A script that returns nothing and drove nothing is HK_SCRIPT with a clear message.
 * A name=value that no param() asked for is HK_BAD_PARAM with the nearest name. */
hk_status hk_script_open(const char *path, const hk_script_options *, hk_script **script, hk_error *error);
void hk_script_close(hk_script *);               /* destroys its scenes and runs as well */
hk_scene *hk_script_scene(const hk_script *);    /* NULL: it returned none */
struct hk_lua_slot *hk_script_slot(hk_script *); /* of that scene */
bool hk_script_drove(const hk_script *, hk_verdict *worst);
size_t hk_script_params(const hk_script *, const hk_param_declared **params); /* for --help; filled even on errors */

/* hk_verify with the scene of the script at `path`; `options` and `run` are those of the first run. */
hk_status hk_script_verify(const char *path, const hk_script_options *options, const hk_run_options *run, hk_run *whole,
                           hk_summary *summary, hk_error *error);

/* ---- for rooms that extend the face ---- */

/* A Lua state with every library open and full rights, in which `function` is called with the light userdata `context`
 * under the limits of `options`; closed afterwards. `path` is the script that errors are put down to. */
hk_status hk_script_host(const char *path, const hk_script_options *options, lua_CFunction function, void *context,
                         hk_error *error);

hk_script *hk_lua_script(lua_State *L); /* that the state belongs to */
const hk_script_options *hk_script_asked(const hk_script *);
hk_run_options *hk_script_run_options(hk_script *); /* of the runs that the script drives; may be changed */
const char *hk_script_path(const hk_script *);      /* as given */
const char *hk_script_folder(const hk_script *);

/* Raise, with the script's file and line in front. Do not return. */
int hk_lua_fail(lua_State *L, hk_status status, const char *format, ...) HK_PRINTF(3, 4) __attribute__((noreturn));
int hk_lua_raise(lua_State *L, const hk_error *error) __attribute__((noreturn));

/* Every key of the table at `index` must be in `known` (NULL ends it); else the error offers the nearest. */
void hk_lua_check_keys(lua_State *L, int index, const char *what, const char *const *known);
double hk_lua_field_number(lua_State *L, int table, const char *what, const char *key, double otherwise);
uint64_t hk_lua_field_whole(lua_State *L, int table, const char *what, const char *key, uint64_t otherwise,
                            double most); /* 0 to most */

/* A scene of a script, with the run that the script itself drives; NULL: it drives none. */
typedef struct hk_lua_slot {
  hk_scene *scene;
  hk_run *run;
} hk_lua_slot;

/* What Lua holds of a scene. Its first user value keeps alive what the owner needs. */
typedef struct hk_lua_scene_handle {
  hk_lua_slot *slot; /* the owner's */
  hk_script *owner;  /* the script that the scene is of */
} hk_lua_scene_handle;

hk_lua_scene_handle *hk_lua_push_scene(lua_State *L); /* of no scene yet; the owner is the state's script */
hk_script *hk_lua_owner(lua_State *L, int index);     /* of the scene at `index` */

/* What Lua holds of a run: the name of its metatable, whose __index has the methods, and the run at argument 1. The
 * first user value of a run is its scene. */
extern const char hk_lua_run_type[];
hk_run *hk_lua_run(lua_State *L);
void hk_lua_push_summary(lua_State *L, const hk_summary *);

#endif
