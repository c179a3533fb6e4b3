/* What a plugin asks the system for beside its heap: files that it opens are counted, and its clocks can be set. The
 * calls go through the functions below as those of the heap do (imports.h). */
#ifndef HK_TOOLS_OUTSIDE_H
#define HK_TOOLS_OUTSIDE_H

#include <stddef.h>
#include <stdint.h>

typedef struct hk_import {
  const char *name; /* of a function of the C library */
  uintptr_t function;
} hk_import;

/* NULL-ended. */
extern const hk_import hk_outside_calls[];

void hk_outside_shift(double seconds); /* all clocks of the plugin go so much ahead from now on */
size_t hk_outside_files(void);         /* calls that open a file, a folder, a pipe or a socket, so far */

#endif
