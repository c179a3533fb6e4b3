/* Clear liquids against the formulas: absorption by the way inside, one surface behind another, up to what is opaque;
 * Fresnel's share by the angle; a ball that is a lens; any order of the triangles. The eye is at (0, -10, 0) and looks
 * along y, with a pixel a centimetre wide at the origin. */
#include "plugins/common/gl/gl_context.h"
#include "plugins/common/picture/painter.h"
#include "tests/plugins/outputs/fake_host.h"

#include <math.h>
#include <setjmp.h>

#include <cmocka.h>

enum {
  WIDTH = 160,
  HEIGHT = 90,
  ROWS = 64,
  COLUMNS = 128,
  BALL_VERTICES = (ROWS + 1) * COLUMNS,
  BALL_FACES = 2 * ROWS * COLUMNS
};
enum { MOST_VERTICES = 2 * BALL_VERTICES, MOST_FACES = 2 * BALL_FACES };

typedef struct world {
  fake f;
  hk_gl_context *gl;
  hk_painter painter;
  hk_appearance appearance;
  hk_snapshot3d snapshot;
  hk_frame_solid solid[3]; /* the last is the liquid */
  hk_view_setup setup;
  double x[3 * MOST_VERTICES], normal[3 * MOST_VERTICES];
  uint32_t face[MOST_FACES][3];
  unsigned char rgba[WIDTH * HEIGHT * 4];
} world;

static const double eye = 10;

static world *open_world(void) {
  static world w;
  const char *why;
  memset(&w, 0, sizeof w);
  fake_open(&w.f, "frames");
  w.gl = hk_gl_context_create(&why);
  if (!w.gl) fail_msg("%s", why);
  assert_int_equal(hk_painter_open(&w.painter, &w.f.host, WIDTH, HEIGHT), HK_OK);
  w.setup = (hk_view_setup){.camera = {{0, -eye, 0}, {0, 0, 0}, 2 * atan(0.045), (double)WIDTH / HEIGHT, 0.2, 600},
                            .low = {-1, -1, -1},
                            .high = {1, 1, 1},
                            .size = 1,
                            .background = {0.9f, 0.9f, 0.9f},
                            .water = {true, 1, {0}}};
  hk_snapshot3d_open(&w.snapshot, &w.f.host, &w.appearance);
  w.snapshot.solid = w.solid, w.snapshot.liquid = true;
  return &w;
}

static void close_world(world *w) {
  hk_painter_close(&w->painter);
  hk_gl_context_destroy(w->gl);
  fake_close(&w->f);
}

static void set_axes(hk_frame_solid *s, double a, double b, double c) {
  s->axis[0][0] = a, s->axis[1][1] = b, s->axis[2][2] = c;
}

/* The liquid has another ball. */
static void add_ball(world *w, double radius, double y) {
  const double pi = acos(-1);
  hk_frame_solid *s = w->solid + 2;
  s->kind = HK_SHAPE_MESH, s->vertex = w->x, s->face = (const uint32_t(*)[3])w->face;
  set_axes(s, 1, 1, 1);
  w->snapshot.normal = w->normal;
  uint32_t first = (uint32_t)s->vertices;
  for (int i = 0; i <= ROWS; i++)
    for (int j = 0; j < COLUMNS; j++, s->vertices++) {
      double turn = 2 * pi * j / COLUMNS, rise = pi * ((double)i / ROWS - 0.5);
      double n[3] = {cos(rise) * cos(turn), cos(rise) * sin(turn), sin(rise)};
      for (size_t c = 0; c < 3; c++)
        w->normal[3 * s->vertices + c] = n[c], w->x[3 * s->vertices + c] = radius * n[c] + (c == 1 ? y : 0);
    }
  for (uint32_t i = 0; i < ROWS; i++)
    for (uint32_t j = 0; j < COLUMNS; j++) {
      uint32_t next = (j + 1) % COLUMNS, a = first + i * COLUMNS, b = a + COLUMNS;
      memcpy(w->face[s->faces++], (uint32_t[]){a + j, a + next, b + next}, sizeof w->face[0]);
      memcpy(w->face[s->faces++], (uint32_t[]){a + j, b + next, b + j}, sizeof w->face[0]);
    }
}

static void add_box(world *w, int k, double x, double y, double half, const uint8_t colour[4]) {
  w->solid[k] = (hk_frame_solid){.kind = HK_SHAPE_BOX, .centre = {x, y, 0}};
  set_axes(w->solid + k, half, half, half);
  memcpy(w->solid[k].colour, colour, 4);
}

/* With the solids from the first one on. */
static void draw(world *w, int first) {
  w->snapshot.solid = w->solid + first, w->snapshot.solids = (size_t)(3 - first);
  assert_int_equal(hk_painter_draw(&w->painter, &w->setup, &w->snapshot, NULL), HK_OK);
  assert_int_equal(hk_painter_read(&w->painter, &w->setup, w->rgba), HK_OK);
}

/* Without the liquid. */
static void draw_bare(world *w, int first) {
  hk_frame_solid liquid = w->solid[2];
  w->solid[2].vertices = w->solid[2].faces = 0;
  draw(w, first);
  w->solid[2] = liquid;
}

/* x and y in pixels from the middle, to the right and up; those of the pixel's own middle are half a pixel more. */
static int byte(const world *w, int x, int y, int c) {
  return w->rgba[((HEIGHT / 2 + y) * WIDTH + WIDTH / 2 + x) * 4 + c];
}

static double to_linear(double b) { return b / 255 <= 0.04045 ? b / 255 / 12.92 : pow((b / 255 + 0.055) / 1.055, 2.4); }

static double to_byte(double l) { return 255 * (l <= 0.0031308 ? 12.92 * l : 1.055 * pow(l, 1 / 2.4) - 0.055); }

/* Of both bytes half is rounding, and half a unit more comes from triangles. */
static void near(double found, double expected) {
  if (!(fabs(found - expected) <= 1.5)) fail_msg("%g, expected %.2f", found, expected);
}

/* The way of the ray through a pixel inside a ball of this radius at `y`. */
static double chord(int px, int py, double radius, double y) {
  double x = (px + 0.5) / 100 / eye, z = (py + 0.5) / 100 / eye, length2 = x * x + 1 + z * z;
  double along = (eye + y) / sqrt(length2), off2 = (eye + y) * (eye + y) - along * along;
  return 2 * sqrt(fmax(radius * radius - off2, 0));
}

static const double absorption[3] = {0.3, 1, 2.5}; /* 1/m */

static void set_absorption(world *w, double factor) {
  for (int c = 0; c < 3; c++) w->setup.water.absorption[c] = (float)(factor * absorption[c]);
}

static void light_is_absorbed_by_the_length_of_its_way(void **state) {
  (void)state;
  static const int pixel[][2] = {{0, 0}, {20, 0}, {-15, 22}, {3, -34}, {30, 15}};
  static unsigned char bare[sizeof((world *)NULL)->rgba];
  world *w = open_world();
  add_ball(w, 0.4, 0);
  add_ball(w, 0.3, 1.5); /* behind it */
  draw_bare(w, 2);
  memcpy(bare, w->rgba, sizeof bare);
  draw(w, 2); /* of the index of air and without absorption it is not seen */
  for (size_t k = 0; k < sizeof bare; k++) assert_true(abs(w->rgba[k] - bare[k]) <= 1);
  set_absorption(w, 1);
  draw(w, 2);
  for (size_t k = 0; k < sizeof pixel / sizeof *pixel; k++)
    for (int c = 0; c < 3; c++) {
      int x = pixel[k][0], y = pixel[k][1];
      double way = chord(x, y, 0.4, 0) + chord(x, y, 0.3, 1.5);
      double before = to_linear(bare[((HEIGHT / 2 + y) * WIDTH + WIDTH / 2 + x) * 4 + c]);
      near(byte(w, x, y, c), to_byte(before * exp(-absorption[c] * way)));
    }
  close_world(w);
}

static void absorption_ends_at_what_is_opaque(void **state) {
  (void)state;
  static const uint8_t grey[4] = {180, 180, 180, 255};
  static const double place[] = {0, 1.5}, way[] = {0.4, 0.8 + 0.3}; /* of the box's front; in the liquid up to it */
  for (int k = 0; k < 2; k++) {
    double before[3];
    world *w = open_world();
    add_ball(w, 0.4, 0);
    if (k == 1) add_ball(w, 0.3, 1.5);
    add_box(w, 1, 0, place[k] + 0.1, 0.1, grey);
    draw_bare(w, 1);
    for (int c = 0; c < 3; c++) before[c] = to_linear(byte(w, 2, 3, c));
    set_absorption(w, 1);
    draw(w, 1);
    for (int c = 0; c < 3; c++) near(byte(w, 2, 3, c), to_byte(before[c] * exp(-absorption[c] * way[k])));
    close_world(w);
  }
}

/* Of the pixel's ray and the ball's normal: half the sum for light across and along the plane of incidence. */
static double share(double index, int px) {
  double x = (px + 0.5) / 100 / eye, z = 0.5 / 100 / eye, length = sqrt(x * x + 1 + z * z);
  double along = eye / length, off2 = eye * eye - along * along;
  double sine = sqrt(off2) / 0.4, in = asin(sine), out = asin(sine / index);
  double across = sin(in - out) / sin(in + out), parallel = tan(in - out) / tan(in + out);
  return (across * across + parallel * parallel) / 2;
}

/* What is mirrored does not depend on the index, and the liquid is so dark that nothing else is seen: of an index
 * without end it mirrors all. */
static void what_is_mirrored_follows_fresnel(void **state) {
  (void)state;
  static const int pixel[] = {0, 12, 20, 28, 33, 36, 38};
  static const double index[] = {1.333, 2.5};
  enum { PIXELS = sizeof pixel / sizeof *pixel };
  double mirrored[PIXELS][3];
  world *w = open_world();
  add_ball(w, 0.4, 0);
  for (int c = 0; c < 3; c++) w->setup.background[c] = 0.6f;
  set_absorption(w, 1e4);
  w->setup.water.index = 1e6f;
  draw(w, 2);
  for (int k = 0; k < PIXELS; k++)
    for (int c = 0; c < 3; c++) mirrored[k][c] = to_linear(byte(w, pixel[k], 0, c));
  set_absorption(w, 0);
  draw(w, 2);
  for (int k = 0; k < PIXELS; k++)
    for (int c = 0; c < 3; c++) near(byte(w, pixel[k], 0, c), to_byte(mirrored[k][c])); /* nothing comes through */
  set_absorption(w, 1e4);
  for (int i = 0; i < 2; i++) {
    w->setup.water.index = (float)index[i];
    draw(w, 2);
    for (int k = 0; k < PIXELS; k++)
      for (int c = 0; c < 3; c++) near(byte(w, pixel[k], 0, c), to_byte(mirrored[k][c] * share(index[i], pixel[k])));
  }
  close_world(w);
}

static void a_ball_is_a_lens(void **state) {
  (void)state;
  static const uint8_t red[4] = {200, 30, 30, 255}, blue[4] = {30, 30, 200, 255};
  world *w = open_world();
  add_ball(w, 0.4, 0);
  add_box(w, 0, -0.5, 2, 0.5, red);
  add_box(w, 1, 0.5, 2, 0.5, blue);
  draw(w, 0);
  assert_true(byte(w, -15, 0, 0) > byte(w, -15, 0, 2) + 50); /* left is red where the index is that of air */
  w->setup.water.index = 1.5f;
  draw(w, 0);
  assert_true(byte(w, -15, 0, 2) > byte(w, -15, 0, 0) + 50);
  assert_true(byte(w, 15, 0, 0) > byte(w, 15, 0, 2) + 50);
  close_world(w);
}

/* Sums of the way round differently: a pixel may be off by one. */
static void the_order_of_triangles_makes_no_difference(void **state) {
  (void)state;
  static unsigned char first[sizeof((world *)NULL)->rgba];
  world *w = open_world();
  add_ball(w, 0.4, 0);
  add_ball(w, 0.3, 0.9);
  set_absorption(w, 1);
  w->setup.water.index = 1.333f;
  draw(w, 2);
  memcpy(first, w->rgba, sizeof first);
  uint64_t seed = 7;
  for (size_t k = w->solid[2].faces; k-- > 1;) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    size_t other = (size_t)(seed >> 33) % (k + 1);
    uint32_t kept[3];
    memcpy(kept, w->face[k], sizeof kept);
    memcpy(w->face[k], w->face[other], sizeof kept);
    memcpy(w->face[other], kept, sizeof kept);
  }
  draw(w, 2);
  size_t off = 0;
  for (size_t k = 0; k < sizeof first; k++) {
    assert_true(abs(w->rgba[k] - first[k]) <= 1);
    off += w->rgba[k] != first[k];
  }
  assert_true(off < sizeof first / 1000);
  close_world(w);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(light_is_absorbed_by_the_length_of_its_way), cmocka_unit_test(absorption_ends_at_what_is_opaque),
      cmocka_unit_test(what_is_mirrored_follows_fresnel), cmocka_unit_test(a_ball_is_a_lens),
      cmocka_unit_test(the_order_of_triangles_makes_no_difference)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
