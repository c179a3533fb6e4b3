/* The last good state of a run outlives its process: a plugin that takes the process along takes no state along. */
#ifndef HK_KEEP_H
#define HK_KEEP_H

#include "core/run/run.h"

/* Begins to keep; `path` is where the state table is to be written (--state). */
void hk_keep_begin(const char *path);
/* hk_run_options.kept: keeps the state of this frame. */
void hk_keep_frame(void *context, const hk_snapshot *, const hk_state *);
void hk_keep_end(void);
/* From a signal handler: replaces this process by one that writes the state table and exits with `code`. Returns when
 * there is nothing to write. */
void hk_keep_hand_over(int code);
bool hk_keep_asked(int argc, char **argv); /* whether this process is the one that is to write */
int hk_keep_write(char **argv);            /* returns the exit code */

#endif
