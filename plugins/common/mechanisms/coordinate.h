/* The coordinate of a joint by four points: the way of a slider, m (way.h), or the angle of a hinge, rad: that between
 * the half planes from the axis a b to c and to d, 0 where these are opposite to each other, positive where d has
 * turned about a b by the right hand (plugins/common/shells/hinge.h). joint:frame() of a scene names the points. */
#ifndef HK_COORDINATE_H
#define HK_COORDINATE_H

#include "core/plugin.h"

enum { HK_COORDINATE_TURN, HK_COORDINATE_WAY };
#define HK_COORDINATE_CHOICES "turn|way"

typedef struct hk_coordinate {
  hk_tuples points;
  int kind;
  hk_per_tuple length; /* of ways, filled by hk_coordinate_start */
} hk_coordinate;

/* HK_BAD_PARAM: points that have no direction, or half planes without a side. */
hk_status hk_coordinate_start(hk_coordinate *, const hk_view *view);
/* The value and its gradient, which may be NULL. Angles are from -pi to pi, or, where near is not NAN, of those that
 * differ by whole turns the one nearest to it. */
double hk_coordinate_value(const hk_coordinate *, const double *x, size_t k, double near, double (*gradient)[3]);
void hk_coordinate_hessian(const hk_coordinate *, const double *x, size_t k, double *H); /* 12 x 12, by rows */
double hk_coordinate_rate(const hk_coordinate *, const double *v, size_t k, double (*gradient)[3]);
/* v.H v: what d^2 q/dt^2 has beside the gradient times accelerations. */
double hk_coordinate_bend(const hk_coordinate *, const double *x, const double *v, size_t k);

#endif
