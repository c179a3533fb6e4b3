/* Springs whose force is the cube of the stretch: with d = x_j - x_i, l = |d|, s = l - L and n = d/l the force on j is
 * -k s^3 n, i gets the opposite; energy 1/4 k s^4. At the rest length they have no stiffness, so they offer no
 * elements. With k = 4 they are the soft springs of the Fermi-Pasta-Ulam problem in Hairer, Lubich and Wanner,
 * Geometric Numerical Integration, section I.5.1, whose energy is s^4. A spring of length 0 has no direction and no
 * force; for L = 0 that is also the limit.
 *
 * -df/dx for x = x_j - x_i is 3 k s^2 n n^T + (k s^3 / l) (I - n n^T): symmetric, with an axial eigenvalue that is
 * never negative and two lateral ones that are negative under compression; HK_WANT_DEFINITE replaces these by 0. */
#include "plugins/kit/parts/part_sums.h"
#include "plugins/kit/springs/edge.h"
#include "plugins/kit/springs/edge_stiffness.h"
#include "core/plugin.h"

typedef struct cubic_springs {
  hk_tuples edges;
  hk_per_tuple k, rest;
  hk_part_sums sums;
} cubic_springs;

static const hk_param params[] = {
    {"edges", "", "pairs of particles to join", .edges = HK_AT(cubic_springs, edges), .flags = HK_REQUIRED},
    {"k", "N/m^3", "force over the cube of the stretch", .per_tuple = HK_AT(cubic_springs, k), .limits = HK_AT_LEAST(0),
     .flags = HK_REQUIRED},
    {"rest", "m", "rest length; left out: the initial length", .per_tuple = HK_AT(cubic_springs, rest),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {0},
};

static hk_status topology(void *self, const hk_view *view) {
  cubic_springs *s = self;
  return hk_part_sums_sort(&s->sums, view, &s->edges, view->is_active);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  cubic_springs *s = self;
  hk_status status = hk_edge_rest(host, view, &s->edges, &s->rest);
  return status == HK_OK ? topology(self, view) : status;
}

static void pull(const cubic_springs *s, const hk_view *view, size_t e, double *F) {
  const uint32_t *pair = hk_tuple(&s->edges, e);
  double d[3], l = hk_edge_difference(view->x, pair, d), stretch = l - hk_tuple_value(&s->rest, e);
  double f = l > 0 ? hk_tuple_value(&s->k, e) * stretch * stretch * stretch / l : 0;
  for (int c = 0; c < 3; c++) {
    F[3 * (size_t)pair[0] + c] += f * d[c];
    F[3 * (size_t)pair[1] + c] -= f * d[c];
  }
}

static double pull_all(const void *self, const hk_view *view, const uint32_t *item, size_t count, double *F) {
  for (size_t k = 0; k < count; k++) pull(self, view, item[k], F);
  return 0; /* of the conservative force no power is counted */
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  const cubic_springs *s = self;
  hk_part_sums_add(&s->sums, view, part, pull_all, s, F);
}

static hk_status add(void *self, const hk_view *view, double *F) {
  add_part(self, view, HK_ALL_PARTS, F);
  return HK_OK;
}

static void parts(void *self, const hk_view *view, const hk_part_use *use) {
  const cubic_springs *s = self;
  (void)view;
  hk_part_lists_touch(&s->sums.lists, &s->edges, use);
}

static double energy(void *self, const hk_view *view) {
  const cubic_springs *s = self;
  double sum = 0, d[3];
  for (size_t e = 0; e < s->edges.count; e++) {
    if (!hk_edge_acts(view, hk_tuple(&s->edges, e))) continue;
    double stretch = hk_edge_difference(view->x, hk_tuple(&s->edges, e), d) - hk_tuple_value(&s->rest, e);
    sum += hk_tuple_value(&s->k, e) * stretch * stretch * stretch * stretch / 4;
  }
  return sum;
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  const cubic_springs *s = self;
  for (size_t e = 0; e < s->edges.count; e++)
    for (int b = 0; b < 4 && hk_edge_acts(view, hk_tuple(&s->edges, e)); b++)
      p->block(p, hk_tuple(&s->edges, e)[b / 2], hk_tuple(&s->edges, e)[b % 2]);
}

static void spring_block(double k, double L, const double d[3], double l, bool definite, double block[9]) {
  double s = l - L, axial = l > 0 ? 3 * k * s * s : 0, lateral = l > 0 ? k * s * s * s / l : 0, n[3] = {0};
  if (definite && lateral < 0) lateral = 0;
  for (int c = 0; c < 3 && l > 0; c++) n[c] = d[c] / l;
  for (int q = 0; q < 9; q++) {
    double nn = n[q / 3] * n[q % 3];
    block[q] = axial * nn + lateral * ((q % 4 == 0) - nn);
  }
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const cubic_springs *s = self;
  const size_t *slot = into->slot;
  for (size_t e = 0; e < s->edges.count; e++) {
    const uint32_t *pair = hk_tuple(&s->edges, e);
    double d[3], block[9];
    if (!hk_edge_acts(view, pair)) continue;
    double l = hk_edge_difference(view->x, pair, d);
    spring_block(hk_tuple_value(&s->k, e), hk_tuple_value(&s->rest, e), d, l, into->want & HK_WANT_DEFINITE, block);
    for (int b = 0; b < 4; b++)
      for (int q = 0; q < 9; q++) into->K[9 * slot[b] + q] += b % 3 == 0 ? block[q] : -block[q];
    slot += 4;
  }
  return HK_OK;
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const cubic_springs *s = self;
  for (size_t e = 0; part != HK_DAMPING_WHOLE && e < s->edges.count; e++) {
    const uint32_t *pair = hk_tuple(&s->edges, e);
    if (!hk_edge_acts(view, pair)) continue;
    double n[3], l = hk_edge_difference(view->x, pair, n), stretch = l - hk_tuple_value(&s->rest, e);
    if (!(l > 0)) continue;
    for (int c = 0; c < 3; c++) n[c] /= l;
    double k = hk_tuple_value(&s->k, e) * stretch * stretch;
    hk_edge_stiffness_add(view, pair, n, 3 * k, fmax(0, k * stretch / l), block);
  }
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_SYMMETRIC_JACOBIAN |
             HK_OFFERS_DEFINITE,
    .add = add,
    .add_part = add_part,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_PARTS_FACET(.touch = parts)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "cubic_springs",
    .summary = "springs that harden with the cube of the stretch, f = -k (l - L)^3 d/l",
    .reference = "Fermi, Pasta and Ulam 1955; Hairer, Lubich and Wanner, Geometric Numerical Integration, I.5.1",
    .instance_size = sizeof(cubic_springs),
    .params = params,
    .create = create,
    .topology = topology,
    .force = &force,
};
