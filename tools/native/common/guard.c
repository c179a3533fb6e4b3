/* Guarded arrays: three maps of pages side by side, of which the outer two have no rights. A signal handler finds the
 * array by the address that was touched. Each module of the tools has a watch of its own; one that does not know what
 * happened asks the one that began to watch before it. The handler uses what may be used in one alone: write() and
 * _exit(). */
#include "tools/native/common/guard.h"

#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static struct {
  const hk_guarded *array[HK_GUARDED_MOST];
  const char *volatile function;
  int fd;                 /* 0: nothing is watched */
  struct sigaction outer; /* who watched before */
} guard;

static size_t page(void) { return (size_t)sysconf(_SC_PAGESIZE); }

bool hk_guard_get(hk_guarded *g, const char *name, size_t bytes, hk_guard_side side) {
  hk_guard_free(g);
  size_t place = 0, wall = page(), inner = (bytes + wall - 1) / wall * wall;
  while (place < HK_GUARDED_MOST && guard.array[place]) place++;
  if (inner == 0) inner = wall;
  char *map = mmap(NULL, inner + 2 * wall, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (place == HK_GUARDED_MOST || map == MAP_FAILED || mprotect(map + wall, inner, PROT_READ | PROT_WRITE) != 0)
    return false;
  *g = (hk_guarded){name, map + wall, bytes, false, map, inner + 2 * wall};
  /* Numbers of 8 bytes end exactly at the wall. */
  if (side == HK_GUARD_BEHIND) g->at = map + wall + (inner - (bytes + 7) / 8 * 8);
  guard.array[place] = g;
  return true;
}

void hk_guard_free(hk_guarded *g) {
  for (size_t k = 0; k < HK_GUARDED_MOST; k++)
    if (guard.array[k] == g) guard.array[k] = NULL;
  if (g->map) munmap(g->map, g->mapped);
  *g = (hk_guarded){0};
}

void hk_guard_allow(hk_guarded *g, bool writable) {
  if (g->map) mprotect(g->map + page(), g->mapped - 2 * page(), writable ? PROT_READ | PROT_WRITE : PROT_READ);
  g->shut = false;
}

void hk_guard_shut(hk_guarded *g) {
  if (g->map) mprotect(g->map + page(), g->mapped - 2 * page(), PROT_NONE);
  g->shut = true;
}

/* ---- the last message ---- */

static void say(const char *text) {
  size_t size = strlen(text), at = 0;
  while (at < size) {
    ssize_t count = write(guard.fd, text + at, size - at);
    if (count <= 0) return;
    at += (size_t)count;
  }
}

static void say_number(size_t number) {
  char digits[24];
  size_t at = sizeof digits - 1;
  digits[at] = 0;
  do digits[--at] = (char)('0' + number % 10);
  while ((number /= 10) > 0);
  say(digits + at);
}

static void say_where(const hk_guarded *g, const char *touched) {
  const char *begin = g->at, *end = begin + g->bytes;
  size_t off = touched < begin ? (size_t)(begin - touched) : (size_t)(touched - end);
  if (g->shut) {
    say("reads or writes ");
    say(g->name);
    say(" after the call in which it was given");
    return;
  }
  if (touched >= begin && touched < end) {
    say("writes to ");
    say(g->name);
    say(", which it may only read, at number ");
    say_number((size_t)(touched - begin) / sizeof(double));
    return;
  }
  say("reads or writes ");
  say_number(off);
  say(touched < begin ? " bytes before " : " bytes behind the end of ");
  say(g->name);
}

static const char *meaning(int number) {
  switch (number) {
  case SIGSEGV:
  case SIGBUS:
    return "reads or writes memory that does not exist (segmentation fault)";
  case SIGFPE:
    return "divides a whole number by zero (SIGFPE)";
  case SIGILL:
    return "reaches code that cannot be executed (SIGILL)";
  case SIGXCPU:
    return "does not end: it used all of its processor time";
  default:
    return "ends the process by abort() (a failed assert does that, too)";
  }
}

/* Whether another module watches this process as well, and this one's functions are not at work. */
static bool leave_to_outer(void) {
  return !guard.function && guard.outer.sa_flags & SA_SIGINFO && guard.outer.sa_sigaction;
}

static void last_words(int number, siginfo_t *info, void *context) {
  const hk_guarded *found = NULL;
  const char *touched = info->si_addr;
  for (size_t k = 0; k < HK_GUARDED_MOST && (number == SIGSEGV || number == SIGBUS); k++) {
    const hk_guarded *g = guard.array[k];
    if (g && touched >= g->map && touched < g->map + g->mapped) found = g;
  }
  if (!found && leave_to_outer()) guard.outer.sa_sigaction(number, info, context);
  say("!");
  say(guard.function ? guard.function : "the plugin");
  say(" ");
  if (found)
    say_where(found, touched);
  else
    say(meaning(number));
  say("\n");
  _exit(120);
}

static void left(void) {
  if (!guard.fd || leave_to_outer()) return;
  say("!");
  say(guard.function ? guard.function : "the plugin");
  say(" ends the process by exit()\n");
  _exit(121);
}

void hk_guard_watch(int fd) {
  static char stack[1 << 16]; /* the plugin's own may be used up */
  static const int fatal[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU};
  struct sigaction action = {.sa_sigaction = last_words, .sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESETHAND};
  guard.fd = fd;
  sigaltstack(&(stack_t){.ss_sp = stack, .ss_size = sizeof stack}, NULL);
  for (size_t k = 0; k < sizeof fatal / sizeof *fatal; k++) sigaction(fatal[k], &action, &guard.outer);
  atexit(left);
}

void hk_guard_enter(const char *function) { guard.function = function; }
