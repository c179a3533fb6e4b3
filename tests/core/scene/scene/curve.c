/* Curves by arc length and the stiffnesses of sections, against closed forms: a helix has unit speed, its radius and
 * its pitch; one that is given by curvature and torsion has these; points divide a polygon into equal lengths. */
#include "core/scene/scene/scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const double pi = 3.141592653589793;
static const double origin[3] = {0.3, -1, 2}, z[3] = {0, 0, 1};

static double distance(const double a[3], const double b[3]) {
  return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static double length(const double a[3]) { return distance(a, (const double[3]){0}); }

/* The k-th central difference of the point at s, k = 1 to 3, of order h^2. */
static void differ(const hk_helix *helix, int k, double s, double h, double out[3]) {
  double p[4][3];
  for (int i = 0; i < 4; i++) hk_helix_at(helix, s + (i < 2 ? i - 2 : i - 1) * h, p[i]);
  double x[3];
  hk_helix_at(helix, s, x);
  for (int c = 0; c < 3; c++)
    out[c] = k == 1   ? (p[2][c] - p[1][c]) / (2 * h)
             : k == 2 ? (p[2][c] - 2 * x[c] + p[1][c]) / (h * h)
                      : (p[3][c] - 2 * p[2][c] + 2 * p[1][c] - p[0][c]) / (2 * h * h * h);
}

/* After one turn, of the length sqrt((2 pi r)^2 + p^2), it has come a pitch along the axis. */
static void a_helix_has_its_radius_and_pitch(void **state) {
  (void)state;
  const double radius = 0.5, pitch = -0.7, turn = sqrt(4 * pi * pi * radius * radius + pitch * pitch);
  hk_helix helix = hk_helix_about(origin, z, 0.4, radius, pitch);
  double a[3], b[3], half[3];
  hk_helix_at(&helix, 0, a);
  hk_helix_at(&helix, turn / 2, half);
  hk_helix_at(&helix, turn, b);
  assert_true(distance(a, origin) < 1e-14);
  assert_true(fabs(b[0] - a[0]) < 1e-14 && fabs(b[1] - a[1]) < 1e-14);
  assert_true(fabs(fabs(b[2] - a[2]) - fabs(pitch)) < 1e-14);
  half[2] = a[2]; /* the other side of the axis */
  assert_true(fabs(distance(half, a) - 2 * radius) < 1e-14);
}

/* Frenet: |x'| = 1, |x''| = curvature, x'.(x'' x x''') = curvature^2 torsion. h = 1e-3: differences are off by h^2
 * times derivatives of order 100, and by rounding 1e-16 / h^3. */
static void a_helix_has_its_curvature_and_torsion(void **state) {
  (void)state;
  const double curvature = 2, torsion = 1.5, tangent[3] = {0.6, 0, 0.8}, s = 0.3, h = 1e-3, tolerance = 1e-4;
  hk_helix helix = hk_helix_along(origin, tangent, 1, curvature, torsion);
  double t[3], d[3][3];
  hk_helix_tangent(&helix, t);
  assert_true(distance(t, tangent) < 1e-14);
  for (int k = 0; k < 3; k++) differ(&helix, k + 1, s, h, d[k]);
  double triple = 0;
  for (int c = 0; c < 3; c++) {
    int i = (c + 1) % 3, j = (c + 2) % 3;
    triple += d[0][c] * (d[1][i] * d[2][j] - d[1][j] * d[2][i]);
  }
  assert_true(fabs(length(d[0]) - 1) < tolerance);
  assert_true(fabs(length(d[1]) - curvature) < tolerance * curvature);
  assert_true(fabs(triple - curvature * curvature * torsion) < tolerance * curvature * curvature * torsion);
}

static void points_divide_a_polygon_into_equal_lengths(void **state) {
  (void)state;
  const double corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 3, 0}, {1, 3, 2}};
  double place[7];
  assert_true(hk_polygon_length(corner, 4) == 6);
  hk_polygon_divide(corner, 4, 7, place);
  const double wanted[7] = {0, 1, 1 + 1 / 3.0, 1 + 2 / 3.0, 2, 2.5, 3};
  for (int k = 0; k < 7; k++) assert_true(fabs(place[k] - wanted[k]) < 1e-14);
}

/* Steel wire: A = pi a b, I = pi a b^3 / 4 about the axis a, and for a circle GJ = G pi r^4 / 2. */
static void the_stiffness_of_a_section_is_that_of_an_ellipse(void **state) {
  (void)state;
  const double E = 200e9, nu = 0.3, r = 1e-3;
  hk_section_numbers circle = hk_section_of(&(hk_section){.half_axis = {r, r}, .E = E, .nu = nu, .density = 7800});
  assert_true(fabs(circle.EA / (E * pi * r * r) - 1) < 1e-14);
  assert_true(fabs(circle.line_mass / (7800 * pi * r * r) - 1) < 1e-14);
  for (int k = 0; k < 2; k++) assert_true(fabs(circle.EI[k] / (E * pi * pow(r, 4) / 4) - 1) < 1e-14);
  assert_true(fabs(circle.GJ / (E / (2 * (1 + nu)) * pi * pow(r, 4) / 2) - 1) < 1e-14);
  hk_section_numbers flat = hk_section_of(&(hk_section){.half_axis = {3 * r, r}, .E = E, .nu = nu, .density = 7800});
  assert_true(fabs(flat.EI[0] / flat.EI[1] - 9) < 1e-13); /* towards the long half axis it is stiffer, by its square */
  hk_error error = {0};
  assert_int_equal(hk_section_check(&(hk_section){.half_axis = {r, -r}, .E = E, .nu = nu, .density = 1}, &error),
                   HK_BAD_PARAM);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_helix_has_its_radius_and_pitch),
      cmocka_unit_test(a_helix_has_its_curvature_and_torsion),
      cmocka_unit_test(points_divide_a_polygon_into_equal_lengths),
      cmocka_unit_test(the_stiffness_of_a_section_is_that_of_an_ellipse),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
