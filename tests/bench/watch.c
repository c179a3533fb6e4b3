/* What it costs to watch a run (hooke run --watch): processor time of the run alone and of the run with the process
 * that keeps its frames for pages, to the end of the run, and how long that takes; the least of several pairs, which
 * alternate. No page is open: a page's own work is the browser's. The scene is scripts/scenes/cloth.lua, with dearer
 * and dearer frames. */
#include "tests/support/command.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { PAIRS = 5, FRAMES = 121 };

typedef struct cost {
  double wall, processor; /* s */
} cost;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double seconds(struct timeval t) { return (double)t.tv_sec + 1e-6 * (double)t.tv_usec; }

static pid_t start(const char *parameter, const char *state, const char *watch) {
  pid_t pid = fork();
  if (pid != 0) return pid;
  int nowhere = open("/dev/null", O_RDWR);
  for (int fd = 0; fd < 3; fd++) dup2(nowhere, fd);
  execl(HK_BUILD "/hooke", "hooke", "run", HK_ROOT "/scripts/scenes/cloth.lua", parameter, "--threads", "1", "--quiet",
        "--no-output", "--state", state, watch, (char *)NULL);
  _exit(127);
}

/* A watched run waits for its user after its end: the state, which is written then, tells of it. */
static cost run(const char *parameter, const char *watch) {
  char state[512];
  struct rusage used;
  int status;
  snprintf(state, sizeof state, "%s/state.csv", test_folder());
  unlink(state);
  double begin = now(), end;
  pid_t pid = start(parameter, state, watch);
  if (watch) {
    while (access(state, F_OK) != 0 && now() - begin < 300) usleep(1000);
    end = now();
    usleep(200000); /* the summary follows the state */
    kill(pid, SIGINT);
  }
  wait4(pid, &status, 0, &used); /* with the processes that it has waited for */
  if (!watch) end = now();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fprintf(stderr, "%s: it failed\n", parameter);
  return (cost){end - begin, seconds(used.ru_utime) + seconds(used.ru_stime)};
}

static void keep_least(cost *least, cost c) {
  least->wall = fmin(least->wall, c.wall);
  least->processor = fmin(least->processor, c.processor);
}

int main(void) {
  static const char *const sides[] = {"N=2", "N=32", "N=64"};
  printf("cloth   processor s   watched   more a frame, ms   wall s   watched\n");
  for (size_t k = 0; k < sizeof sides / sizeof *sides; k++) {
    cost alone = {INFINITY, INFINITY}, watched = alone;
    for (int pair = 0; pair < PAIRS; pair++) {
      keep_least(&alone, run(sides[k], NULL));
      keep_least(&watched, run(sides[k], "--watch --at-once"));
    }
    printf("%-7s %-13.3g %-9.3g %-18.3g %-8.3g %.3g\n", sides[k], alone.processor, watched.processor,
           1e3 * (watched.processor - alone.processor) / FRAMES, alone.wall, watched.wall);
    fflush(stdout);
  }
  return 0;
}
