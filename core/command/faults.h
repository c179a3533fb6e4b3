/* A plugin that takes the process along, by a crash or by exit(), is named, and the process ends with code 2. */
#ifndef HK_FAULTS_H
#define HK_FAULTS_H

#include "core/host/host.h"

/* Begins to watch; once, before anything runs. Runs are to keep the result up to date (hk_run_options.acting). */
const hk_instance *volatile *hk_faults_watch(void);

#endif
