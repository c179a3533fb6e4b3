/* The corpus of hard cases without a limit of steps, the long ones among them: what `make test` leaves out. Arguments:
 * options of `hooke stability --hard`, such as --case undamped. Returns 1 when a run says ok beyond its bound, or does
 * not reach one that it has to reach. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>

int main(int argc, char **argv) {
  char command[4096];
  size_t used = (size_t)snprintf(command, sizeof command, "'%s/hooke' stability --hard '%s/tests/hard' --trust --long",
                                 HK_BUILD, HK_ROOT);
  for (int k = 1; k < argc && used < sizeof command; k++)
    used += (size_t)snprintf(command + used, sizeof command - used, " '%s'", argv[k]);
  int status = system(command);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}
