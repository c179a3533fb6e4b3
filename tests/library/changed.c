/* A run goes on from its checkpoint with another value of a parameter: a weight on a spring, whose stiffness is four
 * times as large from 0.25 s on, follows the swing of the new frequency through the place and velocity that it had.
 * Prints what is not as it should be, and nothing else. */
#include <hooke.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char spring[] = "local k = param('k', 40, 'N/m')\n"
                             "local scene = hooke.scene { duration = 1, fps = 20, dt = 1e-3, integrator = 'rk4' }\n"
                             "local a, b = scene:particle {}, scene:particle { position = { 1, 0, 0 }, mass = 1 }\n"
                             "scene:pin { a }\n"
                             "scene:force('springs', { edges = { { a, b } }, k = k, rest = 0 })\n"
                             "return scene\n";
static int failures;

static void check(int fine, const char *what, const hooke_run *run) {
  if (fine) return;
  failures++;
  printf("failed: %s: %s\n", what, hooke_error(run));
}

/* Opened, or what the refusal says. */
static hooke_run *opened(const char *file, const char *change, const char *refusal) {
  hooke_run *run = hooke_new();
  hooke_status status = hooke_parameter(run, "k", "40");
  if (status == HOOKE_OK && file) status = hooke_option(run, "resume", file);
  if (status == HOOKE_OK && change) status = hooke_option(run, "change", change);
  if (status == HOOKE_OK) status = hooke_open_text(run, "spring.lua", spring);
  if (!refusal) check(status == HOOKE_OK, "it opens", run);
  if (refusal) check(status != HOOKE_OK && strstr(hooke_error(run), refusal), refusal, run);
  return run;
}

int main(int argc, char **argv) {
  const double m = 1, t = 0.25, k = 160, w = sqrt(k / m);
  if (argc != 2) return 1;
  hooke_run *run = opened(NULL, NULL, NULL);
  check(hooke_advance(run, t) == HOOKE_OK && hooke_checkpoint(run, argv[1]) == HOOKE_OK, "it is kept", run);
  const double x = hooke_positions(run)[3], v = hooke_velocities(run)[3];
  hooke_free(run);

  run = opened(argv[1], "k=160", NULL);
  check(fabs(hooke_time(run) - t) < 1e-12, "it goes on from there", run);
  check(hooke_positions(run)[3] == x && hooke_velocities(run)[3] == v, "place and velocity stay", run);
  check(hooke_advance(run, 1) == HOOKE_OK, "it comes to its end", run);
  const double end = x * cos(w * (1 - t)) + v / w * sin(w * (1 - t));
  /* rk4 is off by T w (w h)^4/120 of the amplitude, 2e-9 here. */
  check(fabs(hooke_positions(run)[3] - end) < 1e-8, "it swings by the new stiffness", run);
  check(strstr(hooke_parameters(run), "160") != NULL, "the parameter has the new value", run);
  hooke_free(run);

  hooke_free(opened(NULL, "k=160", "'change' is of a run that goes on"));
  hooke_free(opened(argv[1], "k", "change: 'k' is not the parameter and its value"));
  hooke_free(opened(argv[1], "=3", "change: '=3' is not the parameter and its value"));
  return failures > 0;
}
