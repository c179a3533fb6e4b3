/* Guides: of four points a, b, c, d the way s = (b - a).(d - c)/l stays as it is. With points of rigid bodies they are
 * what a slider is made of: b stays in the plane through a across c d, a, c and d of one body; and where a and b are of
 * one body, c and d of another, these two directions keep their angle. Force and curvature are exact, since s is
 * bilinear: plugins/common/mechanisms/way.h. A multiplier is the force in N on b along c d. */
#include "plugins/common/mechanisms/way.h"

typedef struct guides {
  hk_tuples points;
  hk_per_tuple way, length;
} guides;

static const hk_param params[] = {
    {"points", "", "tuples of four, {a, b, c, d}: b keeps its way from a along c d",
     .tetrahedra = HK_AT(guides, points), .flags = HK_REQUIRED},
    {"way", "m", "(b - a).(d - c)/length; left out: as it starts", .per_tuple = HK_AT(guides, way),
     .flags = HK_OPTIONAL},
    {"length", "m", "of c d, which something else keeps; left out: the initial distance",
     .per_tuple = HK_AT(guides, length), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {0},
};

static double length_of(const guides *s, size_t k) { return hk_tuple_value(&s->length, k); }

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  guides *s = self;
  hk_status status = hk_way_lengths(view, &s->points, &s->length);
  if (status != HK_OK || s->way.count) return status;
  double *start = host->allocate(host, (s->points.count + 1) * sizeof *start);
  if (!start) return host->fail(host, HK_NO_MEMORY, "no memory for %zu guides", s->points.count);
  for (size_t k = 0; k < s->points.count; k++) start[k] = hk_way(view->x, hk_tuple(&s->points, k), length_of(s, k));
  s->way = (hk_per_tuple){s->points.count, start};
  return HK_OK;
}

static size_t count(void *self) { return ((const guides *)self)->points.count; }

static void pattern(void *self, hk_pattern *into) {
  const guides *s = self;
  for (size_t k = 0; k < 4 * s->points.count; k++)
    into->block(into, (uint32_t)(k / 4), hk_tuple(&s->points, k / 4)[k % 4]);
}

static hk_status value(void *self, const hk_view *view, double *g) {
  const guides *s = self;
  for (size_t k = 0; k < s->points.count; k++)
    g[k] = hk_way(view->x, hk_tuple(&s->points, k), length_of(s, k)) - hk_tuple_value(&s->way, k);
  return HK_OK;
}

static hk_status jacobian(void *self, const hk_view *view, double (*J)[3]) {
  const guides *s = self;
  for (size_t k = 0; k < s->points.count; k++)
    hk_way_gradient(view->x, hk_tuple(&s->points, k), length_of(s, k), J + 4 * k);
  return HK_OK;
}

static hk_status curvature(void *self, const hk_view *view, double *c) {
  const guides *s = self;
  for (size_t k = 0; k < s->points.count; k++) c[k] = hk_way_bend(view->v, hk_tuple(&s->points, k), length_of(s, k));
  return HK_OK;
}

static const hk_constraint constraint = {.size = sizeof(hk_constraint),
                                         .flags = HK_WAYS,
                                         .count = count,
                                         .pattern = pattern,
                                         .value = value,
                                         .jacobian = jacobian,
                                         .curvature = curvature};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CONSTRAINT,
    .name = "guides",
    .summary = "points that keep their way along a direction of a body, (b - a).(d - c)/l: sliders, angles",
    .reference = "Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems I (1989), section 9.4",
    .instance_size = sizeof(guides),
    .params = params,
    .create = create,
    .constraint = &constraint,
};
