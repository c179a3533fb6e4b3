/* Plugins are native code in this process: what one does wrong may end it, or never end. Handlers for the signals of a
 * crash, for exit() and for an alarm after an interruption say which plugin was at work, from the pointer that the host
 * sets around every call, and end the process. They only write and replace the process (POSIX 2.4.3), since its memory
 * may be damaged; the last good state is in a file (keep.c). Crashes outside of plugins, those of child processes and
 * signals that somebody else handles already (a sanitizer) are left as they are, after a word of what may have been. */
#include "core/app/process/process.h"

#include <lua.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Handlers are given nothing: what they check_overdue at has to be global. */
static const hk_instance *volatile acting;
static const hk_registry *loading;
static volatile pid_t watched;

static const struct fault {
  int number;
  const char *what;
} faults[] = {{SIGSEGV, "SIGSEGV, memory that is not its own"},
              {SIGBUS, "SIGBUS, memory that is not there"},
              {SIGFPE, "SIGFPE, a division of whole numbers by zero"},
              {SIGILL, "SIGILL, an instruction that this processor does not have"},
              {SIGABRT, "SIGABRT, by abort() or a failed assertion"}};

enum { FAULTS = sizeof faults / sizeof *faults };

static void say(const char *text) {
  ssize_t written = write(STDERR_FILENO, text, strlen(text));
  (void)written; /* there is nobody left to tell */
}

/* "hooke: bad.lua:3: the force 'LABEL' of the plugin NAME", or, while it is loaded, "hooke: the plugin FILE" */
static void name(const hk_instance *plugin, const char *file) {
  say("hooke: ");
  if (file) {
    say("the plugin ");
    say(file);
    say(", while it was loaded,");
    return;
  }
  say(plugin->where);
  say(*plugin->where ? ": the " : "the ");
  say(hk_kind_name(plugin->plugin->kind));
  say(" '");
  say(plugin->label);
  say("'");
  if (strcmp(plugin->label, plugin->plugin->name) == 0) return;
  say(" of the plugin ");
  say(plugin->plugin->name);
}

/* The end of the process, where the last good state is written by the one that follows. */
static void end(int code) {
  hk_keep_hand_over(code);
  _exit(code);
}

/* Nothing that a plugin's file holds can be run or read any more, its functions for the end of the process neither. */
static void end_overwritten(void) {
  const char *path = hk_registry_overwritten(loading);
  if (!path) return;
  say("hooke: the plugin ");
  say(path);
  say(" was written over while it was loaded, and its code is gone: start again, and put a new file in place by "
      "renaming it\n");
  end(2);
}

/* What an earlier call of a plugin has left switched on. */
static void end_trapped(int number, int code) {
  if (number != SIGFPE || code < FPE_FLTDIV || code > FPE_FLTSUB) return;
  say("hooke: a plugin has left floating-point traps switched on (feenableexcept), and one has ended hooke: it has to "
      "switch them off before it returns\n");
  end(2);
}

void hk_faults_check_files(void) {
  if (getpid() == watched) end_overwritten();
}

/* The signal ends the process as it would have without us: its action is the default one again. A script may crash Lua
 * 5.4.0 to 5.4.4 where a deep __concat makes the stack move; without --trust it never does (script/stack.c). */
static void end_unknown(int number, const char *what) {
  if (getpid() == watched) {
    say("hooke: it crashed (");
    say(what);
    say(") outside of all plugins: the error is in hooke or in " LUA_RELEASE
        ", which a script with --trust may crash, up to 5.4.4 by deep calls in a __concat; without --trust it "
        "cannot\n");
  }
  raise(number);
}

static void crashed(int number, siginfo_t *info, void *context) {
  const hk_instance *plugin = hk_acting_here ? hk_acting_here : acting;
  const char *file = loading->opening;
  int k = 0;
  (void)context;
  if (getpid() == watched && number != SIGABRT) end_overwritten();
  if (getpid() == watched && !plugin) end_trapped(number, info->si_code);
  while (k < FAULTS - 1 && faults[k].number != number) k++;
  if ((!plugin && !file) || getpid() != watched) {
    end_unknown(number, faults[k].what);
    return;
  }
  name(plugin, file);
  say(" crashed (");
  say(number == SIGFPE && info->si_code != FPE_INTDIV && info->si_code > 0 ? "SIGFPE, a floating-point trap"
                                                                           : faults[k].what);
  say("): the error is in the plugin; mend it or leave it out\n");
  end(2);
}

static void left(void) {
  const hk_instance *plugin = hk_acting_here ? hk_acting_here : acting;
  const char *file = loading->opening;
  if ((!plugin && !file) || getpid() != watched) return;
  name(plugin, file);
  say(" ended the process by exit(): the error is in the plugin, which has to return a status; mend it or leave it "
      "out\n");
  fflush(NULL);
  end(2);
}

/* ---- calls that do not return ---- */

/* s; who asked to stop waits for it, and a step that is this long is rare. */
enum { PATIENCE = 5 };

static const hk_instance *volatile looked_at; /* who was at work when the time began */
static volatile sig_atomic_t asked;

static void overdue(const hk_instance *plugin, const char *when) {
  name(plugin, NULL);
  say(" has not returned ");
  say(when);
  say(": the run ends in this call, and its outputs are not closed\n");
  end(130);
}

static void check_overdue(int number) {
  const hk_instance *plugin = acting;
  (void)number;
  if (getpid() != watched) return;
  if (plugin && plugin == looked_at) overdue(plugin, "5 s after the interruption");
  looked_at = plugin;
  alarm(PATIENCE);
}

void hk_faults_interrupt(void) {
  const hk_instance *plugin = acting;
  if (getpid() != watched) return;
  if (asked++ && plugin) overdue(plugin, "at the second interruption");
  looked_at = plugin;
  alarm(PATIENCE);
}

void hk_faults_returned(void) { alarm(0); }

static volatile int code_at_end;

static void end_at_last(int number) {
  (void)number;
  _exit(code_at_end);
}

int hk_faults_leave(int code) {
  code_at_end = code;
  signal(SIGALRM, end_at_last);
  alarm(PATIENCE);
  return code;
}

/* A stack of its own, for a plugin whose recursion does not end. */
static int take_stack(void) {
  static char room[1 << 16];
  stack_t stack = {.ss_sp = room, .ss_size = sizeof room};
  return sigaltstack(&stack, NULL) == 0 ? SA_ONSTACK : 0;
}

const hk_instance *volatile *hk_faults_watch(const hk_registry *registry) {
  struct sigaction action = {.sa_sigaction = crashed}, clock = {.sa_handler = check_overdue, .sa_flags = SA_RESTART},
                   before;
  watched = getpid();
  loading = registry;
  sigemptyset(&clock.sa_mask);
  sigaction(SIGALRM, &clock, NULL);
  sigemptyset(&action.sa_mask);
  action.sa_flags = (int)((unsigned)SA_RESETHAND | SA_NODEFER | SA_SIGINFO);
  for (int k = 0; k < FAULTS; k++) {
    if (sigaction(faults[k].number, NULL, &before) != 0 || before.sa_handler != SIG_DFL) continue;
    if (!(action.sa_flags & SA_ONSTACK)) action.sa_flags |= take_stack();
    sigaction(faults[k].number, &action, NULL);
  }
  atexit(left);
  return &acting;
}
