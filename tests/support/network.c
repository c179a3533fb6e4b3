/* A spring network written out plainly: forces from Hooke's law, matrices from the entries k n n^T + k (1 - L/l)
 * (I - n n^T), eigenvalues by Jacobi's rotations. It shares no code with the engine, so that it can be its reference.
 * Only the bound that the system states of its stiffness is the one of the plugins: it is among what is tested.
 */
#include "tests/support/network.h"
#include "plugins/kit/springs/edge_stiffness.h"

#include <stdlib.h>
#include <string.h>

static double separation(const double *x, const uint32_t pair[2], double d[3]) {
  for (size_t c = 0; c < 3; c++) d[c] = x[3 * pair[1] + c] - x[3 * pair[0] + c];
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static void impose(hk_system *system, double t, double *x, double *v) {
  (void)t;
  const spring_network *w = (const spring_network *)(void *)system;
  for (size_t e = 0; e < 3 * w->n; e++) {
    if (w->pin[e / 3] == HK_FREE || (w->pin[e / 3] == HK_PIN_LINE && e % 3 == 2)) continue;
    x[e] = w->X[e];
    v[e] = 0;
  }
}

/* Lines run along z here. */
static void filter(hk_system *system, double *vector) {
  const spring_network *w = (const spring_network *)(void *)system;
  for (size_t e = 0; e < 3 * w->n; e++)
    if (w->pin[e / 3] == HK_PIN_FIXED || (w->pin[e / 3] == HK_PIN_LINE && e % 3 != 2)) vector[e] = 0;
}

static hk_status accelerations(hk_system *system, double t, double *x, double *v, const double *y, double *a,
                               double *dy) {
  spring_network *w = (spring_network *)(void *)system;
  impose(system, t, x, v);
  memset(a, 0, 3 * w->n * sizeof *a);
  for (size_t e = 0; e < w->edges; e++) {
    double d[3], l = separation(x, w->pair[e], d), approach = 0;
    const double *vi = v + 3 * w->pair[e][0], *vj = v + 3 * w->pair[e][1];
    if (!(l > 0)) continue;
    for (size_t c = 0; c < 3; c++) approach += (vj[c] - vi[c]) * d[c] / l;
    double pull = (w->stiffness[e] * (l - w->rest[e]) + w->damping[e] * approach) / l;
    for (size_t c = 0; c < 3; c++) {
      a[3 * w->pair[e][0] + c] += pull * d[c] * w->inverse_mass[w->pair[e][0]];
      a[3 * w->pair[e][1] + c] -= pull * d[c] * w->inverse_mass[w->pair[e][1]];
    }
  }
  for (size_t e = 0; e < 3 * w->n; e++) a[e] -= w->drag * v[e] + w->extra * x[e];
  for (size_t i = 0; i < w->n; i++) {
    a[3 * i] += w->gyration * v[3 * i + 1];
    a[3 * i + 1] -= w->gyration * v[3 * i];
  }
  filter(system, a);
  for (size_t k = 0; k < system->size - 6 * w->n; k++) dy[k] = -w->decay * y[k];
  return ++w->evaluations == w->fails_at ? HK_NOT_FINITE : HK_OK;
}

static bool stiffness_bound(hk_system *system, hk_stiffness_part part, bool stiffening, double (*block)[6]) {
  const spring_network *w = (const spring_network *)(void *)system;
  const hk_elements *list = &w->list.elements;
  hk_edge_stiffness s = {&list->node, &list->stiffness, &list->damping, &list->rest, false};
  hk_view view = {.n = w->n, .x = w->X, .v = w->X + 3 * w->n, .model = &w->model};
  memset(block, 0, w->n * sizeof *block);
  if (!stiffening || w->force.flags & HK_STIFFENS) hk_edge_stiffness_bound(&s, &view, part, block);
  return w->covered;
}

static void *room(size_t count, size_t size) {
  void *memory = calloc(count + 1, size);
  if (!memory) abort();
  return memory;
}

spring_network *network_create(size_t n, size_t edges, bool channel) {
  spring_network *w = room(1, sizeof *w);
  size_t size = 6 * n + (channel ? n : 0) + 1;
  w->n = n;
  w->capacity = edges;
  w->mass = room(n, sizeof *w->mass);
  w->inverse_mass = room(n, sizeof *w->inverse_mass);
  w->pin = room(n, 1);
  w->X = room(size, sizeof *w->X);
  w->pair = room(edges, sizeof *w->pair);
  w->stiffness = room(edges, sizeof *w->stiffness);
  w->damping = room(edges, sizeof *w->damping);
  w->rest = room(edges, sizeof *w->rest);
  for (size_t i = 0; i < n; i++) network_mass(w, i, 1);
  for (size_t k = 6 * n; k < size; k++) w->X[k] = 3;
  w->channel = (hk_channel){"heat", 1, 0};
  w->model = (hk_model){.n = n, .mass = w->mass, .inverse_mass = w->inverse_mass, .pin = w->pin};
  w->partition = (hk_partition){.n = n, .bits = 31, .blocks = 1, .width = 1, .domains = 1, .parts = 2};
  w->model.partition = &w->partition;
  w->model.channels = channel ? 1 : 0;
  w->model.channel = &w->channel;
  w->model.element_list = &w->list;
  w->model.element_lists = 1;
  w->list.force = "springs";
  w->list.elements.node.arity = 2;
  w->list.elements.values = 1;
  w->force = (hk_force_info){"springs", HK_DEPENDS_ON_X | HK_DEPENDS_ON_V, false, true, false};
  w->system = (hk_system){.model = &w->model, .X = w->X, .n = n, .size = size, .tol = 1e-6};
  w->queries = (hk_system_queries){.flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V, .stiffness_bound = stiffness_bound};
  w->split = (hk_split_table){.forces = 1, .force = &w->force};
  w->system.split = &w->split;
  w->system.queries = &w->queries;
  w->system.accelerations = accelerations;
  w->system.impose = impose;
  w->system.filter = filter;
  return w;
}

void network_destroy(spring_network *w) {
  free(w->mass);
  free(w->inverse_mass);
  free(w->pin);
  free(w->X);
  free(w->pair);
  free(w->stiffness);
  free(w->damping);
  free(w->rest);
  free(w);
}

void network_place(spring_network *w, size_t i, double x, double y, double z) {
  w->X[3 * i] = x;
  w->X[3 * i + 1] = y;
  w->X[3 * i + 2] = z;
}

void network_mass(spring_network *w, size_t i, double mass) {
  w->mass[i] = mass;
  w->inverse_mass[i] = 1 / mass;
}

void network_fix(spring_network *w, size_t i) {
  w->pin[i] = HK_PIN_FIXED;
  w->inverse_mass[i] = 0;
}

void network_join(spring_network *w, size_t i, size_t j, double k, double c) {
  double d[3];
  size_t e = w->edges++;
  if (e >= w->capacity) abort();
  w->pair[e][0] = (uint32_t)i;
  w->pair[e][1] = (uint32_t)j;
  w->stiffness[e] = k;
  w->damping[e] = c;
  w->rest[e] = separation(w->X, w->pair[e], d);
  w->list.elements.node = (hk_tuples){w->edges, 2, &w->pair[0][0]};
  w->list.elements.stiffness = (hk_per_tuple){w->edges, w->stiffness};
  w->list.elements.damping = (hk_per_tuple){w->edges, w->damping};
  w->list.elements.rest = (hk_per_tuple){w->edges, w->rest};
}

static void rotate(double *a, size_t m, size_t p, size_t q) {
  double theta = (a[q * m + q] - a[p * m + p]) / (2 * a[p * m + q]);
  double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1), s = t * c;
  for (size_t k = 0; k < m; k++) {
    double x = a[k * m + p], y = a[k * m + q];
    a[k * m + p] = c * x - s * y;
    a[k * m + q] = s * x + c * y;
  }
  for (size_t k = 0; k < m; k++) {
    double x = a[p * m + k], y = a[q * m + k];
    a[p * m + k] = c * x - s * y;
    a[q * m + k] = s * x + c * y;
  }
}

/* Cyclic Jacobi; `a` is destroyed. Rotations that change nothing beyond 1e-14 of the norm are left out. */
static double largest_eigenvalue(double *a, size_t m) {
  double norm = 0, largest = -INFINITY;
  for (size_t k = 0; k < m * m; k++) norm = fmax(norm, fabs(a[k]));
  for (bool turned = true; turned;) {
    turned = false;
    for (size_t p = 0; p < m; p++)
      for (size_t q = p + 1; q < m; q++)
        if (fabs(a[p * m + q]) > 1e-14 * norm) {
          rotate(a, m, p, q);
          turned = true;
        }
  }
  for (size_t k = 0; k < m; k++) largest = fmax(largest, a[k * m + k]);
  return largest;
}

static void add_block(const spring_network *w, double *a, size_t e, double along, double across) {
  double d[3], l = separation(w->X, w->pair[e], d);
  size_t m = 3 * w->n;
  for (size_t side = 0; side < 4; side++) {
    size_t i = w->pair[e][side & 1], j = w->pair[e][side >> 1];
    double factor = (i == j ? 1 : -1) * sqrt(w->inverse_mass[i] * w->inverse_mass[j]);
    for (size_t r = 0; r < 3; r++)
      for (size_t c = 0; c < 3; c++) {
        double nn = d[r] * d[c] / (l * l);
        a[(3 * i + r) * m + 3 * j + c] += factor * (along * nn + across * ((r == c) - nn));
      }
  }
}

static void drop_pinned(const spring_network *w, double *a) {
  size_t m = 3 * w->n;
  for (size_t r = 0; r < m; r++)
    for (size_t c = 0; c < m; c++)
      if ((w->pin[r / 3] == HK_PIN_LINE && r % 3 != 2) || (w->pin[c / 3] == HK_PIN_LINE && c % 3 != 2))
        a[r * m + c] = 0;
}

double network_largest_stiffness(const spring_network *w) {
  size_t m = 3 * w->n;
  double d[3], *a = room(m * m, sizeof *a);
  for (size_t e = 0; e < w->edges; e++)
    add_block(w, a, e, w->stiffness[e], w->stiffness[e] * (1 - w->rest[e] / separation(w->X, w->pair[e], d)));
  for (size_t k = 0; k < m; k++) a[k * m + k] += w->inverse_mass[k / 3] > 0 ? w->extra : 0;
  drop_pinned(w, a);
  double largest = largest_eigenvalue(a, m);
  free(a);
  return largest;
}

double network_largest_damping(const spring_network *w) {
  size_t m = 3 * w->n;
  double *a = room(m * m, sizeof *a);
  for (size_t e = 0; e < w->edges; e++) add_block(w, a, e, w->damping[e], 0);
  for (size_t k = 0; k < m; k++) a[k * m + k] += w->inverse_mass[k / 3] > 0 ? w->drag : 0;
  drop_pinned(w, a);
  double largest = largest_eigenvalue(a, m);
  free(a);
  return largest;
}
