#include "plugins/common/heat/heat_paths.h"
#include "plugins/common/solids/tetrahedron.h"
#include "plugins/kit/springs/edge.h"
#include "plugins/kit/vector3.h"

#include <string.h>

enum { GRAIN = 1024 };

static const uint8_t way_end[][2] = {{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}};

/* ---- shapes ---- */

static void shape_edge(const double *x, const uint32_t *node, double section, double *length) {
  double d[3];
  length[0] = section / hk_edge_difference(x, node, d);
}

/* The side opposite of corner m is way 2 - m. */
static void shape_triangle(const double *x, const uint32_t *node, double thickness, double *length) {
  for (int m = 0; m < 3; m++) {
    double a[3], b[3], normal[3];
    const double *at = x + 3 * (size_t)node[m];
    hk_subtract(a, x + 3 * (size_t)node[(m + 1) % 3], at);
    hk_subtract(b, x + 3 * (size_t)node[(m + 2) % 3], at);
    hk_cross(normal, a, b);
    length[2 - m] = thickness * hk_dot(a, b) / (2 * sqrt(hk_dot(normal, normal)));
  }
}

static void shape_tetrahedron(const double *x, const uint32_t *node, double *length) {
  const hk_tetrahedron t = hk_tetrahedron_of(x, node);
  for (int w = 0; w < 6; w++) length[w] = -fabs(t.volume) * hk_dot(t.slope[way_end[w][0]], t.slope[way_end[w][1]]);
}

hk_status hk_heat_shape(const hk_view *view, const hk_tuples *list, size_t which, double size, double *length) {
  static const char *const kind[] = {"", "", "edge", "triangle", "tetrahedron"};
  static const char *const extent[] = {"", "", "length", "area", "volume"};
  const uint32_t *node = hk_tuple(list, which);
  if (list->arity == 2) shape_edge(view->x, node, size, length);
  if (list->arity == 3) shape_triangle(view->x, node, size, length);
  if (list->arity == 4) shape_tetrahedron(view->x, node, length);
  for (size_t w = 0; w < hk_heat_ways(list->arity); w++)
    if (!isfinite(length[w]))
      return view->host->fail(view->host, HK_BAD_PARAM,
                              "the %s of %s %zu is 0 at the start, and the heat that would pass it infinite: move its "
                              "particles apart, or leave it out",
                              extent[list->arity], kind[list->arity], which + 1);
  return HK_OK;
}

/* ---- rows ---- */

static bool acts(const hk_view *view, const hk_heat_elements *list, size_t k) {
  const uint32_t *node = hk_tuple(list->node, k);
  for (unsigned m = 0; m < list->node->arity && view->is_active; m++)
    if (!view->is_active[node[m]]) return false;
  return !list->gone || !list->gone[k];
}

/* Counts the ways of particle i in start[i + 1]; then, with `fill`, enters them behind start[i], which moves on. */
static void visit(hk_heat_paths *p, const hk_view *view, const hk_heat_elements *e, bool fill) {
  size_t ways = hk_heat_ways(e->node->arity);
  for (size_t k = 0; k < e->node->count; k++) {
    const uint32_t *node = hk_tuple(e->node, k);
    for (size_t w = 0; w < ways && acts(view, e, k); w++)
      for (int end = 0; end < 2; end++) {
        uint32_t i = node[way_end[w][end]];
        if (!fill) {
          p->start[i + 1]++;
          continue;
        }
        p->other[p->start[i]] = node[way_end[w][1 - end]];
        p->length[p->start[i]++] = e->length[ways * k + w];
      }
  }
}

hk_status hk_heat_paths_build(hk_heat_paths *p, const hk_view *view, const hk_heat_elements *list, size_t lists) {
  const hk_host *host = view->host;
  host->release(host, p->start);
  host->release(host, p->other);
  host->release(host, p->length);
  *p = (hk_heat_paths){.start = host->allocate(host, (view->n + 1) * sizeof *p->start)};
  if (!p->start) return host->fail(host, HK_NO_MEMORY, "no memory for the heat of %zu particles", view->n);
  memset(p->start, 0, (view->n + 1) * sizeof *p->start);
  for (size_t l = 0; l < lists; l++) visit(p, view, &list[l], false);
  for (size_t i = 0; i < view->n; i++) p->start[i + 1] += p->start[i];
  size_t ways = p->start[view->n];
  p->other = host->allocate(host, (ways + 1) * sizeof *p->other);
  p->length = host->allocate(host, (ways + 1) * sizeof *p->length);
  if (!p->other || !p->length) return host->fail(host, HK_NO_MEMORY, "no memory for %zu ways of heat", ways);
  for (size_t l = 0; l < lists; l++) visit(p, view, &list[l], true);
  memmove(p->start + 1, p->start, view->n * sizeof *p->start); /* each has moved on to the next row's begin */
  p->start[0] = 0;
  return HK_OK;
}

typedef struct task {
  const hk_heat_paths *paths;
  const hk_view *view;
  const double *potential;
  double *rate;
} task;

static void add_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_heat_paths *p = t->paths;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    size_t i = t->view->active ? t->view->active[k] : k;
    double heat = 0; /* W */
    for (size_t e = p->start[i]; e < p->start[i + 1]; e++)
      heat += p->length[e] * (t->potential[p->other[e]] - t->potential[i]);
    if (p->start[i] < p->start[i + 1]) t->rate[i] += heat / t->view->model->mass[i];
  }
}

void hk_heat_paths_add(const hk_heat_paths *p, const hk_view *view, const double *potential, double *rate) {
  task t = {p, view, potential, rate};
  view->host->parallel_for(view->host, view->acting, GRAIN, add_chunk, &t);
}

double hk_heat_paths_densest(const hk_heat_paths *p, const hk_view *view) {
  double most = 0;
  for (size_t i = 0; i < view->n; i++) {
    double sum = 0;
    for (size_t e = p->start[i]; e < p->start[i + 1]; e++) sum += fabs(p->length[e]);
    if (sum > 0) most = fmax(most, sum / view->model->mass[i]);
  }
  return most;
}
