/* The size of pages: 10 s of the cloth of scripts/scenes/cloth.lua, 32 x 32 and 128 x 128 particles at 60 frames a
 * second, with velocities and strain; and the time that the page takes to be made from the run's trajectory. */
#include "tests/support/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <time.h>

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int shell(const char *command) {
  int code = system(command);
  if (code != 0) fprintf(stderr, "%s\n", command);
  return code;
}

int main(void) {
  static const int sides[] = {32, 128}, stiffness[] = {1000, 30}; /* the stiff one of 128 x 128 runs for minutes */
  char command[2048], page[512];
  struct stat info;
  printf("particles   page      bytes a particle and frame   made in\n");
  for (int k = 0; k < 2; k++) {
    snprintf(
        command, sizeof command,
        "cd '%s' && sed '/scene:output/d; s/duration = 2/duration = 10/' '%s/scripts/scenes/cloth.lua' >cloth.lua && "
        "'%s/hooke' run cloth.lua N=%d k=%d --quiet --out c%d --with output:trajectory",
        test_folder(), HK_ROOT, HK_BUILD, sides[k], stiffness[k], sides[k]);
    if (shell(command) != 0) return 1;
    double begin = now();
    snprintf(command, sizeof command, "cd '%s' && '%s/hooke' view c%d --quiet >view.txt", test_folder(), HK_BUILD,
             sides[k]);
    if (shell(command) != 0) return 1;
    snprintf(page, sizeof page, "%s/c%d/page.html", test_folder(), sides[k]);
    if (stat(page, &info) != 0) return 1;
    printf("%3d x %-3d   %.2f MB   %.4g                        %.2f s\n", sides[k], sides[k],
           1e-6 * (double)info.st_size, (double)info.st_size / (600.0 * sides[k] * sides[k]), now() - begin);
    fflush(stdout);
  }
  return 0;
}
