/* Limits of scripts are kept by a hook that Lua calls after every so many instructions. One call of a function of Lua's
 * library is one instruction: a pattern match may take hours, table.move with numbers of the script's choice years. A
 * thread looks at the script's pulse a few times a second. When the script is at work, has executed no further
 * instructions, has taken no large block of memory and its thread has used two seconds of processor time for that, or
 * the user has asked for the end, the process is ended: nothing can be saved from within that call. Waiting for the
 * engine, or for a processor that others use, is no standstill. */
#include "core/app/process/process.h"

#include <errno.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const double most = 2, patience = 0.5; /* s: as long as 5e8 instructions take; after an interrupt */

/* Threads and handlers of a fork are given nothing. */
static hk_pulse pulse;
static const volatile sig_atomic_t *_Atomic asked_to_end; /* a later script may set it anew while the thread looks */
static clockid_t watched_clock;
static bool running;

static double seconds(clockid_t clock) {
  struct timespec t = {0};
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void end(const char *why, int code) {
  ssize_t written = write(STDERR_FILENO, why, strlen(why));
  (void)written; /* there is nobody left to tell */
  _exit(code);
}

static void *watch(void *begun) {
  sem_post(begun);
  const struct timespec pause = {.tv_nsec = 100000000};
  uint_fast64_t seen = 0;
  double since = 0, interrupted_at = 0;
  for (;;) {
    nanosleep(&pause, NULL);
    uint_fast64_t beats = atomic_load_explicit(&pulse.beats, memory_order_relaxed);
    bool inside = atomic_load_explicit(&pulse.inside, memory_order_relaxed);
    double now = seconds(CLOCK_MONOTONIC), used = seconds(watched_clock);
    if (!inside || beats != seen) {
      seen = beats;
      since = used;
      interrupted_at = 0;
      continue;
    }
    if (*atomic_load(&asked_to_end) && interrupted_at == 0) interrupted_at = now;
    if (interrupted_at > 0 && now - interrupted_at > patience)
      end("hooke: interrupted, inside a function of Lua's library that a script called: nothing was saved\n", 130);
    if (used - since > most)
      end("hooke: a script was for 2 s inside one call of a function of Lua's library: it was ended beyond its limit, "
          "and "
          "nothing was saved (a pattern that matches in too many ways? --trust lifts the limit)\n",
          1);
  }
  return NULL;
}

/* Returns when the thread has begun: a process that forked while its thread was still being set up would leave the
 * child what a library had locked for that (the sanitizers' allocator, for one). */
static void start(void) {
  sem_t begun;
  pthread_t thread;
  pthread_attr_t attributes;
  sigset_t all, before;
  if (pthread_getcpuclockid(pthread_self(), &watched_clock) != 0 || pthread_attr_init(&attributes) != 0) return;
  sem_init(&begun, 0, 0);
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before); /* signals are for the first thread */
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  running = pthread_create(&thread, &attributes, watch, &begun) == 0;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  while (running && sem_wait(&begun) != 0 && errno == EINTR) continue;
  sem_destroy(&begun);
  pthread_attr_destroy(&attributes);
}

hk_pulse *hk_watchdog_start(const volatile sig_atomic_t *interrupted) {
  asked_to_end = interrupted;
  if (running) return &pulse;
  start();
  if (running && pthread_atfork(NULL, NULL, start) != 0) return NULL;
  return running ? &pulse : NULL;
}
