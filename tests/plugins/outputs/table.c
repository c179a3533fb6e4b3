#include "tests/plugins/outputs/fake_host.h"

#include <setjmp.h>

#include <cmocka.h>

static const char *const names[] = {"sag", "a,\"b\""};
static const char header[] = "t [s],kinetic [J],potential [J],work [J],energy [J],momentum x [kg m/s],momentum y [kg "
                             "m/s],momentum z [kg m/s],sag,\"a,\"\"b\"\"\"\n";

static hk_view view_at(const fake *f, double t) { return (hk_view){.t = t, .host = &f->host}; }

static hk_status begin(fake *f, const double *measure) {
  hk_view view = view_at(f, 0);
  hk_frame frame = {.fps = 60, .measures = 2, .measure_name = names, .measure = measure};
  assert_int_equal(f->plugin->create(f->self, &f->host, &view), HK_OK);
  return f->plugin->output->open(f->self, &view, &frame);
}

static hk_status add(fake *f, size_t index, const double *measure) {
  hk_view view = view_at(f, (double)index / 60);
  hk_frame frame = {.index = index,
                    .fps = 60,
                    .kinetic = 0.1,
                    .potential = -1.0 / 3,
                    .work = 1e-300,
                    .momentum = {1, -2, 3e22},
                    .measures = 2,
                    .measure_name = names,
                    .measure = measure};
  return f->plugin->output->frame(f->self, &view, &frame);
}

static void read_table(const fake *f, char *text, size_t size) {
  char path[512];
  snprintf(path, sizeof path, "%s/table.csv", f->folder);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  text[fread(text, 1, size - 1, file)] = 0;
  fclose(file);
}

static void table_has_a_line_per_frame_on_file_at_once(void **state) {
  (void)state;
  fake f;
  char text[2048], expected[2048];
  const double measure[] = {0.25, NAN};
  const char *line = "0.10000000000000001,-0.33333333333333331,1e-300,-0.23333333333333331,1,-2,3e+22,0.25,nan\n";
  fake_open(&f, "table");
  assert_int_equal(begin(&f, measure), HK_OK);
  read_table(&f, text, sizeof text);
  assert_string_equal(text, header);
  assert_int_equal(add(&f, 0, measure), HK_OK);
  assert_int_equal(add(&f, 1, measure), HK_OK);
  read_table(&f, text, sizeof text);
  snprintf(expected, sizeof expected, "%s0,%s0.016666666666666666,%s", header, line, line);
  assert_string_equal(text, expected);
  assert_int_equal(f.plugin->output->close(f.self, HK_DIVERGED), HK_OK);
  fake_close(&f);
}

static void table_leaves_out_frames_between(void **state) {
  (void)state;
  fake f;
  char text[2048];
  int lines = 0;
  const double measure[] = {0, 0};
  fake_open(&f, "table");
  *(int64_t *)fake_field(&f, "every") = 3;
  assert_int_equal(begin(&f, measure), HK_OK);
  for (size_t k = 0; k < 7; k++) assert_int_equal(add(&f, k, measure), HK_OK);
  assert_int_equal(f.plugin->output->close(f.self, HK_VERDICT_OK), HK_OK);
  read_table(&f, text, sizeof text);
  for (const char *c = text; *c; c++) lines += *c == '\n';
  assert_int_equal(lines, 4); /* header, frames 0, 3, 6 */
  fake_close(&f);
}

static void table_reports_a_full_disk(void **state) {
  (void)state;
  fake f;
  char path[512];
  const double measure[] = {0, 0};
  fake_open(&f, "table");
  snprintf(path, sizeof path, "%s/table.csv", f.folder);
  assert_int_equal(symlink("/dev/full", path), 0);
  assert_int_equal(begin(&f, measure), HK_IO);
  assert_non_null(strstr(f.error, "table.csv: No space left on device"));
  fake_close(&f);
}

static void table_reports_a_file_that_cannot_be_made(void **state) {
  (void)state;
  fake f;
  char path[512];
  const double measure[] = {0, 0};
  fake_open(&f, "table");
  snprintf(path, sizeof path, "%s/table.csv", f.folder);
  assert_int_equal(mkdir(path, 0777), 0);
  assert_int_equal(begin(&f, measure), HK_IO);
  assert_non_null(strstr(f.error, "table.csv: Is a directory"));
  fake_close(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(table_has_a_line_per_frame_on_file_at_once),
      cmocka_unit_test(table_leaves_out_frames_between),
      cmocka_unit_test(table_reports_a_full_disk),
      cmocka_unit_test(table_reports_a_file_that_cannot_be_made),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
