/* Surfaces of bodies. Round ones are rings about z, joined in bands: the k-th ring from a pole has 6 k vertices, six
 * sectors of k, so that triangles are nearly equilateral at the pole and not much narrower at the equator; straight
 * parts repeat a ring. */
#include "core/scene/meshes/meshes.h"

enum { SECTORS = 6, MOST_RINGS = 2000, SLENDER = 4 };
static const double pi = 3.14159265358979323846;

/* A ring of SECTORS k vertices, or one vertex for k = 0; `first` is its first vertex. */
typedef struct ring {
  uint32_t first, k;
} ring;

static const char *add_ring(hk_mesh *m, uint32_t k, double radius, double z, ring *made) {
  uint32_t count = k ? SECTORS * k : 1;
  const char *wrong = NULL;
  *made = (ring){(uint32_t)m->vertices, k};
  for (uint32_t j = 0; j < count && !wrong; j++) {
    double angle = 2 * pi * j / count;
    wrong = hk_mesh_add_vertex(m, (const double[3]){radius * cos(angle), radius * sin(angle), z});
  }
  return wrong;
}

static uint32_t at(const ring *r, uint32_t j) { return r->first + (r->k ? j % (SECTORS * r->k) : 0); }

static const char *add_triangle(hk_mesh *m, uint32_t a, uint32_t b, uint32_t c) {
  return hk_mesh_add_face(m, (const uint32_t[3]){a, b, c}, 3);
}

/* One sector of the band between two rings, the first above the second. The upper one has as many vertices, or one more
 * or less a sector. */
static const char *add_sector(hk_mesh *m, const ring *upper, const ring *lower, uint32_t sector) {
  uint32_t u = sector * upper->k, l = sector * lower->k, u_end = u + upper->k, l_end = l + lower->k;
  const char *wrong = NULL;
  bool down = lower->k >= upper->k; /* begins with a triangle whose side is on the lower ring */
  while ((u < u_end || l < l_end) && !wrong) {
    if (down && l < l_end)
      wrong = add_triangle(m, at(upper, u), at(lower, l), at(lower, l + 1)), l++;
    else if (u < u_end)
      wrong = add_triangle(m, at(upper, u + 1), at(upper, u), at(lower, l)), u++;
    down = !down;
  }
  return wrong;
}

typedef struct turner { /* adds a ring and the band between it and the last one */
  hk_mesh *mesh;
  ring last;
  bool begun;
  const char *wrong;
} turner;

static void add(turner *t, uint32_t k, double radius, double z) {
  ring next;
  if (t->wrong) return;
  t->wrong = add_ring(t->mesh, k, radius, z, &next);
  for (uint32_t s = 0; s < SECTORS && t->begun && !t->wrong; s++) t->wrong = add_sector(t->mesh, &t->last, &next, s);
  t->last = next;
  t->begun = true;
}

/* ---- how many rings ---- */

/* The distance of a unit sphere from the plane through three of its points. */
static double depth_of(const double a[3], const double b[3], const double c[3]) {
  double n[3], square = 0, along = 0;
  for (int k = 0, p = 1, q = 2; k < 3; k++, p = (p + 1) % 3, q = (q + 1) % 3) {
    n[k] = (b[p] - a[p]) * (c[q] - a[q]) - (b[q] - a[q]) * (c[p] - a[p]);
    square += n[k] * n[k];
    along += n[k] * a[k];
  }
  return 1 - fabs(along) / sqrt(square);
}

static void on_sphere(uint32_t rings, uint32_t k, uint32_t j, double x[3]) {
  double below = pi / 2 * k / rings, angle = k ? 2 * pi * j / (SECTORS * k) : 0;
  x[0] = sin(below) * cos(angle);
  x[1] = sin(below) * sin(angle);
  x[2] = cos(below);
}

/* The largest deviation of a quarter of a sphere of so many rings: of the widest triangles of each band, of both
 * kinds. */
static double deviation(uint32_t rings) {
  double most = 0;
  for (uint32_t k = 0; k < rings; k++)
    for (uint32_t j = 0; j <= k; j++) {
      double up[3], next[3], low[3], after[3];
      on_sphere(rings, k, j, up);
      on_sphere(rings, k, j + 1, next);
      on_sphere(rings, k + 1, j, low);
      on_sphere(rings, k + 1, j + 1, after);
      most = fmax(most, depth_of(up, low, after));
      if (j < k) most = fmax(most, depth_of(up, next, after));
    }
  return most;
}

/* The deviation falls with the square of their number. */
static uint32_t rings_of_sphere(double detail) {
  double guess = 2 * sqrt(deviation(2) / detail);
  uint32_t rings = guess > MOST_RINGS ? MOST_RINGS : (uint32_t)fmax(2, 0.9 * guess);
  while (rings < MOST_RINGS && deviation(rings) > detail) rings++;
  return rings;
}

/* 1 - cos(pi/(6 k)) <= detail */
static uint32_t rings_of_circle(double detail) {
  double angle = acos(fmax(0.5, 1 - detail));
  return (uint32_t)fmin(MOST_RINGS, fmax(1, ceil(pi / (SECTORS * angle) * (1 - 1e-12))));
}

/* ---- shapes ---- */

/* Rings down a straight part; the last one is not added. Its triangles are flat and need not be short: SLENDER times
 * as long as wide costs a quarter of the triangles, and their heights stay those of the round parts. */
static void add_straight(turner *t, uint32_t k, double radius, double length) {
  uint32_t rows = (uint32_t)fmin(1e5, fmax(1, round(length * SECTORS * k / (SLENDER * 2 * pi * radius))));
  for (uint32_t row = 1; row < rows; row++) add(t, k, radius, length / 2 - length * row / rows);
}

const char *hk_mesh_add_capsule(hk_mesh *m, double radius, double length, double detail) {
  turner t = {.mesh = m};
  uint32_t rings = rings_of_sphere(detail);
  for (uint32_t k = 0; k <= rings; k++) {
    double below = pi / 2 * k / rings;
    add(&t, k, radius * sin(below), length / 2 + radius * cos(below));
  }
  if (length > 0) add_straight(&t, rings, radius, length);
  for (uint32_t k = length > 0 ? rings + 1 : rings; k-- > 0;) {
    double below = pi / 2 * k / rings;
    add(&t, k, radius * sin(below), -length / 2 - radius * cos(below));
  }
  return t.wrong;
}

const char *hk_mesh_add_sphere(hk_mesh *m, double radius, double detail) {
  return hk_mesh_add_capsule(m, radius, 0, detail);
}

const char *hk_mesh_add_cylinder(hk_mesh *m, double radius, double length, double detail) {
  turner t = {.mesh = m};
  uint32_t rings = rings_of_circle(detail);
  for (uint32_t k = 0; k <= rings; k++) add(&t, k, radius * k / rings, length / 2);
  add_straight(&t, rings, radius, length);
  for (uint32_t k = rings + 1; k-- > 0;) add(&t, k, radius * k / rings, -length / 2);
  return t.wrong;
}

const char *hk_mesh_add_box(hk_mesh *m, const double size[3]) {
  static const uint32_t side[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                      {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  const char *wrong = NULL;
  for (uint32_t k = 0; k < 8 && !wrong; k++) {
    const double x[3] = {k & 1 ? size[0] / 2 : -size[0] / 2, k & 2 ? size[1] / 2 : -size[1] / 2,
                         k & 4 ? size[2] / 2 : -size[2] / 2};
    wrong = hk_mesh_add_vertex(m, x);
  }
  for (int k = 0; k < 6 && !wrong; k++) wrong = hk_mesh_add_face(m, side[k], 4);
  return wrong;
}

const char *hk_mesh_add_square(hk_mesh *m, double size) {
  const char *wrong = NULL;
  for (uint32_t k = 0; k < 4 && !wrong; k++) {
    const double x[3] = {k & 1 ? size / 2 : -size / 2, k & 2 ? size / 2 : -size / 2, 0};
    wrong = hk_mesh_add_vertex(m, x);
  }
  return wrong ? wrong : hk_mesh_add_face(m, (const uint32_t[4]){0, 1, 3, 2}, 4);
}
