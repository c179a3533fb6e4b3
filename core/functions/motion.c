/* The motion of the particles of a pin. A particle that starts at p is at x = c + o + R (p - c), c the center at the
 * start, o the offset and R = exp([r]) of the rotation vector r, all functions of time. With R by Rodrigues' formula,
 * f, g and k the series sum (-a^2)^n/(2 n + 1)!, /(2 n + 2)! and /(2 n + 3)! of a = |r|, and d = R (p - c):
 *
 *     x' = o' + w x d,                     w  = r' + g (r x r') + k r x (r x r')
 *     x'' = o'' + w' x d + w x (w x d),    w' = the derivative of that.
 *
 * The second is the left Jacobian of the exponential map (Bullo and Murray 1995, "Proportional derivative control on
 * the Euclidean group"). */
#include "core/functions/functions.h"

#include <string.h>

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(double to[3], const double a[3], const double b[3]) {
  to[0] = a[1] * b[2] - a[2] * b[1];
  to[1] = a[2] * b[0] - a[0] * b[2];
  to[2] = a[0] * b[1] - a[1] * b[0];
}

/* to += s a x b */
static void add_cross(double to[3], double s, const double a[3], const double b[3]) {
  double product[3];
  cross(product, a, b);
  for (int c = 0; c < 3; c++) to[c] += s * product[c];
}

/* ---- coefficients ---- */

typedef struct coefficients {
  double f, g, k, dg, dk; /* the last two: derivatives with respect to the square of the angle */
} coefficients;

/* sum of (-s)^n/(2 n + m)!, and its derivative with respect to s */
static double series(int m, double s, double *derivative) {
  enum { TERMS = 9 }; /* for s below 1 the next one is below 1/19! = 1e-17 */
  double coefficient[TERMS] = {m == 3 ? 1.0 / 6 : 1.0 / m}, sum = 0;
  for (int n = 1; n < TERMS; n++) coefficient[n] = -coefficient[n - 1] / ((2 * n + m - 1) * (2 * n + m));
  *derivative = 0;
  for (int n = TERMS - 1; n >= 0; n--) {
    *derivative = sum + s * *derivative;
    sum = coefficient[n] + s * sum;
  }
  return sum;
}

/* Beyond an angle of 1 the closed forms lose nothing. */
static coefficients coefficients_of(double s) {
  coefficients q;
  double a = sqrt(s), unused;
  if (s < 1) {
    q.f = series(1, s, &unused);
    q.g = series(2, s, &q.dg);
    q.k = series(3, s, &q.dk);
    return q;
  }
  q.f = sin(a) / a;
  q.g = (1 - cos(a)) / s;
  q.k = (1 - q.f) / s;
  q.dg = (q.f / 2 - q.g) / s;
  q.dk = (q.g / 2 - 1.5 * q.k) / s;
  return q;
}

/* ---- */

void hk_motion_open(hk_motion *m, const hk_function *offset, const hk_function *rotation, const double center[3],
                    const char *where, double end) {
  *m = (hk_motion){.turn = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  memcpy(m->center, center, sizeof m->center);
  hk_path_open(&m->offset, offset, "path", where, end);
  hk_path_open(&m->rotation, rotation, "rotation", where, end);
}

void hk_rotation(const double r[3], double R[9]) {
  coefficients q = coefficients_of(dot(r, r));
  const double skew[9] = {0, -r[2], r[1], r[2], 0, -r[0], -r[1], r[0], 0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      R[3 * i + j] = (i == j ? 1 - q.g * dot(r, r) : 0) + q.f * skew[3 * i + j] + q.g * r[i] * r[j];
}

/* r = value, r' = value + 3 */
static void turn_by(hk_motion *m, const double *r, const double *rate) {
  coefficients q = coefficients_of(dot(r, r));
  double twice[3];
  hk_rotation(r, m->turn);
  cross(twice, r, rate);
  memcpy(m->spin, rate, sizeof m->spin);
  add_cross(m->spin, q.g, r, rate);
  add_cross(m->spin, q.k, r, twice);
}

hk_status hk_motion_find(hk_motion *m, double t, hk_error *error) {
  hk_status status = hk_path_find(&m->offset, t, error);
  if (status != HK_OK || !m->rotation.function->call || t == m->rotation.at) return status;
  status = hk_path_find(&m->rotation, t, error);
  if (status == HK_OK) turn_by(m, m->rotation.value, m->rotation.value + HK_COLUMNS);
  return status;
}

/* d = R (origin - center) */
static void arm_of(const hk_motion *m, const double origin[3], double d[3]) {
  double p[3];
  for (int c = 0; c < 3; c++) p[c] = origin[c] - m->center[c];
  for (int c = 0; c < 3; c++) d[c] = dot(m->turn + 3 * c, p);
}

void hk_motion_reaches(hk_motion *m, const double origin[3]) {
  double p[3];
  for (int c = 0; c < 3; c++) p[c] = origin[c] - m->center[c];
  m->reach = fmax(m->reach, sqrt(dot(p, p)));
}

void hk_motion_place(const hk_motion *m, const double origin[3], double x[3], double v[3]) {
  double d[3];
  for (int c = 0; c < 3; c++) x[c] = origin[c] + m->offset.value[c];
  memcpy(v, m->offset.value + HK_COLUMNS, 3 * sizeof *v);
  if (!m->rotation.function->call) return;
  arm_of(m, origin, d);
  for (int c = 0; c < 3; c++) x[c] = m->center[c] + m->offset.value[c] + d[c];
  add_cross(v, 1, m->spin, d);
}

hk_status hk_motion_bend(hk_motion *m, double t, hk_error *error) {
  double second[3], once[3], twice[3], more[3];
  hk_status status = hk_motion_find(m, t, error);
  if (status == HK_OK) status = hk_path_acceleration(&m->offset, t, m->push, error);
  if (status != HK_OK || !m->rotation.function->call) return status;
  status = hk_path_acceleration(&m->rotation, t, second, error);
  const double *r = m->rotation.value, *rate = r + HK_COLUMNS;
  coefficients q = coefficients_of(dot(r, r));
  double growth = 2 * dot(r, rate); /* of the square of the angle */
  cross(once, r, rate);
  cross(twice, r, once);
  cross(more, r, second);
  memcpy(m->twist, second, sizeof second);
  for (int c = 0; c < 3; c++) m->twist[c] += growth * (q.dg * once[c] + q.dk * twice[c]) + q.g * more[c];
  add_cross(m->twist, q.k, rate, once);
  add_cross(m->twist, q.k, r, more);
  return status;
}

void hk_motion_acceleration(const hk_motion *m, const double origin[3], double a[3]) {
  double d[3], around[3];
  memcpy(a, m->push, sizeof m->push);
  if (!m->rotation.function->call) return;
  arm_of(m, origin, d);
  cross(around, m->spin, d);
  add_cross(a, 1, m->twist, d);
  add_cross(a, 1, m->spin, around);
}

double hk_motion_speed_error(const hk_motion *m) { return m->offset.speed_error + m->reach * m->rotation.speed_error; }
