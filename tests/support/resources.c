#include "tests/support/resources.h"

#include <fcntl.h>
#include <stddef.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST = 16 };

static double seconds_of(struct timeval t) { return (double)t.tv_sec + 1e-6 * (double)t.tv_usec; }

static void run(const char *const *arguments) {
  const char *argv[MOST + 3] = {HK_BUILD "/hooke", "run"};
  for (int k = 0; k < MOST && arguments[k]; k++) argv[k + 2] = arguments[k];
  int none = open("/dev/null", O_WRONLY);
  dup2(none, STDOUT_FILENO);
  execv(argv[0], (char *const *)(const void *)argv);
  _exit(127);
}

test_resources test_resources_of(const char *const *arguments) {
  struct rusage used;
  int status = 0;
  pid_t child = fork();
  if (child == 0) run(arguments);
  if (child < 0 || wait4(child, &status, 0, &used) != child || !WIFEXITED(status)) return (test_resources){.code = -1};
  return (test_resources){WEXITSTATUS(status), 1024 * (double)used.ru_maxrss,
                          seconds_of(used.ru_utime) + seconds_of(used.ru_stime)};
}
