/* Standard input, output and error, where the caller has closed them or stops reading. The number of a closed one could
 * go to a file that is opened later, into which the summary would then be printed: it is taken by /dev/null instead,
 * opened such that reading or writing fails. A pipe whose reader has gone is an error of writing like any other: it
 * neither ends a run before its files are complete nor goes unnoticed. */
#include "core/command/standard_files.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

void hk_standard_files_open(void) {
  for (int k = STDIN_FILENO; k <= STDERR_FILENO; k++)
    if (fcntl(k, F_GETFD) < 0) open("/dev/null", k == STDIN_FILENO ? O_WRONLY : O_RDONLY); /* the lowest free number */
  signal(SIGPIPE, SIG_IGN);
}

hk_status hk_standard_output_end(hk_error *error) {
  errno = 0;
  if (fflush(stdout) == 0 && !ferror(stdout)) return HK_OK;
  return hk_error_set(error, HK_IO, "cannot write to standard output: %s", errno ? strerror(errno) : "a part of it is missing");
}
