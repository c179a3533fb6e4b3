/* How particles look: what is where on a picture, and in what colour. */
#include "tests/plugins/outputs/picture_world.h"

static void frames_draw_particles_where_they_are(void **state) {
  (void)state;
  for (int style = 0; style < 3; style++) {
    world w;
    world_open(&w, 1);
    set_still_camera(&w);
    set_number(&w, "radius", 0.1);
    *(int *)fake_field(&w.f, "style") = style + 1;
    w.x[0] = 0.305, w.x[2] = 0.205; /* 30.5 pixels right of the middle, 20.5 above */
    picture p = draw_once(&w);
    extent e = find_red(&w, 0);
    assert_in_range(e.left + e.right, 2 * 110 - 1, 2 * 110 + 1);
    assert_in_range(e.top + e.bottom, 2 * 24 - 1, 2 * 24 + 1);
    assert_in_range(e.right - e.left, style ? 8 : 17, 21);
    assert_true(is_red(&p, 110, 24));
    free(p.rgb);
    fake_close(&w.f);
  }
}

static void frames_turn_a_scene_whose_y_is_up(void **state) {
  (void)state;
  picture p[2];
  for (int y_up = 0; y_up < 2; y_up++) {
    world w;
    world_open(&w, MOST);
    make_cloth(&w, 0, 0.4);
    w.x[2] = 0.8;
    for (int i = 0; i < MOST && y_up; i++) {
      double z = w.x[3 * i + 2];
      w.x[3 * i + 2] = -w.x[3 * i + 1], w.x[3 * i + 1] = z;
    }
    *(int *)fake_field(&w.f, "up") = y_up;
    p[y_up] = draw_once(&w);
    fake_close(&w.f);
  }
  assert_memory_equal(p[0].rgb, p[1].rgb, 3 * 160 * 90);
  free(p[0].rgb), free(p[1].rgb);
}

static void frames_show_sizes_by_mass_and_by_channel(void **state) {
  (void)state;
  hk_channel channels[] = {{"paint", 3, 0}, {"r", 1, 3}};
  for (int by_channel = 0; by_channel < 2; by_channel++) {
    world w;
    double y[8] = {1, 0, 0, 1, 0, 0, 0.05, 0.1};
    world_open(&w, 2);
    set_still_camera(&w);
    w.x[0] = -0.4, w.x[3] = 0.4;
    w.mass[1] = 8;
    w.model.channel = channels, w.model.channels = 2, w.view.y = y;
    set_text(&w, "size", by_channel ? "r" : "mass");
    if (!by_channel) set_number(&w, "radius", 0.1);
    picture p = draw_once(&w);
    int width[2] = {0};
    for (int x = 0; x < 160; x++) width[x >= 80] += is_red(&p, x, 45);
    assert_in_range(width[0], 8, 11); /* 0.05 m */
    assert_in_range(width[1], 17, 21);
    free(p.rgb);
    fake_close(&w.f);
  }
}

static void frames_keep_particles_visible_and_fade_them(void **state) {
  (void)state;
  hk_channel channels[] = {{"paint", 3, 0}, {"smoke", 1, 3}};
  int red[3];
  for (int k = 0; k < 3; k++) {
    world w;
    double y[] = {1, 0, 0, k == 0 ? 1 : k == 1 ? 0.5 : -3};
    world_open(&w, 1);
    set_still_camera(&w);
    set_number(&w, "radius", 1e-9);
    set_number(&w, "least", 3);
    w.model.channel = channels, w.model.channels = 2, w.view.y = y;
    set_text(&w, "fade", "smoke");
    picture p = draw_once(&w);
    red[k] = at(&p, 80, 45)[0] - at(&p, 80, 45)[2];
    free(p.rgb);
    fake_close(&w.f);
  }
  assert_true(red[0] > 100 && red[1] > 0 && red[0] > red[1] + 30 && red[2] <= 0);
}

static void frames_colour_by_age_from_births_seen(void **state) {
  (void)state;
  const double range[] = {0, 1};
  world w;
  world_open(&w, 1);
  set_still_camera(&w);
  set_text(&w, "color", "age");
  set_number(&w, "radius", 0.2);
  *(int *)fake_field(&w.f, "map") = 4; /* grey */
  *(hk_numbers *)fake_field(&w.f, "range") = (hk_numbers){2, range};
  w.x[0] = -0.4, w.x[3] = 0.4;
  assert_int_equal(begin(&w), HK_OK);
  w.view.t = 0.6;
  assert_int_equal(add(&w), HK_OK);
  set_count(&w, 2); /* the second appears between 0.6 s and 1 s: at 1 s it is 0.2 s old */
  w.view.t = 1;
  assert_int_equal(add(&w), HK_OK);
  assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
  picture p = look(&w, 1);
  double old = at(&p, 40, 45)[1], young = at(&p, 120, 45)[1];
  assert_true(old > 200);
  assert_float_equal(young / old, 0.2, 0.08); /* both are lit alike, and the light adds a shine */
  free(p.rgb);
  fake_close(&w.f);
}

static void frames_do_not_shrink_for_few_outliers(void **state) {
  (void)state;
  int width[2];
  for (int outliers = 0; outliers < 2; outliers++) {
    world w;
    world_open(&w, MOST);
    make_cloth(&w, 0, 0);
    w.model.triangles.count = 0;
    if (outliers) w.x[3 * (MOST - 1)] = 300;
    set_number(&w, "outliers", 0.01);
    assert_int_equal(begin(&w), HK_OK);
    for (int k = 0; k < 3; k++) assert_int_equal(add(&w), HK_OK);
    assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
    extent e = find_red(&w, 0);
    width[outliers] = e.right - e.left;
    fake_close(&w.f);
  }
  assert_true(width[0] > 60 && width[1] > 0.8 * width[0]);
}

static void frames_draw_solids_and_particles_before_and_behind(void **state) {
  (void)state;
  static const double sphere[] = {0, 0, 0, 0.2}, box[] = {0.5, 0, 0, 0.2, 0.2, 0.2};
  world w;
  world_open(&w, 3);
  set_still_camera(&w);
  set_number(&w, "radius", 0.05);
  set_vector(&w, "background", 0, 0, 0);
  *(hk_numbers *)fake_field(&w.f, "spheres") = (hk_numbers){4, sphere};
  *(hk_numbers *)fake_field(&w.f, "boxes") = (hk_numbers){6, box};
  w.x[1] = -0.5;              /* before the sphere */
  w.x[3] = 0.5, w.x[4] = 0.5; /* behind the box */
  w.x[6] = -0.5;              /* beside them */
  picture p = draw_once(&w);
  assert_true(is_red(&p, 80, 45) && is_red(&p, 30, 45) && !is_red(&p, 130, 45));
  assert_true(at(&p, 130, 45)[1] > 30 && at(&p, 80, 60)[1] > 30 && at(&p, 80, 15)[1] < 5);
  free(p.rgb);
  fake_close(&w.f);
}

static void frames_have_a_legend_that_hides_particles(void **state) {
  (void)state;
  picture p[2];
  for (int many = 0; many < 2; many++) {
    const double range[] = {0, 1};
    world w;
    world_open(&w, many ? MOST : 1);
    set_still_camera(&w);
    set_switch(&w, "legend", true);
    set_integer(&w, "width", 320), set_integer(&w, "height", 240);
    set_text(&w, "color", "speed");
    set_number(&w, "radius", 0.2);
    *(hk_numbers *)fake_field(&w.f, "range") = (hk_numbers){2, range};
    for (int i = 0; i < MOST; i++) w.x[3 * i] = 0.1 * (i % SIDE) - 0.6, w.x[3 * i + 2] = 0.1 * (i / SIDE) - 0.6;
    if (!many) w.x[0] = w.x[2] = 0.5;
    p[many] = draw_once(&w);
    fake_close(&w.f);
  }
  int text = 0; /* dark letters and the bar are the same, whatever is behind */
  for (int k = 0; k < 320 * 240; k++) {
    const unsigned char *a = p[0].rgb + 3 * k, *b = p[1].rgb + 3 * k;
    bool ink = a[0] == 62 && a[1] == 68 && a[2] == 80;
    if (ink) assert_memory_equal(a, b, 3);
    text += ink;
  }
  assert_true(text > 20);
  free(p[0].rgb), free(p[1].rgb);
}

/* A picture of one particle and one of 144 at the same place: the strength of the lights is chosen by their sum. */
static void frames_expose_lights_alike_however_many(void **state) {
  (void)state;
  int red[2];
  for (int many = 0; many < 2; many++) {
    world w;
    world_open(&w, many ? MOST : 1);
    set_still_camera(&w);
    set_number(&w, "radius", 0.2);
    *(int *)fake_field(&w.f, "style") = 3; /* glow */
    picture p = draw_once(&w);
    red[many] = at(&p, 80, 45)[0];
    free(p.rgb);
    fake_close(&w.f);
  }
  assert_in_range(red[0], 200, 254);
  assert_in_range(red[1], red[0] - 4, red[0] + 4); /* rounding of a byte or two, with the background of another */
}

static void frames_warn_of_a_scale_without_numbers(void **state) {
  (void)state;
  world w;
  world_open(&w, 1);
  set_still_camera(&w);
  set_text(&w, "color", "speed");
  set_switch(&w, "log", true);
  picture p = draw_once(&w); /* at rest: speed 0 */
  assert_string_equal(w.f.warning, "color: there is no positive number for a scale of colours");
  free(p.rgb);
  fake_close(&w.f);
}

static void expect_refusal(world *w, const char *message) {
  assert_int_equal(begin(w), HK_BAD_PARAM);
  assert_string_equal(w->f.error, message);
  fake_close(&w->f);
}

static void frames_refuse_names_and_name_the_nearest(void **state) {
  (void)state;
  world w;
  world_open(&w, 1);
  set_text(&w, "color", "temperature");
  expect_refusal(&w, "color: 'temperature' is not one of auto, none, strain, tension, stress, sheet_stress, "
                     "solid_stress, speed, group, age, mass, paint");
  world_open(&w, 1);
  set_text(&w, "color", "pait");
  expect_refusal(&w, "color: 'pait' is not one of auto, none, strain, tension, stress, sheet_stress, solid_stress, "
                     "speed, group, age, mass, paint; did you mean 'paint'?");
  world_open(&w, 1);
  set_text(&w, "size", "paint");
  expect_refusal(&w, "size: the channel 'paint' has 3 numbers per particle; one is needed");
  world_open(&w, 1);
  set_text(&w, "size", "maas");
  expect_refusal(&w, "size: 'maas' is not one of auto, same, mass, paint; did you mean 'mass'?");
  world_open(&w, 1);
  set_text(&w, "fade", "x");
  w.model.channels = 0;
  set_text(&w, "color", "none");
  expect_refusal(&w, "fade: 'x': the scene has no channels");
}

static void frames_refuse_what_makes_no_picture(void **state) {
  (void)state;
  static const double backwards[] = {1, 0}, from_zero[] = {0, 1}, flat[] = {0, 0, 0, 1, 0, 1}, short_[] = {0, 0, 0};
  world w;
  world_open(&w, 1);
  *(hk_numbers *)fake_field(&w.f, "range") = (hk_numbers){2, backwards};
  expect_refusal(&w, "range: expected two numbers, the smaller first");
  world_open(&w, 1);
  *(hk_numbers *)fake_field(&w.f, "range") = (hk_numbers){2, from_zero};
  set_switch(&w, "log", true);
  expect_refusal(&w, "range: 0 has no logarithm; give two positive numbers, or log = false");
  world_open(&w, 1);
  set_number(&w, "streak", 0.1);
  *(int *)fake_field(&w.f, "style") = 1;
  expect_refusal(&w, "streak: spheres leave none; set style = \"soft\" or \"glow\"");
  world_open(&w, 1);
  set_number(&w, "opacity", 2);
  expect_refusal(&w, "opacity: 2 is above 1; only style = \"glow\" can be stronger");
  world_open(&w, 1);
  w.channel.size = 1;
  set_text(&w, "size", "paint");
  set_number(&w, "radius", 0.1);
  expect_refusal(&w, "radius: the channel 'paint' has the radii; leave one of the two out");
  world_open(&w, 1);
  set_text(&w, "unit", "K");
  expect_refusal(&w, "unit: only the numbers of a channel have none of their own");
  world_open(&w, 1);
  *(hk_numbers *)fake_field(&w.f, "boxes") = (hk_numbers){6, flat};
  expect_refusal(&w, "boxes: expected x, y, z and three extents above 0 for each");
  world_open(&w, 1);
  *(hk_numbers *)fake_field(&w.f, "spheres") = (hk_numbers){3, short_};
  expect_refusal(&w, "spheres: expected x, y, z and a radius above 0 for each");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(frames_draw_particles_where_they_are),
      cmocka_unit_test(frames_turn_a_scene_whose_y_is_up),
      cmocka_unit_test(frames_show_sizes_by_mass_and_by_channel),
      cmocka_unit_test(frames_keep_particles_visible_and_fade_them),
      cmocka_unit_test(frames_colour_by_age_from_births_seen),
      cmocka_unit_test(frames_do_not_shrink_for_few_outliers),
      cmocka_unit_test(frames_draw_solids_and_particles_before_and_behind),
      cmocka_unit_test(frames_have_a_legend_that_hides_particles),
      cmocka_unit_test(frames_expose_lights_alike_however_many),
      cmocka_unit_test(frames_warn_of_a_scale_without_numbers),
      cmocka_unit_test(frames_refuse_names_and_name_the_nearest),
      cmocka_unit_test(frames_refuse_what_makes_no_picture),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
