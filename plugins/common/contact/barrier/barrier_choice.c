/* See barrier_choice.h. */
#include "plugins/common/contact/barrier/barrier_choice.h"
#include "plugins/kit/vector3.h"

static const double weights = 100, gravity = 9.80665 /* m/s^2, standard */;

static double approach_of(const hk_barrier_pair *p, const hk_nearest *at, const double *v) {
  double d = sqrt(at->squared), rate = 0;
  for (size_t e = 0; e < 12; e++) rate -= at->w[e / 3] * v[3 * (size_t)p->pair.vertex[e / 3] + e % 3] * at->d[e % 3];
  return d > 0 ? rate / d : 0;
}

/* Of the pairs of a chunk: the least gap, and the fastest approach of those that may act. */
typedef struct part {
  double closest, approach;
} part;

typedef struct task {
  const hk_barrier_contacts *contacts;
  const hk_view *view;
  bool all; /* whether the gaps of all are asked for, or of those that may act only */
  part *part;
} task;

static void survey_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_barrier_pair *near = t->contacts->near.item;
  part p = {INFINITY, 0};
  for (size_t k = begin; k < end; k++) {
    bool may_act = near[k].least < t->contacts->law.distance;
    if (!may_act && !t->all) continue;
    hk_nearest at = hk_pair_nearest(&near[k].pair, t->view->x);
    p.closest = fmin(p.closest, sqrt(at.squared) - near[k].pair.offset);
    if (may_act) p.approach = fmax(p.approach, approach_of(&near[k], &at, t->view->v));
  }
  t->part[chunk] = p;
}

hk_barrier_survey hk_barrier_survey_at(hk_barrier_contacts *c, const hk_view *view) {
  hk_barrier_survey s = {.closest = INFINITY};
  hk_barrier_values_at(c, view);
  task t = {c, view, c->acting_count == 0, c->parts.item};
  view->host->parallel_for(view->host, c->found, HK_BARRIER_GRAIN, survey_chunk, &t);
  for (size_t k = 0; k * HK_BARRIER_GRAIN < c->found; k++) {
    s.closest = fmin(s.closest, t.part[k].closest);
    s.approach = fmax(s.approach, t.part[k].approach);
  }
  for (size_t k = 0; k < c->acting_count; k++) {
    const hk_barrier_value *v = hk_barrier_acting(c, k);
    s.closest = fmin(s.closest, v->gap);
    s.load += hk_barrier_load(v), s.energy += v->m * v->E;
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
