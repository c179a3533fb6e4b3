/* Declarations shared by the files of core/lua: the script, and the functions of each file that others call. */
#ifndef HK_LUA_INTERNAL_H
#define HK_LUA_INTERNAL_H

#include "core/lua/lua.h"

#include <lauxlib.h>
#include <lualib.h>

struct hk_script {
  lua_State *L;
  lua_State *current; /* L, or the coroutine in which the script drives a run */
  hk_script_options options;
  hk_run_options run_options;
  char *path, *name, *folder;               /* as given; file name; folder, "." at least */
  size_t memory, memory_limit;              /* of Lua */
  size_t engine_memory;                     /* of scenes and runs */
  uint64_t instructions, instruction_limit; /* count and limit of the current call */
  double started, seconds_limit;            /* s, processor time: at the current call's first look at it; of one call */
  const void *refused;                      /* the last request for memory that was refused, see allocate() */
  size_t refused_size;
  bool finished, driving;   /* the script itself has ended; the script is inside scene:run */
  bool spent, memory_spent; /* the script exceeded a limit (that of memory) */
  bool refused_by_system;   /* the last allocation, not by the limit */
  hk_error limit;           /* the error of the limit exceeded; HK_OK: none */
  hk_error raised;          /* the engine's last error raised in the script */
  size_t slots;
  hk_lua_slot **slot;
  hk_lua_slot *returned;
  const hk_run *calling; /* the run that calls a function of the script; NULL: none */
  bool drove;
  hk_verdict worst;
  char *origin; /* the files read so far (scene/origin.c) */
  size_t params, param_capacity;
  hk_param_declared *param;
};

/* limits.c */
bool hk_limits_open(hk_script *); /* creates the Lua state, without libraries; false: no memory */
/* lua_pcall with an instruction budget of its own. After an error, `spent` says whether a limit was exceeded, and
 * `limit` which one. */
int hk_limits_call(lua_State *L, int arguments, int results);

/* Counts work that C code does for the script as instructions, or memory that it takes, as bytes; raises the error of
 * the limit when that is exceeded. */
void hk_limits_count(lua_State *L, size_t instructions);
void hk_limits_take(lua_State *L, size_t bytes);
/* Makes the instructions of a new coroutine count, which has a counter of its own. */
void hk_limits_coroutine(lua_State *L, lua_State *coroutine);
/* The engine works for the script, or no longer; returns what was. While it does the watchdog sees no standstill. */
bool hk_limits_inside(hk_script *, bool inside);
/* The engine's time is not the script's: what the call has used, and its clock set to that. */
double hk_limits_pause(hk_script *);
void hk_limits_resume(hk_script *, double used);

/* errors.c */
/* "file.lua:12", the place of the calling function of the script; also pushed on the stack. */
const char *hk_lua_where(lua_State *L);
/* Calls the function below its arguments under the script's limits; a raised error is stored in `error`. */
hk_status hk_lua_call(lua_State *L, int arguments, int results, hk_error *error);

/* chunk.c */
/* Pushes the compiled script at `path`, or the text of the error. LUA_ERRFILE: the file cannot be read (errno), and
 * nothing is pushed. `within`: as in hk_file_read. */
int hk_lua_load(lua_State *L, const char *path, const char *name, const char *const *within);
/* The folders from which the script may read, for hk_file_read; NULL: all. */
const char *const *hk_lua_readable(const hk_script *, const char *folders[3]);
/* Notes a file that the scene is made from; `what`: "the script". */
void hk_lua_note_file(lua_State *L, const char *what, const char *path, const char *name);
hk_status hk_lua_no_file(const hk_script *, hk_error *error); /* the reason why its file cannot be read, by errno */

/* edges.c: a block of pairs of ids. */
typedef struct hk_lua_edges {
  size_t count;
  uint32_t pair[][2];
} hk_lua_edges;

hk_lua_edges *hk_lua_new_edges(lua_State *L, size_t count);
/* The edges at `index`: a block, or a table of pairs and blocks, copied into a new block on the stack. NULL: the value
 * is neither. */
hk_lua_edges *hk_lua_to_edges(lua_State *L, int index);
void hk_lua_open_edges(lua_State *L);

/* handle.c */
typedef struct hk_lua_handle {
  uint32_t first, count, nx, ny; /* ny is 1 where the handle is no grid */
  bool grid, chain;              /* both false: edges, if any, are kept with the handle */
} hk_lua_handle;

hk_lua_handle *hk_lua_push_handle(lua_State *L, hk_lua_handle shape);
hk_lua_handle *hk_lua_to_handle(lua_State *L, int index); /* NULL: the value is no handle */
/* Converts the ids at `index` (a list, a handle or one number) to a block of numbers on the Lua stack; NULL: none of
 * these. */
double *hk_lua_to_ids(lua_State *L, int index, size_t *count);
int hk_lua_push_structural(lua_State *L, const hk_lua_handle *); /* pushes the edges between neighbours; returns 1 */
void hk_lua_open_handles(lua_State *L);

/* owner.c */
extern const char hk_lua_scene_type[]; /* the name of the metatable */
hk_scene *hk_lua_scene(lua_State *L, int index);
hk_lua_slot *hk_lua_slot_at(lua_State *L, int index);

/* state.c */
void hk_lua_push_state(lua_State *L, int scene); /* state of the scene at index `scene`, which the state keeps alive */
void hk_lua_open_state(lua_State *L);

/* function.c: makes an hk_function of the function at `index`. */
hk_function hk_lua_function(lua_State *L, int index);
hk_function hk_lua_frame_function(lua_State *L, int index); /* it is called with the state of the scene at index 1 */
hk_function hk_lua_rate_function(lua_State *L, int index);  /* it is called with t, id, y... */
hk_gust *hk_lua_push_gust(lua_State *L); /* a function of t that is still to be made; its fastest change is known */

/* values.c */
double hk_lua_number(lua_State *L, int index, const char *what);    /* finite */
double hk_lua_fastest(lua_State *L, const char *what);              /* s, above 0: on top of the stack */
void hk_lua_check_plain(lua_State *L, int index, const char *what); /* no fields from a metatable */
void hk_lua_vector(lua_State *L, int index, const char *what, double into[3]);
bool hk_lua_field_vector(lua_State *L, int table, const char *what, const char *key,
                         double into[3]); /* false: absent */
void hk_lua_set_params(lua_State *L, hk_scene *scene, hk_plugin_spec *spec, int table);

/* param.c: param(), and the check that every name=value was declared. */
int hk_lua_param(lua_State *L);
hk_status hk_lua_check_given(const hk_script *, hk_error *error);

/* builders.c */
uint32_t hk_lua_group(lua_State *L, hk_scene *scene, int table, const char *what); /* value of the key "group" */
/* Adds particles; returns the first id. Errors begin with `what`. */
uint32_t hk_lua_add(lua_State *L, hk_scene *scene, const char *what, size_t count, const double *x, const double *v,
                    const double *mass, double common, uint32_t group);
int hk_lua_gust(lua_State *L);           /* hooke.gust{} */
void hk_lua_open_builders(lua_State *L); /* adds to the method table on top of the stack */
void hk_lua_open_mesh(lua_State *L);     /* mesh.c: likewise */

/* run.c */
int hk_lua_scene_run(lua_State *L); /* scene:run{} */
void hk_lua_note_verdict(hk_script *, hk_run *);
void hk_lua_open_run(lua_State *L);

/* scene.c */
void hk_lua_open_scene(lua_State *L);

/* plain.c */
const char *hk_lua_plain_text(lua_State *L, int index); /* pushes the value as text, without running any function */
/* Replaces functions of the environment on top of the stack that show addresses; `silent`: print does nothing. */
void hk_lua_hide_addresses(lua_State *L, bool silent);

/* sandbox.c: leaves the environment of scenes on the stack. */
void hk_lua_push_sandbox(lua_State *L);
/* guards.c */
/* Replaces a function of the table on top of the stack; its upvalue is the original. */
void hk_lua_replace(lua_State *L, const char *name, lua_CFunction by);
/* Replaces functions that could evade the limits, in the environment on top of the stack. */
void hk_lua_guard(lua_State *L);

#endif
