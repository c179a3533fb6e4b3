/* The end of a process whose untrusted script stands still inside a C function of Lua's library. */
#ifndef HK_WATCHDOG_H
#define HK_WATCHDOG_H

#include "core/lua/lua.h"

#include <signal.h>

/* Starts the watchdog, also in processes that this one forks later. `interrupted`: set when the user wants the end.
 * Returns the pulse that it watches, NULL where no thread can be started. */
hk_pulse *hk_watchdog_start(const volatile sig_atomic_t *interrupted);

#endif
