/* Places spread evenly over a surface, from a seed: darts thrown evenly by area, of which one stays where none lies
 * closer than a distance that shrinks until there are enough (relaxed dart throwing: McCool and Fiume 1992,
 * Hierarchical Poisson disk sampling distributions). It starts at 0.85 of the distance in a hexagonal lattice of that
 * many points, which is more than darts reach, and ends near 0.7. Distances are straight through space. */
#include "core/scene/scene/scene.h"
#include "core/engine/base/base.h"

#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double start = 0.85, shrink = 0.95; /* of the lattice's distance; from one distance to the next */
enum { THROWS = 8 };                             /* darts per wanted point at each distance */

/* ---- one dart ---- */

static void cross(const double a[3], const double b[3], double into[3]) {
  for (int c = 0; c < 3; c++) into[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double normalise(double a[3]) {
  double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  for (int c = 0; c < 3 && length > 0; c++) a[c] /= length;
  return length;
}

void hk_frame_across(const double axis[3], double side[3], double other[3]) {
  int least = fabs(axis[1]) < fabs(axis[0]) ? 1 : 0;
  if (fabs(axis[2]) < fabs(axis[least])) least = 2;
  for (int c = 0; c < 3; c++) side[c] = (c == least) - axis[least] * axis[c];
  normalise(side);
  cross(axis, side, other);
}

void hk_random_in_cone(uint64_t random[4], const double axis[3], double angle, double into[3]) {
  double side[3], other[3], height = 1 - hk_random_uniform(random) * (1 - cos(angle));
  double turn = 2 * pi * hk_random_uniform(random), width = sqrt(fmax(0, 1 - height * height));
  hk_frame_across(axis, side, other);
  for (int c = 0; c < 3; c++) into[c] = height * axis[c] + width * (cos(turn) * side[c] + sin(turn) * other[c]);
}

/* The triangle in which `area` lies, of areas summed up. */
static size_t triangle_at(const double *sum, size_t count, double area) {
  size_t low = 0, high = count - 1;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (sum[middle] > area)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

typedef struct target {
  const hk_skin *skin;
  double *sum, (*normal)[3]; /* areas up to each triangle, m^2; of vertices */
  double area;
} target;

static void throw_dart(const target *t, uint64_t random[4], double x[3], double normal[3]) {
  const hk_skin *s = t->skin;
  if (!s->triangles) {
    hk_random_in_cone(random, s->axis, s->cap, normal);
    for (int c = 0; c < 3; c++) x[c] = s->centre[c] + s->radius * normal[c];
    return;
  }
  const uint32_t *corner = s->triangle[triangle_at(t->sum, s->triangles, t->area * hk_random_uniform(random))];
  double root = sqrt(hk_random_uniform(random)), part = hk_random_uniform(random);
  const double weight[3] = {1 - root, root * (1 - part), root * part};
  memset(x, 0, 3 * sizeof *x);
  memset(normal, 0, 3 * sizeof *normal);
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++) {
      x[c] += weight[k] * s->vertex[corner[k]][c];
      normal[c] += weight[k] * t->normal[corner[k]][c];
    }
  normalise(normal);
}

/* Areas, and normals of the vertices: those of their triangles, weighted by area. */
static void measure(target *t) {
  const hk_skin *s = t->skin;
  if (!s->triangles) t->area = 2 * pi * s->radius * s->radius * (1 - cos(s->cap));
  for (size_t k = 0; k < s->triangles; k++) {
    double edge[2][3], twice[3];
    for (int m = 0; m < 2; m++)
      for (int c = 0; c < 3; c++) edge[m][c] = s->vertex[s->triangle[k][m + 1]][c] - s->vertex[s->triangle[k][0]][c];
    cross(edge[0], edge[1], twice);
    for (int m = 0; m < 3; m++)
      for (int c = 0; c < 3; c++) t->normal[s->triangle[k][m]][c] += twice[c];
    t->sum[k] = t->area += normalise(twice) / 2;
  }
}

/* ---- which of them lie close: cells of the distance's size, chains of points by a hash ---- */

typedef struct near {
  size_t buckets;
  uint32_t *first, *next; /* points, from 1; 0: none */
  double distance;
} near;

static size_t bucket_of(const near *n, const double x[3], const int shift[3]) {
  uint64_t hash = 1469598103934665603u; /* FNV-1a */
  for (int c = 0; c < 3; c++)
    hash = (hash ^ (uint64_t)((int64_t)floor(x[c] / n->distance) + shift[c])) * 1099511628211u;
  return (hash ^ hash >> 29) & (n->buckets - 1);
}

static bool lies_free(const near *n, const double (*x)[3], const double dart[3]) {
  for (int k = 0; k < 27; k++) {
    const int shift[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
    for (uint32_t p = n->first[bucket_of(n, dart, shift)]; p; p = n->next[p - 1]) {
      double square = 0;
      for (int c = 0; c < 3; c++) square += (x[p - 1][c] - dart[c]) * (x[p - 1][c] - dart[c]);
      if (square < n->distance * n->distance) return false;
    }
  }
  return true;
}

static void keep(near *n, const double (*x)[3], uint32_t point) {
  const int none[3] = {0};
  size_t bucket = bucket_of(n, x[point], none);
  n->next[point] = n->first[bucket];
  n->first[bucket] = point + 1;
}

static void scatter(const target *t, near *n, size_t count, uint64_t random[4], double (*x)[3], double (*normal)[3]) {
  size_t found = 0;
  n->distance = start * sqrt(2 * t->area / (sqrt(3) * (double)count));
  for (; found < count; n->distance *= shrink) {
    memset(n->first, 0, n->buckets * sizeof *n->first);
    for (size_t k = 0; k < found; k++) keep(n, (const double(*)[3])x, (uint32_t)k);
    for (size_t k = 0; k < THROWS * count && found < count; k++) {
      throw_dart(t, random, x[found], normal[found]);
      if (lies_free(n, (const double(*)[3])x, x[found])) keep(n, (const double(*)[3])x, (uint32_t)found++);
    }
  }
}

hk_status hk_scatter(const hk_skin *skin, size_t count, uint64_t random[4], double (*x)[3], double (*normal)[3],
                     hk_error *error) {
  target t = {.skin = skin};
  near n = {.buckets = 64};
  hk_status status = HK_OK;
  while (n.buckets < 2 * count) n.buckets *= 2;
  t.sum = malloc((skin->triangles + 1) * sizeof *t.sum);
  t.normal = calloc(skin->vertices + 1, sizeof *t.normal);
  n.first = malloc(n.buckets * sizeof *n.first);
  n.next = malloc((count + 1) * sizeof *n.next);
  if (!t.sum || !t.normal || !n.first || !n.next)
    status = hk_error_set(error, HK_NO_MEMORY, "no memory for %zu places", count);
  if (status == HK_OK) measure(&t);
  if (status == HK_OK && !(t.area > 0 && t.area < INFINITY))
    status = hk_error_set(error, HK_BAD_PARAM, "the surface has no area");
  if (status == HK_OK) scatter(&t, &n, count, random, x, normal);
  free(t.sum);
  free(t.normal);
  free(n.first);
  free(n.next);
  return status;
}
