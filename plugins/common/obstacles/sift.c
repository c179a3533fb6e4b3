/* Which particles may meet an obstacle in a step: a few operations each, in loops that compilers vectorise, since most
 * particles of a large scene meet none. A path departs from the straight line by h |v1 - v0|/8 at most. */
#include "plugins/common/obstacles/obstacle.h"
#include "plugins/kit/vector3.h"

typedef struct block {
  const hk_obstacle *o;
  const hk_obstacle_moves *moves;
  size_t begin, count;
  double radius; /* m, the largest of the particles, and rounding */
  bool *near;
} block;

static double largest_radius(const hk_obstacle *o, size_t begin, size_t count) {
  double most = fmax(o->largest, o->radii ? 0 : o->radius);
  for (size_t k = 0; o->radii && k < count; k++) most = fmax(most, o->radii[begin + k]);
  return most;
}

static void sift_plane(const block *b) {
  const hk_obstacle_moves *m = b->moves;
  const double *restrict x0 = m->x_from + 3 * b->begin, *restrict x1 = m->x + 3 * b->begin;
  const double *restrict v0 = m->v_from + 3 * b->begin, *restrict v1 = m->v + 3 * b->begin;
  double n[3], bend = m->h / 8;
  hk_body_direction(&b->o->motion.end, b->o->shape.normal, n);
  double height = hk_dot(n, b->o->motion.end.origin) + b->radius;
  for (size_t k = 0; k < b->count; k++) {
    size_t e = 3 * k;
    double from = n[0] * x0[e] + n[1] * x0[e + 1] + n[2] * x0[e + 2];
    double to = n[0] * x1[e] + n[1] * x1[e + 1] + n[2] * x1[e + 2];
    double dv = n[0] * (v1[e] - v0[e]) + n[1] * (v1[e + 1] - v0[e + 1]) + n[2] * (v1[e + 2] - v0[e + 2]);
    b->near[k] |= (from < to ? from : to) - bend * fabs(dv) <= height;
  }
}

/* By the sphere about the shape: further from it than the way is long. (a + b)^2 <= 2 a^2 + 2 b^2 saves the roots. */
static void sift_sphere(const block *b, double radius) {
  const hk_obstacle_moves *m = b->moves;
  const double *restrict x0 = m->x_from + 3 * b->begin, *restrict x1 = m->x + 3 * b->begin;
  const double *restrict v0 = m->v_from + 3 * b->begin, *restrict v1 = m->v + 3 * b->begin;
  const double *c = b->o->motion.end.origin;
  double bend = m->h * m->h / 16, reach = 3 * radius * radius;
  for (size_t k = 0; k < b->count; k++) {
    size_t e = 3 * k;
    double rx = x1[e] - c[0], ry = x1[e + 1] - c[1], rz = x1[e + 2] - c[2];
    double dx = x1[e] - x0[e], dy = x1[e + 1] - x0[e + 1], dz = x1[e + 2] - x0[e + 2];
    double wx = v1[e] - v0[e], wy = v1[e + 1] - v0[e + 1], wz = v1[e + 2] - v0[e + 2];
    double way = dx * dx + dy * dy + dz * dz, arc = bend * (wx * wx + wy * wy + wz * wz);
    b->near[k] |= rx * rx + ry * ry + rz * rz <= reach + 3 * way + 3 * arc;
  }
}

void hk_obstacles_sift(const hk_obstacle_set *set, const hk_obstacle_moves *moves, size_t begin, size_t end,
                       bool *near) {
  for (size_t k = 0; k < end - begin; k++) near[k] = false;
  for (size_t q = 0; q < set->count; q++) {
    const hk_obstacle *o = set->member[q];
    const double *half = o->shape.half, *c = o->motion.end.origin;
    double scale = fabs(c[0]) + fabs(c[1]) + fabs(c[2]) + hk_length(half);
    block b = {o, moves, begin, end - begin, largest_radius(o, begin, end - begin) + 1e-12 * scale, near};
    if (!o->motion.still || o->shape.hollow || o->shape.kind == HK_SHAPE_MESH)
      for (size_t k = 0; k < b.count; k++) near[k] = true;
    else if (o->shape.kind == HK_SHAPE_PLANE)
      sift_plane(&b);
    else
      sift_sphere(&b, hk_length(half) + b.radius);
  }
}
