/* Hooke's springs, damped along the spring: the force on j is -(k (l - L) + c (u.d)/l) d/l, with d = x_j - x_i, l = |d|
 * and u = v_j - v_i; i gets the opposite. A spring of length 0 has no direction and no force; for L = 0 that is also
 * the limit. The energy is 1/2 k (l - L)^2; the damping's power is -c (u.d)^2/l^2. */
#include "plugins/kit/springs/edge.h"
#include "plugins/kit/springs/edge_order.h"
#include "plugins/kit/springs/spring_along.h"
#include "plugins/kit/springs/spring_blocks.h"
#include "plugins/kit/springs/spring_bilinear.h"

typedef struct springs {
  hk_tuples edges;
  hk_per_tuple k, damping, rest;
  hk_spring_layout layout;
  hk_elements acting; /* the springs that act, where the force acts on some particles only */
  const hk_host *host;
} springs;

enum { K = 1, DAMPING, REST }; /* rows of the table */

static const hk_param params[] = {
    {"edges", "", "pairs of particles to join", .edges = HK_AT(springs, edges), .flags = HK_REQUIRED},
    {"k", "N/m", "stiffness", .per_tuple = HK_AT(springs, k), .limits = HK_AT_LEAST(0), .flags = HK_REQUIRED},
    {"damping", "N s/m", "damping along the spring", .per_tuple = HK_AT(springs, damping), .limits = HK_AT_LEAST(0)},
    {"rest", "m", "rest length; left out: the initial length", .per_tuple = HK_AT(springs, rest),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {0},
};

static void drop_acting(springs *s) {
  hk_elements *a = &s->acting;
  s->host->release(s->host, (void *)(uintptr_t)a->node.index);
  s->host->release(s->host, a->stiffness.value);
  s->host->release(s->host, a->damping.value);
  s->host->release(s->host, a->rest.value);
  *a = (hk_elements){.node = {0, 2, NULL}};
}

static hk_status list_acting(springs *s, const hk_view *view) {
  hk_elements *a = &s->acting;
  size_t room = s->edges.count + 1;
  drop_acting(s);
  if (!view->is_active) return HK_OK;
  uint32_t *index = s->host->allocate(s->host, 2 * room * sizeof *index);
  a->node.index = index;
  a->stiffness.value = s->host->allocate(s->host, room * sizeof(double));
  a->damping.value = s->host->allocate(s->host, room * sizeof(double));
  a->rest.value = s->host->allocate(s->host, room * sizeof(double));
  if (!index || !a->stiffness.value || !a->damping.value || !a->rest.value)
    return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu springs", s->edges.count);
  for (size_t e = 0; e < s->edges.count; e++) {
    const uint32_t *pair = hk_tuple(&s->edges, e);
    size_t k = a->node.count;
    if (!hk_edge_acts(view, pair)) continue;
    index[2 * k] = pair[0], index[2 * k + 1] = pair[1];
    a->stiffness.value[k] = hk_tuple_value(&s->k, e);
    a->damping.value[k] = hk_tuple_value(&s->damping, e);
    a->rest.value[k] = hk_tuple_value(&s->rest, e);
    a->node.count++;
  }
  a->stiffness.count = a->damping.count = a->rest.count = a->node.count;
  return HK_OK;
}

static hk_status topology(void *self, const hk_view *view) {
  springs *s = self;
  const hk_edge_order given = {s->edges, s->k, s->damping, s->rest};
  hk_edge_order o = given;
  hk_spring_layout_free(&s->layout, s->host);
  hk_status status = list_acting(s, view);
  if (status != HK_OK) return status;
  if (!hk_edge_order_improve(&o, s->host, view->n))
    return s->host->fail(s->host, HK_NO_MEMORY, "no memory to sort %zu springs", s->edges.count);
  status =
      hk_spring_layout_build(&s->layout, s->host, view->model->partition, &o.edges, &o.k, &o.c, &o.L, view->is_active);
  hk_edge_order_release(&o, s->host, &given);
  return status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  springs *s = self;
  s->host = host;
  hk_status status = hk_edge_rest(host, view, &s->edges, &s->rest);
  return status == HK_OK ? topology(self, view) : status;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  const springs *s = self;
  hk_spring_forces(&s->layout, view->host, view->x, view->v, F, view->power);
  return HK_OK;
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  const springs *s = self;
  hk_spring_part(&s->layout, part, view->x, view->v, F, view->power);
}

static void parts(void *self, const hk_view *view, const hk_part_use *use) {
  const springs *s = self;
  (void)view;
  hk_spring_layout_touch(&s->layout, use);
}

static double energy(void *self, const hk_view *view) {
  const springs *s = self;
  return hk_spring_energy(&s->layout, view->x);
}

static void elements(void *self, const hk_view *view, hk_elements *out) {
  const springs *s = self;
  *out = s->acting;
  if (!view->is_active)
    *out = (hk_elements){.node = s->edges, .stiffness = s->k, .damping = s->damping, .rest = s->rest};
  out->values = 1;
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const springs *s = self;
  hk_spring_stiffness_bound(&s->layout, view, part, block);
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  const springs *s = self;
  (void)view;
  hk_spring_pattern(&s->layout, p);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const springs *s = self;
  hk_spring_blocks(&s->layout, view->host, view->x, view->v, into);
  return HK_OK;
}

static hk_elements all_of(const springs *s) {
  return (hk_elements){.node = s->edges, .stiffness = s->k, .damping = s->damping, .rest = s->rest};
}

static hk_spring_slopes slopes_of(const hk_transposed *into) {
  if (!into->parameter) return (hk_spring_slopes){0};
  return (hk_spring_slopes){into->parameter[K], into->parameter[DAMPING], into->parameter[REST]};
}

static hk_status transposed(void *self, const hk_view *view, const double *u, const hk_transposed *into) {
  const hk_elements all = all_of(self);
  const hk_spring_slopes slopes = slopes_of(into);
  hk_spring_transposed(&all, view, u, into, &slopes);
  return HK_OK;
}

static hk_status bilinear(void *self, const hk_view *view, const hk_bilinear *form, const hk_transposed *into) {
  const hk_elements all = all_of(self);
  const hk_spring_slopes slopes = slopes_of(into);
  hk_spring_bilinear(&all, view, form, into, &slopes);
  return HK_OK;
}

static hk_status along(void *self, const hk_view *view, const hk_tangent *directions, size_t count) {
  const hk_elements all = all_of(self);
  const hk_spring_rows rows = {K, DAMPING, REST};
  hk_spring_along(&all, view, &rows, directions, count);
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_POWER |
             HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add = add,
    .add_part = add_part,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian, .transposed = transposed,
                                          .bilinear = bilinear, .along = along),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_ELEMENTS_FACET(.list = elements),
                        HK_PARTS_FACET(.touch = parts)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "springs",
    .summary = "Hooke's springs damped along their direction, f = -(k (l - L) + c u.d/l) d/l",
    .reference = "Hooke 1678; damping along the spring as in Baraff and Witkin 1998, section 4.5",
    .instance_size = sizeof(springs),
    .params = params,
    .create = create,
    .topology = topology,
    .force = &force,
};
