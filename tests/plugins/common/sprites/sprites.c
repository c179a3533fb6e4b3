/* Points in front of a camera at the origin that looks along -z, with 100 pixels to 45 degrees: a point at depth 10 is
 * drawn 10 pixels large per metre. */
#include "plugins/common/sprites/depth_order.h"
#include "plugins/common/sprites/sprites.h"
#include "tests/support/plain_host.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 200, PIXELS = SIDE * SIDE };

static size_t allocations_left = SIZE_MAX, thread_grain = 1;

static void *allocate(const hk_host *host, size_t bytes) {
  (void)host;
  if (allocations_left == 0) return NULL;
  allocations_left--;
  return calloc(1, bytes + 1);
}

static hk_status fail_(const hk_host *host, hk_status status, const char *format, ...) {
  (void)host, (void)format;
  return status;
}

/* Chunks from the last to the first: what depends on their order shows. */
static void backwards(const hk_host *host, size_t count, size_t grain, void (*body)(void *, size_t, size_t, size_t),
                      void *context) {
  (void)host;
  grain *= thread_grain;
  for (size_t k = (count + grain - 1) / grain; k-- > 0;)
    body(context, k * grain, (k + 1) * grain < count ? (k + 1) * grain : count, k);
}

static const hk_host host = {.fail = fail_, .allocate = allocate, .release = test_release, .parallel_for = backwards};

static const hk_lens lens = {.view = {[0] = 1, [5] = 1, [10] = 1, [15] = 1}, .projection = {[0] = 1, [5] = 1}};

static hk_sprite_shading look_of(hk_style style) {
  return (hk_sprite_shading){.style = style,
                             .opacity = 1,
                             .least = 1,
                             .clear = 5,
                             .thick = 15,
                             .light = {{0, 0, 1}, {0, 1, 0}, {0, 0, 1}, {0, 0, 1}}};
}

static hk_point_sprite point_at(double x, double y, double depth, double radius, uint8_t red, uint8_t green,
                                uint8_t blue) {
  return (hk_point_sprite){{(float)x, (float)y, (float)-depth}, (float)radius, {0}, {red, green, blue, 255}};
}

typedef struct canvas {
  uint8_t rgba[PIXELS][4];
} canvas;

static void fill(canvas *c, uint8_t byte) { memset(c, byte, sizeof *c); }

static const uint8_t *pixel(const canvas *c, int x, int y) { return c->rgba[y * SIDE + x]; }

/* Draws the points over the canvas; `scene`: distance of what is there already. */
static void draw(canvas *c, const hk_sprite_shading *shading, const hk_point_sprite *point, size_t count, float scene) {
  hk_sprites s;
  hk_sprites_open(&s, &host);
  assert_int_equal(hk_sprites_place(&s, &lens, shading, SIDE, SIDE, point, count), HK_OK);
  for (int k = 0; k < s.image.width * s.image.height; k++) s.distance[k] = scene;
  hk_sprites_draw(&s, shading, &c->rgba[0][0], SIDE);
  hk_sprites_close(&s);
}

static double light_of(uint8_t byte) {
  double c = byte / 255.0;
  return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

/* A byte's rounding in light, at most: the slope of sRGB is 2.3 at white. */
static const double step = 2.3 / 255;

static void sprites_are_where_perspective_puts_them(void **state) {
  (void)state;
  canvas c;
  hk_sprite_shading shading = look_of(HK_STYLE_SPHERE);
  hk_point_sprite point = point_at(3.05, -2.05, 10, 0.8, 255, 0, 0); /* middle at pixel (130.5, 79.5), radius 8 */
  fill(&c, 0);
  draw(&c, &shading, &point, 1, INFINITY);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      double r = hypot(x - 130, y - 79);
      if (r < 7) assert_true(pixel(&c, x, y)[0] > 60);
      if (r > 9) assert_int_equal(pixel(&c, x, y)[0], 0);
    }
  assert_true(pixel(&c, 130, 79)[0] > 200 && pixel(&c, 130, 79)[1] < 80);
}

static void sprites_keep_the_picture_beside_them(void **state) {
  (void)state;
  for (int style = HK_STYLE_SPHERE; style <= HK_STYLE_GLOW; style++) {
    canvas c, before;
    hk_sprite_shading shading = look_of((hk_style)style);
    for (int k = 0; k < PIXELS; k++) memset(c.rgba[k], k % 256, 4);
    before = c;
    hk_point_sprite point[] = {point_at(0, 0, 10, 2, 255, 255, 255), point_at(9, 9, 10, 0, 255, 255, 255)};
    draw(&c, &shading, point, 2, INFINITY);
    int same = 0;
    for (int k = 0; k < PIXELS; k++) {
      bool far_off = hypot(k % SIDE - 99.5, k / SIDE - 99.5) > 22 && hypot(k % SIDE - 189.5, k / SIDE - 189.5) > 4;
      if (far_off) assert_memory_equal(c.rgba[k], before.rgba[k], 4);
      same += far_off;
    }
    assert_in_range(same, PIXELS / 2, PIXELS);
    assert_true(pixel(&c, 100, 100)[0] > 150);
  }
}

static void sprites_of_light_add_up_in_any_order(void **state) {
  (void)state;
  hk_sprite_shading shading = look_of(HK_STYLE_GLOW);
  hk_point_sprite point[] = {point_at(0.05, 0.05, 10, 2, 60, 0, 0), point_at(1.05, 0.05, 9, 2, 0, 50, 30)};
  hk_point_sprite turned[] = {point[1], point[0]};
  canvas a, b, both, other;
  fill(&a, 0), fill(&b, 0), fill(&both, 0), fill(&other, 0);
  draw(&a, &shading, point, 1, INFINITY);
  draw(&b, &shading, point + 1, 1, INFINITY);
  draw(&both, &shading, point, 2, INFINITY);
  draw(&other, &shading, turned, 2, INFINITY);
  assert_memory_equal(&both, &other, sizeof both);
  int overlapping = 0;
  for (int k = 0; k < PIXELS; k++) {
    /* What is shown is s/(1 + m), m the strongest colour of s: back to s, the sum has to be that of both. */
    double sum[3], shown[3], most = 0, strongest[2] = {0};
    const canvas *one[] = {&a, &b};
    for (int c = 0; c < 3; c++)
      for (int i = 0; i < 2; i++) strongest[i] = fmax(strongest[i], light_of(one[i]->rgba[k][c]));
    for (int c = 0; c < 3; c++) {
      sum[c] = 0, shown[c] = light_of(both.rgba[k][c]);
      for (int i = 0; i < 2; i++) sum[c] += light_of(one[i]->rgba[k][c]) / (1 - strongest[i]);
      most = fmax(most, sum[c]);
    }
    for (int c = 0; c < 3; c++) assert_true(fabs(shown[c] - sum[c] / (1 + most)) < step);
    overlapping += a.rgba[k][0] > 20 && b.rgba[k][1] > 20;
  }
  assert_in_range(overlapping, 50, PIXELS);
}

static void sprites_of_light_keep_their_hue(void **state) {
  (void)state;
  hk_sprite_shading shading = look_of(HK_STYLE_GLOW);
  hk_point_sprite point[50];
  canvas c;
  for (int k = 0; k < 50; k++) point[k] = point_at(0.05, 0.05, 10, 2, 200, 100, 50);
  fill(&c, 0);
  draw(&c, &shading, point, 50, INFINITY);
  const uint8_t *p = pixel(&c, 100, 100);
  double expected = light_of(100) / light_of(200);
  assert_true(p[0] > 240);
  assert_float_equal(light_of(p[1]) / light_of(p[0]), expected, 0.02);
}

static void sprites_hide_what_is_behind_them(void **state) {
  (void)state;
  canvas c;
  hk_point_sprite near = point_at(0.05, 0.05, 8, 1, 255, 0, 0), far = point_at(0.05, 0.05, 12, 3, 0, 0, 255);
  for (int style = HK_STYLE_SPHERE; style <= HK_STYLE_SOFT; style++)
    for (int turn = 0; turn < 2; turn++) {
      hk_sprite_shading shading = look_of((hk_style)style);
      hk_point_sprite point[] = {turn ? far : near, turn ? near : far};
      fill(&c, 0);
      draw(&c, &shading, point, 2, INFINITY);
      assert_true(pixel(&c, 100, 100)[0] > 150 && pixel(&c, 100, 100)[2] < 90);
      assert_true(pixel(&c, 116, 100)[2] > 60 && pixel(&c, 116, 100)[0] < 90);
    }
}

/* Soft discs: over = a c + (1 - a) p with a = opacity (1 - r^2)^2, r from the middle of the pixel. */
static void sprites_cover_by_their_weight(void **state) {
  (void)state;
  canvas c;
  hk_sprite_shading shading = look_of(HK_STYLE_SOFT);
  hk_point_sprite point = point_at(0.05, 0.05, 10, 2, 255, 255, 255);
  shading.opacity = 0.5;
  point.colour[3] = 128;
  fill(&c, 100);
  draw(&c, &shading, &point, 1, INFINITY);
  for (int x = 70; x < 130; x++) {
    double r = fmin(abs(x - 100) / 20.0, 1), a = 0.5 * 128 / 255 * pow(1 - r * r, 2);
    assert_true(fabs(light_of(pixel(&c, x, 100)[0]) - (a + (1 - a) * light_of(100))) < step);
  }
}

static void sprites_are_hidden_by_the_scene(void **state) {
  (void)state;
  canvas c, clean;
  hk_point_sprite point = point_at(0, 0, 10, 1, 255, 255, 255);
  fill(&clean, 0);
  for (int style = HK_STYLE_SPHERE; style <= HK_STYLE_GLOW; style++) {
    hk_sprite_shading shading = look_of((hk_style)style);
    fill(&c, 0);
    draw(&c, &shading, &point, 1, 8.9f);
    assert_memory_equal(&c, &clean, sizeof c);
    draw(&c, &shading, &point, 1, -INFINITY);
    assert_memory_equal(&c, &clean, sizeof c);
    draw(&c, &shading, &point, 1, 10);
    assert_true(pixel(&c, 100, 100)[0] > 150);
  }
}

static void sprites_too_small_for_a_pixel_keep_their_light(void **state) {
  (void)state;
  hk_sprite_shading shading = look_of(HK_STYLE_GLOW);
  double least = INFINITY, most = 0;
  shading.opacity = 0.05; /* faint: what is shown is the sum */
  for (int k = 0; k < 25; k++) {
    canvas c;
    hk_point_sprite point = point_at(0.02 * (k % 5), 0.02 * (k / 5), 10, 0.01, 255, 255, 255);
    fill(&c, 0);
    draw(&c, &shading, &point, 1, INFINITY);
    double sum = 0;
    for (int i = 0; i < PIXELS; i++) sum += light_of(c.rgba[i][0]);
    least = fmin(least, sum), most = fmax(most, sum);
  }
  assert_true(least > 0 && most < 1.35 * least); /* the sum of the weight over pixels, by quadrature, differs by 1.3 */
}

static void sprites_leave_streaks_behind(void **state) {
  (void)state;
  for (int style = HK_STYLE_SOFT; style <= HK_STYLE_GLOW; style++) {
    canvas c;
    hk_sprite_shading shading = look_of((hk_style)style);
    hk_point_sprite point = point_at(0.05, 0.05, 10, 0.3, 255, 255, 255);
    point.tail[0] = 4, point.tail[1] = 4;
    fill(&c, 0);
    draw(&c, &shading, &point, 1, INFINITY);
    for (int k = 0; k < 40; k++) /* it falls to nothing over 40 pixels down and left */
      assert_true(pixel(&c, 100 - k, 100 - k)[0] <= pixel(&c, 101 - k, 101 - k)[0] || k == 0);
    assert_true(pixel(&c, 80, 80)[0] > 40);
    assert_int_equal(pixel(&c, 58, 58)[0], 0);
    assert_int_equal(pixel(&c, 106, 106)[0], 0);
    assert_int_equal(pixel(&c, 80, 90)[0], 0);
  }
}

static void sprites_vanish_in_fog(void **state) {
  (void)state;
  double last = 0;
  for (int depth = 4; depth <= 20; depth += 4) {
    canvas c;
    hk_sprite_shading shading = look_of(HK_STYLE_SOFT);
    hk_point_sprite point = point_at(0.005 * depth, 0.005 * depth, depth, 1, 0, 0, 0);
    shading.fog = 1, shading.fog_colour[0] = 1;
    fill(&c, 0);
    draw(&c, &shading, &point, 1, INFINITY);
    double share = fmin(fmax((depth - 5) / 10.0, 0), 1);
    assert_true(fabs(light_of(pixel(&c, 100, 100)[0]) - share) < step);
    assert_true(share >= last);
    last = share;
  }
}

static void sprites_do_not_depend_on_threads(void **state) {
  (void)state;
  static hk_point_sprite point[3000];
  for (int k = 0; k < 3000; k++) {
    double a = sin(12.9898 * k) * 43758.5453, b = sin(78.233 * k) * 12543.123, d = sin(3.7 * k) * 9131.7;
    a -= floor(a), b -= floor(b), d -= floor(d);
    point[k] = point_at(20 * a - 10, 20 * b - 10, 5 + 10 * d, 0.3 * a, (uint8_t)(255 * b), (uint8_t)(255 * d), 90);
    point[k].colour[3] = (uint8_t)(255 * d), point[k].tail[0] = (float)(k % 3 - 1);
  }
  for (int style = HK_STYLE_SPHERE; style <= HK_STYLE_GLOW; style++) {
    canvas c[2];
    hk_sprite_shading shading = look_of((hk_style)style);
    for (int k = 0; k < 2; k++) {
      thread_grain = k ? 1000000 : 1;
      fill(c + k, 40);
      draw(c + k, &shading, point, 3000, 11);
    }
    thread_grain = 1;
    assert_memory_equal(c, c + 1, sizeof *c);
  }
}

/* Positions that no picture holds: behind the eye, at the eye, at the ends of single precision. */
static void sprites_survive_any_position(void **state) {
  (void)state;
  static const double place[] = {0, 1e-30, -1e-30, 1e-3, -1, 1, 1e3, -1e9, 1e19, -1e30};
  enum { N = sizeof place / sizeof *place };
  static hk_point_sprite point[N * N * N];
  for (int k = 0; k < N * N * N; k++) {
    point[k] = point_at(place[k % N], place[k / N % N], place[k / N / N], fabs(place[(k * 7) % N]), 200, 100, 50);
    for (int c = 0; c < 3; c++) point[k].tail[c] = (float)place[(k * 3 + c) % N];
  }
  for (int style = HK_STYLE_SPHERE; style <= HK_STYLE_GLOW; style++)
    for (int k = 0; k < N * N * N; k += 10) {
      canvas c;
      hk_sprite_shading shading = look_of((hk_style)style);
      draw(&c, &shading, point + k, 10, 11);
    }
}

static void sprites_survive_want_of_memory(void **state) {
  (void)state;
  hk_point_sprite point = point_at(0, 0, 10, 1, 255, 255, 255);
  hk_sprite_shading shading = look_of(HK_STYLE_SPHERE);
  hk_status status = HK_NO_MEMORY;
  for (size_t k = 0; status != HK_OK; k++) {
    hk_sprites s;
    allocations_left = k;
    hk_sprites_open(&s, &host);
    status = hk_sprites_place(&s, &lens, &shading, SIDE, SIDE, &point, 1);
    hk_sprites_close(&s);
    assert_true(k < 20 && (status == HK_OK || status == HK_NO_MEMORY));
  }
  allocations_left = SIZE_MAX;
}

static void depth_order_is_that_of_a_stable_sort(void **state) {
  (void)state;
  enum { N = 5000 };
  static hk_sprite sprite[N];
  static uint32_t order[N], spare[N], key[2 * N];
  uint64_t seed = 7;
  for (int k = 0; k < N; k++) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    sprite[k].depth = powf(10, (float)(seed >> 40) / (1 << 24) * 60 - 30);
    if (k % 5 == 0) sprite[k].depth = 1;
    sprite[k].radius = k % 7 ? 1 : 0;
  }
  size_t listed = hk_depth_order(sprite, N, order, spare, key);
  assert_int_equal(listed, N - (N + 6) / 7);
  for (size_t k = 0; k < listed; k++) {
    assert_true(order[k] % 7 != 0);
    if (!k) continue;
    float a = sprite[order[k - 1]].depth, b = sprite[order[k]].depth;
    assert_true(a < b || (a == b && order[k - 1] < order[k]));
  }
}

static void bytes_of_a_picture_pass_through_light_unchanged(void **state) {
  (void)state;
  hk_srgb s;
  hk_srgb_fill(&s);
  for (int k = 0; k < 256; k++) assert_int_equal(s.byte[(int)(sqrtf(s.light[k]) * (HK_SRGB_ROOTS - 1) + 0.5f)], k);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sprites_are_where_perspective_puts_them),
      cmocka_unit_test(sprites_keep_the_picture_beside_them),
      cmocka_unit_test(sprites_of_light_add_up_in_any_order),
      cmocka_unit_test(sprites_of_light_keep_their_hue),
      cmocka_unit_test(sprites_hide_what_is_behind_them),
      cmocka_unit_test(sprites_cover_by_their_weight),
      cmocka_unit_test(sprites_are_hidden_by_the_scene),
      cmocka_unit_test(sprites_too_small_for_a_pixel_keep_their_light),
      cmocka_unit_test(sprites_leave_streaks_behind),
      cmocka_unit_test(sprites_vanish_in_fog),
      cmocka_unit_test(sprites_do_not_depend_on_threads),
      cmocka_unit_test(sprites_survive_any_position),
      cmocka_unit_test(sprites_survive_want_of_memory),
      cmocka_unit_test(depth_order_is_that_of_a_stable_sort),
      cmocka_unit_test(bytes_of_a_picture_pass_through_light_unchanged),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
