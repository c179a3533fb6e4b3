/* The motion of a film: camera, floor, births, files, faults. */
#include "tests/plugins/outputs/picture_world.h"

static void frames_camera_sees_the_whole_motion(void **state) {
  (void)state;
  world w;
  world_open(&w, MOST);
  make_cloth(&w, 0, 0);
  assert_int_equal(begin(&w), HK_OK);
  for (int k = 0; k < 3; k++) {
    make_cloth(&w, 1.5 * k, -0.4 * k * k);
    assert_int_equal(add(&w), HK_OK);
  }
  assert_false(there_is(&w, "frames/000000.png")); /* the camera must know the motion first */
  assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
  extent all = {0, 160, -1, 90, -1};
  for (size_t k = 0; k < 3; k++) {
    extent e = find_red(&w, k);
    assert_true(e.count > 50);
    all.left = e.left < all.left ? e.left : all.left, all.right = e.right > all.right ? e.right : all.right;
    all.top = e.top < all.top ? e.top : all.top, all.bottom = e.bottom > all.bottom ? e.bottom : all.bottom;
  }
  assert_true(all.left > 2 && all.right < 157 && all.top > 2 && all.bottom < 87);
  /* ... and stands no farther off than it must: it aims at two thirds of the height or five sixths of the width, less
   * a margin of a fiftieth of the size on each side. */
  assert_true(all.right - all.left > 0.76 * 160 || all.bottom - all.top > 0.6 * 90);
  fake_close(&w.f);
}

static void frames_light_both_sides_of_a_cloth(void **state) {
  (void)state;
  for (int side = -1; side <= 1; side += 2) {
    world w;
    world_open(&w, MOST);
    make_cloth(&w, 0, 0);
    for (size_t k = 0; k < 3 * MOST; k++) w.y[k] = 1;
    set_switch(&w, "ground", false);
    set_vector(&w, "from", 0.1, -0.2, 2 * side);
    set_vector(&w, "background", 0, 0, 0);
    assert_int_equal(begin(&w), HK_OK);
    assert_int_equal(add(&w), HK_OK);
    assert_true(there_will_be(&w, "frames/000000.png")); /* nothing to wait for but the file */
    assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
    picture p = look(&w, 0);
    const unsigned char *middle = p.rgb + 3 * (45 * 160 + 80);
    for (int c = 0; c < 3; c++) {
      assert_true(middle[c] > 80); /* of 255; white cloth */
      assert_int_equal(p.rgb[c], 0);
    }
    free(p.rgb);
    fake_close(&w.f);
  }
}

static void frames_show_the_floor_and_a_shadow_on_it(void **state) {
  (void)state;
  int darkest[2] = {255, 255};
  for (int floor = 0; floor < 2; floor++) {
    world w;
    world_open(&w, MOST);
    make_cloth(&w, 0, 0.3);
    set_switch(&w, "ground", floor);
    assert_int_equal(begin(&w), HK_OK);
    assert_int_equal(add(&w), HK_OK);
    assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
    picture p = look(&w, 0);
    for (int k = 0; k < 160 * 90; k++) {
      const unsigned char *c = p.rgb + 3 * k;
      bool grey = abs(c[0] - c[1]) < 12 && c[2] + 4 > c[1]; /* neither cloth nor its edge */
      if (grey && c[1] < darkest[floor]) darkest[floor] = c[1];
    }
    free(p.rgb);
    fake_close(&w.f);
  }
  assert_true(darkest[1] < darkest[0] - 20);
}

static void frames_have_the_size_asked_for_and_become_a_video(void **state) {
  (void)state;
  bool ffmpeg = system("command -v ffmpeg >/dev/null 2>&1") == 0;
  world w;
  world_open(&w, MOST);
  make_cloth(&w, 0, 1);
  set_integer(&w, "width", 162);
  set_integer(&w, "height", 98);
  set_integer(&w, "every", 2);
  set_switch(&w, "video", true);
  assert_int_equal(begin(&w), HK_OK);
  for (int k = 0; k < 5; k++) assert_int_equal(add(&w), HK_OK);
  assert_int_equal(end(&w, HK_STOPPED), HK_OK);
  picture p = look(&w, 0);
  assert_int_equal(p.width, 162);
  assert_int_equal(p.height, 98);
  free(p.rgb);
  assert_true(there_is(&w, "frames/000002.png"));
  assert_false(there_is(&w, "frames/000003.png"));
  assert_int_equal(there_is(&w, "video.mp4"), ffmpeg);
  assert_int_equal(strstr(w.f.warning, "ffmpeg") == NULL, ffmpeg);
  fake_close(&w.f);
}

/* H.264 has two by two pixels of one colour. */
static void frames_refuse_a_video_of_odd_size(void **state) {
  (void)state;
  world w;
  world_open(&w, 1);
  set_integer(&w, "width", 161);
  set_switch(&w, "video", true);
  assert_int_equal(begin(&w), HK_BAD_PARAM);
  assert_non_null(strstr(w.f.error, "not 161 x 90: take 162 x 90, or video = false"));
  set_switch(&w, "video", false);
  picture p = draw_once(&w);
  assert_int_equal(p.width, 161);
  free(p.rgb);
  fake_close(&w.f);
}

static void frames_can_be_a_video_alone(void **state) {
  (void)state;
  if (system("command -v ffmpeg >/dev/null 2>&1") != 0) skip();
  world w;
  world_open(&w, MOST);
  make_cloth(&w, 0, 1);
  set_switch(&w, "pictures", false);
  assert_int_equal(w.f.plugin->create(w.f.self, &w.f.host, &w.view), HK_OK);
  assert_non_null(strstr(w.f.warning, "nothing is written"));
  set_switch(&w, "video", true);
  assert_int_equal(begin(&w), HK_OK);
  for (int k = 0; k < 7; k++) assert_int_equal(add(&w), HK_OK); /* more than wait for the program at any time */
  assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
  assert_true(there_is(&w, "video.mp4"));
  assert_false(there_is(&w, "frames/000000.png"));
  fake_close(&w.f);
}

/* A particle 20 pixels wide goes on by 15 pixels a frame; stills are a third as large, three in a row. */
static void frames_put_stills_on_a_sheet(void **state) {
  (void)state;
  world w;
  char path[512];
  world_open(&w, 1);
  set_still_camera(&w);
  set_number(&w, "radius", 0.1);
  set_integer(&w, "sheet", 5);
  assert_int_equal(begin(&w), HK_OK);
  for (int k = 0; k < 9; k++) {
    w.x[0] = -0.6 + 0.15 * k;
    assert_int_equal(add(&w), HK_OK);
  }
  assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
  snprintf(path, sizeof path, "%s/sheet.png", w.f.folder);
  picture p = read_picture(path);
  assert_int_equal(p.width, 3 * 53 + 2 * 4);
  assert_int_equal(p.height, 2 * 30 + 4);
  for (int k = 0; k < 6; k++) { /* pictures 0, 2, 4, 6, 8, and no sixth one */
    int x = k % 3 * 57 + (k < 5 ? (80 - 60 + 30 * k) / 3 : 26), y = k / 3 * 34 + 15;
    assert_int_equal(is_red(&p, x, y), k < 5);
    assert_false(is_red(&p, x, y + 10));
  }
  for (int c = 0; c < 3; c++) {
    assert_int_equal(at(&p, 54, 10)[c], 255); /* between two stills */
    assert_int_equal(at(&p, 140, 50)[c], 255);
  }
  free(p.rgb);
  fake_close(&w.f);
}

/* A cloth that flies 20 times its own length: it stays in the middle, as large as it was. With the camera left out or
 * given. The fit is around the box of what is seen, whose corners are empty: less than 2/3 is filled. */
static void frames_camera_follows_the_particles(void **state) {
  (void)state;
  for (int given = 0; given < 2; given++) {
    world w;
    world_open(&w, MOST);
    make_cloth(&w, 0, 0);
    set_switch(&w, "follow", true);
    if (given) set_vector(&w, "from", 0, -3, 1);
    if (given) set_vector(&w, "look_at", 0, 0, 0);
    assert_int_equal(begin(&w), HK_OK);
    for (int k = 0; k < 21; k++) {
      make_cloth(&w, k, 0.5 * k);
      assert_int_equal(add(&w), HK_OK);
    }
    assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
    extent middle = find_red(&w, 10);
    int width = middle.right - middle.left, height = middle.top - middle.bottom;
    assert_true(width > 0.3 * 160 || -height > 0.4 * 90);
    for (size_t k = 0; k < 21; k++) {
      extent e = find_red(&w, k);
      assert_in_range(abs(e.left + e.right - 159), 0, 16); /* the middle of the box is not that of the picture of it */
      assert_in_range(abs(e.right - e.left - width), 0, 3);
    }
    fake_close(&w.f);
  }
}

/* A camera that turns by a quarter: what was deep is wide, in pictures that wait and in those that do not. */
static void frames_camera_moves_with_time(void **state) {
  (void)state;
  for (int waits = 0; waits < 2; waits++) {
    world w;
    world_open(&w, 2);
    set_still_camera(&w);
    set_number(&w, "radius", 0.1);
    set_integer(&w, "sheet", waits);
    w.x[1] = -0.4, w.x[4] = 0.4;
    assert_int_equal(begin(&w), HK_OK);
    assert_int_equal(add(&w), HK_OK);
    set_vector(&w, "from", 10, 0, 0);
    assert_int_equal(add(&w), HK_OK);
    assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
    extent before = find_red(&w, 0), after = find_red(&w, 1);
    assert_in_range(before.right - before.left, 18, 23);
    assert_in_range(after.right - after.left, 97, 103); /* 0.8 m and two radii, a pixel a centimetre */
    fake_close(&w.f);
  }
}

static void frames_say_why_there_is_no_video(void **state) {
  (void)state;
  char *path = strdup(getenv("PATH")), program[512];
  for (int broken = 0; broken < 2; broken++) {
    world w;
    world_open(&w, 1);
    snprintf(program, sizeof program, "%s/ffmpeg", w.f.folder);
    FILE *file = broken ? fopen(program, "w") : NULL;
    if (file) {
      fputs("#!/bin/sh\necho first >&2\necho the disk is sour >&2\nexit 3\n", file);
      fclose(file);
      chmod(program, 0700);
    }
    setenv("PATH", w.f.folder, 1);
    set_switch(&w, "video", true);
    assert_int_equal(begin(&w), HK_OK);
    assert_int_equal(add(&w), HK_OK);
    assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
    setenv("PATH", path, 1);
    assert_true(there_is(&w, "frames/000000.png"));
    assert_non_null(
        strstr(w.f.warning, broken ? "no video: ffmpeg: the disk is sour" : "no video: there is no program"));
    fake_close(&w.f);
  }
  free(path);
}

static void frames_follow_births_and_deaths(void **state) {
  (void)state;
  static const size_t count[] = {3, 0, 9, 144, 1};
  world w;
  world_open(&w, 3);
  for (size_t i = 0; i < 3 * MOST; i++) w.x[i] = sin(12.9898 * (double)i);
  assert_int_equal(begin(&w), HK_OK);
  for (size_t k = 0; k < 5; k++) {
    set_count(&w, count[k]);
    assert_int_equal(add(&w), HK_OK);
  }
  assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
  for (size_t k = 0; k < 5; k++) assert_int_equal(find_red(&w, k).count > 0, count[k] > 0);
  assert_true(find_red(&w, 3).count > 5 * find_red(&w, 2).count);
  fake_close(&w.f);
}

static void frames_drawn_at_once_follow_a_scene_that_starts_empty(void **state) {
  (void)state;
  world w;
  world_open(&w, 0);
  set_vector(&w, "from", 0, -20, 5);
  set_vector(&w, "look_at", 0, 0, 0);
  set_number(&w, "ground_height", -2);
  set_number(&w, "radius", 1);
  assert_int_equal(begin(&w), HK_OK);
  assert_int_equal(add(&w), HK_OK);
  set_count(&w, 1);
  for (size_t k = 1; k < 4; k++) { /* coming from afar */
    w.x[1] = 40.0 * (3 - (double)k);
    assert_int_equal(add(&w), HK_OK);
  }
  assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
  assert_int_equal(find_red(&w, 0).count, 0);
  for (size_t k = 1; k < 4; k++) assert_true(find_red(&w, k).count > find_red(&w, k - 1).count);
  fake_close(&w.f);
}

static void frames_of_a_diverged_run_show_what_went_before(void **state) {
  (void)state;
  world w;
  world_open(&w, MOST);
  make_cloth(&w, 0, 0);
  assert_int_equal(begin(&w), HK_OK);
  for (int k = 0; k < 4; k++) assert_int_equal(add(&w), HK_OK);
  w.x[0] = 1e30, w.x[4] = -1e300, w.x[8] = NAN, w.x[9] = INFINITY;
  assert_int_equal(add(&w), HK_OK);
  assert_int_equal(end(&w, HK_DIVERGED), HK_OK);
  extent before = find_red(&w, 0), after = find_red(&w, 4);
  assert_true(before.right - before.left > 80 || before.bottom - before.top > 45);
  assert_true(after.count > 0.8 * before.count); /* all but the triangles at four of 144 particles */
  fake_close(&w.f);
}

static void frames_colour_springs_by_strain(void **state) {
  (void)state;
  for (int sign = -1; sign <= 1; sign += 2) {
    const double range[] = {-0.1, 0.1};
    world w;
    world_open(&w, 8);
    make_chain(&w, 0.1 * sign);
    set_text(&w, "color", "auto");
    set_switch(&w, "legend", false);
    *(hk_numbers *)fake_field(&w.f, "range") = (hk_numbers){2, range};
    assert_int_equal(begin(&w), HK_OK);
    assert_int_equal(add(&w), HK_OK);
    assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
    picture p = look(&w, 0);
    int red = 0, blue = 0;
    for (int k = 0; k < 160 * 90; k++) {
      red += p.rgb[3 * k] > p.rgb[3 * k + 2] + 60;
      blue += p.rgb[3 * k + 2] > p.rgb[3 * k] + 60;
    }
    free(p.rgb);
    assert_true(sign > 0 ? red > 50 && blue == 0 : blue > 50 && red == 0);
    fake_close(&w.f);
  }
}

/* Pixels in the strong colour of a chain of which every other spring is stretched by 10 %, and the others by `between`.
 */
static int strong_pixels(double between) {
  const double range[] = {-0.1, 0.1};
  world w;
  world_open(&w, 8); /* both ends are of a spring that is stretched by 10 % */
  make_chain(&w, 0);
  for (uint32_t i = 0; i < w.n; i++) w.x[3 * i] += (i + 1) / 2 * 0.01 + i / 2 * 0.1 * between;
  set_text(&w, "color", "strain");
  set_switch(&w, "legend", false);
  *(hk_numbers *)fake_field(&w.f, "range") = (hk_numbers){2, range};
  assert_int_equal(begin(&w), HK_OK);
  assert_int_equal(add(&w), HK_OK);
  assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
  picture p = look(&w, 0);
  int strong = 0;
  for (int k = 0; k < 160 * 90; k++) strong += p.rgb[3 * k] > p.rgb[3 * k + 2] + 60;
  free(p.rgb);
  fake_close(&w.f);
  return strong;
}

/* A mean of both springs is pale in the middle: 0.6 of the pixels. */
static void frames_show_the_largest_strain_at_a_particle(void **state) {
  (void)state;
  assert_true(strong_pixels(-0.05) > 0.9 * strong_pixels(0.1));
}

static void frames_report_a_full_disk(void **state) {
  (void)state;
  world w;
  char path[512];
  world_open(&w, 1);
  assert_int_equal(begin(&w), HK_OK);
  snprintf(path, sizeof path, "%s/frames/000000.png", w.f.folder);
  assert_int_equal(symlink("/dev/full", path), 0);
  assert_int_equal(add(&w), HK_OK);
  assert_int_equal(end(&w, HK_VERDICT_OK), HK_IO);
  assert_non_null(strstr(w.f.error, "000000.png: No space left on device"));
  fake_close(&w.f);
}

static void frames_report_a_folder_that_cannot_be_used(void **state) {
  (void)state;
  world w;
  char path[512];
  world_open(&w, 1);
  snprintf(path, sizeof path, "%s/frames", w.f.folder);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fclose(file);
  assert_int_equal(begin(&w), HK_IO);
  assert_non_null(strstr(w.f.error, "Not a directory"));
  fake_close(&w.f);
}

static void frames_survive_want_of_memory_anywhere(void **state) {
  (void)state;
  hk_status status = HK_NO_MEMORY;
  for (long k = 0; status != HK_OK; k++) {
    world w;
    world_open(&w, 8);
    make_chain(&w, 0);
    set_number(&w, "radius", 0.02);
    w.f.allocations_left = k;
    hk_status opened = status = begin(&w);
    if (status == HK_OK) status = add(&w);
    if (opened == HK_OK) {
      hk_status closed = end(&w, HK_STOPPED);
      if (status == HK_OK) status = closed;
    }
    if (status != HK_OK) {
      assert_int_equal(status, HK_NO_MEMORY);
      assert_non_null(strstr(w.f.error, "no memory"));
    }
    fake_close(&w.f);
    assert_true(k < 100);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(frames_camera_sees_the_whole_motion),
      cmocka_unit_test(frames_light_both_sides_of_a_cloth),
      cmocka_unit_test(frames_show_the_floor_and_a_shadow_on_it),
      cmocka_unit_test(frames_have_the_size_asked_for_and_become_a_video),
      cmocka_unit_test(frames_camera_follows_the_particles),
      cmocka_unit_test(frames_camera_moves_with_time),
      cmocka_unit_test(frames_put_stills_on_a_sheet),
      cmocka_unit_test(frames_refuse_a_video_of_odd_size),
      cmocka_unit_test(frames_can_be_a_video_alone),
      cmocka_unit_test(frames_say_why_there_is_no_video),
      cmocka_unit_test(frames_follow_births_and_deaths),
      cmocka_unit_test(frames_drawn_at_once_follow_a_scene_that_starts_empty),
      cmocka_unit_test(frames_of_a_diverged_run_show_what_went_before),
      cmocka_unit_test(frames_colour_springs_by_strain),
      cmocka_unit_test(frames_show_the_largest_strain_at_a_particle),
      cmocka_unit_test(frames_report_a_full_disk),
      cmocka_unit_test(frames_report_a_folder_that_cannot_be_used),
      cmocka_unit_test(frames_survive_want_of_memory_anywhere),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
