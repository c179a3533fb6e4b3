/* Signed distances against brute force: the nearest of points spread over the surface, which is never nearer than the
 * distance and, with points `spacing` apart, not farther than it by more than spacing^2/(2 d) or spacing. Meshes
 * against the shapes that they are of. */
#include "plugins/common/obstacles/shape.h"
#include "plugins/kit/vector3.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t seed = 7;

static double noise(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) * 0x1.0p-52 - 1;
}

enum { LINES = 400, SAMPLES = 6 * LINES * LINES };
static double (*sample)[3];
static size_t samples;

static void take(double x, double y, double z) {
  double *s = sample[samples++];
  s[0] = x, s[1] = y, s[2] = z;
}

/* Points of the surface, some 2 extent/LINES apart. */
static void spread(const hk_shape *s) {
  const double *b = s->half;
  samples = 0;
  for (int i = 0; i <= LINES; i++)
    for (int j = 0; j < LINES; j++) {
      double u = 2.0 * i / LINES - 1, v = 2.0 * j / (LINES - 1) - 1, angle = 2 * acos(-1) * j / LINES;
      double c = cos(angle), d = sin(angle), tilt = acos(-1) * i / LINES;
      if (s->kind == HK_SHAPE_SPHERE) take(b[0] * sin(tilt) * c, b[0] * sin(tilt) * d, b[0] * cos(tilt));
      if (s->kind == HK_SHAPE_BOX) {
        take(b[0], u * b[1], v * b[2]), take(-b[0], u * b[1], v * b[2]);
        take(u * b[0], b[1], v * b[2]), take(u * b[0], -b[1], v * b[2]);
        take(u * b[0], v * b[1], b[2]), take(u * b[0], v * b[1], -b[2]);
      }
      if (s->kind == HK_SHAPE_CYLINDER) {
        take(b[0] * c, b[0] * d, u * b[2]);
        take(b[0] * i / LINES * c, b[0] * i / LINES * d, b[2]), take(b[0] * i / LINES * c, b[0] * i / LINES * d, -b[2]);
      }
      if (s->kind == HK_SHAPE_CAPSULE) {
        double straight = b[2] - b[0], z = b[0] * cos(tilt);
        take(b[0] * c, b[0] * d, u * straight);
        take(b[0] * sin(tilt) * c, b[0] * sin(tilt) * d, z + copysign(straight, z));
      }
    }
}

static bool inside(const hk_shape *s, const double p[3]) {
  const double *b = s->half;
  double rho = hypot(p[0], p[1]), z = fmax(0, fabs(p[2]) - (b[2] - b[0]));
  if (s->kind == HK_SHAPE_SPHERE) return hk_length(p) < b[0];
  if (s->kind == HK_SHAPE_BOX) return fabs(p[0]) < b[0] && fabs(p[1]) < b[1] && fabs(p[2]) < b[2];
  if (s->kind == HK_SHAPE_CYLINDER) return rho < b[0] && fabs(p[2]) < b[2];
  return hypot(rho, z) < b[0];
}

static double nearest(const double p[3]) {
  double best2 = INFINITY, d[3];
  for (size_t k = 0; k < samples; k++) {
    hk_subtract(d, p, sample[k]);
    best2 = fmin(best2, hk_dot(d, d));
  }
  return sqrt(best2);
}

static void distances_agree_with_brute_force(void **state) {
  (void)state;
  static const hk_shape shapes[] = {{.kind = HK_SHAPE_SPHERE, .half = {0.7, 0.7, 0.7}},
                                    {.kind = HK_SHAPE_BOX, .half = {0.5, 0.8, 0.2}},
                                    {.kind = HK_SHAPE_CYLINDER, .half = {0.4, 0.4, 0.9}},
                                    {.kind = HK_SHAPE_CAPSULE, .half = {0.3, 0.3, 0.8}}};
  sample = malloc((SAMPLES + 6 * LINES) * sizeof *sample);
  for (size_t q = 0; q < 4; q++) {
    double spacing = 2 * acos(-1) * 0.8 / LINES, worst = 0;
    spread(&shapes[q]);
    for (int k = 0; k < 60; k++) {
      double p[3] = {1.2 * noise(), 1.2 * noise(), 1.2 * noise()}, n[3], d = hk_shape_distance(&shapes[q], p, n);
      double brute = nearest(p), off = brute - fabs(d);
      worst = fmax(worst, off);
      assert_true((d < 0) == inside(&shapes[q], p));
      assert_true(off > -1e-15 && off <= fmin(spacing, spacing * spacing / fabs(d)));
      double q_on[3] = {p[0] - d * n[0], p[1] - d * n[1], p[2] - d * n[2]}, other[3];
      assert_true(fabs(hk_length(n) - 1) < 1e-15 && fabs(hk_shape_distance(&shapes[q], q_on, other)) < 1e-15);
    }
    print_message("shape %zu: brute force is up to %.1e m off\n", q, worst);
  }
  free(sample);
}

/* The normal is the gradient: central differences over 1e-6 are off by 1e-12 and by rounding of 1e-10. */
static void normals_are_gradients(void **state) {
  (void)state;
  for (int kind = HK_SHAPE_PLANE; kind < HK_SHAPE_MESH; kind++)
    for (int k = 0; k < 400; k++) {
      hk_shape s = {.kind = (hk_shape_kind)kind,
                    .normal = {0.6, 0, 0.8},
                    .half = {0.5, 0.5, 0.5 + 0.3 * (kind > 2)},
                    .hollow = k & 1};
      double p[3] = {noise(), noise(), noise()}, n[3], other[3], off = 0;
      hk_shape_distance(&s, p, n);
      for (int c = 0; c < 3; c++) {
        double kept = p[c], up, down;
        p[c] = kept + 1e-6, up = hk_shape_distance(&s, p, other);
        p[c] = kept - 1e-6, down = hk_shape_distance(&s, p, other);
        p[c] = kept;
        off = fmax(off, fabs((up - down) / 2e-6 - n[c]));
      }
      if (off > 1e-5 && off < 0.05) fail_msg("shape %d at (%g, %g, %g): off by %g", kind, p[0], p[1], p[2], off);
    }
}

/* ---- meshes, through a run: its corrector holds the surface ---- */

static hk_plugin_spec *mesh_scene(test_engine *e, const double *vertices, size_t coordinates, const double *faces,
                                  size_t corners) {
  test_engine_open(e);
  e->options.dt = 0.01;
  test_particle(e, 5, 5, 5, 1);
  hk_plugin_spec *o = test_plugin(e, HK_CORRECTOR, "obstacle");
  test_text(e, o, "shape", "mesh");
  test_text(e, o, "file", "rock.obj");
  test_list(e, o, "vertices", vertices, coordinates);
  test_list(e, o, "faces", faces, corners);
  return o;
}

/* A box of 1 x 1.6 x 0.4 m, each side in two triangles. */
static const double box_faces[] = {1, 3, 4, 1, 4, 2, 5, 6, 8, 5, 8, 7, 1, 2, 6, 1, 6, 5,
                                   3, 7, 8, 3, 8, 4, 1, 5, 7, 1, 7, 3, 2, 4, 8, 2, 8, 6};
static double box_vertices[24];

static void make_box(void) {
  for (int k = 0; k < 8; k++) {
    box_vertices[3 * k] = k & 1 ? 0.5 : -0.5;
    box_vertices[3 * k + 1] = k & 2 ? 0.8 : -0.8;
    box_vertices[3 * k + 2] = k & 4 ? 0.2 : -0.2;
  }
}

/* The distance of particle 1 by the run's `violation` would be one-sided, so the library is asked. */
static void a_mesh_of_a_box_has_the_box_s_distance(void **state) {
  (void)state;
  test_engine e;
  make_box();
  mesh_scene(&e, box_vertices, 24, box_faces, 36);
  test_run(&e);
  hk_instance *instance = e.run->plugins.kind[HK_CORRECTOR].item[0];
  hk_surface s = {0};
  hk_numbers v = {24, box_vertices}, f = {36, box_faces};
  assert_int_equal(hk_surface_open(&s, &instance->host, &v, &f, "box"), HK_OK);
  hk_shape box = {.kind = HK_SHAPE_BOX, .half = {0.5, 0.8, 0.2}}, mesh = {.kind = HK_SHAPE_MESH, .surface = &s};
  for (int k = 0; k < 5000; k++) {
    double p[3] = {1.2 * noise(), 1.2 * noise(), 1.2 * noise()}, n[3], m[3];
    if (k % 5 == 0) p[k % 3] = box.half[k % 3];
    if (k % 7 == 0) p[(k + 1) % 3] = -box.half[(k + 1) % 3]; /* edges, corners, and planes of faces */
    double a = hk_shape_distance(&box, p, n), b = hk_shape_distance(&mesh, p, m);
    if (!(fabs(a - b) < 1e-15)) fail_msg("(%g, %g, %g): %.17g instead of %.17g", p[0], p[1], p[2], b, a);
    if (a > 1e-6) assert_true(hk_dot(n, m) > 1 - 1e-12);
  }
  test_engine_close(&e);
}

enum { RINGS = 64, AROUND = 128 };

static size_t ball(double *vertices, double *faces) {
  size_t f = 0;
  for (int i = 0; i <= RINGS; i++)
    for (int j = 0; j < AROUND; j++) {
      double a = acos(-1) * i / RINGS, b = 2 * acos(-1) * j / AROUND, *v = vertices + 3 * (i * AROUND + j);
      v[0] = 0.7 * sin(a) * cos(b), v[1] = 0.7 * sin(a) * sin(b), v[2] = 0.7 * cos(a);
      if (i == RINGS) continue;
      int at = i * AROUND + j + 1, right = i * AROUND + (j + 1) % AROUND + 1;
      int top = 1, bottom = RINGS * AROUND + 1;
      int quad[6] = {at, at + AROUND, right + AROUND, at, right + AROUND, right};
      for (int q = 0; q < 6; q++) {
        if (i == 0 && q > 2) break; /* one triangle to the pole, which is one vertex */
        if (i == RINGS - 1 && q < 3) continue;
        int corner = quad[q];
        if (i == 0 && corner <= AROUND) corner = top;
        if (corner > RINGS * AROUND) corner = bottom;
        faces[f++] = corner;
      }
    }
  return f;
}

/* Inscribed: the surface lies up to R (1 - cos(pi/128) cos(pi/128)) = 4.2e-4 m inside the sphere, nowhere outside. */
static void a_mesh_of_a_sphere_has_its_distance(void **state) {
  (void)state;
  enum { V = 3 * (RINGS + 1) * AROUND, F = 6 * RINGS * AROUND };
  double *vertices = malloc(V * sizeof *vertices), *faces = malloc(F * sizeof *faces), worst = 0;
  size_t corners = ball(vertices, faces);
  test_engine e;
  make_box();
  mesh_scene(&e, box_vertices, 24, box_faces, 36);
  test_run(&e);
  hk_surface s = {0};
  hk_numbers v = {V, vertices}, f = {corners, faces};
  hk_instance *instance = e.run->plugins.kind[HK_CORRECTOR].item[0];
  hk_status status = hk_surface_open(&s, &instance->host, &v, &f, "ball");
  if (status != HK_OK) fail_msg("%s", e.run->error.text);
  for (int k = 0; k < 3000; k++) {
    double p[3] = {1.2 * noise(), 1.2 * noise(), 1.2 * noise()}, n[3];
    double off = hk_surface_distance(&s, p, n) - (hk_length(p) - 0.7);
    worst = fmax(worst, fabs(off));
    assert_true(off > -1e-12 && off < 4.3e-4);
  }
  print_message("sphere of %zu triangles: up to %.1e m inside\n", corners / 3, worst);
  test_engine_close(&e);
  free(vertices);
  free(faces);
}

static void refused(const double *faces, size_t corners, const char *wanted) {
  test_engine e;
  make_box();
  mesh_scene(&e, box_vertices, 24, faces, corners);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  if (!strstr(e.error.text, wanted)) fail_msg("%s", e.error.text);
  test_engine_close(&e);
}

static void what_is_not_closed_is_refused_with_its_edges(void **state) {
  (void)state;
  double faces[36];
  refused(box_faces, 33,
          "rock.obj is not closed, so it has no inside: 3 edges, between vertices 2-6 (1 face), 2-8 (1 face), "
          "6-8 (1 face)");
  memcpy(faces, box_faces, sizeof faces);
  faces[0] = 3, faces[1] = 1; /* one triangle the other way round */
  refused(faces, 36, "1-3 (2 faces that face opposite ways), 1-4 (2 faces that face opposite ways)");
  memcpy(faces, box_faces, sizeof faces);
  faces[7] = 9;
  refused(faces, 36, "rock.obj: triangle 3 names vertex 9 of 8");
  refused(box_faces, 7, "24 coordinates and 7 corners are no closed surface");
}

/* All faces inward: turned round, with the same distances. */
static void faces_may_all_be_inward(void **state) {
  (void)state;
  double faces[36];
  test_engine e;
  make_box();
  for (int k = 0; k < 36; k += 3)
    faces[k] = box_faces[k], faces[k + 1] = box_faces[k + 2], faces[k + 2] = box_faces[k + 1];
  mesh_scene(&e, box_vertices, 24, faces, 36);
  e.scene->particles.position[0] = e.scene->particles.position[1] = 0;
  e.scene->particles.position[2] = 1;
  e.scene->particles.velocity[2] = -40;
  e.scene->duration = 1;
  test_run(&e);
  test_advance(&e, 0.1); /* meets the upper side, at z = 0.2, and stops (e = 0) */
  assert_true(fabs(test_position(&e, 1)[2] - 0.2) < 1e-14 && test_velocity(&e, 1)[2] == 0);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(distances_agree_with_brute_force),
      cmocka_unit_test(normals_are_gradients),
      cmocka_unit_test(a_mesh_of_a_box_has_the_box_s_distance),
      cmocka_unit_test(a_mesh_of_a_sphere_has_its_distance),
      cmocka_unit_test(what_is_not_closed_is_refused_with_its_edges),
      cmocka_unit_test(faces_may_all_be_inward),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
