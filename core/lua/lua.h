/* The Lua face: runs a scene script in its sandbox and yields the scene it returns. The second part is for folders such
 * as core/tools that add functions of their own to it. */
#ifndef HK_LUA_FACE_H
#define HK_LUA_FACE_H

#include "core/run/run.h"

#include <lua.h>
#include <stdatomic.h>

typedef struct hk_param_given {
  const char *name, *value; /* name=value of the command line */
  bool used;
} hk_param_given;

typedef struct hk_param_declared { /* by param() in the script */
  char *name, *help;
  char *initial, *value; /* as text */
} hk_param_declared;

/* What an untrusted script does, for a watchdog in a thread of its own: no hook ends a long call of a function of Lua's
 * library. */
typedef struct hk_pulse {
  atomic_bool inside;         /* in the script's code: not waiting for the engine */
  atomic_uint_fast64_t beats; /* grows while instructions of the script are executed */
} hk_pulse;

/* Confines the process to what the untrusted scene needs, for good. NULL: done; otherwise what cannot be given up. */
typedef struct hk_confiner {
  const char *(*confine)(void *context, const char *scene);
  void *context;
} hk_confiner;

typedef struct hk_script_options {
  hk_registry *registry;
  const char *library;        /* folder of scripts/lib; NULL: none */
  bool trust;                 /* runs the script without the sandbox */
  bool silent;                /* `print` does nothing: the script has run before, for the same run */
  size_t memory_limit;        /* bytes, 0: the default of 512 MiB */
  uint64_t instruction_limit; /* Lua VM instructions in one call into the script, 0: the default of 5e8 */
  const hk_run_options *run;  /* options of scene:run{} for scripts that drive runs */
  hk_pulse *pulse;            /* NULL: nobody watches */
  hk_confiner confiner;       /* for tools; confine NULL: there is none */
  int threads;
  uint64_t seed;
  hk_stand_in stand_in; /* of all scenes of the script */
  size_t given_count;
  hk_param_given *given;
} hk_script_options;

typedef struct hk_script hk_script;

/* Runs the script. hk_script_scene returns the scene that the script returned; a script that drove its own runs returns
 * none, and hk_script_drove is true. A script that returned no scene and drove no run is the error HK_SCRIPT. A
 * name=value that no param() declares is HK_BAD_PARAM with the nearest name. */
hk_status hk_script_open(const char *path, const hk_script_options *, hk_script **script, hk_error *error);
void hk_script_close(hk_script *);               /* destroys its scenes and runs as well */
hk_scene *hk_script_scene(const hk_script *);    /* NULL: the script returned none */
struct hk_lua_slot *hk_script_slot(hk_script *); /* the slot of the script's scene */
bool hk_script_drove(const hk_script *, hk_verdict *worst);
size_t hk_script_params(const hk_script *, const hk_param_declared **params); /* for --help; filled even on errors */

/* hk_verify with the scene of the script at `path`; `options` and `run` are those of the first run. */
hk_status hk_script_verify(const char *path, const hk_script_options *options, const hk_run_options *run, bool half,
                           hk_run *whole, hk_summary *summary, hk_error *error);

/* ---- for folders that extend the Lua interface ---- */

/* A Lua state with every library open and full rights, in which `function` is called with the light userdata `context`
 * under the limits of `options`; closed afterwards. `path` is the script that errors name. */
hk_status hk_script_host(const char *path, const hk_script_options *options, lua_CFunction function, void *context,
                         hk_error *error);

/* Runs the file at the script's path in the sandbox, with the present `hooke`; pushes what it returns. */
void hk_lua_run_file(lua_State *L);

/* What the runs that the script drove cost so far, together. */
typedef struct hk_work {
  size_t runs, steps, evaluations;
  hk_verdict worst;
} hk_work;
hk_work hk_script_work(const hk_script *);

hk_script *hk_lua_script(lua_State *L); /* the script that the Lua state belongs to */
const hk_script_options *hk_script_asked(const hk_script *);
hk_run_options *hk_script_run_options(hk_script *); /* options of the runs that the script drives; may be changed */
const char *hk_script_path(const hk_script *);      /* as given */
const char *hk_script_folder(const hk_script *);

/* Raises an error prefixed by the script's file and line. Does not return. */
int hk_lua_fail(lua_State *L, hk_status status, const char *format, ...) HK_PRINTF(3, 4) __attribute__((noreturn));
int hk_lua_raise(lua_State *L, const hk_error *error) __attribute__((noreturn));

/* Tables of a script are read as they are, past metatables, so that nothing of the script runs while its values are
 * taken. A table that takes fields from a metatable (__index) is refused, since what it seems to hold is not there. */
int hk_lua_field(lua_State *L, int table, const char *key); /* pushes the field; returns its type */
/* Every key of the table at `index` must be in `known` (NULL ends it); otherwise the error suggests the nearest key. */
void hk_lua_check_keys(lua_State *L, int index, const char *what, const char *const *known);
double hk_lua_field_number(lua_State *L, int table, const char *what, const char *key, double otherwise);
uint64_t hk_lua_field_whole(lua_State *L, int table, const char *what, const char *key, uint64_t otherwise,
                            double most); /* 0 to most */

/* A scene of a script, and the run of it that the script drives; NULL: none. */
typedef struct hk_lua_slot {
  hk_scene *scene;
  hk_run *run;
} hk_lua_slot;

/* The userdata of a scene. Its first user value keeps the owner's data alive. */
typedef struct hk_lua_scene_handle {
  hk_lua_slot *slot; /* belongs to the owner */
  hk_script *owner;  /* the script that made the scene */
} hk_lua_scene_handle;

hk_lua_scene_handle *hk_lua_push_scene(lua_State *L); /* without a scene at first; the owner is the state's script */
hk_script *hk_lua_owner(lua_State *L, int index);     /* owner of the scene at `index` */

/* The userdata of a run: the name of its metatable, whose __index has the methods, and the run at argument 1. The first
 * user value of a run is its scene. */
extern const char hk_lua_run_type[];
hk_run *hk_lua_run(lua_State *L);
/* Pushes a name of a scene, or another text of a script, harmless for a terminal. */
void hk_lua_push_plain(lua_State *L, const char *text);
void hk_lua_push_summary(lua_State *L, const hk_summary *);

#endif
