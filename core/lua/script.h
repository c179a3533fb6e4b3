/* The Lua face: runs a scene script in its sandbox and yields the scene it returns. */
#ifndef HK_SCRIPT_H
#define HK_SCRIPT_H

#include "core/base/error.h"
#include "core/host/registry.h"
#include "core/run/run.h"
#include "core/scene/scene.h"

typedef struct hk_param_given {
  const char *name, *value; /* name=value of the command line */
  bool used;
} hk_param_given;

typedef struct hk_param_declared { /* by param() in the script */
  char *name, *help;
  char *initial, *value; /* as text */
} hk_param_declared;

typedef struct hk_choice { /* of an integrator and its step */
  char integrator[256];    /* "name" or "name:parameter=value,..."; "": none */
  double dt, tol;          /* NAN: its own */
} hk_choice;

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
void hk_script_close(hk_script *); /* destroys its scenes and runs as well */
hk_scene *hk_script_scene(hk_script *);
bool hk_script_drove(const hk_script *, hk_verdict *worst);
size_t hk_script_params(const hk_script *, const hk_param_declared **params); /* for --help; filled even on errors */

#endif
