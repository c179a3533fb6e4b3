/* What holds for all of the process, and plugins may not leave changed: how the processor rounds, what it does with
 * numbers too small for full precision, whether it traps, and what happens at signals. After a change of them a crash
 * is mute, Ctrl-C is dead, or every number is a bit wrong. Each of hooke's threads has modes of its own, and looks at
 * them after its part of a loop; the first one asks what they have found. */
#include "core/app/process/process.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>

enum { FOUND = 512 };

static uint64_t own_modes;

static const struct watched_signal {
  int number;
  const char *name;
} signals[] = {{SIGSEGV, "SIGSEGV"}, {SIGBUS, "SIGBUS"}, {SIGFPE, "SIGFPE"},   {SIGILL, "SIGILL"},
               {SIGABRT, "SIGABRT"}, {SIGINT, "SIGINT"}, {SIGTERM, "SIGTERM"}, {SIGALRM, "SIGALRM"}};

enum { SIGNALS = sizeof signals / sizeof *signals };

static struct sigaction own_action[SIGNALS];

/* ---- the processor's modes; on other processors than these nobody looks ---- */

#if defined(__x86_64__)
enum { DENORMALS = 0x8040, TRAPS = 0x1f80, ROUNDING = 0x6000 };
static uint64_t modes(void) { return __builtin_ia32_stmxcsr() & (DENORMALS | TRAPS | ROUNDING); }
static void set_modes(uint64_t to) {
  __builtin_ia32_ldmxcsr((__builtin_ia32_stmxcsr() & ~(unsigned)(DENORMALS | TRAPS | ROUNDING)) | (unsigned)to);
}
#elif defined(__aarch64__)
enum { DENORMALS = 0x1000000, TRAPS = 0x9f00, ROUNDING = 0xc00000 };
static uint64_t modes(void) {
  uint64_t control;
  __asm__ volatile("mrs %0, fpcr" : "=r"(control));
  return control & (DENORMALS | TRAPS | ROUNDING);
}
static void set_modes(uint64_t to) { __asm__ volatile("msr fpcr, %0" : : "r"(to)); }
#else
enum { DENORMALS = 1, TRAPS = 2, ROUNDING = 4 };
static uint64_t modes(void) { return 0; }
static void set_modes(uint64_t to) { (void)to; }
#endif

static const char *changed_modes(void) {
  uint64_t differ = modes() ^ own_modes;
  if (!differ) return NULL;
  set_modes(own_modes);
  if (differ & ROUNDING)
    return "has left the rounding mode changed (fesetround), by which all numbers after it would be others: it has to "
           "set it back before it returns";
  if (differ & TRAPS)
    return "has left floating-point traps switched on (feenableexcept), at which the process would end: it has to "
           "switch them off before it returns";
  return "has left numbers below 2e-308 flushed to zero (-ffast-math, or a mode of the processor): it has to set the "
         "mode back before it returns";
}

static _Atomic(const char *) changed_in_thread;

void hk_settings_thread_ended(void) {
  const char *what = changed_modes();
  if (what) atomic_store(&changed_in_thread, what);
}

/* ---- signals ---- */

static bool same_action(const struct sigaction *a, const struct sigaction *b) {
  bool told = a->sa_flags & SA_SIGINFO, also_told = b->sa_flags & SA_SIGINFO;
  return told == also_told && (told ? a->sa_sigaction == b->sa_sigaction : a->sa_handler == b->sa_handler);
}

static const char *changed_signal(void) {
  static char text[FOUND];
  struct sigaction now;
  for (size_t k = 0; k < SIGNALS; k++) {
    if (sigaction(signals[k].number, NULL, &now) != 0 || same_action(&now, &own_action[k])) continue;
    sigaction(signals[k].number, &own_action[k], NULL);
    snprintf(text, sizeof text,
             "has left what happens at %s changed (signal, sigaction), which is hooke's to say: it has to leave "
             "signals alone",
             signals[k].name);
    return text;
  }
  return NULL;
}

static const char *disturbed(void) {
  const char *what = changed_modes(), *beside = atomic_exchange(&changed_in_thread, NULL);
  hk_faults_check_files();
  return what ? what : beside ? beside : changed_signal();
}

const char *(*hk_settings_watch(void))(void) {
  own_modes = modes();
  for (size_t k = 0; k < SIGNALS; k++) sigaction(signals[k].number, NULL, &own_action[k]);
  return disturbed;
}
