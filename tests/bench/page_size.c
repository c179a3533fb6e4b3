/* The size of pages: the cloth of scripts/scenes/cloth.lua at 60 frames a second, with velocities and strain, 10 s of
 * 32 x 32 particles and 2 s of 128 x 128, from which 10 s follow in proportion; and the time that the page takes to be
 * made from the run's trajectory. */
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
  static const int sides[] = {32, 128}, seconds[] = {10, 2};
  char command[2048], page[512];
  struct stat info;
  printf("particles   s    page      bytes a particle and frame   made in\n");
  for (int k = 0; k < 2; k++) {
    snprintf(
        command, sizeof command,
        "cd '%s' && sed '/scene:output/d; s/duration = 2/duration = %d/' '%s/scripts/scenes/cloth.lua' >cloth.lua && "
        "'%s/hooke' run cloth.lua N=%d --quiet --out c%d --with output:trajectory",
        test_folder(), seconds[k], HK_ROOT, HK_BUILD, sides[k], sides[k]);
    if (shell(command) != 0) return 1;
    double begin = now();
    snprintf(command, sizeof command, "cd '%s' && '%s/hooke' view c%d --quiet >view.txt", test_folder(), HK_BUILD,
             sides[k]);
    if (shell(command) != 0) return 1;
    snprintf(page, sizeof page, "%s/c%d/page.html", test_folder(), sides[k]);
    if (stat(page, &info) != 0) return 1;
    printf("%3d x %-3d   %-2d   %.2f MB   %.4g                        %.2f s\n", sides[k], sides[k], seconds[k],
           1e-6 * (double)info.st_size, (double)info.st_size / (60.0 * seconds[k] * sides[k] * sides[k]),
           now() - begin);
    fflush(stdout);
  }
  return 0;
}
