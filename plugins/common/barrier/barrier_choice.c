/* See barrier_choice.h. */
#include "plugins/common/barrier/barrier_choice.h"
#include "plugins/common/space/vector3.h"

static const double weights = 100, gravity = 9.80665 /* m/s^2, standard */;

static double approach_of(const hk_barrier_pair *p, const hk_nearest *at, const double *v) {
  double d = sqrt(at->squared), rate = 0;
  for (size_t e = 0; e < 12; e++) rate -= at->w[e / 3] * v[3 * (size_t)p->pair.vertex[e / 3] + e % 3] * at->d[e % 3];
  return d > 0 ? rate / d : 0;
}

hk_barrier_survey hk_barrier_look(const hk_barrier_contacts *c, const hk_view *view) {
  hk_barrier_survey s = {.closest = INFINITY};
  const hk_barrier_pair *near = c->near.item;
  hk_barrier_value v;
  for (size_t k = 0; k < c->found; k++) {
    bool acts = hk_barrier_evaluate(&near[k], &c->law, view->x, &v);
    s.closest = fmin(s.closest, v.gap);
    if (near[k].least < c->law.distance) s.approach = fmax(s.approach, approach_of(&near[k], &v.nearest, view->v));
    if (acts) s.load += hk_barrier_load(&v), s.energy += v.m * v.E;
  }
  return s;
}

double hk_barrier_density(const hk_barrier_contacts *c, const hk_view *view) {
  const hk_surface_mesh *mesh = c->surfaces->mesh(c->surfaces->self);
  const hk_barrier_shape *shape = (const hk_barrier_shape *)(const void *)c->shape;
  double mass = 0, area = 0;
  for (size_t k = 0; k < mesh->points; k++) {
    uint32_t i = mesh->point[k];
    if (!(view->model->inverse_mass[i] > 0)) continue;
    mass += view->model->mass[i];
    area += shape[i].area;
  }
  return area > 0 ? mass / area : 0;
}

double hk_barrier_chosen(double density, double distance, double approach, double before) {
  double needed = density * (weights * gravity + approach * approach / distance);
  return needed > 2 * before || before == 0 ? needed : before;
}
