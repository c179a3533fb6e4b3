/* The law of impact of one contact between a body or an edge and an obstacle, for the solver of all of them. Of a
 * contact that closes at the part s of the step with the normal speed u < 0, the step ends at least with the normal
 * speed u_1 - (1 + e) u and the gap g_1 - (1 + e) u (1 - s) h, where u_1 and g_1 are those without it, and with neither
 * below 0 (impact.h). Friction takes the way and the speed across n since the impact, in the obstacle's frame.
 *
 * A rider of a rigid body with a radius R is a ball's centre, two of them are a capsule's axis: what touches is x - R
 * n (common/contact/bodies/body_arms.h). So friction turns round bodies; the normal speeds of both points are the same.
 * At every instant it is another point, so its way across n is the integral of its speed, by the trapezium rule, not
 * the way of one point. A body of fewer carriers has no such points, and is touched at x.
 *
 * Where the normal turns from n_0 to n_1 while contact lasts, impulses are along n between them, and the speed along n
 * is reversed from what v_0, without its part along n_0, has there: on a circle both ends then have the same speed, and
 * the law is of order 2, as the implicit midpoint rule is. The slip of a round body is treated likewise. */
#include "plugins/common/obstacles/body_obstacle_law.h"
#include "plugins/kit/vector3.h"

/* Of the step: a flight between two bounces that is shorter is none, as in obstacle.c. */
static const double shortest_flight = 1e-3;

/* rad: a normal that turns by less in a step does not turn; one by more, at an edge of the obstacle. */
static const double straight = 1e-12, corner = 0.5;

/* Times the change of a step: a slip that is one. */
static const double surely = 10;

double hk_body_contact_touching(const hk_obstacle *o, const hk_obstacle_moves *m, const hk_obstacle_feature *f) {
  size_t i = f->end[0], j = f->end[1];
  return 1e5 * fmax(hk_obstacle_rounding(o, m->x_from + 3 * i, m->x + 3 * i, i),
                    hk_obstacle_rounding(o, m->x_from + 3 * j, m->x + 3 * j, j));
}

static void weigh(const hk_obstacle_feature *f, double place, const double *y, double out[3]) {
  for (size_t c = 0; c < 3; c++) out[c] = (1 - place) * y[3 * (size_t)f->end[0] + c];
  for (size_t c = 0; c < 3 && place != 0; c++) out[c] += place * y[3 * (size_t)f->end[1] + c];
}

double hk_body_contact_speed(const hk_body_contact *k, const hk_obstacle_moves *m, const hk_feature_gap *gap,
                             const double n[3], double s) {
  double v_from[3], v[3], surface[3];
  weigh(&k->feature, gap->place, m->v_from, v_from);
  weigh(&k->feature, gap->place, m->v, v);
  hk_obstacle_surface_velocity(k->obstacle, s, gap->x, surface);
  for (int c = 0; c < 3; c++) v[c] = v_from[c] + s * (v[c] - v_from[c]) - surface[c];
  return hk_dot(v, n);
}

/* The restitution that counts: none where the bounces end within the step. */
static double restitution(const hk_body_contact *k, double closing, double pull, double left, double h) {
  double e = k->obstacle->restitution, flight = 2 * e * closing / pull;
  if (!(pull > 0)) return e;
  return flight <= (1 - e) * left || flight <= shortest_flight * h ? 0 : e;
}

/* Where the point was at the part s, carried along by the obstacle to the end of the step. */
static void carried(const hk_body_contact *k, const hk_obstacle_moves *m, double s, double out[3]) {
  double from[3], to[3], u[3], v[3], p[3], x[3], place = k->way.to.place;
  hk_body_frame frame;
  weigh(&k->feature, place, m->x_from, from);
  weigh(&k->feature, place, m->x, to);
  weigh(&k->feature, place, m->v_from, u);
  weigh(&k->feature, place, m->v, v);
  double a = s * s * (3 - 2 * s), b = s * (1 - s) * (1 - s) * m->h, c = s * s * (s - 1) * m->h;
  for (int d = 0; d < 3; d++) x[d] = s == 1 ? to[d] : from[d] + a * (to[d] - from[d]) + b * u[d] + c * v[d];
  hk_motion_at(&k->obstacle->motion, s, &frame);
  if (s == 0) frame = k->obstacle->motion.start;
  hk_body_point(&frame, x, p);
  hk_body_place(&k->obstacle->motion.end, p, out);
}

/* ---- round bodies and what is curved ---- */

static hk_body_arms arms_of(const hk_body_contact *k) {
  double radius = k->carrier ? hk_obstacle_radius(k->obstacle, k->feature.end[0]) : 0;
  return (hk_body_arms){{{.carrier = k->carrier, .radius = radius}, {.carrier = NULL}}};
}

/* The direction d of one frame of the obstacle, as it is in another one. */
static void turn(const hk_body_frame *from, const hk_body_frame *to, const double d[3], double out[3]) {
  double x[3], own[3];
  for (int c = 0; c < 3; c++) x[c] = from->origin[c] + d[c];
  hk_body_point(from, x, own);
  hk_body_direction(to, own, out);
}

/* Of a step in which contact lasts: the normal in its middle; how the velocity of what touches changes from there to
 * the end's normal, and the speed of the centre along n, both of the start's motion, in the frame of the end. */
typedef struct course {
  bool lasts;
  double n[3], turned[3], normal; /* m/s */
} course;

/* Where the particles are at x: the place that touches, m, and its velocity, m/s. */
static void touching_point(const hk_body_contact *k, const double *x, const double *v, const double n[3], double at[3],
                           double speed[3]) {
  hk_body_arms arms = arms_of(k);
  hk_body_arms_set(&arms, x, n);
  weigh(&k->feature, k->way.to.place, x, at);
  weigh(&k->feature, k->way.to.place, v, speed);
  hk_add_scaled(at, -arms.side[0].radius, n);
  hk_body_arms_add(&arms, v, n, speed);
}

/* m/s, against the obstacle, of what touches with the normal n at the start of the step. */
static void speed_then(const hk_body_contact *k, const hk_obstacle_moves *m, const double n[3], double out[3]) {
  double x[3], v[3], own[3];
  touching_point(k, m->x_from, m->v_from, n, x, v);
  hk_body_velocity(&k->obstacle->motion.start, x, v, own);
  hk_body_direction(&k->obstacle->motion.end, own, out);
}

/* m/s, of the feature's own place against the obstacle at the start of the step. */
static double speed_of_centre(const hk_body_contact *k, const hk_obstacle_moves *m) {
  double x[3], v[3], own[3];
  weigh(&k->feature, k->way.from.place, m->x_from, x);
  weigh(&k->feature, k->way.from.place, m->v_from, v);
  hk_body_velocity(&k->obstacle->motion.start, x, v, own);
  return hk_length(own);
}

/* before: the normal of the start, in the frame of the end. */
static void bend(course *c, const hk_body_contact *k, const hk_obstacle_moves *m, const double before[3]) {
  const hk_motion *motion = &k->obstacle->motion;
  double back[3], v_0[3], v_mid[3], v_1[3];
  hk_add_scaled(c->n, 1, before);
  double length = hk_length(c->n);
  for (int d = 0; d < 3; d++) c->n[d] /= length;
  speed_then(k, m, k->way.from.n, v_0);
  turn(&motion->end, &motion->start, c->n, back);
  speed_then(k, m, back, v_mid);
  turn(&motion->end, &motion->start, k->way.to.n, back);
  speed_then(k, m, back, v_1);
  hk_subtract(c->turned, v_1, v_mid);
  hk_add_scaled(v_mid, -hk_dot(v_0, before), before);
  c->normal = hk_dot(v_mid, c->n);
}

/* change: m/s, of the normal speed in the step. */
static course course_of(const hk_body_contact *k, const hk_obstacle_moves *m, double change) {
  const hk_motion *motion = &k->obstacle->motion;
  course c = {.lasts = false};
  double before[3], angle[3], v_0[3];
  hk_copy(c.n, k->way.to.n);
  if (k->feature.end[0] != k->feature.end[1] || k->way.landing > 0) return c;
  if (k->way.from.gap < -hk_body_contact_touching(k->obstacle, m, &k->feature)) return c;
  turn(&motion->start, &motion->end, k->way.from.n, before);
  hk_subtract(angle, c.n, before);
  double size = hk_length(angle);
  if (size < straight || size > corner) return c;
  speed_then(k, m, k->way.from.n, v_0);
  if (hk_dot(v_0, before) < -fabs(change) - size * speed_of_centre(k, m)) return c; /* it lands */
  c.lasts = true;
  bend(&c, k, m, before);
  return c;
}

/* The way across n that a round body has slipped since the part s, by the trapezium rule, into the origin of the place;
 * v: m/s, of what touches at the end. */
static void slip(hk_impact *out, const hk_body_contact *k, const hk_obstacle_moves *m, const double v[3], double s) {
  double x[3], now[3], then[3], way[3];
  weigh(&k->feature, k->way.to.place, m->x, x);
  hk_subtract(now, v, out->speed.origin);
  speed_then(k, m, k->way.from.n, then);
  for (int c = 0; c < 3; c++) way[c] = (1 - s) * m->h / 2 * ((1 - s) * then[c] + (1 + s) * now[c]);
  hk_add_scaled(way, -hk_dot(way, out->frame.n), out->frame.n);
  hk_subtract(out->place.origin, x, way);
}

/* The origin of the speed, and what a curve changes. */
static void aim(hk_impact *out, const hk_body_contact *k, const course *c, const double at[3]) {
  hk_obstacle_surface_velocity(k->obstacle, 1, at, out->speed.origin);
  if (!c->lasts) return;
  out->speed.target = out->plastic = -c->normal;
  hk_add_scaled(out->speed.origin, -1, c->turned);
  hk_add_scaled(out->speed.origin, hk_dot(c->turned, c->n), c->n);
}

bool hk_body_obstacle_impact(hk_impact *out, hk_body_arms *arms, const hk_body_contact *k, const hk_obstacle_moves *m,
                             bool again) {
  const hk_feature_gap *end = &k->way.to;
  const double *n = end->n, h = m->h, s = k->way.landing, g = end->gap;
  double at[3], v[3], x[3], way[3];
  double u_0 = hk_body_contact_speed(k, m, end, n, 0), u_1 = hk_body_contact_speed(k, m, end, n, 1);
  const course c = course_of(k, m, u_1 - u_0);
  uint32_t i = k->feature.end[0], j = k->feature.end[1];
  *out = (hk_impact){.pair = {{i, j, i, i}, HK_EDGE_EDGE, 0, k->way.from.gap}};
  out->frame.w[0] = 1 - end->place, out->frame.w[1] = end->place;
  hk_copy(out->frame.n, c.n);
  *arms = arms_of(k);
  double u = fmin(0, u_0 + s * (u_1 - u_0)), touching = hk_body_contact_touching(k->obstacle, m, &k->feature);
  bool inside = k->way.from.gap < -touching && s == 0;
  double turned = again ? 0 : (1 + restitution(k, -u, (u_0 - u_1) / h, (1 - s) * h, h)) * u, gap = fmin(g, 0);
  out->speed.target = again ? 0 : fmax(0, u_1 - turned);
  out->plastic = again ? 0 : fmax(0, u_1 - u);
  if (g < 0) gap = again || inside || c.lasts ? 0 : fmax(0, g - turned * (1 - s) * h);
  touching_point(k, m->x, m->v, c.n, at, v);
  aim(out, k, &c, at);
  if (k->carrier)
    slip(out, k, m, v, again && s > 0 ? 1 : s);
  else
    carried(k, m, again ? 1 : s, out->place.origin);
  weigh(&k->feature, end->place, m->x, x);
  hk_subtract(way, x, out->place.origin);
  out->place.target = hk_dot(way, c.n) + (g < 0 ? (gap - g) / hk_dot(c.n, n) : 0);
  return fabs(g) <= touching;
}

void hk_body_obstacle_moments(hk_body_moments *out, const hk_body_contact *k, const hk_obstacle_moves *m) {
  const hk_obstacle *o = k->obstacle;
  double then[3], now[3], s = k->way.landing;
  bool any = k->carrier && o->rolling + o->spinning > 0;
  *out = (hk_body_moments){.rolling = o->rolling, .spinning = o->spinning};
  out->side[0].carrier = any ? k->carrier : NULL;
  if (!any) return;
  hk_copy(out->rest, o->motion.end.spin);
  hk_body_spin(k->carrier, m->x_from, m->v_from, then);
  hk_body_spin(k->carrier, m->x, m->v, now);
  hk_subtract(then, then, o->motion.start.spin);
  hk_subtract(now, now, o->motion.end.spin);
  for (int c = 0; c < 3; c++) out->way[c] = (1 - s) * m->h / 2 * ((1 - s) * then[c] + (1 + s) * now[c]);
}

void hk_body_obstacle_slides(const hk_body_contact *k, const hk_obstacle_moves *m, double slip[3]) {
  const double *n = k->way.to.n;
  double at[3], now[3], surface[3], then[3], change[3];
  double touching = hk_body_contact_touching(k->obstacle, m, &k->feature);
  slip[0] = slip[1] = slip[2] = 0;
  if (!(k->obstacle->friction > 0) || k->way.landing > 0 || k->way.from.gap < -touching) return;
  touching_point(k, m->x, m->v, n, at, now);
  hk_obstacle_surface_velocity(k->obstacle, 1, at, surface);
  hk_subtract(now, now, surface);
  speed_then(k, m, k->way.from.n, then);
  hk_subtract(change, now, then);
  if (hk_dot(then, n) < -hk_length(change)) return; /* it lands */
  hk_add_scaled(then, -hk_dot(then, n), n);
  if (hk_length(then) > surely * hk_length(change)) hk_copy(slip, then);
}
