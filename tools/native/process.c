/* process: child processes, pipes and clocks, which Lua lacks (Debian's lua-posix stops at Lua 5.3). A call that the
 * system refuses raises an error with the system's message, unless its comment says otherwise. */
#include "tools/native/common/guard.h"

#include <errno.h>
#include <fcntl.h>
#include <lauxlib.h>
#include <lua.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static int refuse(lua_State *L, const char *what) { return luaL_error(L, "%s: %s", what, strerror(errno)); }

/* clock() -> s, of a monotonic clock. */
static int get_clock(lua_State *L) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  lua_pushnumber(L, (double)t.tv_sec + 1e-9 * (double)t.tv_nsec);
  return 1;
}

/* processor_time(pid) -> s, of a child that runs; nil: the system does not tell. processor_time() -> s, of this process
 * and all its children that have ended. */
static double used_by(int who) {
  struct rusage used;
  getrusage(who, &used);
  return (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

static int processor_time(lua_State *L) {
  struct timespec t;
  if (!lua_isnoneornil(L, 1)) {
    clockid_t clock;
    if (clock_getcpuclockid((pid_t)luaL_checkinteger(L, 1), &clock) != 0 || clock_gettime(clock, &t) != 0) return 0;
    lua_pushnumber(L, (double)t.tv_sec + 1e-9 * (double)t.tv_nsec);
    return 1;
  }
  lua_pushnumber(L, used_by(RUSAGE_SELF) + used_by(RUSAGE_CHILDREN));
  return 1;
}

/* terminal(fd) -> whether fd is a terminal. processors() -> the number of processors available. */
static int is_terminal(lua_State *L) {
  lua_pushboolean(L, isatty((int)luaL_checkinteger(L, 1)));
  return 1;
}

static int processors(lua_State *L) {
  long online = sysconf(_SC_NPROCESSORS_ONLN);
  lua_pushinteger(L, online > 0 ? online : 1);
  return 1;
}

static int signals_written = -1; /* the end of a pipe, as a handler is given nothing; -1: signals end the process */

/* fork() -> in the parent: pid, fd to read what the child writes; in the child: 0, fd to write to. */
static int start(lua_State *L) {
  int fd[2];
  if (pipe(fd) != 0) return refuse(L, "pipe");
  sigset_t asked, before; /* a signal to the child is its own, not the tool's, from its first moment */
  sigemptyset(&asked);
  sigaddset(&asked, SIGINT);
  sigaddset(&asked, SIGTERM);
  fflush(NULL);
  sigprocmask(SIG_BLOCK, &asked, &before);
  pid_t pid = fork();
  if (pid == 0 && signals_written >= 0) {
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
  }
  sigprocmask(SIG_SETMASK, &before, NULL);
  if (pid < 0) {
    close(fd[0]);
    close(fd[1]);
    return refuse(L, "fork");
  }
  close(fd[pid == 0 ? 0 : 1]);
#ifdef __linux__
  if (pid == 0) prctl(PR_SET_PDEATHSIG, SIGKILL); /* the child ends with the tool that started it */
#endif
  lua_pushinteger(L, pid);
  lua_pushinteger(L, fd[pid == 0 ? 1 : 0]);
  return 2;
}

/* capture() -> fd of a nameless file, in which what a process prints can be kept. */
static int capture(lua_State *L) {
  char name[] = "/tmp/hooke-XXXXXX";
  int fd = mkstemp(name);
  if (fd < 0) return refuse(L, "mkstemp");
  unlink(name);
  lua_pushinteger(L, fd);
  return 1;
}

/* captured(fd) -> the text in such a file, up to 4 kB; closes it. */
static int captured(lua_State *L) {
  char text[4096];
  int fd = (int)luaL_checkinteger(L, 1);
  ssize_t count = pread(fd, text, sizeof text, 0);
  close(fd);
  lua_pushlstring(L, text, count > 0 ? (size_t)count : 0);
  return 1;
}

static void limit(int resource, rlim_t most) { setrlimit(resource, &(struct rlimit){most, most}); }

/* allow(seconds): the calling process may take so much more processor time from now on. */
static int allow(lua_State *L) {
  struct rusage used;
  getrusage(RUSAGE_SELF, &used);
  rlim_t most = (rlim_t)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + (rlim_t)luaL_checknumber(L, 1) + 2;
  setrlimit(RLIMIT_CPU, &(struct rlimit){most, RLIM_INFINITY});
  return 0;
}

/* confine(seconds, bytes, out, err, fd): the calling process has so much processor time and address space left, leaves
 * no core file, writes files of 16 MB at most, and prints into the files `out` and `err`. A fatal signal or an exit()
 * writes a line to fd (common/guard.h). */
static int confine(lua_State *L) {
  allow(L);
#ifndef __SANITIZE_ADDRESS__ /* whose shadow memory needs terabytes of addresses */
  limit(RLIMIT_AS, (rlim_t)luaL_checknumber(L, 2));
#endif
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 1 << 24);
  fflush(NULL);
  if (dup2((int)luaL_checkinteger(L, 3), 1) < 0 || dup2((int)luaL_checkinteger(L, 4), 2) < 0) return refuse(L, "dup2");
  hk_guard_watch((int)luaL_checkinteger(L, 5));
  return 0;
}

/* write(fd, text) -> whether all of the text was written (the reader may have closed the pipe). */
static int write_all(lua_State *L) {
  size_t size, at = 0;
  int fd = (int)luaL_checkinteger(L, 1);
  const char *text = luaL_checklstring(L, 2, &size);
  while (at < size) {
    ssize_t count = write(fd, text + at, size - at);
    if (count < 0 && errno != EINTR) break;
    if (count > 0) at += (size_t)count;
  }
  lua_pushboolean(L, at == size);
  return 1;
}

/* read(fd) -> the data available, "" at the end. */
static int read_some(lua_State *L) {
  luaL_Buffer buffer;
  enum { ROOM = 1 << 16 };
  char *room = luaL_buffinitsize(L, &buffer, ROOM);
  ssize_t count;
  do count = read((int)luaL_checkinteger(L, 1), room, ROOM);
  while (count < 0 && errno == EINTR);
  luaL_pushresultsize(&buffer, count > 0 ? (size_t)count : 0);
  return 1;
}

static int close_fd(lua_State *L) {
  close((int)luaL_checkinteger(L, 1));
  return 0;
}

/* ready({fd, ...}, s) -> { [fd] = true } of those that can be read or were closed; waits up to s seconds for the
 * first. */
static int ready(lua_State *L) {
  enum { MOST = 257 }; /* 256 processes, and signals */
  struct pollfd list[MOST];
  luaL_checktype(L, 1, LUA_TTABLE);
  size_t count = lua_rawlen(L, 1);
  luaL_argcheck(L, count <= MOST, 1, "more than 256 processes at once");
  for (size_t k = 0; k < count; k++, lua_pop(L, 1)) {
    lua_rawgeti(L, 1, (lua_Integer)k + 1);
    list[k] = (struct pollfd){.fd = (int)lua_tointeger(L, -1), .events = POLLIN};
  }
  if (poll(list, (nfds_t)count, (int)(1e3 * luaL_checknumber(L, 2))) < 0 && errno != EINTR) return refuse(L, "poll");
  lua_newtable(L);
  for (size_t k = 0; k < count; k++) {
    if (!list[k].revents) continue;
    lua_pushboolean(L, 1);
    lua_rawseti(L, -2, list[k].fd);
  }
  return 1;
}

/* wait(pid) -> "exit" or "signal", and its number. */
static int wait_for(lua_State *L) {
  int status;
  pid_t pid = (pid_t)luaL_checkinteger(L, 1), got;
  do got = waitpid(pid, &status, 0);
  while (got < 0 && errno == EINTR);
  if (got < 0) return refuse(L, "waitpid");
  lua_pushstring(L, WIFSIGNALED(status) ? "signal" : "exit");
  lua_pushinteger(L, WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
  return 2;
}

static int kill_process(lua_State *L) {
  kill((pid_t)luaL_checkinteger(L, 1), SIGKILL);
  return 0;
}

/* pipe() -> fd to read, fd to write; programs that are started do not get them unasked. */
static int make_pipe(lua_State *L) {
  int fd[2];
  if (pipe(fd) != 0) return refuse(L, "pipe");
  for (int k = 0; k < 2; k++) {
    fcntl(fd[k], F_SETFD, FD_CLOEXEC);
    lua_pushinteger(L, fd[k]);
  }
  return 2;
}

/* Copies of descriptors above those that a program is given, so that none is overwritten before it is copied. */
enum { GIVEN = 16 };

static void give(const int from[GIVEN]) {
  int copy[GIVEN];
  for (int k = 0; k < GIVEN; k++) copy[k] = from[k] >= 0 ? fcntl(from[k], F_DUPFD_CLOEXEC, GIVEN) : -1;
  for (int k = 0; k < GIVEN; k++)
    if (copy[k] >= 0 && dup2(copy[k], k) < 0) _exit(127);
}

/* In the child of a vfork, which only makes calls of the system: a program of its own, which ends in order when its
 * starter has ended. */
static void become(char *const *arguments, const int from[GIVEN]) {
  signal(SIGPIPE, SIG_DFL);
  setpgid(0, 0); /* an interrupt at the terminal is for the starter, who hands it on */
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGTERM);
#endif
  give(from);
  execv(arguments[0], arguments);
  _exit(127);
}

/* spawn({program, word, ...}, {[fd] = fd, ...}) -> pid: starts a program, with our descriptors as those of these
 * numbers (below 16). */
static int spawn(lua_State *L) {
  int from[GIVEN];
  luaL_checktype(L, 1, LUA_TTABLE);
  size_t count = lua_rawlen(L, 1);
  char **arguments = lua_newuserdatauv(L, (count + 1) * sizeof *arguments, 0);
  for (size_t k = 0; k < count; k++, lua_pop(L, 1)) { /* the table keeps the texts */
    lua_rawgeti(L, 1, (lua_Integer)k + 1);
    union {
      const char *constant;
      char *word;
    } u = {luaL_checkstring(L, -1)}; /* execv changes none */
    arguments[k] = u.word;
  }
  arguments[count] = NULL;
  for (int k = 0; k < GIVEN; k++, lua_pop(L, 1)) from[k] = lua_rawgeti(L, 2, k) ? (int)lua_tointeger(L, -1) : -1;
  fflush(NULL);
  pid_t pid = vfork(); /* no handlers of forks: other threads may hold what these would need */
  if (pid < 0) return refuse(L, "fork");
  if (pid == 0) become(arguments, from);
  lua_pushinteger(L, pid);
  return 1;
}

/* interrupt(pid): as Ctrl-C does. */
static int interrupt(lua_State *L) {
  kill((pid_t)luaL_checkinteger(L, 1), SIGINT);
  return 0;
}

static bool ends_at_second;
static volatile sig_atomic_t noted;

/* Some senders, such as timeout(1), send twice at once: that is one signal. */
static void end_at_second(void) {
  static struct timespec first;
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (!noted) first = now;
  double since = (double)(now.tv_sec - first.tv_sec) + 1e-9 * (double)(now.tv_nsec - first.tv_nsec);
  if (noted && since >= 0.5) _exit(130);
  noted = 1;
}

static void note_signal(int number) {
  int before = errno;
  if (ends_at_second) end_at_second();
  ssize_t written = write(signals_written, "", 1);
  (void)number, (void)written; /* a full pipe says it already */
  errno = before;
}

/* signals([second]) -> fd that can be read once the user has asked this process to end. It is not ended by that any
 * more; second: by another signal, half a second later or more, it is, with the exit code 130. */
static int catch_signals(lua_State *L) {
  ends_at_second = lua_toboolean(L, 1);
  struct sigaction action = {.sa_handler = note_signal};
  int fd[2];
  if (pipe(fd) != 0) return refuse(L, "pipe");
  for (int k = 0; k < 2; k++) fcntl(fd[k], F_SETFD, FD_CLOEXEC);
  fcntl(fd[1], F_SETFL, O_NONBLOCK);
  signals_written = fd[1];
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  sigaction(SIGHUP, &action, NULL);
  lua_pushinteger(L, fd[0]);
  return 1;
}

/* exit(code): ends the process at once, without the exit functions that the parent registered. */
static int exit_now(lua_State *L) {
  fflush(NULL);
  _exit((int)luaL_checkinteger(L, 1));
}

__attribute__((visibility("default"))) int luaopen_process(lua_State *L);

int luaopen_process(lua_State *L) {
  static const luaL_Reg functions[] = {{"clock", get_clock},
                                       {"terminal", is_terminal},
                                       {"processors", processors},
                                       {"fork", start},
                                       {"write", write_all},
                                       {"read", read_some},
                                       {"close", close_fd},
                                       {"ready", ready},
                                       {"wait", wait_for},
                                       {"kill", kill_process},
                                       {"exit", exit_now},
                                       {"capture", capture},
                                       {"captured", captured},
                                       {"confine", confine},
                                       {"allow", allow},
                                       {"pipe", make_pipe},
                                       {"spawn", spawn},
                                       {"interrupt", interrupt},
                                       {"signals", catch_signals},
                                       {"processor_time", processor_time},
                                       {NULL, NULL}};
  signal(SIGPIPE, SIG_IGN); /* write returns an error in a child whose parent has ended */
  luaL_newlib(L, functions);
  return 1;
}
