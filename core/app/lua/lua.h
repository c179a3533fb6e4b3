/* The Lua face: runs a scene script in its sandbox and yields the scene it returns. The second part is for folders such
 * as core/app/tools that add functions of their own to it. */
#ifndef HK_LUA_FACE_H
#define HK_LUA_FACE_H

#include "core/app/script/script.h"

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
/* hk_runtime_estimate, likewise. */
void hk_script_runtime_estimate(const char *path, const hk_script_options *options, const hk_run_options *run,
                                hk_run *whole);

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

const hk_script_options *hk_script_asked(const hk_script *);
hk_run_options *hk_script_run_options(hk_script *); /* options of the runs that the script drives; may be changed */
const char *hk_script_path(const hk_script *);      /* as given */
const char *hk_script_folder(const hk_script *);

/* The userdata of a run: the name of its metatable, whose __index has the methods, and the run at argument 1. The first
 * user value of a run is its scene. */
extern const char hk_lua_run_type[];
hk_run *hk_lua_run(lua_State *L);
/* Pushes a name of a scene, or another text of a script, harmless for a terminal. */
void hk_lua_push_plain(lua_State *L, const char *text);
void hk_lua_push_summary(lua_State *L, const hk_summary *);

#endif
