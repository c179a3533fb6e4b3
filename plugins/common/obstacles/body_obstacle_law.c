/* The law of impact of one contact between a body or an edge and an obstacle, for the solver of all of them. Of a
 * contact that closes at the part s of the step with the normal speed u < 0, the step ends at least with the normal
 * speed u_1 - (1 + e) u and the gap g_1 - (1 + e) u (1 - s) h, where u_1 and g_1 are those without it, and with neither
 * below 0 (impact.h). Friction takes the way and the speed across n since the impact, in the obstacle's frame. */
#include "plugins/common/obstacles/body_obstacle_law.h"
#include "plugins/kit/vector3.h"

/* Of the step: a flight between two bounces that is shorter is none, as in obstacle.c. */
static const double shortest_flight = 1e-3;

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

/* Where the point of the feature was at the part s, carried along by the obstacle to the end of the step. */
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

bool hk_body_obstacle_impact(hk_impact *out, const hk_body_contact *k, const hk_obstacle_moves *m, bool again) {
  const hk_feature_gap *end = &k->way.to;
  const double *n = end->n, h = m->h, s = k->way.landing, g = end->gap;
  uint32_t i = k->feature.end[0], j = k->feature.end[1];
  double now[3], way[3];
  *out = (hk_impact){.pair = {{i, j, i, i}, HK_EDGE_EDGE, 0, k->way.from.gap}, .frame.w = {1 - end->place, end->place}};
  hk_copy(out->frame.n, n);
  double u_0 = hk_body_contact_speed(k, m, end, n, 0), u_1 = hk_body_contact_speed(k, m, end, n, 1);
  double u = fmin(0, u_0 + s * (u_1 - u_0));
  double touching = hk_body_contact_touching(k->obstacle, m, &k->feature);
  bool inside = k->way.from.gap < -touching && s == 0;
  double turned = again ? 0 : (1 + restitution(k, -u, (u_0 - u_1) / h, (1 - s) * h, h)) * u, gap = fmin(g, 0);
  out->speed.target = again ? 0 : fmax(0, u_1 - turned);
  out->plastic = again ? 0 : fmax(0, u_1 - u);
  if (g < 0) gap = again || inside ? 0 : fmax(0, g - turned * (1 - s) * h);
  hk_obstacle_surface_velocity(k->obstacle, 1, end->x, out->speed.origin);
  carried(k, m, again ? 1 : s, out->place.origin);
  weigh(&k->feature, end->place, m->x, now);
  hk_subtract(way, now, out->place.origin);
  out->place.target = hk_dot(way, n) + (g < 0 ? gap - g : 0);
  return fabs(g) <= touching;
}
