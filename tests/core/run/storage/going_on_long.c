/* A run that was interrupted after any number of steps and goes on from what its output `checkpoint` left ends in the
 * very bits of the run that was not: for every integrator of the folder, on scenes that between them have pins of all
 * kinds, timed forces, damping, channels, a corrector, a source, contact, neighbours and constraints, and whatever the
 * number of threads. Each run is interrupted at three places; under sanitizers, which look for other faults than bits
 * that differ, at one, which is another for the next method. */
#include "tests/fixtures/looker.h"
#include "tests/support/command.h"
#include "tests/support/engine.h"
#include "tests/support/melting.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 5, EVERY = 3, MOST_STEPS = 12000 };

static const double end = 0.5, fps = 20;

static char methods[64][64];
static size_t method_count;

static int list_methods(void **state) {
  (void)state;
  DIR *folder = opendir(HK_BUILD "/plugins/integrators");
  for (struct dirent *entry; folder && (entry = readdir(folder));) {
    size_t length = strlen(entry->d_name);
    if (length < 4 || length > 60 || strcmp(entry->d_name + length - 3, ".so") != 0) continue;
    memcpy(methods[method_count], entry->d_name, length - 3);
    methods[method_count++][length - 3] = 0;
  }
  if (folder) closedir(folder);
  return method_count >= 9 ? 0 : -1;
}

/* ---- scenes ---- */

/* x = 0.05 sin 9t, with no velocity: it is found by differences. */
static hk_status sway(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out, size_t most,
                      size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)most, (void)error;
  out[0] = 0.05 * sin(9 * *in);
  out[1] = out[2] = 0;
  *n_out = 3;
  return HK_OK;
}

static void net(test_engine *e) {
  uint32_t edge[2 * SIDE * SIDE][2], path = 1;
  size_t edges = 0;
  for (uint32_t k = 0; k < SIDE * SIDE; k++) {
    test_particle(e, 0.2 * (k % SIDE), 0.2 * (k / SIDE) + 0.01 * (k % 3), 0.01 * (k % 7), 0.02 + 0.003 * (k % 5));
    if (k % SIDE) edge[edges][0] = k, edge[edges++][1] = k + 1;
    if (k >= SIDE) edge[edges][0] = k + 1 - SIDE, edge[edges++][1] = k + 1;
  }
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, edges);
  test_number(e, springs, "k", 200);
  test_number(e, springs, "rest", 0.19);
  test_number(e, springs, "damping", 0.01);
  hk_pin_spec moved = {.kind = HK_PIN_PATH, .count = 1, .id = &path, .release = 0.37, .path = {.call = sway}};
  moved.rotation = moved.path;
  moved.center[1] = 1;
  assert_int_equal(hk_scene_add_pin(e->scene, &moved, &e->error), HK_OK);
  test_pin(e, HK_PIN_FIXED, SIDE, NULL);
  test_pin(e, HK_PIN_LINE, SIDE * SIDE, (const double[]){0.48, 0.6, 0.64}); /* no axis: projections are rounded */
  test_pin(e, HK_PIN_PLANE, SIDE * SIDE - 3, (const double[]){0.64, 0.48, 0.6});
}

static void pinned_and_timed(test_engine *e) {
  net(e);
  test_plugin(e, HK_FORCE, "gravity")->from = 0.11;
  hk_plugin_spec *drag = test_plugin(e, HK_FORCE, "drag");
  test_number(e, drag, "rate", 0.5);
  drag->to = 0.31;
}

static void with_channels(test_engine *e) {
  assert_int_equal(hk_scene_add_channel(e->scene, "heat", 1, (const double[]){3}, -2, NULL, &e->error), HK_OK);
  net(e);
  test_plugin(e, HK_FORCE, "gravity");
}

static void corrected(test_engine *e) {
  net(e);
  test_plugin(e, HK_FORCE, "gravity");
  test_number(e, test_plugin(e, HK_CORRECTOR, "fixture:floor"), "height", -0.3);
}

static void fed(test_engine *e) {
  net(e);
  hk_plugin_spec *source = test_plugin(e, HK_SOURCE, "fixture:spout");
  test_number(e, source, "every", 0.06);
  test_number(e, source, "lifetime", 0.14);
  test_vector(e, source, "position", 3, 3, 3);
}

/* Drops that cool, rise and burst on a tilted plate. */
static void sprayed(test_engine *e) {
  const double air = 293;
  assert_int_equal(hk_scene_add_channel(e->scene, "temperature", 1, &air, 0, NULL, &e->error), HK_OK);
  net(e);
  hk_plugin_spec *source = test_plugin(e, HK_SOURCE, "emitter");
  test_number(e, source, "rate", 130);
  test_number(e, source, "lifetime", 0.21);
  test_number(e, source, "mass", 0.01);
  test_number(e, source, "cone", 30);
  test_text(e, source, "channel", "temperature");
  test_number(e, source, "amount", 350);
  test_vector(e, source, "position", 0.2, 2, 1);
  test_vector(e, source, "direction", 0, 0, -1);
  hk_plugin_spec *cools = test_plugin(e, HK_FORCE, "relax");
  test_text(e, cools, "channel", "temperature");
  test_number(e, cools, "rate", 2);
  test_list(e, cools, "target", &air, 1);
  test_plugin(e, HK_FORCE, "buoyancy");
  hk_plugin_spec *plate = test_plugin(e, HK_CORRECTOR, "obstacle");
  test_text(e, plate, "shape", "box");
  test_vector(e, plate, "size", 0.6, 0.6, 0.1);
  test_vector(e, plate, "position", 0.2, 2, 0.8);
  test_vector(e, plate, "rotation", 0, 0.4, 0);
  test_number(e, plate, "restitution", 0.6);
  test_number(e, plate, "friction", 0.2);
}

/* Grains that lean on each other: how far each pair has slipped is part of the state. */
static void poured(test_engine *e) {
  for (int k = 0; k < 12; k++) test_particle(e, 0.03 * (k % 2), 0.02 * (k % 3), 0.1 + 0.19 * k, 0.1);
  hk_plugin_spec *grains = test_plugin(e, HK_FORCE, "soft_spheres"), *walls = test_plugin(e, HK_FORCE, "soft_walls");
  hk_plugin_spec *both[] = {grains, walls};
  for (int k = 0; k < 2; k++) {
    test_number(e, both[k], "radius", 0.1);
    test_number(e, both[k], "stiffness", 200);
    test_number(e, both[k], "friction", 0.4);
    test_number(e, both[k], "restitution", 0.5);
  }
  test_plugin(e, HK_FORCE, "gravity");
}

static void attracted(test_engine *e) {
  for (int k = 0; k < 64; k++) test_particle(e, k % 4 + 0.01 * k, k / 4 % 4, k / 16 - 0.02 * k, 1);
  hk_plugin_spec *bodies = test_plugin(e, HK_FORCE, "nbody");
  test_text(e, bodies, "method", "tree");
  test_number(e, bodies, "softening", 0.1);
  test_number(e, bodies, "G", 1);
}

static void touching(test_engine *e) {
  for (int k = 0; k < 4; k++) test_particle(e, 0.02 * k, 0, 0.106 + 0.22 * k, 0.1);
  hk_plugin_spec *spheres = test_plugin(e, HK_FORCE, "fixture:barrier_spheres");
  test_boolean(e, spheres, "floor", true);
  test_boolean(e, spheres, "cautious", true);
  test_plugin(e, HK_FORCE, "gravity");
}

static void crowded(test_engine *e) {
  for (int k = 0; k < 27; k++) test_particle(e, 1.15 * (k % 3), 1.15 * (k / 3 % 3), 1.2 * (k / 9) + 0.01 * k, 1);
  test_plugin(e, HK_FORCE, "fixture:lennard_jones");
}

static void barred(test_engine *e) {
  net(e);
  test_plugin(e, HK_FORCE, "gravity");
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "fixture:bar"), (const uint32_t[][2]){{7, 13}, {13, 19}}, 2);
}

static void on_the_ground(test_engine *e) {
  net(e);
  test_plugin(e, HK_FORCE, "gravity");
  hk_plugin_spec *ground = test_plugin(e, HK_CONSTRAINT, "fixture:ground");
  test_list(e, ground, "particles", (const double[]){8, 13, 18}, 3);
  test_vector(e, ground, "normal", 0, 0, 1);
  test_number(e, ground, "height", -0.02);
}

/* A curled rod, a ribbon twisted between clamps one of which moves, and a twisted ring: frames and angles are kept. */
static void twisted(test_engine *e) {
  enum { LONG = 9 };
  uint32_t edge[3 * LONG][2], edges = 0, path[2];
  for (uint32_t k = 0; k < 3 * LONG; k++) {
    uint32_t rod = k / LONG, j = k % LONG, first = rod * LONG + 1;
    double angle = 2 * 3.14159265358979323846 * j / LONG;
    test_particle(e, rod < 2 ? 0.1 * j : 0.2 * cos(angle),
                  0.5 * rod + (rod < 2 ? 0.02 * sin(1.9 * j) : 0.2 * sin(angle)), 0.02 * cos(1.3 * j),
                  0.01 + 0.001 * j);
    if (j + 1 < LONG || rod == 2) edge[edges][0] = k + 1, edge[edges++][1] = j + 1 < LONG ? k + 2 : first;
  }
  for (uint32_t k = 0; k < 2; k++)
    test_pin(e, HK_PIN_FIXED, k + 1, NULL), test_pin(e, HK_PIN_FIXED, LONG + k + 1, NULL);
  path[0] = 2 * LONG - 1, path[1] = 2 * LONG;
  hk_pin_spec moved = {.kind = HK_PIN_PATH, .count = 2, .id = path, .release = 0.37, .path = {.call = sway}};
  assert_int_equal(hk_scene_add_pin(e->scene, &moved, &e->error), HK_OK);
  hk_plugin_spec *rods = test_plugin(e, HK_FORCE, "rods"), *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, rods, (const uint32_t(*)[2])edge, edges);
  test_number(e, rods, "EI", 1e-3);
  test_number(e, rods, "EI2", 3e-3);
  test_number(e, rods, "GJ", 1e-3);
  test_number(e, rods, "turn", 5);
  test_edges(e, springs, (const uint32_t(*)[2])edge, edges);
  test_number(e, springs, "k", 300);
  test_plugin(e, HK_FORCE, "gravity");
  double spin[LONG - 1]; /* the first rod is a ribbon as well, whose angles are particles */
  for (uint32_t k = 0; k + 1 < LONG; k++) {
    spin[k] = test_particle(e, 0.01 * k, 2, 0, 0.02);
    test_pin(e, HK_PIN_LINE, (uint32_t)spin[k], (const double[]){1, 0, 0});
  }
  hk_plugin_spec *ribbon = test_plugin(e, HK_FORCE, "rods");
  test_edges(e, ribbon, (const uint32_t(*)[2])edge, LONG - 1);
  test_number(e, ribbon, "EI", 1e-3);
  test_number(e, ribbon, "EI2", 2e-3);
  test_number(e, ribbon, "GJ", 1e-3);
  test_list(e, ribbon, "spins", spin, LONG - 1);
  test_number(e, ribbon, "radius", 0.1);
}

/* Sheets and bars that are gone leave surfaces and equations, at the interruption as before. */
static void molten(test_engine *e) {
  melting_sheet(e, "melting_membrane", 260, 15);
  melting_warms(e, 30);
  test_plugin(e, HK_FORCE, "gravity");
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *bars = test_plugin(e, HK_CONSTRAINT, "melting_bars");
  test_edges(e, bars, (const uint32_t[][2]){{1, 7}, {7, 13}, {13, 19}}, 3);
  test_text(e, bars, "channel", "temperature"), test_number(e, bars, "melts", 262);
}

typedef struct scene_case {
  const char *name;
  void (*make)(test_engine *);
} scene_case;

static const scene_case scenes[] = {{"pinned and timed", pinned_and_timed},
                                    {"channels", with_channels},
                                    {"corrected", corrected},
                                    {"fed", fed},
                                    {"sprayed", sprayed},
                                    {"poured", poured},
                                    {"attracted", attracted},
                                    {"touching", touching},
                                    {"crowded", crowded},
                                    {"barred", barred},
                                    {"on the ground", on_the_ground},
                                    {"twisted", twisted},
                                    {"molten", molten}};

enum { SCENES = sizeof scenes / sizeof *scenes };

/* ---- runs ---- */

typedef struct outcome {
  hk_status status;
  double *X;
  size_t size, steps;
  hk_summary summary;
  char error[1024];
} outcome;

static void open_engine(test_engine *e, const scene_case *scene, const char *method, const char *folder) {
  test_engine_open(e);
  e->scene->duration = end;
  e->scene->fps = fps;
  e->scene->tol = 1e-3;
  scene->make(e);
  test_plugin(e, HK_INTEGRATOR, method);
  test_number(e, test_plugin(e, HK_OUTPUT, "checkpoint"), "every", EVERY);
  e->options.no_output = false;
  e->options.out = folder;
}

/* Runs to the end, or for so many steps. */
static outcome run(test_engine *e, size_t steps) {
  outcome o = {0};
  e->options.step_limit = steps;
  o.status = hk_run_open(e->scene, &e->options, &e->run, &e->error);
  if (o.status == HK_OK) o.status = hk_run_advance(e->run, end, &e->error);
  snprintf(o.error, sizeof o.error, "%s", e->error.text);
  hk_error later = {0};
  if (e->run && hk_run_close(e->run, &later) != HK_OK) fail_msg("%s", later.text);
  if (!e->run) return o;
  hk_run_summary(e->run, &o.summary);
  o.size = e->run->state.size;
  o.steps = e->run->record.steps;
  o.X = malloc(o.size * sizeof *o.X);
  assert_non_null(o.X);
  memcpy(o.X, e->run->state.X, o.size * sizeof *o.X);
  return o;
}

static void same_end(const outcome *a, const outcome *b, const char *what) {
  if (b->status != HK_OK) fail_msg("%s: %s", what, b->error);
  if (a->size != b->size || memcmp(a->X, b->X, a->size * sizeof *a->X) != 0) {
    size_t k = 0;
    while (k < a->size && k < b->size && a->X[k] == b->X[k]) k++;
    fail_msg("%s: number %zu of %zu differs: %.17g, gone on %.17g", what, k, a->size, a->X[k], b->X[k]);
  }
  const hk_summary *p = &a->summary, *q = &b->summary;
  if (p->verdict != q->verdict || p->steps != q->steps || p->force_evaluations != q->force_evaluations ||
      p->energy_last != q->energy_last || p->energy_work != q->energy_work || p->frames != q->frames)
    fail_msg("%s: not judged as a whole: steps %zu, %zu; evaluations %zu, %zu; energy %.17g, %.17g", what, p->steps,
             q->steps, p->force_evaluations, q->force_evaluations, p->energy_last, q->energy_last);
}

/* Interrupts after that many steps, goes on; false: there was no checkpoint yet. */
static bool go_on(const scene_case *scene, const char *method, const outcome *whole, size_t steps, int threads) {
  char folder[512], file[600], what[256];
  test_engine first, second;
  snprintf(folder, sizeof folder, "%s/%.63s", test_folder(), method);
  snprintf(file, sizeof file, "%s/newest.checkpoint", folder);
  snprintf(what, sizeof what, "%s, %.63s, stopped after %zu of %zu steps, %d threads", scene->name, method, steps,
           whole->steps, threads);
  open_engine(&first, scene, method, folder);
  outcome part = run(&first, steps);
  if (part.status != HK_INTERRUPTED) fail_msg("%s: %s", what, part.error);
  test_engine_close(&first);
  free(part.X);
  FILE *there = fopen(file, "rb");
  if (!there) return false;
  fclose(there);
  open_engine(&second, scene, method, folder);
  second.options.resume = file;
  second.options.threads = threads;
  outcome rest = run(&second, 0);
  same_end(whole, &rest, what);
  test_engine_close(&second);
  free(rest.X);
  return true;
}

/* What outputs are told at the last frame of the run: its error and its last step. resume NULL: from the start. */
static looker last_frame(size_t steps, const char *resume, size_t *taken) {
  static const scene_case scene = {"pinned_and_timed", pinned_and_timed};
  static looker seen;
  char folder[512];
  test_engine e;
  snprintf(folder, sizeof folder, "%s/frames", test_folder());
  open_engine(&e, &scene, "dopri5", folder);
  const hk_plugin_spec *spec = test_plugin(&e, HK_OUTPUT, "fixture:looker");
  e.options.resume = resume;
  outcome o = run(&e, steps);
  if (o.status != HK_OK && o.status != HK_INTERRUPTED) fail_msg("%s", o.error);
  seen = *(const looker *)test_instance(&e, spec)->self;
  *taken = o.steps;
  test_engine_close(&e);
  free(o.X);
  return seen;
}

/* Interrupted between two frames, it still tells the largest estimate since the frame before. */
static void frames_after_it_are_told_what_was_before_it(void **state) {
  (void)state;
  char file[600];
  size_t steps, ignored;
  looker whole = last_frame(0, NULL, &steps);
  assert_true(whole.error > 0);
  snprintf(file, sizeof file, "%s/frames/newest.checkpoint", test_folder());
  for (size_t k = 1; k <= 3; k++) {
    last_frame(steps - k, NULL, &ignored);
    looker rest = last_frame(0, file, &ignored);
    assert_true(rest.error == whole.error && rest.step == whole.step);
  }
}

static void a_run_that_goes_on_ends_in_the_same_bits(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  const bool sanitized = strstr(HK_BUILD, "sanitize") != NULL;
  size_t pairs = 0, gone_on = 0, tries = 0;
  for (size_t s = 0; s < SCENES; s++)
    for (size_t m = 0; m < method_count; m++) {
      test_engine e;
      char folder[512];
      snprintf(folder, sizeof folder, "%s/whole", test_folder());
      open_engine(&e, &scenes[s], methods[m], folder);
      outcome whole = run(&e, MOST_STEPS);
      bool takes = whole.status == HK_OK;
      test_engine_close(&e);
      for (size_t k = 1; takes && k <= 3; k++) {
        if (sanitized && k != 1 + (s + m) % 3) continue;
        gone_on += go_on(&scenes[s], methods[m], &whole, (whole.steps - 1) * k / 4 + 1, threads[k - 1]);
        tries++;
      }
      pairs += takes;
      if (!takes) print_message("%s, %s: %s\n", scenes[s].name, methods[m], whole.error);
      free(whole.X);
    }
  print_message("%zu pairs of scene and method; %zu of %zu interrupted runs went on\n", pairs, gone_on, tries);
  assert_true(pairs > SCENES * method_count * 3 / 4);
  assert_true(gone_on > tries * 2 / 3); /* the others were stopped before their first point */
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(frames_after_it_are_told_what_was_before_it),
                                     cmocka_unit_test(a_run_that_goes_on_ends_in_the_same_bits)};
  return cmocka_run_group_tests(tests, list_methods, NULL);
}
