/* A pendulum by libhooke: a scene in memory, a parameter, an option, its positions frame by frame, its verdict.
 * cc pendulum.c $(pkg-config --cflags --libs libhooke) */
#include <hooke.h>

#include <math.h>
#include <stdio.h>

static const char scene[] = "local length = param('length', 1, 'm', { min = 0.1, max = 10 })\n"
                            "local scene = hooke.scene { duration = 2, fps = 50 }\n"
                            "local hook = scene:particle { position = { 0, 0, 0 }, mass = 1 }\n"
                            "local bob = scene:particle { position = { 0.01 * length, 0, -length }, mass = 1 }\n"
                            "scene:pin(hook)\n"
                            "scene:force('gravity', {})\n"
                            "scene:constraint('bars', { edges = { { hook, bob } } })\n"
                            "scene:measure('height', function(s) return s:position(bob)[3] end)\n"
                            "return scene\n";

/* s, when the bob, row 1, first passed below the hook; between two frames on a straight line. */
typedef struct passage {
  double time, before, at;
} passage;

static void look(hooke_run *run, void *context) {
  passage *first = context;
  double x = hooke_positions(run)[3 * 1], t = hooke_time(run);
  if (t > 0 && first->before > 0 && x <= 0 && !(first->time > 0))
    first->time = first->at + (t - first->at) * first->before / (first->before - x);
  first->before = x;
  first->at = t;
}

int main(void) {
  passage first = {0};
  hooke_run *run = hooke_new();
  hooke_on_frame(run, look, &first);
  if (hooke_parameter(run, "length", "0.5") != HOOKE_OK || hooke_option(run, "accuracy", "1e-5") != HOOKE_OK ||
      hooke_open_text(run, "pendulum.lua", scene) != HOOKE_OK || hooke_finish(run) != HOOKE_OK) {
    fprintf(stderr, "%s\n", hooke_error(run));
    hooke_free(run);
    return 1;
  }
  double quarter = acos(-1) / 2 * sqrt(0.5 / 9.81); /* s, of small swings, which are 2.5e-5 faster than these at most */
  printf("below the hook at %.6f s, a quarter of small swings is %.6f s; %s at %g s, height %.6f m\n", first.time,
         quarter, hooke_verdict(run), hooke_time(run), hooke_measure(run, 0));
  hooke_free(run);
  return fabs(first.time / quarter - 1) < 1e-3 ? 0 : 1;
}
