/* `--integrator auto`: the only choice that is made by measuring, by tools/auto.lua, which says so and keeps it. */
#ifndef HK_AUTO_H
#define HK_AUTO_H

#include "core/app/options/options.h"
#include "core/app/tools/tools.h"

/* Whether the command line, or the scene when it says nothing, leaves the integrator to be chosen. */
bool hk_auto_asked(const hk_options *, const hk_scene *);
/* Asks the tool in the folder `tools` and puts its answer into the options, whose texts are then in `choice`; `script`
 * are those of the scene. HK_BAD_PARAM: no accuracy is asked for. */
hk_status hk_auto_choose(hk_options *, const hk_scene *, const char *tools, const hk_script_options *script,
                         hk_choice *choice, hk_error *error);

#endif
