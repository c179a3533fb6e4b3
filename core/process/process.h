/* The process in which scripts and plugins run, and what holds when one of them does not behave: standard files, what
 * an untrusted scene's process gives up, who is at work when the process ends, the state that outlives it, and the end
 * of a script that stands still. Nothing here knows of options; signals are caught by the command, which tells of them.
 */
#ifndef HK_PROCESS_H
#define HK_PROCESS_H

#include "core/lua/lua.h"

#include <signal.h>
#include <stdbool.h>

/* ---- standard_files.c: standard input, output and error ---- */

/* Before any file is opened. HK_IO: the process may not open as many as hooke needs. */
hk_status hk_standard_files_open(hk_error *error);
/* At the end: whether all that was printed has been written. */
hk_status hk_standard_output_end(hk_error *error);

/* ---- confinement.c: what the process of an untrusted scene gives up before the scene's script runs: programs, the
 * network, other processes, and the files outside of what it needs. A scene that broke its sandbox would be as far as
 * before ---- */

typedef struct hk_confinement {
  const char *scene;     /* its script: the folder may be read */
  const char *read[5];   /* further files and folders to read; NULL members are skipped */
  const char *search;    /* folders of plugins, separated by ':', or NULL */
  const char *libraries; /* LD_LIBRARY_PATH, likewise */
  const char *programs;  /* PATH: where ffmpeg is looked for, which outputs call */
  const char *output;    /* a folder to write in, made here where it is missing; NULL: none */
  bool named;            /* the user has named it */
  const char *cache;     /* the folder of tools/auto.lua, made here; NULL: none */
  const char *state;     /* a file to write, NULL: none */
} hk_confinement;

/* Closes the doors, for this thread and all later threads and processes. NULL: all are closed; otherwise a sentence
 * that says what this system cannot close. */
const char *hk_confine(const hk_confinement *);
/* Removes the folders that hk_confine made, where they are empty. */
void hk_confinement_end(void);

/* ---- faults.c: a plugin that takes the process along is named: by a crash or by exit(), which end it with code 2, or
 * by a call that does not return although the user has asked to stop, 130. The last good state is then kept as keep.c
 * says ---- */

/* Begins to watch; once, before anything runs. Runs are to keep the result up to date (hk_run_options.acting). */
const hk_instance *volatile *hk_faults_watch(const hk_registry *);
/* From a signal handler: the user asks to stop. A plugin that is still in the same call seconds later is ended, at a
 * second interruption at once. */
void hk_faults_interrupt(void);
void hk_faults_returned(void); /* the steps have come to an end: nothing is to be waited for */
/* The last thing, when all files are closed: libraries that wait at exit() for their threads, and these for memory, are
 * waited for some seconds. Returns the code. */
int hk_faults_leave(int code);

/* ---- keep.c: the last good state of a run outlives its process: a plugin that takes the process along takes no state
 * along ---- */

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

/* ---- watchdog.c: the end of a script that stands still inside a C function of Lua's library ---- */

/* Starts the watchdog, also in processes that this one forks later. `interrupted`: set when the user wants the end.
 * Returns the pulse that it watches, NULL where no thread can be started. */
hk_pulse *hk_watchdog_start(const volatile sig_atomic_t *interrupted);

#endif
