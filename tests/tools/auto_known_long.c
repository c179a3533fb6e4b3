/* --integrator auto on scenes whose best kind of method theory knows: of high order for an undamped orbit and a small
 * error, implicit where a fast mode is damped away or no step could follow the stiffness, explicit for a soft cloth,
 * with short steps for a few stiff springs alone. The choice rests on a clock, which a busy or halted machine can make
 * wrong for a moment: a choice that is not the known one is measured again, twice. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* The plain run has all of it; the two largest scenes take minutes under sanitizers, by which the methods' times are
 * not those of hooke. */
static void leave_to_the_plain_run(void) {
  if (strstr(HK_BUILD, "sanitize")) skip();
}

typedef struct choice {
  char name[64];
  char said[1 << 14];
} choice;

static choice ask_once(const char *arguments) {
  static test_result r;
  choice c = {.name = ""};
  char command[512];
  snprintf(command, sizeof command, "auto %s --again --budget 60",
           arguments); /* under sanitizers all takes ten times as long */
  test_hooke(&r, "XDG_CACHE_HOME=cache", command);
  snprintf(c.said, sizeof c.said, "%s", r.err);
  if (r.code != 0 || sscanf(r.err, "hooke: auto: %63[a-z0-9_]", c.name) != 1)
    fail_msg("exit %d: %s%s", r.code, r.out, r.err);
  return c;
}

static bool is_one_of(const choice *c, const char *names) {
  char name[80], list[512];
  snprintf(name, sizeof name, " %s ", c->name);
  snprintf(list, sizeof list, " %s ", names);
  return strstr(list, name) != NULL;
}

enum { TRIES = 3 };

/* The choice has to be among `names`, or, without `wanted`, not to be. */
static void ask(const char *arguments, const char *names, bool wanted) {
  choice c = {.name = ""};
  for (int k = 0; k < TRIES && (k == 0 || is_one_of(&c, names) != wanted); k++) c = ask_once(arguments);
  if (is_one_of(&c, names) != wanted) fail_msg("%s is %s of '%s': %s", c.name, wanted ? "none" : "one", names, c.said);
}

static const char implicit[] =
    "backward_euler implicit_midpoint implicit_trapezoid bdf2 linear_bdf2 tr_bdf2 esdirk4 cvode "
    "arkode imex baraff_witkin local_global xpbd";
static const char second_order[] = "leapfrog local_leapfrog symplectic_euler stoermer_wide2 midpoint trapezoid";

static const char low_order[] =
    "euler backward_euler desbrun baraff_witkin local_global xpbd imex bdf2 linear_bdf2 tr_bdf2 "
    "implicit_midpoint implicit_trapezoid leapfrog local_leapfrog symplectic_euler "
    "stoermer_wide2 midpoint trapezoid";

/* Nine turns to 1e-9 m: order 2 needs some 1e5 steps for each. */
static void an_orbit_to_nine_digits_takes_a_high_order(void **state) {
  (void)state;
  test_write("orbit.lua", "local scene = hooke.scene { duration = 10, fps = 10 }\n"
                          "scene:particle { position = { 1, 0, 0 }, velocity = { 0, 5, 0 }, mass = 1 }\n"
                          "scene:force('central', { strength = 30 })\nreturn scene\n");
  ask("orbit.lua --accuracy 1e-9", low_order, false);
}

/* A rope of springs so stiff that a leapfrog step is 3e-7 s, which swings in 1 s. */
static void a_nearly_rigid_rope_takes_an_implicit_method(void **state) {
  (void)state;
  test_write("rope.lua", "local scene = hooke.scene { duration = 0.2, fps = 50 }\n"
                         "local rope = scene:strand { n = 12, from = { 0, 0, 0 }, to = { 1, 0, 0 }, mass = 0.1 }\n"
                         "scene:pin { rope:at(1) }\nscene:force('gravity')\nscene:force('drag', { rate = 0.5 })\n"
                         "scene:force('springs', { edges = rope:edges(), k = 1e10, damping = 100 })\nreturn scene\n");
  ask("rope.lua --accuracy 1e-3", implicit, true);
}

/* Dampers of a rate of 1e6/s join particles that otherwise move slowly. */
static void strong_dampers_take_an_implicit_method(void **state) {
  (void)state;
  test_write("dampers.lua", "local scene = hooke.scene { duration = 0.5, fps = 20 }\n"
                            "local rope = scene:strand { n = 10, from = { 0, 0, 0 }, to = { 1, 0, 0 }, mass = 0.1 }\n"
                            "scene:pin { rope:at(1), rope:at(10) }\nscene:force('gravity')\n"
                            "scene:force('springs', { edges = rope:edges(), k = 100, damping = 1e4 })\nreturn scene\n");
  ask("dampers.lua --accuracy 1e-4", implicit, true);
}

static void a_soft_cloth_takes_an_explicit_method_of_order_2(void **state) {
  (void)state;
  leave_to_the_plain_run();
  ask(HK_ROOT "/scripts/scenes/curtain.lua N=16 --until 0.2 --accuracy 1e-4", second_order, true);
}

/* 1 % of the springs are 1,000 times stiffer: their short steps cost little, those of the rest would be 30 times as
 * many. */
static void a_few_stiff_springs_take_short_steps_of_their_own(void **state) {
  (void)state;
  leave_to_the_plain_run();
  test_write("mixed.lua", "local scene = hooke.scene { duration = 0.2, fps = 50 }\n"
                          "local cloth = scene:grid { nx = 40, ny = 40, width = 1, height = 1, mass = 0.15 }\n"
                          "local row, stiff = {}, {}\nfor i = 1, 40 do row[i] = cloth:at(i, 40) end\nscene:pin(row)\n"
                          "for k = 1, 20 do stiff[k] = { cloth:at(2 * k - 1, k), cloth:at(2 * k, k) } end\n"
                          "scene:force('gravity')\nscene:force('drag', { rate = 0.02 })\n"
                          "scene:force('springs', { edges = cloth:structural(), k = 1000 })\n"
                          "scene:force('springs', { edges = cloth:shear(), k = 300 })\n"
                          "scene:force('springs', { edges = stiff, k = 1e6 })\nreturn scene\n");
  ask("mixed.lua --until 0.1 --accuracy 1e-5", "local_leapfrog", true);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_orbit_to_nine_digits_takes_a_high_order),
      cmocka_unit_test(a_nearly_rigid_rope_takes_an_implicit_method),
      cmocka_unit_test(strong_dampers_take_an_implicit_method),
      cmocka_unit_test(a_soft_cloth_takes_an_explicit_method_of_order_2),
      cmocka_unit_test(a_few_stiff_springs_take_short_steps_of_their_own),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
