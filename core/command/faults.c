/* Plugins are native code in this process: what one does wrong may end it. A handler for the signals of a crash and one
 * for exit() say which plugin was at work, from the pointer that the host sets around every call, and end the process
 * with code 2. Nothing can be saved then: the memory may be damaged. The signal handler only writes (POSIX 2.4.3).
 * Crashes outside of plugins, those of child processes and signals that somebody else handles already (a sanitizer)
 * are left as they are. */
#include "core/command/faults.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Handlers are given nothing: what they look at has to be global. */
static const hk_instance *volatile acting;
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

/* "hooke: bad.lua:3: the force 'LABEL' of the plugin NAME" */
static void name(const hk_instance *plugin) {
  say("hooke: ");
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

static void crashed(int number) {
  const hk_instance *plugin = acting;
  int k = 0;
  if (!plugin || getpid() != watched) {
    raise(number); /* its action is the default one again */
    return;
  }
  while (k < FAULTS - 1 && faults[k].number != number) k++;
  name(plugin);
  say(" crashed (");
  say(faults[k].what);
  say("): the error is in the plugin; mend it or leave it out\n");
  _exit(2);
}

static void left(void) {
  const hk_instance *plugin = acting;
  if (!plugin || getpid() != watched) return;
  name(plugin);
  say(" ended the process by exit(): the error is in the plugin, which has to return a status; mend it or leave it "
      "out\n");
  fflush(NULL);
  _exit(2);
}

/* A stack of its own, for a plugin whose recursion does not end. */
static int take_stack(void) {
  static char room[1 << 16];
  stack_t stack = {.ss_sp = room, .ss_size = sizeof room};
  return sigaltstack(&stack, NULL) == 0 ? SA_ONSTACK : 0;
}

const hk_instance *volatile *hk_faults_watch(void) {
  struct sigaction action = {.sa_handler = crashed}, before;
  watched = getpid();
  sigemptyset(&action.sa_mask);
  action.sa_flags = (int)((unsigned)SA_RESETHAND | SA_NODEFER);
  for (int k = 0; k < FAULTS; k++) {
    if (sigaction(faults[k].number, NULL, &before) != 0 || before.sa_handler != SIG_DFL) continue;
    if (!(action.sa_flags & SA_ONSTACK)) action.sa_flags |= take_stack();
    sigaction(faults[k].number, &action, NULL);
  }
  atexit(left);
  return &acting;
}
