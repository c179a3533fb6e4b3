/* The signs of the determinants by which points lie on one side or the other of a line or a plane, without a tolerance:
 * as if in exact arithmetic, for all finite doubles, however large, small or different. With coordinates that are not
 * finite the answer is 0: callers look before. */
#ifndef HK_ORIENTATION_H
#define HK_ORIENTATION_H

/* The sign of the area of a, b, c: 1 anticlockwise, -1 clockwise, 0 on one line. */
int hk_orient2d(const double a[2], const double b[2], const double c[2]);

/* The sign of the volume of a, b, c, d, that is of (b - a) x (c - a) . (d - a): 1 where d lies on the side from which
 * a, b, c run anticlockwise, 0 in one plane. */
int hk_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

#endif
