/* Normals at corners: sharp at creases, smooth on what is round. */
#include "plugins/common/normals/corner_normals.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

static void *allocate(const hk_host *host, size_t bytes) {
  (void)host;
  return malloc(bytes);
}

static void release(const hk_host *host, void *memory) {
  (void)host;
  free(memory);
}

static double cosine(const float a[3], const double b[3]) {
  double dot = 0, length = 0, other = 0;
  for (int c = 0; c < 3; c++) dot += (double)a[c] * b[c], length += (double)(a[c] * a[c]), other += b[c] * b[c];
  return dot / sqrt(length * other);
}

enum { SIDES = 24, RINGS = 2 };

/* A cylinder about z with a lid: sides are turned by 15 degrees from each other, the lid by 90 from them. */
static void corners_are_round_about_a_cylinder_and_sharp_at_its_lid(void **state) {
  (void)state;
  float x[RINGS * SIDES + 1][3] = {{0}};
  uint32_t face[3 * SIDES][3];
  for (uint32_t k = 0; k < SIDES; k++) {
    double angle = 2 * acos(-1) * k / SIDES;
    uint32_t next = (k + 1) % SIDES;
    for (uint32_t r = 0; r < RINGS; r++)
      x[r * SIDES + k][0] = (float)cos(angle), x[r * SIDES + k][1] = (float)sin(angle), x[r * SIDES + k][2] = (float)r;
    uint32_t faces[3][3] = {
        {k, next, SIDES + next}, {k, SIDES + next, SIDES + k}, {SIDES + k, SIDES + next, RINGS * SIDES}};
    for (int f = 0; f < 3; f++)
      for (int i = 0; i < 3; i++) face[3 * k + (uint32_t)f][i] = faces[f][i];
  }
  x[RINGS * SIDES][2] = 1;
  hk_host host = {.allocate = allocate, .release = release};
  hk_corner_normals c = {0};
  float normal[9 * SIDES][3];
  assert_int_equal(hk_corner_normals_reserve(&c, &host, RINGS * SIDES + 1, 3 * SIDES), HK_OK);
  hk_corner_normals_find(&c, (const float(*)[3])x, RINGS * SIDES + 1, (const uint32_t(*)[3])face, 3 * SIDES, normal);
  for (size_t k = 0; k < 9 * SIDES; k++) {
    const float *p = x[face[k / 3][k % 3]];
    bool lid = k / 3 % 3 == 2;
    double expected[3] = {lid ? 0 : (double)p[0], lid ? 0 : (double)p[1], lid};
    /* Each side's two triangles weigh one or two at a corner: off by a third of the 7.5 degrees at most. */
    assert_true(cosine(normal[k], expected) > cos(2.6 * acos(-1) / 180));
  }
  hk_corner_normals_free(&c, &host);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(corners_are_round_about_a_cylinder_and_sharp_at_its_lid),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
