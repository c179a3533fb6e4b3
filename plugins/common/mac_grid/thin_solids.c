#include "plugins/common/mac_grid/thin_solids.h"
#include "plugins/kit/vector3.h"

enum { TURNS = 100, SAMPLES = 4 };

static const double first_step = 1e-4, touching = 1e-6; /* of the way that is looked along */
static const double parallel = 0.86602540378443865;     /* cos 30 degrees */

/* Whether the direction leads out of the plane of a plane box. */
static bool leaves_plane(const hk_liquid_grid *g, const double direction[3]) {
  bool leaves = false;
  for (int c = 0; c < 3; c++) leaves |= g->flat[c] && fabs(direction[c]) > parallel;
  return leaves;
}

static double extent_of(const hk_liquid_grid *g, const hk_obstacle *o) {
  double least = INFINITY;
  for (int c = 0; c < 3; c++) {
    double own[3] = {c == 0, c == 1, c == 2}, axis[3];
    hk_body_direction(&o->motion.end, own, axis);
    if (o->shape.kind == HK_SHAPE_SPHERE || !leaves_plane(g, axis)) least = fmin(least, 2 * o->shape.half[c]);
  }
  return least;
}

/* m, through the solid from p on its surface along the unit vector d, by steps as long as the surface is away (sphere
 * tracing: Hart 1996, The Visual Computer 12), to a side that faces the other way; INFINITY: it is `most` or more. */
static double way_through(const hk_shape *shape, const double p[3], const double d[3], double most) {
  double way = first_step * most;
  for (int turn = 0; turn < TURNS && way < most; turn++) {
    double at[3], n[3];
    for (int c = 0; c < 3; c++) at[c] = p[c] + way * d[c];
    double depth = -hk_shape_distance(shape, at, n);
    if (depth <= touching * most) return hk_dot(n, d) > parallel ? way + depth : INFINITY;
    way += depth;
  }
  return INFINITY;
}

/* The same from a point of a triangle, with one question where a ball of that size fits in. */
static double way_from(const hk_shape *shape, const double p[3], const double normal[3], double most) {
  double middle[3], n[3], inwards[3];
  for (int c = 0; c < 3; c++) {
    inwards[c] = -normal[c];
    middle[c] = p[c] + most / 2 * inwards[c];
  }
  if (-hk_shape_distance(shape, middle, n) >= most / 2 * (1 - touching)) return INFINITY;
  return way_through(shape, p, inwards, most);
}

/* In the middle of a triangle, and between that and its corners. */
static void sample(const hk_surface *s, size_t f, int k, double p[3]) {
  for (int c = 0; c < 3; c++) {
    p[c] = 0;
    for (int v = 0; v < 3; v++) {
      double weight = k == 0 ? 1 / 3.0 : v == k - 1 ? 2 / 3.0 : 1 / 6.0;
      p[c] += weight * s->vertex[3 * (size_t)s->face[f][v] + (size_t)c];
    }
  }
}

static double mesh_thickness(const hk_liquid_grid *g, const hk_obstacle *o, double most, double place[3]) {
  const hk_surface *s = o->shape.surface;
  double least = INFINITY;
  for (size_t f = 0; f < s->faces; f++) {
    double normal[3];
    hk_body_direction(&o->motion.end, s->face_normal[f], normal);
    for (int k = 0; k < SAMPLES && !leaves_plane(g, normal); k++) {
      double p[3], x[3];
      sample(s, f, k, p);
      hk_body_place(&o->motion.end, p, x);
      double way = hk_liquid_in_box(g, x) ? way_from(&o->shape, p, s->face_normal[f], fmin(most, least)) : INFINITY;
      if (!(way < least)) continue;
      least = way;
      hk_copy(place, x);
    }
  }
  return least;
}

double hk_thickness(const hk_liquid_grid *g, const hk_obstacle *o, double most, double place[3]) {
  hk_copy(place, o->motion.end.origin);
  if (o->shape.kind == HK_SHAPE_PLANE || o->shape.hollow) return INFINITY;
  double least = o->shape.kind == HK_SHAPE_MESH ? mesh_thickness(g, o, most, place) : extent_of(g, o);
  return least < most ? least : INFINITY;
}

void hk_warn_of_thin(const hk_host *host, const hk_liquid_grid *g, const hk_obstacle_set *all, const char *what) {
  double cell = fmax(g->spacing[0], fmax(g->spacing[1], g->spacing[2])), place[3];
  for (size_t k = 0; k < all->count; k++) {
    double least = hk_thickness(g, all->member[k], 2 * cell * (1 - touching), place);
    if (least < INFINITY)
      host->warn(host,
                 "obstacle %zu is %.3g m thin near (%.3g, %.3g, %.3g), and cells are %.3g m: %s may leak through what "
                 "is thinner than two of them; take cells of %.3g m, or make it %.3g m thick",
                 k + 1, least, place[0], place[1], place[2], cell, what, least / 2, 2 * cell);
  }
}
