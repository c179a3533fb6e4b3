/* A plugin that takes the process along is named: by a crash or by exit(), which end it with code 2, or by a call that
 * does not return although the user has asked to stop, 130. The last good state is then kept as keep.h says. */
#ifndef HK_FAULTS_H
#define HK_FAULTS_H

#include "core/host/host.h"

/* Begins to watch; once, before anything runs. Runs are to keep the result up to date (hk_run_options.acting). */
const hk_instance *volatile *hk_faults_watch(const hk_registry *);
/* From a signal handler: the user asks to stop. A plugin that is still in the same call seconds later is ended, at a
 * second interruption at once. */
void hk_faults_interrupt(void);
void hk_faults_returned(void); /* the steps have come to an end: nothing is to be waited for */
/* The last thing, when all files are closed: libraries that wait at exit() for their threads, and these for memory, are
 * waited for some seconds. Returns the code. */
int hk_faults_leave(int code);

#endif
