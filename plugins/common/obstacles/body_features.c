/* See body_features.h. On an edge the distance to a convex shape is a convex function, whose least value golden
 * sections find; for others the least of some samples begins the search, so that a dent narrower than a sixteenth of an
 * edge may be missed. In time, the surface is approached by steps of the gap over the speed, in which nothing can be
 * passed (conservative advancement), and the root by bisection. */
#include "plugins/common/obstacles/body_features.h"
#include "plugins/kit/vector3.h"

#include <float.h>

enum { SECTIONS = 80, SAMPLES = 16, ADVANCES = 200, BISECTIONS = 80 };

static const double narrow = 1e-8; /* of an edge, or of a slope: the gap is off by the square of that */

/* ---- in space ---- */

typedef struct edge {
  const hk_obstacle *o;
  double p[2][3], radius[2]; /* of the ends, in the obstacle's frame */
} edge;

static double distance_on(const edge *e, double place, double n[3]) {
  double p[3];
  for (int c = 0; c < 3; c++) p[c] = (1 - place) * e->p[0][c] + place * e->p[1][c];
  return hk_shape_distance(&e->o->shape, p, n) - (1 - place) * e->radius[0] - place * e->radius[1];
}

static void bracket(const edge *e, double *low, double *high) {
  double least = INFINITY, n[3];
  int best = 0;
  if (hk_shape_is_convex(&e->o->shape)) return;
  for (int k = 0; k <= SAMPLES; k++) {
    double gap = distance_on(e, (double)k / SAMPLES, n);
    if (gap < least) least = gap, best = k;
  }
  *low = fmax(0, (double)(best - 1) / SAMPLES);
  *high = fmin(1, (double)(best + 1) / SAMPLES);
}

/* m per edge: how the distance grows along the edge at that place. */
static double slope_on(const edge *e, double place) {
  double n[3], along[3];
  distance_on(e, place, n);
  hk_subtract(along, e->p[1], e->p[0]);
  return hk_dot(n, along) - (e->radius[1] - e->radius[0]);
}

/* The slope rises along the edge: its root, by secants that halve the weight of an end that stays (Dowell and Jarratt
 * 1971, the Illinois method), and by bisection at a kink. */
static double nearest_place(const edge *e, double length) {
  double low = 0, high = 1;
  bracket(e, &low, &high);
  double at_low = slope_on(e, low), at_high = slope_on(e, high);
  if (at_low >= 0) return low;
  if (at_high <= 0) return high;
  for (int k = 0, stayed = 0; k < SECTIONS && high - low > narrow; k++) {
    double place = k % 4 == 3 ? (low + high) / 2 : (low * at_high - high * at_low) / (at_high - at_low);
    double slope = slope_on(e, place);
    if (fabs(slope) <= narrow * length) return place;
    if (slope < 0) {
      low = place, at_low = slope;
      if (stayed == 1) at_high /= 2;
      stayed = 1;
    } else {
      high = place, at_high = slope;
      if (stayed == -1) at_low /= 2;
      stayed = -1;
    }
  }
  return (low + high) / 2;
}

/* The nearest place of the edge; an end, where that is as near but for rounding, or where all of it is farther away
 * than `reach`, as the distance changes by no more than the way along the edge. */
static hk_feature_gap nearest(const edge *e, double rounding, double reach) {
  hk_feature_gap g = {.place = 0};
  double other[3], n[3], one = distance_on(e, 0, g.n);
  g.gap = one;
  if (e->p[0][0] == e->p[1][0] && e->p[0][1] == e->p[1][1] && e->p[0][2] == e->p[1][2]) return g;
  double two = distance_on(e, 1, other), length = 0;
  for (int c = 0; c < 3; c++) length += (e->p[1][c] - e->p[0][c]) * (e->p[1][c] - e->p[0][c]);
  if (two < one) g.gap = two, g.place = 1, hk_copy(g.n, other);
  bool flat = e->o->shape.kind == HK_SHAPE_PLANE; /* its distance is linear */
  if (flat || (one + two - sqrt(length)) / 2 > reach) return g;
  double place = nearest_place(e, sqrt(length)), gap = distance_on(e, place, n);
  if (!(gap < g.gap - rounding)) return g;
  g = (hk_feature_gap){.gap = gap, .place = place, .inside_of_edge = true};
  hk_copy(g.n, n);
  return g;
}

/* ---- in time ---- */

/* Hermite's cubic of particle i at the part s. */
static void place_at(const hk_obstacle_moves *m, size_t i, double s, double x[3]) {
  const double *a = m->x_from + 3 * i, *b = m->x + 3 * i, *u = m->v_from + 3 * i, *v = m->v + 3 * i;
  double p = s * s * (3 - 2 * s), q = s * (1 - s) * (1 - s) * m->h, r = s * s * (s - 1) * m->h;
  for (int c = 0; c < 3; c++) x[c] = s == 0 ? a[c] : s == 1 ? b[c] : a[c] + p * (b[c] - a[c]) + q * u[c] + r * v[c];
}

hk_feature_gap hk_feature_gap_at(const hk_obstacle *o, const hk_obstacle_moves *m, const hk_obstacle_feature *f,
                                 double s, double reach) {
  edge e = {.o = o};
  double x[2][3], own[3], rounding = 0;
  hk_body_frame frame;
  if (s < 1 && s > 0)
    hk_motion_at(&o->motion, s, &frame);
  else
    frame = s == 1 ? o->motion.end : o->motion.start;
  for (int k = 0; k < 2; k++) {
    place_at(m, f->end[k], s, x[k]);
    hk_body_point(&frame, x[k], e.p[k]);
    e.radius[k] = hk_obstacle_radius(o, f->end[k]);
    rounding = fmax(rounding, 1e4 * hk_obstacle_rounding(o, x[k], x[k], f->end[k]));
  }
  hk_feature_gap g = nearest(&e, rounding, reach);
  hk_copy(own, g.n);
  hk_body_direction(&frame, own, g.n);
  for (int c = 0; c < 3; c++) g.x[c] = (1 - g.place) * x[0][c] + g.place * x[1][c];
  return g;
}

/* m, no point of the feature moves farther than this against the obstacle in the step. */
static double motion_of(const hk_obstacle *o, const hk_obstacle_moves *m, const hk_obstacle_feature *f) {
  double most = 0;
  for (int k = 0; k < 2; k++) {
    size_t i = f->end[k];
    double p[3], q[3], w[3], u[3], way[3], bend[3];
    hk_body_point(&o->motion.start, m->x_from + 3 * i, p);
    hk_body_point(&o->motion.end, m->x + 3 * i, q);
    hk_body_velocity(&o->motion.start, m->x_from + 3 * i, m->v_from + 3 * i, w);
    hk_body_velocity(&o->motion.end, m->x + 3 * i, m->v + 3 * i, u);
    hk_subtract(way, q, p);
    for (int c = 0; c < 3; c++) bend[c] = fabs(m->h * w[c] - way[c]) + fabs(m->h * u[c] - way[c]);
    most = fmax(most, hk_length(way) + hk_length(bend) / 2);
  }
  return most;
}

static void find_root(const hk_obstacle *o, const hk_obstacle_moves *m, const hk_obstacle_feature *f, double low,
                      double high, double reach, hk_feature_way *way) {
  for (int k = 0; k < BISECTIONS && high - low > 4 * DBL_EPSILON; k++) {
    double middle = (low + high) / 2;
    *(hk_feature_gap_at(o, m, f, middle, reach).gap > 0 ? &low : &high) = middle;
  }
  way->landing = high;
  way->at = hk_feature_gap_at(o, m, f, high, reach);
}

bool hk_feature_may_touch(const hk_obstacle *o, const hk_obstacle_moves *m, const hk_obstacle_feature *f,
                          double touching) {
  double reach = touching + motion_of(o, m, f);
  return hk_feature_gap_at(o, m, f, 1, reach).gap <= reach;
}

hk_feature_way hk_feature_way_of(const hk_obstacle *o, const hk_obstacle_moves *m, const hk_obstacle_feature *f,
                                 double touching) {
  double motion = motion_of(o, m, f), reach = touching + motion;
  hk_feature_way way = {.landing = 1, .to = hk_feature_gap_at(o, m, f, 1, reach)};
  if (way.to.gap > reach) return way;
  way.from = hk_feature_gap_at(o, m, f, 0, reach);
  way.touches = way.to.gap <= touching;
  way.at = way.to;
  if (way.from.gap <= touching) {
    if (way.touches) way.landing = 0, way.at = way.from;
    return way;
  }
  if (way.from.gap + way.to.gap > motion) return way;
  double s = 0, gap = way.from.gap;
  for (int k = 0; k < ADVANCES && gap > 0; k++) {
    double next = s + fmax(gap, touching) / motion;
    if (next >= 1) break;
    s = next;
    gap = hk_feature_gap_at(o, m, f, s, reach).gap;
  }
  bool before = gap <= 0;
  if (!before && !(way.to.gap < 0)) return way;
  way.touches = true;
  find_root(o, m, f, before ? fmax(0, s - 2 * touching / motion) : s, before ? s : 1, reach, &way);
  return way;
}

void hk_obstacle_surface_velocity(const hk_obstacle *o, double s, const double x[3], double u[3]) {
  const double rest[3] = {0, 0, 0};
  hk_body_frame frame;
  hk_motion_at(&o->motion, s, &frame);
  hk_body_move(&frame, x, rest, u);
}
