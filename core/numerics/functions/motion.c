/* The motion of the particles of a pin. A particle that starts at p is at x = c + o + R (p - c), c the center at the
 * start, o the offset and R = exp([r]) of the rotation vector r, all functions of time. With R by Rodrigues' formula,
 * f, g and k the series sum (-a^2)^n/(2 n + 1)!, /(2 n + 2)! and /(2 n + 3)! of a = |r|, and d = R (p - c):
 *
 *     x' = o' + w x d,                     w  = r' + g (r x r') + k r x (r x r')
 *     x'' = o'' + w' x d + w x (w x d),    w' = the derivative of that.
 *
 * The second is the left Jacobian of the exponential map (Bullo and Murray 1995, "Proportional derivative control on
 * the Euclidean group"). */
#include "core/numerics/functions/functions.h"

#include <stdlib.h>
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

/* ---- a motion of two functions ---- */

static hk_scripted_motion *scripted(hk_pin_motion *motion) { return (hk_scripted_motion *)(void *)motion; }

void hk_rotation(const double r[3], double R[9]) {
  coefficients q = coefficients_of(dot(r, r));
  const double skew[9] = {0, -r[2], r[1], r[2], 0, -r[0], -r[1], r[0], 0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      R[3 * i + j] = (i == j ? 1 - q.g * dot(r, r) : 0) + q.f * skew[3 * i + j] + q.g * r[i] * r[j];
}

/* r = value, r' = value + 3 */
static void turn_by(hk_pin_motion *m, const double *r, const double *rate) {
  coefficients q = coefficients_of(dot(r, r));
  double twice[3];
  hk_rotation(r, m->turn);
  cross(twice, r, rate);
  memcpy(m->spin, rate, sizeof m->spin);
  add_cross(m->spin, q.g, r, rate);
  add_cross(m->spin, q.k, r, twice);
}

static hk_status find(hk_pin_motion *motion, double t, hk_error *error) {
  hk_scripted_motion *m = scripted(motion);
  hk_status status = hk_path_find(&m->offset, t, error);
  memcpy(motion->offset, m->offset.value, sizeof motion->offset);
  memcpy(motion->velocity, m->offset.value + HK_COLUMNS, sizeof motion->velocity);
  if (status == HK_OK && motion->turns && t != m->rotation.at) {
    status = hk_path_find(&m->rotation, t, error);
    if (status == HK_OK) turn_by(motion, m->rotation.value, m->rotation.value + HK_COLUMNS);
  }
  motion->speed_error = m->offset.speed_error + m->reach * m->rotation.speed_error;
  return status;
}

static hk_status bend(hk_pin_motion *motion, double t, hk_error *error) {
  hk_scripted_motion *m = scripted(motion);
  double second[3], once[3], twice[3], more[3];
  hk_status status = find(motion, t, error);
  if (status == HK_OK) status = hk_path_acceleration(&m->offset, t, motion->push, error);
  if (status != HK_OK || !motion->turns) return status;
  status = hk_path_acceleration(&m->rotation, t, second, error);
  const double *r = m->rotation.value, *rate = r + HK_COLUMNS;
  coefficients q = coefficients_of(dot(r, r));
  double growth = 2 * dot(r, rate); /* of the square of the angle */
  cross(once, r, rate);
  cross(twice, r, once);
  cross(more, r, second);
  memcpy(motion->twist, second, sizeof second);
  for (int c = 0; c < 3; c++) motion->twist[c] += growth * (q.dg * once[c] + q.dk * twice[c]) + q.g * more[c];
  add_cross(motion->twist, q.k, rate, once);
  add_cross(motion->twist, q.k, r, more);
  return status;
}

void hk_motion_open(hk_scripted_motion *m, const hk_function *offset, const hk_function *rotation,
                    const double center[3], const char *where, double end) {
  *m = (hk_scripted_motion){.motion = {.find = find, .bend = bend, .turns = rotation->call}};
  m->motion.turn[0] = m->motion.turn[4] = m->motion.turn[8] = 1;
  memcpy(m->motion.center, center, sizeof m->motion.center);
  hk_path_open(&m->offset, offset, "path", where, end);
  hk_path_open(&m->rotation, rotation, "rotation", where, end);
}

static void reach(hk_scripted_motion *m, const double origin[3]) {
  double p[3];
  for (int c = 0; c < 3; c++) p[c] = origin[c] - m->motion.center[c];
  m->reach = fmax(m->reach, sqrt(dot(p, p)));
}

hk_status hk_motions_open(hk_pins *pins, double end, hk_error *error) {
  for (size_t k = 0; k < pins->count; k++) {
    const hk_pin_spec *spec = pins->item[k].spec;
    if (spec->kind != HK_PIN_PATH) continue;
    hk_scripted_motion *m = malloc(sizeof *m);
    if (!m) return hk_error_set(error, HK_NO_MEMORY, "no memory for the pins");
    hk_motion_open(m, &spec->path, &spec->rotation, spec->center, spec->where, fmin(end, spec->release));
    for (size_t j = 0; j < pins->item[k].count; j++) reach(m, pins->item[k].origin + 3 * j);
    pins->item[k].motion = &m->motion;
  }
  return HK_OK;
}
