/* Options that have no effect on a run, which is said before its first step. */
#include "core/run/run/run.h"

#include <math.h>

static bool is_adaptive(const hk_plugin *plugin, const void *context) {
  (void)context;
  return plugin->integrator->flags & HK_ADAPTIVE;
}

static void warn_of_tolerance(hk_run *run) {
  const hk_plugin *adaptive = NULL;
  hk_error why = {0};
  if (isnan(run->options.tol) || run->loop.method->flags & HK_ADAPTIVE) return;
  hk_registry_prefer(run->scene->registry, HK_INTEGRATOR, is_adaptive, NULL, &adaptive, &why);
  hk_warn(&run->warnings,
          "--tol %g has no effect: %s takes steps of a given length; give --dt, or choose a method that chooses its "
          "steps%s%s",
          run->options.tol, run->loop.integrator->plugin->name, adaptive ? ", such as --integrator " : "",
          adaptive ? adaptive->name : "");
}

/* Files come from outputs and, unless they are turned off, from measures. */
static void warn_of_folder(hk_run *run) {
  const hk_run_options *o = &run->options;
  if (!o->out || run->plugins.kind[HK_OUTPUT].count || (run->scene->measures && !o->no_output)) return;
  if (o->no_output)
    hk_warn(&run->warnings, "--out %s has no effect: --no-output turns outputs and measures.csv off", o->out);
  else
    hk_warn(&run->warnings,
            "--out %s: nothing will be written there, since the scene has no output and no measure; scene:output or "
            "--with adds one, such as --with output:trajectory",
            o->out);
}

void hk_warn_of_unused_options(hk_run *run) {
  warn_of_tolerance(run);
  warn_of_folder(run);
}
