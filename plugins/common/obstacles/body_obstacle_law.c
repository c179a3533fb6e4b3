/* The law of impact of one contact between a body or an edge and an obstacle, for the solver of all of them. Of a
 * contact that closes at the part s of the step with the normal speed u < 0, the step ends at least with the normal
 * speed u_1 - (1 + e) u and the gap g_1 - (1 + e) u (1 - s) h, where u_1 and g_1 are those without it, and with neither
 * below 0 (impact.h). Friction takes the way and the speed across n since the impact, in the obstacle's frame.
 *
 * A rider of a rigid body with a radius R is a ball's centre: what touches is x - R n, a combination of the four
 * carriers as every point of a body is, whose weights are the rider's and those of -R n across them. So friction turns
 * a ball; the normal speeds of both points are the same. A body of fewer carriers has no such points, and is touched at
 * x. */
#include "plugins/common/obstacles/body_obstacle_law.h"
#include "plugins/kit/vector3.h"

#include <string.h>

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

/* The sum of weights times what y has of the particles. */
static void combine(const hk_weighted_point *p, const double *y, double out[3]) {
  out[0] = out[1] = out[2] = 0;
  for (int i = 0; i < 4; i++)
    if (p->weight[i] != 0) hk_add_scaled(out, p->weight[i], y + 3 * (size_t)p->particle[i]);
}

/* What touches at the end of the step, as a combination of particles. */
static hk_weighted_point point_of(const hk_body_contact *k, const hk_obstacle_moves *m) {
  const hk_feature_gap *end = &k->way.to;
  uint32_t i = k->feature.end[0], j = k->feature.end[1];
  hk_weighted_point p = {{i, j, i, i}, {1 - end->place, end->place, 0, 0}};
  double side[3][3], across[3][3], radius = hk_obstacle_radius(k->obstacle, i);
  if (!k->rider) return p;
  memcpy(p.particle, k->rider->carrier, sizeof p.particle);
  memcpy(p.weight, k->rider->weight, sizeof p.weight);
  const double *origin = m->x + 3 * (size_t)p.particle[0];
  for (int c = 0; c < 3; c++) hk_subtract(side[c], m->x + 3 * (size_t)p.particle[c + 1], origin);
  for (int c = 0; c < 3; c++) hk_cross(across[c], side[(c + 1) % 3], side[(c + 2) % 3]);
  double volume = hk_dot(side[0], across[0]);
  for (int c = 0; c < 3; c++) {
    double part = -radius * hk_dot(across[c], end->n) / volume;
    p.weight[c + 1] += part;
    p.weight[0] -= part;
  }
  return p;
}

/* Where the point was at the part s, carried along by the obstacle to the end of the step. */
static void carried(const hk_body_contact *k, const hk_weighted_point *point, const hk_obstacle_moves *m, double s,
                    double out[3]) {
  double from[3], to[3], u[3], v[3], p[3], x[3];
  hk_body_frame frame;
  combine(point, m->x_from, from);
  combine(point, m->x, to);
  combine(point, m->v_from, u);
  combine(point, m->v, v);
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
  double now[3], way[3];
  hk_weighted_point point = point_of(k, m);
  *out = (hk_impact){.pair = {.kind = HK_EDGE_EDGE, .gap = k->way.from.gap}};
  memcpy(out->pair.vertex, point.particle, sizeof out->pair.vertex);
  memcpy(out->frame.w, point.weight, sizeof out->frame.w);
  hk_copy(out->frame.n, n);
  double u_0 = hk_body_contact_speed(k, m, end, n, 0), u_1 = hk_body_contact_speed(k, m, end, n, 1);
  double u = fmin(0, u_0 + s * (u_1 - u_0));
  double touching = hk_body_contact_touching(k->obstacle, m, &k->feature);
  bool inside = k->way.from.gap < -touching && s == 0;
  double turned = again ? 0 : (1 + restitution(k, -u, (u_0 - u_1) / h, (1 - s) * h, h)) * u, gap = fmin(g, 0);
  out->speed.target = again ? 0 : fmax(0, u_1 - turned);
  out->plastic = again ? 0 : fmax(0, u_1 - u);
  if (g < 0) gap = again || inside ? 0 : fmax(0, g - turned * (1 - s) * h);
  combine(&point, m->x, now);
  hk_obstacle_surface_velocity(k->obstacle, 1, now, out->speed.origin);
  carried(k, &point, m, again ? 1 : s, out->place.origin);
  hk_subtract(way, now, out->place.origin);
  out->place.target = hk_dot(way, n) + (g < 0 ? gap - g : 0);
  return fabs(g) <= touching;
}
