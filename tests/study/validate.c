/* All problems with known answers at all of their levels, with the page and the figures in out/validate: what `make
 * test` does with coarse levels only (tests/tools/validate_quick.c, validate_quick_long.c). Arguments: those of `hooke validate`. Returns its
 * exit code, 5 where an answer or an order is wrong. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>

int main(int argc, char **argv) {
  char command[4096];
  size_t used = (size_t)snprintf(command, sizeof command, "'%s/hooke' validate", HK_BUILD);
  for (int k = 1; k < argc && used < sizeof command; k++)
    used += (size_t)snprintf(command + used, sizeof command - used, " '%s'", argv[k]);
  int status = system(command);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}
