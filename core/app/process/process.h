/* The process in which scripts and plugins run, and its fences: the standard files, the rights that the process of an
 * untrusted scene gives up (confinement), the name of the plugin that crashed or hangs (faults), the last good state
 * after a crash (keep), and a time limit for calls of Lua's library (watchdog). Options are the command's; it also
 * installs the signal handlers and calls the functions marked "from a signal handler". */
#ifndef HK_PROCESS_H
#define HK_PROCESS_H

#include "core/app/lua/lua.h"

#include <signal.h>
#include <stdbool.h>

/* ---- standard_files.c: standard input, output and error ---- */

/* Opens /dev/null in the place of closed standard files. Call before any file is opened. HK_IO: the limit of open files
 * is too low for hooke. */
hk_status hk_standard_files_open(hk_error *error);
/* Flushes standard output at the end. HK_IO: something printed could not be written. */
hk_status hk_standard_output_end(hk_error *error);

/* ---- confinement.c: landlock and seccomp, before the script of an untrusted scene runs. The process gives up other
 * programs, the network, signals to other processes, and all files but those in hk_confinement: code that escapes from
 * the sandbox of Lua gains no rights ---- */

typedef struct hk_confinement {
  const char *scene;      /* its script, whose folder may be read */
  const char *read[5];    /* further files and folders to read; NULL members are skipped */
  const char *search;     /* folders of plugins, separated by ':', or NULL */
  const char *libraries;  /* LD_LIBRARY_PATH, likewise */
  const char *programs;   /* PATH: where ffmpeg is looked for, which outputs call */
  const char *output;     /* a folder to write in, made here where it is missing; NULL: none */
  bool named;             /* the user has named it */
  const char *cache;      /* the folder of tools/auto.lua, made here; NULL: none */
  const char *written[2]; /* files to write, beside which a part is made and renamed; NULL members are skipped */
} hk_confinement;

/* Confines this thread and all later threads and processes, irrevocably. NULL: all rights are given up; otherwise a
 * sentence with those that this kernel cannot restrict. */
const char *hk_confine(const hk_confinement *);
/* Removes the folders that hk_confine made, where they are empty. */
void hk_confinement_end(void);

/* ---- faults.c: names the plugin in whose call the process ends: by a crash or exit(), exit code 2, or by a call that
 * does not return within 5 s of the user's interruption, exit code 130. The last good state is then written (keep.c)
 * ---- */

/* Installs the handlers; once, before any plugin runs. Runs keep the result up to date: the plugin at work, or NULL
 * (hk_run_options.acting). */
const hk_instance *volatile *hk_faults_watch(const hk_registry *);
/* From a signal handler: the user asks to stop. The process ends if the plugin is in the same call 5 s later, or at a
 * second interruption. */
void hk_faults_interrupt(void);
/* Ends the process where a plugin's file was written over in its place. */
void hk_faults_check_files(void);
void hk_faults_returned(void); /* the steps have ended: no call is waited for any more */
/* Called last, with all files closed: ends the process by force if libraries hang in exit(), waiting for threads of
 * their own, for some seconds. Returns the code. */
int hk_faults_leave(int code);

/* ---- settings.c: what a plugin may not change, since it holds for all of the process ---- */

/* Notes what is set now, after hk_faults_watch: the returned function compares, puts right what differs and says it
 * (hk_run_options.disturbed). Files it leaves to faults.c. */
const char *(*hk_settings_watch(void))(void);
/* hk_run_options.thread_ended: looks at the modes of the thread at hand, for that function to say. */
void hk_settings_thread_ended(void);

/* ---- keep.c: the last good state of a run, in a file without a name, from which a new process writes the state table
 * after a crash ---- */

/* `path`: of the state table (--state), which is written after a crash. */
void hk_keep_begin(const char *path);
/* hk_run_options.kept: stores the state of this frame in place of the last one. */
void hk_keep_frame(void *context, const hk_snapshot *, const hk_state *);
void hk_keep_end(void);
/* From a signal handler: replaces this process by one that writes the state table and exits with `code`. Returns when
 * there is nothing to write. */
void hk_keep_hand_over(int code);
bool hk_keep_asked(int argc, char **argv); /* whether this process was started to write the table */
int hk_keep_write(char **argv);            /* returns the exit code */

/* ---- watchdog.c: a time limit for scripts inside a C function of Lua's library, where no hook runs ---- */

/* Starts the watchdog, also in processes that this one forks later. `interrupted`: set when the user wants the end.
 * Returns the pulse that it watches, NULL where no thread can be started. */
hk_pulse *hk_watchdog_start(const volatile sig_atomic_t *interrupted);

#endif
