/* Gas in pictures: what comes through smoke is what Beer's and Lambert's law says, the lamp's light fades likewise, hot
 * gas is red, and what stands before the smoke hides it. */
#include "plugins/common/volume/volume.h"
#include "tests/support/solver_matrix.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { CELLS = 8, SIDE = CELLS + 2, SIZE = SIDE * SIDE * SIDE, WIDTH = 9 };

typedef struct fixture {
  test_solver s; /* its host */
  double smoke[SIZE], heat[SIZE];
  float distance[WIDTH * WIDTH];
  hk_volume volume;
  hk_volume_optics optics;
  hk_view_setup setup;
  hk_volume_draw draw;
} fixture;

/* A cube of 1 m full of smoke, seen from 100 m away, so that rays are parallel. */
static fixture *open_fixture(double smoke, double heat) {
  fixture *f = calloc(1, sizeof *f);
  assert_non_null(f);
  test_solver_open(&f->s, "pcg", 2);
  for (size_t i = 0; i < SIZE; i++) f->smoke[i] = smoke, f->heat[i] = heat;
  for (size_t k = 0; k < WIDTH * WIDTH; k++) f->distance[k] = INFINITY;
  f->volume = (hk_volume){.cells = {CELLS, CELLS, CELLS},
                          .stride = {1, SIDE, SIDE * SIDE},
                          .size = SIZE,
                          .smoke = f->smoke,
                          .heat = f->heat,
                          .ambient = 300};
  for (int c = 0; c < 3; c++) f->volume.spacing[c] = 1.0 / CELLS;
  f->optics.extinction = 1000;
  f->setup.camera = (hk_camera){{0.5, -100, 0.5}, {0.5, 0.5, 0.5}, 0.02, 1, 1, 1000};
  f->draw = (hk_volume_draw){&f->s.solver->host,   &f->volume, &f->optics, &f->setup, {0}, {0, 0, 1}, WIDTH, WIDTH,
                             {0, 0, WIDTH, WIDTH}, f->distance};
  return f;
}

static void close_fixture(fixture *f) {
  test_solver_close(&f->s);
  free(f);
}

static double linear(int byte) {
  double c = byte / 255.0;
  return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

/* The pixel in the middle over a background of that grey. */
static void pixel(fixture *f, int grey, unsigned char found[4]) {
  unsigned char rgba[4 * WIDTH * WIDTH];
  memset(rgba, grey, sizeof rgba);
  assert_int_equal(hk_volume_draw_on(&f->draw, rgba), HK_OK);
  memcpy(found, rgba + 4 * (WIDTH * WIDTH / 2), 4);
}

/* What it adds to grey and to black is the same: the difference is what comes through. A byte is 0.4 %. */
static void what_comes_through_is_beers_and_lamberts(void **state) {
  (void)state;
  fixture *f = open_fixture(1e-3, 0);
  unsigned char grey[4], black[4];
  pixel(f, 128, grey);
  pixel(f, 0, black);
  double part = (linear(grey[0]) - linear(black[0])) / linear(128);
  if (!(fabs(part - exp(-1)) < 0.03)) fail_msg("%.4f instead of %.4f", part, exp(-1));
  close_fixture(f);
}

static void what_is_nearer_hides_it(void **state) {
  (void)state;
  fixture *f = open_fixture(1e-3, 0);
  unsigned char found[4];
  for (size_t k = 0; k < WIDTH * WIDTH; k++) f->distance[k] = 99;
  pixel(f, 128, found);
  assert_int_equal(found[0], 128);
  close_fixture(f);
}

/* Downwards from the top, where the lamp is; a piece of a cell is left out or counted twice: 1/8 of the depth. */
static void the_lamps_light_fades_in_smoke(void **state) {
  (void)state;
  fixture *f = open_fixture(1e-3, 0);
  double light[SIZE];
  hk_volume_light(&f->draw, light);
  for (size_t k = 0; k < CELLS; k++) {
    double depth = 1 - ((double)k + 0.5) / CELLS, found = -log(light[4 + 4 * SIDE + (k + 1) * SIDE * SIDE]);
    if (!(fabs(found - depth) < 0.13)) fail_msg("depth %.4f instead of %.4f", found, depth);
  }
  close_fixture(f);
}

/* Wien's law: at 1300 K there is less green than red, and less blue; at 2000 K, of which glow is the light, none is. */
static void hot_gas_glows_by_its_temperature(void **state) {
  (void)state;
  fixture *f = open_fixture(0, 1000);
  unsigned char found[4];
  f->optics.glow = 50;
  pixel(f, 0, found);
  assert_true(found[0] > found[1] && found[1] > found[2]);
  for (size_t i = 0; i < SIZE; i++) f->heat[i] = 1700;
  f->optics.glow = 0.5;
  pixel(f, 0, found);
  for (int c = 0; c < 3; c++)
    if (!(fabs(linear(found[c]) - 0.5) < 0.01)) fail_msg("%g", linear(found[c]));
  close_fixture(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_comes_through_is_beers_and_lamberts),
      cmocka_unit_test(what_is_nearer_hides_it),
      cmocka_unit_test(the_lamps_light_fades_in_smoke),
      cmocka_unit_test(hot_gas_glows_by_its_temperature),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
