/* What tells the eye how things lie: shadows on each other, the thickness of cloth, the width of strands. All is looked
 * at along y from 4 m off, where the picture has `scale` pixels per metre. */
#include "plugins/common/obstacles/obstacles_service.h"
#include "tests/plugins/outputs/picture_world.h"

static const double distance = 4;

static double scale(void) { return 45 / tan(15 * acos(-1) / 180) / distance; }

static void look_along_y(world *w, double height) {
  set_vector(w, "from", 0, -distance, height);
  set_vector(w, "look_at", 0, 0, height);
  set_switch(w, "ground", false);
}

/* The number of reddish pixels in a column of the picture. */
static int red_in_column(const picture *p, int column) {
  int count = 0;
  for (int row = 0; row < p->height; row++) {
    const unsigned char *c = p->rgb + 3 * (row * p->width + column);
    count += c[0] > c[1] + 30;
  }
  return count;
}

static void draw_one(world *w) {
  assert_int_equal(begin(w), HK_OK);
  assert_int_equal(add(w), HK_OK);
  assert_int_equal(end(w, HK_VERDICT_OK), HK_OK);
}

static void frames_show_cloth_as_thick_as_it_is(void **state) {
  (void)state;
  static const double thickness[] = {0, 0.1, 0.3};
  for (int k = 0; k < 3; k++) {
    world w;
    world_open(&w, MOST);
    make_cloth(&w, 0, 0);
    for (size_t i = 0; i < MOST; i++) w.x[3 * i + 1] += 0.5; /* the near border at y = 0 */
    look_along_y(&w, 0);
    set_number(&w, "thickness", thickness[k]);
    draw_one(&w);
    picture p = look(&w, 0);
    double least = k == 0 ? 0 : 1.5; /* pixels: a rim is never thinner than 1.5, and pixels at its edges count or not */
    assert_true(fabs(red_in_column(&p, 80) - fmax(thickness[k] * scale(), least)) <= 2);
    assert_true(fabs(red_in_column(&p, 70) - fmax(thickness[k] * scale(), least)) <= 2);
    free(p.rgb);
    fake_close(&w.f);
  }
}

static void frames_draw_strands_as_wide_as_asked(void **state) {
  (void)state;
  world w;
  world_open(&w, 8);
  make_chain(&w, 0);
  for (size_t i = 0; i < 8; i++) w.x[3 * i] -= 0.35;
  look_along_y(&w, 0);
  set_number(&w, "tube", 0.12);
  set_number(&w, "radius", 0.01);
  draw_one(&w);
  picture p = look(&w, 0);
  for (int column = 75; column < 86; column++) assert_true(fabs(red_in_column(&p, column) - 0.24 * scale()) <= 2);
  free(p.rgb);
  fake_close(&w.f);
}

/* Pixels of a cloth that leans towards the eye, along z = 0.5 + y, without and with a small sphere in front of it. */
static picture draw_leaning(world *w, const hk_numbers *sphere, bool shadows) {
  world_open(w, MOST);
  make_cloth(w, 0, 0);
  for (size_t i = 0; i < MOST; i++) w->x[3 * i + 2] = w->x[3 * i + 1] + 0.5, w->y[3 * i + 1] = 0.4;
  look_along_y(w, 0.5);
  set_switch(w, "shadows", shadows);
  *(hk_numbers *)fake_field(&w->f, "spheres") = *sphere;
  draw_one(w);
  return look(w, 0);
}

/* The light comes from 0.42 to the left, 0.3 towards the eye, 1 above, as seen from the eye. From the sphere's middle
 * it meets the cloth, z = 0.5 + y, at middle - t (-0.42, -0.3, 1) with z - y = 0.5. */
static void frames_cast_the_shadow_of_a_sphere_where_the_light_has_it(void **state) {
  (void)state;
  double sphere[] = {-0.1, -0.2, 0.9, 0.06};
  const hk_numbers list = {4, sphere};
  world w;
  picture with = draw_leaning(&w, &list, true);
  fake_close(&w.f);
  picture without = draw_leaning(&w, &list, false);
  fake_close(&w.f);
  double t = (sphere[2] - sphere[1] - 0.5) / 1.3, sum = 0, at[2] = {0, 0};
  for (int row = 0; row < 90; row++)
    for (int column = 0; column < 160; column++) {
      int k = 3 * (row * 160 + column), darker = without.rgb[k] - with.rgb[k];
      if (darker < 25) continue;
      sum += 1, at[0] += column + 0.5, at[1] += row + 0.5;
    }
  double x = sphere[0] + 0.42 * t, y = sphere[1] + 0.3 * t, z = sphere[2] - t, nearer = distance / (distance + y);
  assert_true(fabs(at[0] / sum - (80 + x * scale() * nearer)) < 1.5); /* pixels */
  assert_true(fabs(at[1] / sum - (45 - (z - 0.5) * scale() * nearer)) < 1.5);
  /* The area of an ellipse: the sphere's circle by 1/cos on the cloth, by its slope on the picture. */
  double length = sqrt(0.42 * 0.42 + 0.3 * 0.3 + 1), cosine = 1.3 / length / sqrt(2);
  double area = acos(-1) * pow(0.06 * scale(), 2) / cosine / sqrt(2);
  assert_true(fabs(sum / area - 1) < 0.35); /* an edge of some 30 pixels is soft by one */
  free(with.rgb), free(without.rgb);
}

static void frames_without_shadows_have_none(void **state) {
  (void)state;
  const hk_numbers none = {0, NULL};
  world w;
  picture with = draw_leaning(&w, &none, true);
  fake_close(&w.f);
  picture without = draw_leaning(&w, &none, false);
  fake_close(&w.f);
  for (int k = 0; k < 3 * 160 * 90; k++)
    assert_true(abs(with.rgb[k] - without.rgb[k]) <= 1); /* nor does it shade itself */
  free(with.rgb), free(without.rgb);
}

/* Grey as solids are, without the spheres of pins; one particle that is free makes it cloth. */
static void frames_draw_what_is_pinned_as_a_whole_as_a_solid(void **state) {
  (void)state;
  for (int free_one = 0; free_one < 2; free_one++) {
    world w;
    world_open(&w, MOST);
    make_cloth(&w, 0, 0);
    memset(w.pin, HK_PIN_FIXED, sizeof w.pin);
    w.pin[MOST / 2] = free_one ? HK_FREE : HK_PIN_FIXED;
    look_along_y(&w, 0);
    set_vector(&w, "from", 0, -0.1, 4);
    draw_one(&w);
    picture p = look(&w, 0);
    int red = 0, dark = 0, grey = 0;
    for (int k = 0; k < 160 * 90; k++) {
      const unsigned char *c = p.rgb + 3 * k;
      red += c[0] > c[1] + 60, dark += c[0] < 100 && abs(c[0] - c[1]) < 30;
      grey += c[0] > c[2] && c[0] < c[2] + 30;
    }
    double pixels = scale() * scale();
    assert_true(free_one ? red > 0.5 * pixels && dark > 100 : red == 0 && dark == 0 && grey > 0.8 * pixels);
    free(p.rgb);
    fake_close(&w.f);
  }
}

static hk_obstacle_set set;
static hk_obstacles all = {.shown = &set};

static const void *serve_obstacles(const hk_host *host, const char *service) {
  (void)host;
  return strcmp(service, HK_OBSTACLES_INTERFACE) == 0 ? &all : NULL;
}

/* A capsule, 0.2 m wide and 0.6 m long, upright or, by half a turn less, along x. */
static hk_obstacle capsule_at(double x, bool upright) {
  hk_obstacle o = {.shape = {.kind = HK_SHAPE_CAPSULE, .half = {0.1, 0.1, 0.3}}};
  hk_pose pose = {.position = {x, 0, 0}, .rotation = {0, upright ? 0 : acos(-1) / 2, 0}};
  hk_pose history[HK_POSES];
  hk_motion_begin(history, &pose);
  hk_motion_of(&o.motion, history);
  return o;
}

static extent find_dark(const world *w, size_t k) {
  picture p = look(w, k);
  extent e = {0, p.width, -1, p.height, -1};
  for (int k2 = 0; k2 < p.width * p.height; k2++) {
    const unsigned char *c = p.rgb + 3 * k2;
    int x = k2 % p.width, y = k2 / p.width;
    if (c[2] > c[0]) continue; /* the background is bluish, solids are not */
    e.count++;
    e.left = x < e.left ? x : e.left, e.right = x > e.right ? x : e.right;
    e.top = y < e.top ? y : e.top, e.bottom = y > e.bottom ? y : e.bottom;
  }
  free(p.rgb);
  return e;
}

/* The outline has the capsule's width and length, to a pixel at each end; a nearer part is larger by 1/40. */
static void frames_draw_obstacles_where_they_are(void **state) {
  (void)state;
  world w;
  world_open(&w, 1);
  w.x[0] = 100; /* out of the picture */
  hk_obstacle o = capsule_at(0, true);
  set = (hk_obstacle_set){.count = 1, .member = {&o}};
  w.f.host.query = serve_obstacles;
  look_along_y(&w, 0);
  assert_int_equal(begin(&w), HK_OK);
  assert_int_equal(add(&w), HK_OK);
  o = capsule_at(0.4, false);
  assert_int_equal(add(&w), HK_OK);
  assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
  for (size_t k = 0; k < 2; k++) {
    extent e = find_dark(&w, k);
    double wide = (k ? 0.6 : 0.2) * scale(), high = (k ? 0.2 : 0.6) * scale();
    assert_true(fabs(e.right - e.left + 1 - wide) <= 2.5 && fabs(e.bottom - e.top + 1 - high) <= 2.5);
    assert_true(fabs((e.left + e.right + 1) / 2.0 - 80 - (k ? 0.4 * scale() : 0)) <= 1.5);
  }
  fake_close(&w.f);
}

/* Edges that a script makes by hand, and elements on more than two particles, are drawn where springs of others are:
 * half a metre each, 3 pixels thick. */
static void frames_show_edges_and_elements_that_no_spring_shows(void **state) {
  (void)state;
  enum { SPRING, EDGE, BEND };
  static const uint32_t edge[2] = {2, 3}, bend[3] = {4, 5, 6};
  for (int kinds = 0; kinds < 3; kinds++) {
    world w;
    world_open(&w, 7);
    for (size_t i = 0; i < 7; i++) w.x[3 * i] = 0.1 * (double)i - 0.3;
    w.x[2] = w.x[5] = 0.2, w.x[3] = -0.3, w.x[0] = 0.2; /* the spring: above, 0.5 m long */
    w.x[6] = -0.3, w.x[9] = 0.2;                        /* the edge: in the middle */
    for (size_t i = 4; i < 7; i++) w.x[3 * i] = 0.25 * (double)i - 1.3, w.x[3 * i + 2] = -0.2;
    w.pair[0][0] = 0, w.pair[0][1] = 1, w.stiffness = 1, w.rest = 0.5;
    hk_element_list list[2] = {{.force = "springs", .elements = {.node = {1, 2, &w.pair[0][0]}}},
                               {.force = "angles", .elements = {.node = {1, 3, bend}}}};
    w.model.element_list = list, w.model.element_lists = kinds == BEND ? 2 : 1;
    if (kinds >= EDGE) w.model.edges = (hk_tuples){1, 2, edge};
    set_still_camera(&w);
    set_number(&w, "tube", 0.015);
    set_switch(&w, "shadows", false);
    picture p = draw_once(&w);
    for (int k = 0; k < 3; k++) {
      int y = 45 - 20 + 20 * k;
      assert_int_equal(is_red(&p, 80 - 12, y), k <= kinds); /* between the particles, which have other radii */
    }
    free(p.rgb);
    fake_close(&w.f);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(frames_show_cloth_as_thick_as_it_is),
      cmocka_unit_test(frames_draw_strands_as_wide_as_asked),
      cmocka_unit_test(frames_cast_the_shadow_of_a_sphere_where_the_light_has_it),
      cmocka_unit_test(frames_without_shadows_have_none),
      cmocka_unit_test(frames_draw_what_is_pinned_as_a_whole_as_a_solid),
      cmocka_unit_test(frames_draw_obstacles_where_they_are),
      cmocka_unit_test(frames_show_edges_and_elements_that_no_spring_shows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
