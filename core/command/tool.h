/* `hooke NAME`: runs tools/NAME.lua with full rights. */
#ifndef HK_TOOL_H
#define HK_TOOL_H

#include "core/lua/script.h"

/* The script gets its arguments in `arg` and ends with the number it returns (nothing: 0). Beside what scenes have,
 * `hooke` has catalogue(), load(), nearest() and paths; `require` finds modules beside the tool and in scripts/lib.
 * `choice` gets what the tool said with hooke.chosen(), or an empty name; NULL: nobody asks. */
hk_status hk_tool_run(const char *path, int argc, char **argv, const hk_script_options *options, int *exit_code,
                      hk_choice *choice, hk_error *error);

#endif
