/* What libhooke says of wrong names, values and orders of calls, each in one sentence; and that the thread's rounding
 * and the process's signals are the program's. Prints what is not as it should be, and nothing else. */
#include <hooke.h>

#include <fenv.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

static const char ball[] = "local z = param('z', 9, 'm', { min = 0 })\n"
                           "print('not to be heard')\n"
                           "local scene = hooke.scene { duration = 1 }\n"
                           "scene:channel('heat', {})\n"
                           "scene:particle { mass = 1, position = { 0, 0, z }, heat = 7 }\n"
                           "scene:force('gravity', {})\n"
                           "scene:measure('z', function(s) return s:position(1)[3] end)\n"
                           "return scene\n";
static int failures;

static void check(int fine, const char *what) {
  if (fine) return;
  failures++;
  printf("failed: %s\n", what);
}

static void expect(hooke_run *run, hooke_status got, hooke_status wanted, const char *text) {
  if (got == wanted && strstr(hooke_error(run), text) && !strchr(hooke_error(run), '\n')) return;
  failures++;
  printf("failed: status %d, expected %d with '%s': %s\n", (int)got, (int)wanted, text, hooke_error(run));
}

static void descriptions(void) {
  hooke_run *run = hooke_new();
  expect(run, hooke_option(run, "accurcy", "1e-3"), HOOKE_BAD_PARAM, "did you mean '--accuracy'");
  expect(run, hooke_option(run, "dt", "-1"), HOOKE_BAD_PARAM, "'-1' is not a positive number");
  expect(run, hooke_option(run, "dt", "0,01"), HOOKE_BAD_PARAM, "'0,01' is not a positive number");
  expect(run, hooke_option(run, "dt", NULL), HOOKE_BAD_PARAM, "--dt needs a value");
  expect(run, hooke_option(run, "trust", "1"), HOOKE_BAD_PARAM, "--trust takes no value");
  expect(run, hooke_option(run, "--dt", "1"), HOOKE_BAD_PARAM, "without dashes");
  expect(run, hooke_option(run, NULL, "1"), HOOKE_BAD_PARAM, "name of the option is missing");
  expect(run, hooke_option(run, "json", NULL), HOOKE_BAD_PARAM, "option of the command line");
  expect(run, hooke_option(run, "watch", NULL), HOOKE_BAD_PARAM, "option of the command line");
  expect(run, hooke_option(run, "port", "3"), HOOKE_BAD_PARAM, "option of the command line");
  expect(run, hooke_parameter(run, "--dt", "1"), HOOKE_BAD_PARAM, "no name of a parameter");
  expect(run, hooke_parameter(run, "a=b", "1"), HOOKE_BAD_PARAM, "an argument of its own");
  expect(run, hooke_parameter(run, "a", NULL), HOOKE_BAD_PARAM, "is NULL");
  expect(run, hooke_advance(run, 1), HOOKE_BAD_PARAM, "hooke_open comes first");
  expect(run, hooke_finish(run), HOOKE_BAD_PARAM, "hooke_open comes first");
  expect(run, hooke_checkpoint(run, "x"), HOOKE_BAD_PARAM, "no scene has been opened");
  check(!hooke_positions(run) && !hooke_summary(run) && !hooke_parameters(run) && hooke_count(run) == 0 &&
            isnan(hooke_time(run)),
        "there is nothing to look at before hooke_open");
  hooke_free(run);
}

static void opening(const char *name, const char *value, const char *text, hooke_status wanted, const char *sentence) {
  hooke_run *run = hooke_new();
  hooke_status status = name ? hooke_parameter(run, name, value) : HOOKE_OK;
  if (status == HOOKE_OK) status = hooke_open_text(run, "ball.lua", text);
  expect(run, status, wanted, sentence);
  expect(run, hooke_advance(run, 1), HOOKE_BAD_PARAM, "the run has ended");
  hooke_free(run);
}

static void scenes(void) {
  hooke_run *run = hooke_new();
  expect(run, hooke_open(run, "no/such.lua"), HOOKE_IO, "cannot read the scene no/such.lua");
  hooke_free(run);
  opening("z", "-1", ball, HOOKE_BAD_PARAM, "-1 is below the minimum 0");
  opening("y", "1", ball, HOOKE_BAD_PARAM, "'y'");
  opening(NULL, NULL, "return 1 +", HOOKE_SCRIPT, "ball.lua:1");
  opening(NULL, NULL, "", HOOKE_SCRIPT, "returned no scene");
  opening(NULL, NULL, "return hooke.scene {}", HOOKE_BAD_PARAM, "the scene is empty");
}

/* Calls of a frame function that would take the run along. */
static void meddle(hooke_run *run, void *context) {
  int *frames = context;
  expect(run, hooke_advance(run, 1), HOOKE_BAD_PARAM, "the run is taking steps");
  expect(run, hooke_finish(run), HOOKE_BAD_PARAM, "the run is taking steps");
  expect(run, hooke_checkpoint(run, "x"), HOOKE_BAD_PARAM, "the run is taking steps");
  if (++*frames == 4) hooke_stop(run);
}

static void running(void) {
  struct sigaction before, after;
  int frames = 0;
  size_t size;
  sigaction(SIGINT, NULL, &before);
  fesetround(FE_UPWARD);
  hooke_run *run = hooke_new();
  hooke_on_frame(run, meddle, &frames);
  expect(run, hooke_open_text(run, NULL, ball), HOOKE_OK, "taking steps"); /* by the frame 0 */
  expect(run, hooke_parameter(run, "z", "1"), HOOKE_BAD_PARAM, "has been opened");
  expect(run, hooke_open_text(run, NULL, ball), HOOKE_BAD_PARAM, "has been opened");
  expect(run, hooke_advance(run, NAN), HOOKE_BAD_PARAM, "no number");
  const double *heat = hooke_channel(run, "heat", &size);
  check(heat && size == 1 && *heat == 7 && !hooke_channel(run, "cold", &size) && size == 0, "channels by their names");
  check(!hooke_measure_name(run, 1) && strcmp(hooke_measure_name(run, 0), "z") == 0, "measures end with NULL");
  check(strstr(hooke_parameters(run), "{\"parameters\":[{\"name\":\"z\",") != NULL, "the scene declares z");
  expect(run, hooke_finish(run), HOOKE_INTERRUPTED, "");
  check(frames == 4 && strcmp(hooke_verdict(run), "interrupted") == 0, "hooke_stop ends the run at its next step");
  hooke_free(run);
  check(fegetround() == FE_UPWARD, "the rounding mode is the program's");
  sigaction(SIGINT, NULL, &after);
  check(before.sa_handler == after.sa_handler, "SIGINT is the program's");
}

/* z - g/2 after a second, exact for leapfrog but for rounding, whichever way the program rounds, and in one go or two.
 */
static void rounding(void) {
  double z[2];
  for (int k = 0; k < 2; k++) {
    fesetround(k ? FE_DOWNWARD : FE_TONEAREST);
    hooke_run *run = hooke_new();
    hooke_open_text(run, NULL, ball);
    if (k) expect(run, hooke_advance(run, 0.5), HOOKE_OK, "");
    expect(run, hooke_finish(run), HOOKE_OK, "");
    check(strcmp(hooke_verdict(run), "ok") == 0, "a ball that falls is ok");
    z[k] = hooke_positions(run)[2];
    hooke_free(run);
  }
  fesetround(FE_TONEAREST);
  check(fabs(z[0] - (9 - 9.81 / 2)) < 1e-9 && fabs(z[0] - z[1]) < 1e-12, "the ball falls by g/2");
}

int main(void) {
  descriptions();
  scenes();
  running();
  rounding();
  hooke_free(NULL);
  return failures > 0;
}
