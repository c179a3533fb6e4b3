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
