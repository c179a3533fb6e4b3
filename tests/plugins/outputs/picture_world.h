/* Small pictures of small scenes, read back. What is looked for is painted pure red by a channel of three numbers:
 * nothing else in a picture is. */
#ifndef HK_TEST_PICTURE_WORLD_H
#define HK_TEST_PICTURE_WORLD_H

#include "tests/plugins/outputs/fake_host.h"

#include <setjmp.h>

#include <cmocka.h>
#include <png.h>

enum { SIDE = 12, MOST = SIDE * SIDE };

typedef struct world {
  fake f;
  size_t n;
  double x[3 * MOST], v[3 * MOST], y[3 * MOST], mass[MOST];
  uint32_t id[MOST], group[MOST];
  uint8_t pin[MOST];
  uint32_t triangle[2 * MOST][3], pair[MOST][2];
  double stiffness, damping, rest;
  hk_channel channel;
  hk_element_list list;
  hk_model model;
  hk_view view;
  hk_frame frame;
} world;

typedef struct picture {
  int width, height;
  unsigned char *rgb;
} picture;

static inline void set_number(world *w, const char *name, double value) { *(double *)fake_field(&w->f, name) = value; }
static inline void set_integer(world *w, const char *name, int64_t value) {
  *(int64_t *)fake_field(&w->f, name) = value;
}
static inline void set_switch(world *w, const char *name, bool value) { *(bool *)fake_field(&w->f, name) = value; }
static inline void set_text(world *w, const char *name, const char *value) {
  *(const char **)fake_field(&w->f, name) = value;
}
static inline void set_vector(world *w, const char *name, double x, double y, double z) {
  double *v = fake_field(&w->f, name);
  v[0] = x, v[1] = y, v[2] = z;
}

/* n red particles at rest at the origin; 160 x 90 pixels, no video. */
static inline void world_open(world *w, size_t n) {
  static const char *const group_name[] = {"all"};
  memset(w, 0, sizeof *w);
  fake_open(&w->f, "frames");
  w->n = n;
  for (size_t i = 0; i < MOST; i++) w->mass[i] = 1, w->id[i] = (uint32_t)i + 1, w->y[3 * i] = 1;
  w->channel = (hk_channel){"paint", 3, 0};
  w->model = (hk_model){.n = n,
                        .mass = w->mass,
                        .inverse_mass = w->mass,
                        .id = w->id,
                        .group = w->group,
                        .pin = w->pin,
                        .groups = 1,
                        .group_name = group_name,
                        .channels = 1,
                        .channel = &w->channel,
                        .triangles = {0, 3, &w->triangle[0][0]},
                        .element_list = &w->list};
  w->view = (hk_view){.n = n, .x = w->x, .v = w->v, .y = w->y, .model = &w->model, .host = &w->f.host};
  w->frame.fps = 30;
  set_integer(w, "width", 160);
  set_integer(w, "height", 90);
  set_text(w, "color", "paint");
  set_switch(w, "video", false);
}

/* The particles become a cloth, one metre square in the xy-plane around `x`, 0, `z`. */
static inline void make_cloth(world *w, double x, double z) {
  w->model.triangles.count = 0;
  for (uint32_t i = 0; i < SIDE; i++)
    for (uint32_t j = 0; j < SIDE; j++) {
      uint32_t a = i * SIDE + j;
      w->x[3 * a] = x - 0.5 + (double)i / (SIDE - 1), w->x[3 * a + 1] = -0.5 + (double)j / (SIDE - 1);
      w->x[3 * a + 2] = z;
      if (i + 1 == SIDE || j + 1 == SIDE) continue;
      uint32_t corner[2][3] = {{a, a + SIDE, a + SIDE + 1}, {a, a + SIDE + 1, a + 1}};
      memcpy(w->triangle[w->model.triangles.count], corner, sizeof corner);
      w->model.triangles.count += 2;
    }
}

/* The particles become a chain along x with springs of 0.1 m, stretched by `strain`. */
static inline void make_chain(world *w, double strain) {
  for (uint32_t i = 0; i < w->n; i++) w->x[3 * i] = 0.1 * (1 + strain) * i;
  for (uint32_t i = 0; i + 1 < w->n; i++) w->pair[i][0] = i, w->pair[i][1] = i + 1;
  w->stiffness = 100, w->rest = 0.1;
  w->list = (hk_element_list){.force = "springs",
                              .elements = {.node = {w->n - 1, 2, &w->pair[0][0]},
                                           .values = 1,
                                           .stiffness = {1, &w->stiffness},
                                           .damping = {1, &w->damping},
                                           .rest = {1, &w->rest}},
                              .acts = true};
  w->model.element_lists = 1;
}

static inline hk_status begin(world *w) {
  hk_status status = w->f.plugin->create(w->f.self, &w->f.host, &w->view);
  return status == HK_OK ? w->f.plugin->output->open(w->f.self, &w->view, &w->frame) : status;
}

static inline hk_status add(world *w) {
  hk_status status = w->f.plugin->output->frame(w->f.self, &w->view, &w->frame);
  w->frame.index++;
  return status;
}

static inline hk_status end(world *w, hk_verdict verdict) { return w->f.plugin->output->close(w->f.self, verdict); }

static inline void set_count(world *w, size_t n) {
  w->n = w->view.n = w->model.n = n;
  assert_int_equal(w->f.plugin->topology(w->f.self, &w->view), HK_OK);
}

static inline bool there_is(const world *w, const char *name) {
  char path[512];
  struct stat info;
  snprintf(path, sizeof path, "%s/%s", w->f.folder, name);
  return stat(path, &info) == 0 && info.st_size > 0;
}

/* Files are written while the next pictures are drawn: within some seconds, or a minute of a busy machine. */
static inline bool there_will_be(const world *w, const char *name) {
  for (int tries = 0; tries < 3000 && !there_is(w, name); tries++) usleep(20000);
  return there_is(w, name);
}

static inline picture read_picture(const char *path) {
  png_image image = {.version = PNG_IMAGE_VERSION};
  if (!png_image_begin_read_from_file(&image, path)) fail_msg("%s: %s", path, image.message);
  image.format = PNG_FORMAT_RGB;
  picture p = {(int)image.width, (int)image.height, malloc(PNG_IMAGE_SIZE(image))};
  assert_true(png_image_finish_read(&image, NULL, p.rgb, 0, NULL));
  return p;
}

static inline picture look(const world *w, size_t k) {
  char path[512];
  snprintf(path, sizeof path, "%s/frames/%06zu.png", w->f.folder, k);
  return read_picture(path);
}

static inline bool is_red(const picture *p, int x, int y) {
  const unsigned char *c = p->rgb + 3 * (y * p->width + x);
  return c[0] > c[1] + 40 && c[0] > c[2] + 40;
}

typedef struct extent {
  int count, left, right, top, bottom; /* of red pixels */
} extent;

static inline extent find_red(const world *w, size_t k) {
  picture p = look(w, k);
  extent e = {0, p.width, -1, p.height, -1};
  for (int y = 0; y < p.height; y++)
    for (int x = 0; x < p.width; x++) {
      if (!is_red(&p, x, y)) continue;
      e.count++;
      e.left = x < e.left ? x : e.left, e.right = x > e.right ? x : e.right;
      e.top = y < e.top ? y : e.top, e.bottom = y > e.bottom ? y : e.bottom;
    }
  free(p.rgb);
  return e;
}

static inline picture draw_once(world *w) {
  assert_int_equal(begin(w), HK_OK);
  assert_int_equal(add(w), HK_OK);
  assert_int_equal(end(w, HK_VERDICT_OK), HK_OK);
  return look(w, 0);
}

/* A camera at (0, -10, 0) that looks along y, with a pixel a centimetre wide at the origin. */
static inline void set_still_camera(world *w) {
  set_vector(w, "from", 0, -10, 0);
  set_vector(w, "look_at", 0, 0, 0);
  set_number(w, "fov", 2 * atan(0.045) * 180 / acos(-1));
  set_switch(w, "ground", false);
  set_switch(w, "legend", false);
}

static inline const unsigned char *at(const picture *p, int x, int y) { return p->rgb + 3 * (y * p->width + x); }

#endif
