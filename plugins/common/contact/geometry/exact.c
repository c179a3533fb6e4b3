/* Whether segments and triangles meet, from signs of determinants alone (orientation.h).
 *
 * Where four points lie in one plane, a projection along an axis in which three of them are not on one line is one to
 * one on that plane, and the question is one of two dimensions. Where there is no such axis all are on one line, and
 * segments meet where their extents do. */
#include "plugins/common/contact/geometry/exact.h"
#include "plugins/common/contact/geometry/orientation.h"

/* The signs of the plane's two sides of a set of points: whether it lies wholly on one. */
static bool same_side(int a, int b) { return a != 0 && a == b; }

/* ---- On a line --------------------------------------------------------------------------------------------------- */

static double least(double a, double b) { return a < b ? a : b; }
static double most(double a, double b) { return a > b ? a : b; }

static bool extents_meet(hk_point p, hk_point q, hk_point r, hk_point s) {
  for (int c = 0; c < 3; c++)
    if (most(p[c], q[c]) < least(r[c], s[c]) || most(r[c], s[c]) < least(p[c], q[c])) return false;
  return true;
}

/* ---- In a plane -------------------------------------------------------------------------------------------------- */

/* The sign of the area of a, b, c seen along an axis. */
static int area(hk_point a, hk_point b, hk_point c, int axis) {
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  return hk_orient2d((double[]){a[u], a[v]}, (double[]){b[u], b[v]}, (double[]){c[u], c[v]});
}

/* An axis along which a, b, c are not on one line; -1: they are. */
static int axis_of(hk_point a, hk_point b, hk_point c) {
  for (int axis = 0; axis < 3; axis++)
    if (area(a, b, c, axis) != 0) return axis;
  return -1;
}

/* Segments in one plane, which is not seen edge on along `axis`. */
static bool flat_segments_meet(hk_point p, hk_point q, hk_point r, hk_point s, int axis) {
  int pr = area(p, q, r, axis), ps = area(p, q, s, axis), rp = area(r, s, p, axis), rq = area(r, s, q, axis);
  if (same_side(pr, ps) || same_side(rp, rq)) return false;
  return extents_meet(p, q, r, s);
}

static bool coplanar_segments_meet(hk_point p, hk_point q, hk_point r, hk_point s) {
  int axis = axis_of(p, q, r);
  if (axis < 0) axis = axis_of(p, q, s);
  if (axis < 0) axis = axis_of(r, s, p);
  if (axis < 0) axis = axis_of(r, s, q);
  return axis < 0 ? extents_meet(p, q, r, s) : flat_segments_meet(p, q, r, s, axis);
}

/* A point in the plane of a triangle with area along the axis. */
static bool holds(hk_point a, hk_point b, hk_point c, hk_point p, int axis) {
  int side = area(a, b, c, axis);
  return area(a, b, p, axis) != -side && area(b, c, p, axis) != -side && area(c, a, p, axis) != -side;
}

static bool meets_a_side(hk_point p, hk_point q, hk_point a, hk_point b, hk_point c) {
  return hk_segments_meet(p, q, a, b) || hk_segments_meet(p, q, b, c) || hk_segments_meet(p, q, c, a);
}

static bool coplanar_segment_meets(hk_point p, hk_point q, hk_point a, hk_point b, hk_point c) {
  int axis = axis_of(a, b, c);
  if (axis >= 0 && (holds(a, b, c, p, axis) || holds(a, b, c, q, axis))) return true;
  return meets_a_side(p, q, a, b, c);
}

/* ---- In space ---------------------------------------------------------------------------------------------------- */

bool hk_segments_meet(hk_point p, hk_point q, hk_point r, hk_point s) {
  return extents_meet(p, q, r, s) && hk_orient3d(p, q, r, s) == 0 && coplanar_segments_meet(p, q, r, s);
}

bool hk_segment_meets_triangle(hk_point p, hk_point q, hk_point a, hk_point b, hk_point c) {
  int above = hk_orient3d(a, b, c, p), below = hk_orient3d(a, b, c, q);
  if (same_side(above, below)) return false;
  if (above == 0 && below == 0) return coplanar_segment_meets(p, q, a, b, c);
  /* The line p q crosses the plane once: in the triangle where it passes its three sides with the same sense. */
  int ab = hk_orient3d(p, q, a, b), bc = hk_orient3d(p, q, b, c), ca = hk_orient3d(p, q, c, a);
  bool left = ab > 0 || bc > 0 || ca > 0, right = ab < 0 || bc < 0 || ca < 0;
  return !(left && right);
}
