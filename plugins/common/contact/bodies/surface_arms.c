/* Every side of an impact that is of one rigid body is rubbed at its surface, the radius of its feature away from its
 * place: the centre of a ball, the axis of a capsule, a triangle. Both sides then are rubbed in one place, so that
 * friction keeps the angular momentum of two bodies, and turns balls. The way that has been slipped since the impact is
 * the integral of the slip's speed by the trapezium rule, as what touches is another point at every instant. Cloth,
 * strands and particles have nothing that turns, and are rubbed where they are. */
#include "plugins/common/contact/bodies/surface_arms.h"
#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

static hk_body_arms arms_of(const hk_model *m, const hk_surface_mesh *mesh, const hk_impact *k) {
  hk_body_arms arms = {{{.carrier = NULL}, {.carrier = NULL}}};
  int split = hk_pair_split(k->pair.kind);
  for (int side = 0; side < 2; side++) {
    int first = side == 0 ? 0 : split, last = side == 0 ? split : 4;
    hk_body_arm *a = &arms.side[side];
    a->carrier = hk_body_arm_carriers(m, k->pair.vertex + first, k->frame.w + first, last - first);
    for (int i = first; i < last; i++) a->radius = fmax(a->radius, mesh->radius[k->pair.vertex[i]]);
  }
  return arms;
}

/* m/s, of the difference of both sides where they touch. */
static void slip_of(const hk_impact *k, hk_body_arms *arms, const double *x, const double *v, double out[3]) {
  for (int c = 0; c < 3; c++) out[c] = 0;
  for (int i = 0; i < 4; i++) hk_add_scaled(out, k->frame.w[i], v + 3 * (size_t)k->pair.vertex[i]);
  hk_body_arms_set(arms, x, k->frame.n);
  hk_body_arms_add(arms, v, k->frame.n, out);
}

/* Into the origin of the place, whose part along n stays. */
static void slip(hk_impact *k, hk_body_arms *arms, const hk_step_move *m) {
  double then[3], now[3], way[3], s = k->part, difference[3];
  slip_of(k, arms, m->x_from, m->v_from, then);
  slip_of(k, arms, m->x, m->v, now);
  for (int c = 0; c < 3; c++) {
    difference[c] = -k->place.origin[c];
    way[c] = (1 - s) * m->h / 2 * ((1 - s) * then[c] + (1 + s) * now[c]);
  }
  for (int i = 0; i < 4; i++) hk_add_scaled(difference, k->frame.w[i], m->x + 3 * (size_t)k->pair.vertex[i]);
  hk_subtract(difference, difference, way);
  hk_add_scaled(difference, -hk_dot(difference, k->frame.n), k->frame.n);
  hk_add_scaled(k->place.origin, 1, difference);
}

hk_status hk_surface_arms_find(hk_body_impacts *s, const hk_surface_mesh *mesh, const hk_contact_solver *solver,
                               const hk_step_move *m) {
  s->arms = NULL;
  if (s->count == 0 || !(solver->friction > 0)) return HK_OK;
  hk_status status = hk_reserve(s->host, &s->arms_found, &s->arms_room, solver->count, sizeof *s->arms_found);
  if (status != HK_OK) return status;
  s->arms = s->arms_found;
  for (size_t e = 0; e < solver->count; e++) {
    s->arms[e] = arms_of(s->model, mesh, &solver->impact[e]);
    if (hk_body_arms_any(&s->arms[e])) slip(&solver->impact[e], &s->arms[e], m);
  }
  return HK_OK;
}

/* ---- rolling and spinning friction ---- */

/* The spin of three places that move as a rigid body does: that of their plane's vectors and its unit normal. */
static void spin_of_triangle(const uint32_t *corner, const double *x, const double *v, double out[3]) {
  double place[4][3] = {{0, 0, 0}}, speed[4][3] = {{0, 0, 0}}, normal[3], part[3];
  static const uint32_t all[4] = {0, 1, 2, 3};
  for (int c = 0; c < 3; c++) hk_copy(place[c], x + 3 * (size_t)corner[c]);
  for (int c = 0; c < 3; c++) hk_copy(speed[c], v + 3 * (size_t)corner[c]);
  double e[2][3], d[2][3];
  for (int c = 0; c < 2; c++) hk_subtract(e[c], place[c + 1], place[0]), hk_subtract(d[c], speed[c + 1], speed[0]);
  hk_cross(normal, e[0], e[1]);
  hk_cross(speed[3], d[0], e[1]);
  hk_cross(part, e[0], d[1]);
  hk_add_scaled(speed[3], 1, part);
  double length = hk_length(normal);
  out[0] = out[1] = out[2] = 0;
  if (!(length > 0)) return;
  for (int c = 0; c < 3; c++) normal[c] /= length, speed[3][c] /= length;
  hk_add_scaled(speed[3], -hk_dot(speed[3], normal), normal);
  hk_copy(place[3], place[0]);
  hk_add_scaled(place[3], sqrt(length), normal);
  for (int c = 0; c < 3; c++) speed[3][c] = speed[0][c] + sqrt(length) * speed[3][c];
  hk_body_spin(all, place[0], speed[0], out);
}

/* The spin across the edge; an edge does not tell that along it, and a point none. */
static void spin_of_edge(const uint32_t *end, const double *x, const double *v, double out[3]) {
  double e[3], d[3];
  hk_subtract(e, x + 3 * (size_t)end[1], x + 3 * (size_t)end[0]);
  hk_subtract(d, v + 3 * (size_t)end[1], v + 3 * (size_t)end[0]);
  double square = hk_dot(e, e);
  hk_cross(out, e, d);
  for (int c = 0; c < 3; c++) out[c] = square > 0 ? out[c] / square : 0;
}

/* The spin of a side of the impact, rad/s: that of its body, or of the pinned feature. */
static void spin_of(const hk_impact *k, const uint32_t *carrier, int side, const double *x, const double *v,
                    double out[3]) {
  out[0] = out[1] = out[2] = 0;
  if (carrier)
    hk_body_spin(carrier, x, v, out);
  else if (side == 1 && k->pair.kind == HK_POINT_TRIANGLE)
    spin_of_triangle(k->pair.vertex + 1, x, v, out);
  else if (k->pair.kind == HK_EDGE_EDGE)
    spin_of_edge(k->pair.vertex + 2 * side, x, v, out);
}

static bool is_pinned(const hk_model *m, const hk_impact *k, int side) {
  int split = hk_pair_split(k->pair.kind);
  for (int i = side == 0 ? 0 : split; i < (side == 0 ? split : 4); i++)
    if (k->frame.w[i] != 0 && (hk_model_moves(m, k->pair.vertex[i]) || m->pin[k->pair.vertex[i]] == HK_PIN_RIDES))
      return false;
  return true;
}

static hk_body_moments moments_of(const hk_model *m, const hk_impact *k, const hk_step_move *move) {
  hk_body_moments out = {.rolling = 0};
  double then[2][3], now[2][3], s = k->part;
  int split = hk_pair_split(k->pair.kind);
  for (int side = 0; side < 2; side++) {
    int first = side == 0 ? 0 : split, last = side == 0 ? split : 4;
    const uint32_t *c = hk_body_arm_carriers(m, k->pair.vertex + first, k->frame.w + first, last - first);
    out.side[side].carrier = c;
    spin_of(k, c, side, move->x_from, move->v_from, then[side]);
    spin_of(k, c, side, move->x, move->v, now[side]);
    if (!c) hk_add_scaled(out.rest, side == 0 ? -1 : 1, now[side]);
  }
  for (int c = 0; c < 3; c++)
    out.way[c] = (1 - s) * move->h / 2 * ((1 - s) * (then[0][c] - then[1][c]) + (1 + s) * (now[0][c] - now[1][c]));
  for (int side = 0; side < 2; side++)
    if (!out.side[side].carrier && !is_pinned(m, k, side)) out.side[0].carrier = out.side[1].carrier = NULL;
  return out;
}

hk_status hk_surface_moments_find(hk_body_impacts *s, const hk_contact_solver *solver, const hk_step_move *move,
                                  double rolling, double spinning) {
  s->moments = NULL;
  if (s->count == 0 || !(rolling + spinning > 0)) return HK_OK;
  hk_status status = hk_reserve(s->host, &s->moments_found, &s->found_room, solver->count, sizeof *s->moments_found);
  if (status != HK_OK) return status;
  s->moments = s->moments_found;
  for (size_t e = 0; e < solver->count; e++) {
    s->moments[e] = moments_of(s->model, &solver->impact[e], move);
    s->moments[e].rolling = rolling;
    s->moments[e].spinning = spinning;
  }
  return HK_OK;
}
