#include "plugins/common/lengths/lengths.h"
#include "plugins/kit/springs/edge.h"

static hk_status check(const hk_lengths *l, const hk_host *host, const hk_view *view, const char *remedy) {
  for (size_t e = 0; e < l->edges.count; e++) {
    const uint32_t *pair = hk_tuple(&l->edges, e);
    if (hk_tuple_value(&l->length, e) > 0) continue;
    return host->fail(host, HK_BAD_PARAM, "the length between particles %u and %u (edge %zu) is 0: %s",
                      (unsigned)view->model->id[pair[0]], (unsigned)view->model->id[pair[1]], e + 1, remedy);
  }
  return HK_OK;
}

hk_status hk_lengths_start(hk_lengths *l, const hk_host *host, const hk_view *view, const char *remedy) {
  hk_status status = hk_edge_rest(host, view, &l->edges, &l->length);
  return status == HK_OK ? check(l, host, view, remedy) : status;
}

size_t hk_lengths_count(void *self) { return ((const hk_lengths *)self)->edges.count; }

void hk_lengths_pattern(void *self, hk_pattern *p) {
  const hk_lengths *l = self;
  for (size_t e = 0; e < l->edges.count; e++)
    for (int end = 0; end < 2; end++) p->block(p, (uint32_t)e, hk_tuple(&l->edges, e)[end]);
}

hk_status hk_lengths_value(void *self, const hk_view *view, double *g) {
  const hk_lengths *l = self;
  double d[3];
  for (size_t e = 0; e < l->edges.count; e++)
    g[e] = hk_tuple_value(&l->length, e) - hk_edge_difference(view->x, hk_tuple(&l->edges, e), d);
  return HK_OK;
}

hk_status hk_lengths_jacobian(void *self, const hk_view *view, double (*J)[3]) {
  const hk_lengths *l = self;
  double d[3];
  for (size_t e = 0; e < l->edges.count; e++) {
    double now = hk_edge_difference(view->x, hk_tuple(&l->edges, e), d), by = now > 0 ? 1 / now : 0;
    for (int c = 0; c < 3; c++) {
      J[2 * e][c] = by * d[c];
      J[2 * e + 1][c] = -J[2 * e][c];
    }
  }
  return HK_OK;
}

hk_status hk_lengths_curvature(void *self, const hk_view *view, double *c) {
  const hk_lengths *l = self;
  double d[3], u[3];
  for (size_t e = 0; e < l->edges.count; e++) {
    const uint32_t *pair = hk_tuple(&l->edges, e);
    double now = hk_edge_difference(view->x, pair, d), speed = hk_edge_difference(view->v, pair, u);
    double by = now > 0 ? 1 / now : 0, along = by * (d[0] * u[0] + d[1] * u[1] + d[2] * u[2]);
    c[e] = -by * (speed * speed - along * along);
  }
  return HK_OK;
}
