/* Values between a script and the engine: the Lua state under its limits, errors with the script's line, and what
 * numbers, vectors, functions, edges and handles of a script mean. It knows neither what a scene's functions are called
 * nor how a script is found and run; builders/ and lua/ do. */
#ifndef HK_SCRIPT_H
#define HK_SCRIPT_H

#include "core/numerics/functions/functions.h"
#include "core/run/run/run.h"

#include <lauxlib.h>
#include <lua.h>
#include <lualib.h>
#include <stdatomic.h>

typedef struct hk_param_given {
  const char *name, *value; /* name=value of the command line */
  bool used;
} hk_param_given;

typedef struct hk_param_declared { /* by param() in the script */
  char *name, *help;
  char *initial, *value; /* as text */
  const char *type;      /* of the default: "integer", "number", "boolean" or "string" */
  double min, max;       /* NAN: no limit is declared */
} hk_param_declared;

/* What an untrusted script does, for a watchdog in a thread of its own: no hook ends a long call of a function of Lua's
 * library. */
typedef struct hk_pulse {
  atomic_bool inside;         /* in the script's code: not waiting for the engine */
  atomic_uint_fast64_t beats; /* grows with instructions of the script and with large blocks of memory that it takes */
} hk_pulse;

/* Confines the process, for good, to reading the folder of `path` (an untrusted scene, a foreign recording) and `other`
 * and to writing in `folder` (both may be NULL). NULL: done; otherwise what cannot be given up. */
typedef struct hk_confiner {
  const char *(*confine)(void *context, const char *path, const char *other, const char *folder);
  void *context;
} hk_confiner;

typedef struct hk_script_options {
  hk_registry *registry;
  const char *library;        /* folder of scripts/lib; NULL: none */
  const char *text;           /* of the script, in the place of its file; it outlives the script. NULL: the file's */
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

/* A scene of a script, and the run of it that the script drives; NULL: none. */
typedef struct hk_lua_slot {
  hk_scene *scene;
  hk_run *run;
} hk_lua_slot;

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
  size_t last_size, doubled_stack[2]; /* bytes: the last request; what a full stack, a coroutine's one, would ask for */
  bool reserving;                     /* the first stack gets its slots */
  bool finished, driving;             /* the script itself has ended; the script is inside scene:run */
  bool spent, memory_spent;           /* the script exceeded a limit (that of memory) */
  bool refused_by_system;             /* the last allocation, not by the limit */
  hk_error limit;                     /* the error of the limit exceeded; HK_OK: none */
  hk_error raised;                    /* the engine's last error raised in the script */
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

hk_script *hk_lua_script(lua_State *L); /* the script that the Lua state belongs to */

/* limits.c */
bool hk_limits_open(hk_script *); /* creates the Lua state, without libraries; false: no memory */
/* lua_pcall with an instruction budget of its own. After an error, `spent` says whether a limit was exceeded, and
 * `limit` which one. */
int hk_limits_call(lua_State *L, int arguments, int results);
/* Inside such a call the next of several of their own budgets begins. */
void hk_limits_renew(lua_State *L);

/* Counts work that C code does for the script as instructions, or memory that it takes, as bytes; raises the error of
 * the limit when that is exceeded. */
void hk_limits_count(lua_State *L, size_t instructions);
void hk_limits_take(lua_State *L, size_t bytes);
size_t hk_limits_left(const hk_script *); /* bytes that hk_limits_take would still allow, 1 at least */
/* Puts a new coroutine under the limits: it has a counter of instructions and a stack of its own. */
void hk_limits_coroutine(lua_State *L, lua_State *coroutine);
/* The engine works for the script, or no longer; returns what was. While it does the watchdog sees no standstill. */
bool hk_limits_inside(hk_script *, bool inside);
/* The engine's time is not the script's: what the call has used, and its clock set to that. */
double hk_limits_pause(hk_script *);
void hk_limits_resume(hk_script *, double used);

/* stack.c: the stack of a script never moves. */
/* Gives a new stack all the slots that it may have; false: no memory. */
bool hk_stack_reserve(hk_script *, lua_State *);
/* The system backs the bytes with memory at once: Lua writes to all of them. */
void hk_stack_back(void *memory, size_t bytes);
bool hk_stack_overflows(const hk_script *, size_t size); /* whether a full stack asks for these bytes */
/* What a C function may put on the stack at once. */
int hk_stack_slots(const hk_script *, const lua_State *);
int hk_stack_coroutine_slots(void);

/* errors.c */
/* Raises an error prefixed by the script's file and line. */
int hk_lua_fail(lua_State *L, hk_status status, const char *format, ...) HK_PRINTF(3, 4) __attribute__((noreturn));
int hk_lua_raise(lua_State *L, const hk_error *error) __attribute__((noreturn));
/* Leaves a warning with the scene, which its runs say, with the script's file and line. */
void hk_lua_warn(lua_State *L, hk_scene *, const char *format, ...) HK_PRINTF(3, 4);
/* "file.lua:12", the place of the calling function of the script; also pushed on the stack. */
const char *hk_lua_where(lua_State *L);
/* Calls the function below its arguments under the script's limits; a raised error is stored in `error`. */
hk_status hk_lua_call(lua_State *L, int arguments, int results, hk_error *error);

/* members.c */
/* The userdata of the type "hooke.WHAT" at 1, or an error that shows the form of the call: "state:position(id)". */
void *hk_lua_self(lua_State *L, const char *type, const char *form);
const char *hk_lua_method_name(const void *methods, size_t k); /* hk_name_at of a list of luaL_Reg */
/* Raises that `what` has no member of the name at 2; it names the one that may be meant, or says what there is. */
int hk_lua_no_member(lua_State *L, const char *what, hk_name_at *, const void *context, const char *otherwise);
void hk_lua_check_table(lua_State *L, int index, const char *what, const char *form);
const char *hk_lua_kind(lua_State *L, int index); /* what an argument is, in words: "a number", "nothing" */
/* Arguments of a function, or an error that shows the form of its call. */
const char *hk_lua_text(lua_State *L, int index, const char *form);
lua_Integer hk_lua_integer(lua_State *L, int index, const char *form); /* 16.0 is one */

/* chunk.c */
/* Pushes the compiled script at `path`, or the text of the error. LUA_ERRFILE: the file cannot be read (errno), and
 * nothing is pushed. `within`: as in hk_file_read. */
int hk_lua_load(lua_State *L, const char *path, const char *name, const char *const *within);
int hk_lua_load_script(lua_State *L); /* the state's own script, from its file or text */
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
  uint32_t first, count, nx, ny; /* ny is 1 where the handle is neither a grid, several chains nor a block */
  uint32_t nz;                   /* of a block; 0: it is none */
  bool grid, chain;              /* chain: ny of them, nx particles each; both false: edges are kept with it, if any */
  bool alternating;              /* the diagonals of a grid's triangles, from cell to cell */
  uint32_t roots;                /* the first particles of each chain that hold it */
} hk_lua_handle;

enum {                       /* user values of a handle beside a mesh's 1 to 3 */
       HK_LUA_NUMBERS = 4,   /* a table of what it answers beside its methods */
       HK_LUA_TETRAHEDRA = 5 /* of a solid */
};

/* The id of the k-th particle that holds a chain, from 0. */
static inline uint32_t hk_lua_root(const hk_lua_handle *h, uint32_t k) {
  return h->first + k / h->roots * h->nx + k % h->roots;
}

/* The ids of triangle k of a grid, two for each cell, rows of cells in order. */
void hk_lua_grid_triangle(const hk_lua_handle *, size_t k, uint32_t corner[3]);

hk_lua_handle *hk_lua_push_handle(lua_State *L, hk_lua_handle shape);
hk_lua_handle *hk_lua_to_handle(lua_State *L, int index); /* NULL: the value is no handle */
/* Converts the ids at `index` (a list, a handle or one number) to a block of numbers on the Lua stack; NULL: none of
 * these. */
double *hk_lua_to_ids(lua_State *L, int index, size_t *count);
int hk_lua_push_structural(lua_State *L, const hk_lua_handle *); /* pushes the edges between neighbours; returns 1 */
void hk_lua_open_handles(lua_State *L);

/* owner.c */
/* The userdata of a scene. Its first user value keeps the owner's data alive. */
typedef struct hk_lua_scene_handle {
  hk_lua_slot *slot; /* belongs to the owner */
  hk_script *owner;  /* the script that made the scene */
} hk_lua_scene_handle;

hk_lua_scene_handle *hk_lua_push_scene(lua_State *L); /* without a scene at first; the owner is the state's script */
hk_script *hk_lua_owner(lua_State *L, int index);     /* owner of the scene at `index` */
extern const char hk_lua_scene_type[];                /* the name of the metatable */
hk_scene *hk_lua_scene(lua_State *L, int index);
/* The run that a state reads; NULL: the value at `index` is no state of a scene that runs. */
hk_run *hk_lua_state_run(lua_State *L, int index);
extern const char hk_lua_state_type[]; /* the name of the metatable of states */
hk_lua_slot *hk_lua_slot_at(lua_State *L, int index);

/* function.c: makes an hk_function of the function at `index`. */
hk_function hk_lua_function(lua_State *L, int index);
hk_function hk_lua_rate_function(lua_State *L, int index); /* it is called with t, id, y... */
hk_gust *hk_lua_push_gust(lua_State *L); /* a function of t that is still to be made; its fastest change is known */

/* values.c */
/* Tables of a script are read as they are, past metatables, so that nothing of the script runs while its values are
 * taken. A table that takes fields from a metatable (__index) is refused, since what it seems to hold is not there. */
int hk_lua_field(lua_State *L, int table, const char *key); /* pushes the field; returns its type */
/* Every key of the table at `index` must be in `known` (NULL ends it); otherwise the error suggests the nearest key. */
void hk_lua_check_keys(lua_State *L, int index, const char *what, const char *const *known);
double hk_lua_field_number(lua_State *L, int table, const char *what, const char *key, double otherwise);
uint64_t hk_lua_field_whole(lua_State *L, int table, const char *what, const char *key, uint64_t otherwise,
                            double most);                           /* 0 to most */
double hk_lua_number(lua_State *L, int index, const char *what);    /* finite */
double hk_lua_fastest(lua_State *L, const char *what);              /* s, above 0: on top of the stack */
void hk_lua_check_plain(lua_State *L, int index, const char *what); /* no fields from a metatable */
void hk_lua_vector(lua_State *L, int index, const char *what, double into[3]);
bool hk_lua_field_vector(lua_State *L, int table, const char *what, const char *key,
                         double into[3]); /* false: absent */
/* Of the function of t at the key; false: absent. */
bool hk_lua_field_function(lua_State *L, int table, const char *what, const char *key, hk_function *function);
void hk_lua_set_params(lua_State *L, hk_scene *scene, hk_plugin_spec *spec, int table);

/* material.c: puts a copy in the place of the table at the positive index `table`, in which the key "material" is
 * replaced by what the module of that name has for `what`, a builder or a plugin. Without the key nothing changes. A
 * material that gives nothing, since all of it stands in the table, leaves a warning with the scene. */
void hk_lua_take_material(lua_State *L, hk_scene *, int table, const char *what);
#define HK_LUA_REQUIRE "hooke.require" /* the script's `require` in the registry */

#endif
