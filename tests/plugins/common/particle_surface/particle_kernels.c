/* Anisotropic kernels against closed forms: balls in a full liquid, flat ones in a sheet, the mean of two; turned with
 * the particles; and how flat a face is beside what the other fields make of it. */
#include "plugins/common/particle_surface/particle_kernels.h"
#include "plugins/common/particle_surface/particle_surface.h"
#include "tests/plugins/common/isosurface/balls.h"

enum { MOST = 12000 };

static double place[MOST][3], turned[MOST][3];

/* A lattice of that spacing from the origin, moved by up to `noise` of it in each direction. */
static size_t fill_block(size_t nx, size_t ny, size_t nz, double spacing, double noise) {
  uint64_t seed = 9;
  size_t n = 0;
  assert_true(nx * ny * nz <= MOST);
  for (; n < nx * ny * nz; n++) {
    size_t at[3] = {n % nx, n / nx % ny, n / nx / ny};
    for (int c = 0; c < 3; c++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      place[n][c] = spacing * ((double)at[c] + 2 * noise * ((double)(seed >> 40) / (double)(1 << 24) - 0.5));
    }
  }
  return n;
}

static hk_particle_kernels make(bench *b, const double (*x)[3], size_t n, hk_particle_surface_options o) {
  hk_particle_kernels k = {0};
  o.kind = HK_ANISOTROPIC;
  assert_int_equal(hk_particle_options_complete(&o, &b->instance.host), HK_OK);
  assert_int_equal(hk_particle_kernels_make(&k, &b->instance.host, x, n, &o), HK_OK);
  return k;
}

/* A sum over 123 points stands for the integral of the covariance: some percent. */
static void a_full_liquid_has_balls_about_its_particles(void **state) {
  (void)state;
  bench b;
  open_bench(&b, 1);
  size_t n = fill_block(13, 13, 13, 0.1, 0), middle = n / 2;
  hk_particle_kernels k = make(&b, (const double(*)[3])place, n, (hk_particle_surface_options){.radius = 0.05});
  const double *form = k.kernel[middle].form, full = 1 / (0.15 * 0.15);
  for (int c = 0; c < 3; c++) {
    assert_true(fabs(form[c] / full - 1) < 0.1 && fabs(form[3 + c]) < 1e-9 * full);
    assert_true(fabs(k.centre[middle][c] - place[middle][c]) < 1e-14);
  }
  assert_true(fabs(k.kernel[middle].reach - 0.3) < 0.015);
  hk_particle_kernels_free(&k, &b.instance.host);
  close_bench(&b);
}

/* Of no extent along z, so that the largest ratio of axes is met. */
static void a_sheet_has_kernels_as_flat_as_is_allowed(void **state) {
  (void)state;
  bench b;
  open_bench(&b, 1);
  size_t n = fill_block(9, 9, 1, 0.1, 0);
  for (int stretch = 1; stretch < 10; stretch += 4) {
    hk_particle_kernels k = make(&b, (const double(*)[3])place, n,
                                 (hk_particle_surface_options){.radius = 0.05, .stretch = stretch, .few = 10});
    const double *form = k.kernel[n / 2].form;
    assert_true(fabs(form[1] / form[0] - 1) < 1e-9 && fabs(form[2] / form[0] - stretch * stretch) < 1e-8);
    hk_particle_kernels_free(&k, &b.instance.host);
  }
  close_bench(&b);
}

static void two_particles_draw_together(void **state) {
  (void)state;
  static const double asked[3] = {1, 0.4, -1}, took[3] = {1, 0.4, 0};
  bench b;
  open_bench(&b, 1);
  memset(place, 0, sizeof place);
  place[1][1] = 0.3;
  for (int c = 0; c < 3; c++) {
    hk_particle_kernels k =
        make(&b, (const double(*)[3])place, 2,
             (hk_particle_surface_options){.radius = 0.1, .reach = 0.5, .lone = 0.5, .position_smoothing = asked[c]});
    double w = 1 - 0.6 * 0.6 * 0.6;
    /* Either mean is w/(1 + w) of the way to the other particle, and their average the part (1 - w)/(1 + w) of that. */
    double part = w / (1 + w) * (1 - (1 - w) / (1 + w));
    assert_true(fabs(k.centre[0][1] - took[c] * 0.3 * part) < 1e-15 && k.centre[0][0] == 0);
    assert_true(fabs(k.kernel[0].form[1] - 1 / (0.125 * 0.125)) < 1e-10); /* few neighbours: a ball of half the reach */
    assert_true(k.kernel[0].reach == 0.25);
    hk_particle_kernels_free(&k, &b.instance.host);
  }
  close_bench(&b);
}

/* The value of the field of kernels at a place, as a sum over all of them. */
static double value_at(const hk_particle_kernels *k, size_t n, const double x[3]) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) {
    const double *a = k->kernel[i].form,
                 d[3] = {x[0] - k->centre[i][0], x[1] - k->centre[i][1], x[2] - k->centre[i][2]};
    double q = sqrt(a[0] * d[0] * d[0] + a[1] * d[1] * d[1] + a[2] * d[2] * d[2] +
                    2 * (a[3] * d[1] * d[2] + a[4] * d[0] * d[2] + a[5] * d[0] * d[1]));
    sum += k->kernel[i].amplitude * (q < 1 ? 1 - 1.5 * q * q + 0.75 * q * q * q : q < 2 ? pow(2 - q, 3) / 4 : 0);
  }
  return sum;
}

static void turn(const double x[3], double to[3]) { /* by 0.6 about z, then by 1.1 about x */
  double u = cos(0.6) * x[0] - sin(0.6) * x[1], v = sin(0.6) * x[0] + cos(0.6) * x[1];
  to[0] = u, to[1] = cos(1.1) * v - sin(1.1) * x[2], to[2] = sin(1.1) * v + cos(1.1) * x[2];
}

static void kernels_turn_with_the_particles(void **state) {
  (void)state;
  bench b;
  open_bench(&b, 2);
  size_t n = fill_block(8, 8, 3, 0.1, 0.3);
  for (size_t i = 0; i < n; i++) turn(place[i], turned[i]);
  hk_particle_surface_options o = {.radius = 0.05};
  hk_particle_kernels k = make(&b, (const double(*)[3])place, n, o), l = make(&b, (const double(*)[3])turned, n, o);
  for (int s = 0; s < 40; s++) {
    double x[3] = {0.02 * s, 0.3 + 0.01 * s, 0.35 - 0.012 * s}, y[3];
    turn(x, y);
    double value = value_at(&k, n, x), other = value_at(&l, n, y);
    if (!(fabs(value - other) < 1e-9 * (1 + value))) fail_msg("%g, turned %g", value, other); /* axes to rounding */
  }
  hk_particle_kernels_free(&k, &b.instance.host);
  hk_particle_kernels_free(&l, &b.instance.host);
  close_bench(&b);
}

typedef struct face {
  double height, rms, volume;
} face;

/* Of the upper face z, far from the edges, m; the volume in those of the particles' cubes. */
static face measure_face(size_t n, double spacing, hk_particle_surface_options o) {
  bench b;
  face f = {0};
  double count = 0;
  open_bench(&b, 2);
  assert_int_equal(hk_particle_surface_find(&b.surface, &b.instance.host, (const double(*)[3])place, n, &o), HK_OK);
  assert_int_equal(count_broken(&b.surface), 0);
  for (int pass = 0; pass < 2; pass++) {
    for (size_t v = 0; v < b.surface.vertices; v++) {
      const double *x = b.surface.x[v];
      if (fabs(x[0] - 0.9) > 0.4 || fabs(x[1] - 0.9) > 0.4 || x[2] < 0.4) continue;
      if (pass == 0) f.height += x[2], count++;
      if (pass == 1) f.rms += pow(x[2] - f.height, 2);
    }
    if (pass == 0) f.height /= count;
  }
  f.rms = sqrt(f.rms / count);
  f.volume = surface_volume(&b.surface) / ((double)n * pow(spacing, 3));
  close_bench(&b);
  return f;
}

/* A block of 19 x 19 x 8 particles, of which the uppermost are at 0.7 m, so that the face is at 0.75 m. What is said
 * in particle_surface.h. */
static void a_face_is_flatter_than_by_other_fields_and_in_its_place(void **state) {
  (void)state;
  for (int noisy = 0; noisy < 2; noisy++) {
    size_t n = fill_block(19, 19, 8, 0.1, noisy ? 0.25 : 0);
    face f[3];
    for (int kind = 0; kind < 3; kind++)
      f[kind] = measure_face(
          n, 0.1,
          (hk_particle_surface_options){.kind = (hk_particle_field_kind)kind, .radius = 0.05, .without_normals = true});
    double off = fabs(f[2].height - 0.75) / 0.1, rms = f[2].rms / 0.1;
    if (!(off < 0.12 && rms < (noisy ? 0.075 : 5e-4) && fabs(f[2].volume - 1) < 0.055 && f[2].rms < 0.75 * f[0].rms &&
          f[2].rms < 0.75 * f[1].rms))
      fail_msg("off by %g spacings, rms %g (%g, %g), volume %g (%g, %g)", off, rms, f[0].rms / 0.1, f[1].rms / 0.1,
               f[2].volume, f[0].volume, f[1].volume);
  }
}

/* The particles of a cubic lattice within a ball of ten spacings; the volume is that of their cubes. */
static void a_ball_has_its_volume(void **state) {
  (void)state;
  bench b;
  size_t n = 0;
  long euler[1] = {0};
  open_bench(&b, 2);
  for (int k = 0; k < 21 * 21 * 21; k++) {
    double x[3] = {0.1 * (k % 21 - 10), 0.1 * (k / 21 % 21 - 10), 0.1 * (k / 441 - 10)};
    if (x[0] * x[0] + x[1] * x[1] + x[2] * x[2] <= 1) memcpy(place[n++], x, sizeof x);
  }
  assert_int_equal(hk_particle_surface_find(&b.surface, &b.instance.host, (const double(*)[3])place, n,
                                            &(hk_particle_surface_options){.kind = HK_ANISOTROPIC, .radius = 0.05}),
                   HK_OK);
  assert_true(find_components(&b.surface, euler, 1) == 1 && euler[0] == 2);
  double volume = surface_volume(&b.surface) / ((double)n * 1e-3);
  double area = surface_area(&b.surface) / (4 * M_PI * pow(3 * surface_volume(&b.surface) / (4 * M_PI), 2 / 3.0));
  if (!(fabs(volume - 1) < 0.02 && area > 1 && area < 1.05)) fail_msg("volume %g, area %g", volume, area);
  close_bench(&b);
}

/* More than N_eps at one place have no covariance; the drop of one particle has somewhat more than its cube's volume.
 */
static void drops_are_balls(void **state) {
  (void)state;
  for (size_t n = 1; n < 80; n += 39) {
    bench b;
    long euler[1] = {0};
    open_bench(&b, 1);
    memset(place, 0, sizeof place);
    hk_particle_surface_options o = {.kind = HK_ANISOTROPIC, .radius = 0.05, .cell = 0.01};
    assert_int_equal(hk_particle_surface_find(&b.surface, &b.instance.host, (const double(*)[3])place, n, &o), HK_OK);
    assert_true(find_components(&b.surface, euler, 1) == 1 && euler[0] == 2);
    double volume = surface_volume(&b.surface) / 1e-3;
    if (n == 1 && !(volume > 1 && volume < 1.4)) fail_msg("a drop has the volume %g", volume);
    close_bench(&b);
  }
}

static void refused(hk_particle_surface_options options, const char *text) {
  bench b;
  open_bench(&b, 1);
  options.kind = HK_ANISOTROPIC, options.radius = 1;
  hk_status status = hk_particle_surface_find(&b.surface, &b.instance.host, (const double(*)[3])place, 1, &options);
  if (status != HK_BAD_PARAM || !strstr(b.error.text, text)) fail_msg("%d: %s", (int)status, b.error.text);
  close_bench(&b);
}

static void what_cannot_be_is_said(void **state) {
  (void)state;
  refused((hk_particle_surface_options){.position_smoothing = 1.5}, "positions smoothed by 1.5");
  refused((hk_particle_surface_options){.position_smoothing = NAN}, "positions smoothed by nan");
  refused((hk_particle_surface_options){.stretch = 0.5}, "kernels stretched up to 0.5");
  refused((hk_particle_surface_options){.lone = 2}, "kernels of lone particles of 2 reaches");
  refused((hk_particle_surface_options){.threshold = 1}, "a threshold of 1: ");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_full_liquid_has_balls_about_its_particles),
                                     cmocka_unit_test(a_sheet_has_kernels_as_flat_as_is_allowed),
                                     cmocka_unit_test(two_particles_draw_together),
                                     cmocka_unit_test(kernels_turn_with_the_particles),
                                     cmocka_unit_test(a_face_is_flatter_than_by_other_fields_and_in_its_place),
                                     cmocka_unit_test(a_ball_has_its_volume),
                                     cmocka_unit_test(drops_are_balls),
                                     cmocka_unit_test(what_cannot_be_is_said)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
