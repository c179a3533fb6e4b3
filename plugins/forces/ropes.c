/* Ropes: springs with tension but no compression. With d = x_j - x_i, l = |d|, n = d/l, s = l - L and u = v_j - v_i a
 * rope is taut where s > 0; its tension is then T = max(0, k s + c u.n), the force on j is -T n and i gets the
 * opposite. Slack ropes exert no force. The energy is 1/2 k s^2 where taut; the damping part of T has the power -(T - k
 * s) u.n.
 *
 * -df/dx for x = x_j - x_i is (k - b) n n^T + b I + (c/l) n (u - (u.n) n)^T with b = T/l, and -df/dv is c n n^T, as of
 * springs (spring_blocks.h); b is never negative, so without the last term, which HK_WANT_SYMMETRIC omits, the block is
 * definite. At s = 0 the stiffness is discontinuous: methods lose their order there, although the motion is continuous.
 *
 * No elements are offered: methods that work element by element would apply compression with them. */
#include "plugins/kit/parts/part_sums.h"
#include "plugins/kit/springs/edge.h"
#include "plugins/kit/springs/edge_stiffness.h"
#include "core/plugin.h"

typedef struct ropes {
  hk_tuples edges;
  hk_per_tuple k, damping, rest;
  hk_part_sums sums;
} ropes;

static const hk_param params[] = {
    {"edges", "", "pairs of particles to join", .edges = HK_AT(ropes, edges), .flags = HK_REQUIRED},
    {"k", "N/m", "stiffness where taut", .per_tuple = HK_AT(ropes, k), .limits = HK_AT_LEAST(0), .flags = HK_REQUIRED},
    {"damping", "N s/m", "damping along the rope where taut", .per_tuple = HK_AT(ropes, damping),
     .limits = HK_AT_LEAST(0)},
    {"rest", "m", "length up to which it is slack; left out: the initial length", .per_tuple = HK_AT(ropes, rest),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {0},
};

static hk_status topology(void *self, const hk_view *view) {
  ropes *s = self;
  return hk_part_sums_sort(&s->sums, view, &s->edges, view->is_active);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  ropes *s = self;
  hk_status status = hk_edge_rest(host, view, &s->edges, &s->rest);
  return status == HK_OK ? topology(self, view) : status;
}

/* One taut rope with a tension above 0. */
typedef struct taut {
  double n[3], u[3], l; /* m, m/s */
  double rate;          /* u.n, m/s */
  double spring, T;     /* k s and the tension, N */
} taut;

/* False where the rope is slack. */
static bool measure(const ropes *s, const hk_view *view, size_t e, taut *r) {
  const uint32_t *pair = hk_tuple(&s->edges, e);
  r->l = hk_edge_difference(view->x, pair, r->n);
  if (!(r->l > hk_tuple_value(&s->rest, e))) return false;
  hk_edge_difference(view->v, pair, r->u);
  r->rate = 0;
  for (int c = 0; c < 3; c++) r->n[c] /= r->l, r->rate += r->u[c] * r->n[c];
  r->spring = hk_tuple_value(&s->k, e) * (r->l - hk_tuple_value(&s->rest, e));
  r->T = fmax(0, r->spring + hk_tuple_value(&s->damping, e) * r->rate);
  return true;
}

/* Returns the power. */
static double pull(const ropes *s, const hk_view *view, size_t e, double *F) {
  const uint32_t *pair = hk_tuple(&s->edges, e);
  taut r;
  if (!measure(s, view, e, &r)) return 0;
  for (int c = 0; c < 3; c++) {
    F[3 * (size_t)pair[0] + c] += r.T * r.n[c];
    F[3 * (size_t)pair[1] + c] -= r.T * r.n[c];
  }
  return -(r.T - r.spring) * r.rate;
}

static double pull_all(const void *self, const hk_view *view, const uint32_t *item, size_t count, double *F) {
  double power = 0;
  for (size_t k = 0; k < count; k++) power += pull(self, view, item[k], F);
  return power;
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  const ropes *s = self;
  hk_part_sums_add(&s->sums, view, part, pull_all, s, F);
}

static hk_status add(void *self, const hk_view *view, double *F) {
  add_part(self, view, HK_ALL_PARTS, F);
  return HK_OK;
}

static void parts(void *self, const hk_view *view, const hk_part_use *use) {
  const ropes *s = self;
  (void)view;
  hk_part_lists_touch(&s->sums.lists, &s->edges, use);
}

static double energy(void *self, const hk_view *view) {
  const ropes *s = self;
  double sum = 0, d[3];
  for (size_t e = 0; e < s->edges.count; e++) {
    if (!hk_edge_acts(view, hk_tuple(&s->edges, e))) continue;
    double stretch = fmax(0, hk_edge_difference(view->x, hk_tuple(&s->edges, e), d) - hk_tuple_value(&s->rest, e));
    sum += hk_tuple_value(&s->k, e) * stretch * stretch / 2;
  }
  return sum;
}

/* Names the blocks of slack ropes as well: they may be taut at the next step. */
static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  const ropes *s = self;
  for (size_t e = 0; e < s->edges.count; e++)
    for (int b = 0; b < 4 && hk_edge_acts(view, hk_tuple(&s->edges, e)); b++)
      p->block(p, hk_tuple(&s->edges, e)[b / 2], hk_tuple(&s->edges, e)[b % 2]);
}

static void rope_blocks(const ropes *s, size_t e, const taut *r, bool symmetric, double K[9], double D[9]) {
  double b = r->T / r->l, k = hk_tuple_value(&s->k, e), c = hk_tuple_value(&s->damping, e);
  for (int q = 0; q < 9; q++) {
    double nn = r->n[q / 3] * r->n[q % 3], across = r->u[q % 3] - r->rate * r->n[q % 3];
    K[q] = (k - b) * nn + b * (q % 4 == 0) + (symmetric ? 0 : c / r->l * r->n[q / 3] * across);
    D[q] = c * nn;
  }
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const ropes *s = self;
  const size_t *slot = into->slot;
  for (size_t e = 0; e < s->edges.count; e++) {
    taut r;
    double K[9], D[9];
    if (!hk_edge_acts(view, hk_tuple(&s->edges, e))) continue;
    if (measure(s, view, e, &r) && r.T > 0) {
      rope_blocks(s, e, &r, into->want & HK_WANT_SYMMETRIC, K, D);
      for (int b = 0; b < 4; b++)
        for (int q = 0; q < 9; q++) {
          into->K[9 * slot[b] + (size_t)q] += b % 3 == 0 ? K[q] : -K[q];
          into->D[9 * slot[b] + (size_t)q] += b % 3 == 0 ? D[q] : -D[q];
        }
    }
    slot += 4;
  }
  return HK_OK;
}

/* What the damping's part of the tension adds to the stiffness across: T/l is above k where the ends part faster than
 * (k/c) L; a slack rope is taken as just taut. */
static void add_fast(const ropes *s, const hk_view *view, double (*block)[6]) {
  static const double none[3] = {0};
  for (size_t e = 0; s->damping.count && e < s->edges.count; e++) {
    const uint32_t *pair = hk_tuple(&s->edges, e);
    double n[3], u[3], l = hk_edge_difference(view->x, pair, n), rate = 0, L = hk_tuple_value(&s->rest, e);
    double k = hk_tuple_value(&s->k, e), c = hk_tuple_value(&s->damping, e), least = fmax(l, L);
    if (!hk_edge_acts(view, pair) || !(l > 0)) continue;
    hk_edge_difference(view->v, pair, u);
    for (int q = 0; q < 3; q++) rate += u[q] * n[q] / l;
    double over = (k * (least - L) + c * rate) / least - k;
    if (over > 0) hk_edge_stiffness_add(view, pair, none, 0, over, block);
  }
}

/* Bounds the stiffness of all ropes as if taut at any length, since a rope that is slack now may become taut. */
static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const ropes *s = self;
  const hk_edge_stiffness of = {&s->edges, &s->k, &s->damping, &s->rest, true};
  hk_edge_stiffness_bound(&of, view, part == HK_STIFFNESS_UNDAMPED ? HK_STIFFNESS_WHOLE : part, block);
  if (part != HK_DAMPING_WHOLE) add_fast(s, view, block);
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_STIFFENS | HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM |
             HK_POWER | HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add = add,
    .add_part = add_part,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_PARTS_FACET(.touch = parts)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "ropes",
    .summary = "springs that pull and never push, f = -max(0, k (l - L) + c u.d/l) d/l where l > L",
    .reference = "",
    .instance_size = sizeof(ropes),
    .params = params,
    .create = create,
    .topology = topology,
    .force = &force,
};
