/* Standard input, output and error, where the caller has closed them or stops reading. The number of a closed one could
 * go to a file that is opened later, into which the summary would then be printed: it is taken by /dev/null instead,
 * opened such that reading or writing fails. A pipe whose reader has gone is an error of writing like any other: it
 * neither ends a run before its files are complete nor goes unnoticed; and so is a file that reaches the limit of its
 * size (ulimit -f). */
#include "core/app/process/process.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* Of which a run opens 7 at once and a bench 13. With fewer, what is opened first is missing without a word: rules of
 * what the process may read, from which "Permission denied" follows. */
enum { FEWEST = 16 };

hk_status hk_standard_files_open(hk_error *error) {
  struct rlimit most = {0};
  for (int k = STDIN_FILENO; k <= STDERR_FILENO; k++)
    if (fcntl(k, F_GETFD) < 0) open("/dev/null", k == STDIN_FILENO ? O_WRONLY : O_RDONLY); /* the lowest free number */
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);
  if (getrlimit(RLIMIT_NOFILE, &most) != 0 || most.rlim_cur >= FEWEST) return HK_OK;
  return hk_error_set(error, HK_IO, "%d files may be open at once (ulimit -n), and hooke needs %d", (int)most.rlim_cur,
                      FEWEST);
}

hk_status hk_standard_output_end(hk_error *error) {
  errno = 0;
  if (fflush(stdout) == 0 && !ferror(stdout)) return HK_OK;
  return hk_error_set(error, HK_IO, "cannot write to standard output: %s",
                      errno ? strerror(errno) : "a part of it is missing");
}
