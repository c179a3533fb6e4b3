#include "plugins/common/obstacles/motion.h"
#include "plugins/kit/vector3.h"

#include <float.h>
#include <string.h>

static const double unknown = -INFINITY; /* s, the time of a pose that there is not */

void hk_motion_begin(hk_pose history[HK_POSES], const hk_pose *now) {
  for (int k = 0; k < HK_POSES; k++) history[k] = *now;
  history[0].t = history[1].t = unknown;
}

static bool same_time(double a, double b) { return fabs(a - b) <= 16 * DBL_EPSILON * fmax(fabs(a), fabs(b)); }

/* The step that the last pose ended was taken back where the new one begins where it began. */
void hk_motion_advance(hk_pose history[HK_POSES], double t_from, const hk_pose *now) {
  bool again = history[1].t > unknown && fabs(history[1].t - t_from) < fabs(history[2].t - t_from);
  if (!again) {
    history[0] = history[1];
    history[1] = history[2];
  }
  history[2] = *now;
}

/* The quadratic, or line, through the poses' entry at `value`, and its derivative in t. */
static void interpolate(const hk_motion *m, const double *a, const double *b, const double *c, double t, double out[3],
                        double rate[3]) {
  double t0 = m->pose[0].t, t1 = m->pose[1].t, t2 = m->pose[2].t, h = t2 - t1;
  for (int k = 0; k < 3; k++) {
    double slope = (c[k] - b[k]) / h, bend = 0;
    if (m->bent) bend = (slope - (b[k] - a[k]) / (t1 - t0)) / (t2 - t0);
    out[k] = b[k] + (t - t1) * (slope + (t - t2) * bend);
    rate[k] = slope + (2 * t - t1 - t2) * bend;
  }
}

/* R = exp([r]) by Rodrigues' formula, and w = J(r) r'. */
static void turn(const double r[3], const double rate[3], double R[9], double w[3]) {
  double a2 = hk_dot(r, r), a = sqrt(a2), cross[3], twice[3];
  bool small = a < 1e-4; /* the next terms of the series are a^4/120 */
  double f = small ? 1 - a2 / 6 : sin(a) / a, g = small ? 0.5 - a2 / 24 : (1 - cos(a)) / a2;
  double k = small ? 1.0 / 6 - a2 / 120 : (a - sin(a)) / (a2 * a);
  const double skew[9] = {0, -r[2], r[1], r[2], 0, -r[0], -r[1], r[0], 0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) R[3 * i + j] = (i == j ? 1 - g * a2 : 0) + f * skew[3 * i + j] + g * r[i] * r[j];
  hk_cross(cross, r, rate);
  hk_cross(twice, r, cross);
  for (int c = 0; c < 3; c++) w[c] = rate[c] + g * cross[c] + k * twice[c];
}

void hk_motion_at(const hk_motion *m, double s, hk_body_frame *f) {
  if (m->still || s >= 1) {
    *f = m->end;
    return;
  }
  const hk_pose *p = m->pose;
  double t = p[1].t + s * (p[2].t - p[1].t), r[3], rate[3];
  interpolate(m, p[0].position, p[1].position, p[2].position, t, f->origin, f->velocity);
  interpolate(m, p[0].rotation, p[1].rotation, p[2].rotation, t, r, rate);
  turn(r, rate, f->turn, f->spin);
}

static bool same_pose(const hk_pose *a, const hk_pose *b) {
  return memcmp(a->position, b->position, sizeof a->position) == 0 &&
         memcmp(a->rotation, b->rotation, sizeof a->rotation) == 0;
}

void hk_motion_of(hk_motion *m, const hk_pose history[HK_POSES]) {
  memcpy(m->pose, history, sizeof m->pose);
  m->bent = history[0].t > unknown;
  m->still = same_pose(history, history + 2) && same_pose(history + 1, history + 2);
  memset(&m->end, 0, sizeof m->end);
  hk_copy(m->end.origin, history[2].position);
  turn(history[2].rotation, (const double[3]){0, 0, 0}, m->end.turn, m->end.spin);
  m->start = m->end;
  if (m->still || same_time(history[1].t, history[2].t)) return;
  hk_motion_at(m, 0, &m->start);
  m->still = false;
  double r[3], rate[3], position[3];
  interpolate(m, history[0].position, history[1].position, history[2].position, history[2].t, position,
              m->end.velocity);
  interpolate(m, history[0].rotation, history[1].rotation, history[2].rotation, history[2].t, r, rate);
  turn(history[2].rotation, rate, m->end.turn, m->end.spin);
}

static void into(const hk_body_frame *f, const double d[3], double to[3]) {
  const double *R = f->turn;
  for (int c = 0; c < 3; c++) to[c] = R[c] * d[0] + R[3 + c] * d[1] + R[6 + c] * d[2];
}

void hk_body_direction(const hk_body_frame *f, const double d[3], double to[3]) {
  const double *R = f->turn;
  for (int c = 0; c < 3; c++) to[c] = hk_dot(R + 3 * c, d);
}

void hk_body_point(const hk_body_frame *f, const double x[3], double p[3]) {
  double d[3];
  hk_subtract(d, x, f->origin);
  into(f, d, p);
}

void hk_body_place(const hk_body_frame *f, const double p[3], double x[3]) {
  hk_body_direction(f, p, x);
  for (int c = 0; c < 3; c++) x[c] += f->origin[c];
}

static void velocity_at(const hk_body_frame *f, const double x[3], double at[3]) {
  double d[3];
  hk_subtract(d, x, f->origin);
  hk_cross(at, f->spin, d);
  for (int c = 0; c < 3; c++) at[c] += f->velocity[c];
}

void hk_body_velocity(const hk_body_frame *f, const double x[3], const double u[3], double w[3]) {
  double own[3], d[3];
  velocity_at(f, x, own);
  hk_subtract(d, u, own);
  into(f, d, w);
}

void hk_body_move(const hk_body_frame *f, const double x[3], const double w[3], double u[3]) {
  double own[3];
  velocity_at(f, x, own);
  hk_body_direction(f, w, u);
  for (int c = 0; c < 3; c++) u[c] += own[c];
}
