/* Springs that are drawn out too far are shortened after the step (Provot 1995, the "dynamic inverse procedure"): with
 * the strain tau = (l - L)/L > tau_c both ends move along the spring until l = (1 + tau_c) L, each by its share
 * w_i/(w_i + w_j) of the way, w = 1/m: halves for equal masses; a pinned end stays. One correction may stretch a
 * neighbour, so sweeps are repeated until none is left or `sweeps` is reached; what is then left above the limit is the
 * run's violation, and said. The method: plugins/common/strain.
 *
 * In the paper velocities stay as they are: a spring that is pulled on at its limit then gains speed that shows as soon
 * as the pull ends. By default they are those of an inelastic rope instead, by impulses along the springs that keep
 * momentum and angular momentum; as the step goes to zero the run then converges to springs that cannot be drawn out
 * further than their limit. Where sweeps come to no end and would gain energy, as between pins that are too far apart,
 * and from the pins outwards, impulses take what leads beyond the limits, and no more. */
#include "plugins/kit/springs/edge.h"
#include "plugins/common/strain/strain_limits.h"

typedef struct strain_limit {
  hk_tuples edges;
  hk_per_tuple rest, limit, compression;
  int order;
  int64_t sweeps;
  double tolerance;
  int velocity;
  double said; /* part of a limit that a warning has named */
  double (*range)[2];
  hk_strain_limits limits;
  const hk_host *host;
} strain_limit;

enum { KEPT = 1 }; /* of `velocity` */

static const hk_param params[] = {
    {"edges", "", "pairs of particles whose distance is limited", .edges = HK_AT(strain_limit, edges),
     .flags = HK_REQUIRED},
    {"rest", "m", "rest length L; left out: the initial length", .per_tuple = HK_AT(strain_limit, rest),
     .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"limit", "", "tau_c: edges are at most (1 + tau_c) L long", .per_tuple = HK_AT(strain_limit, limit),
     .initial = {0.1}, .limits = HK_AT_LEAST(0)},
    {"compression", "", "edges are at least (1 - compression) L long; left out: of any length",
     .per_tuple = HK_AT(strain_limit, compression), .limits = HK_WITHIN(0, 1), .flags = HK_OPTIONAL},
    {"order", "",
     "of a sweep: as the edges are given; from the pins outwards, where only the end that is farther from a "
     "pin moves; the most strained first",
     .choice = HK_AT(strain_limit, order), .choices = "given|outwards|sorted"},
    {"sweeps", "", "at most in a step; fewer where no edge is left beyond its limit",
     .integer = HK_AT(strain_limit, sweeps), .initial = {1000}, .limits = HK_WITHIN(1, 1e9)},
    {"tolerance", "", "part of its limit by which an edge may be beyond it without a correction",
     .number = HK_AT(strain_limit, tolerance), .initial = {1e-7}, .limits = HK_WITHIN(0, 1)},
    {"velocity", "",
     "corrected with the positions, by impulses along the edges that leave no speed beyond a limit; or "
     "kept as it is, as in the paper",
     .choice = HK_AT(strain_limit, velocity), .choices = "corrected|kept"},
    {0},
};

static const hk_field fields[] = {
    {"said", .number = HK_AT(strain_limit, said)},
    {0},
};

/* Of a length computed from three squares and a root, and again from moved ends. */
static const double rounding = 1e-14;

static hk_status set_range(strain_limit *s, const hk_view *view, size_t e) {
  const uint32_t *id = view->model->id, *pair = hk_tuple(&s->edges, e);
  double rest = hk_tuple_value(&s->rest, e), limit = hk_tuple_value(&s->limit, e);
  if (!(rest > 0))
    return s->host->fail(s->host, HK_BAD_PARAM,
                         "edges: particles %u and %u are in one place, so that their edge has the rest length 0 and no "
                         "strain: leave it out, or give `rest`",
                         id[pair[0]], id[pair[1]]);
  s->range[e][0] = s->compression.count ? (1 - hk_tuple_value(&s->compression, e)) * rest : 0;
  s->range[e][1] = (1 + limit) * rest;
  return HK_OK;
}

static hk_status topology(void *self, const hk_view *view) {
  strain_limit *s = self;
  const hk_host *host = s->host;
  hk_strain_free(&s->limits, host);
  host->release(host, s->range);
  s->range = host->allocate(host, (s->edges.count + 1) * sizeof *s->range);
  if (!s->range) return host->fail(host, HK_NO_MEMORY, "no memory for %zu limits", s->edges.count);
  hk_status status = HK_OK;
  for (size_t e = 0; e < s->edges.count && status == HK_OK; e++) status = set_range(s, view, e);
  if (status != HK_OK) return status;
  s->limits = (hk_strain_limits){.n = view->n, .count = s->edges.count, .pair = hk_pairs(&s->edges)};
  s->limits.limit = (const double(*)[2])s->range;
  s->limits.slack = s->tolerance + rounding;
  s->limits.order = (hk_strain_order)s->order;
  status = hk_strain_build(&s->limits, host);
  return status == HK_OK ? HK_OK : host->fail(host, status, "no memory for %zu edges", s->edges.count);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  strain_limit *s = self;
  s->host = host;
  hk_status status = hk_edge_rest(host, view, &s->edges, &s->rest);
  return status == HK_OK ? topology(self, view) : status;
}

/* What is left is said the first time, and again when it has grown tenfold. */
static void warn_of_the_rest(strain_limit *s, const hk_view *view, const hk_strain_result *r) {
  if (!(r->excess > 10 * s->said)) return;
  s->said = r->excess;
  const uint32_t *pair = hk_tuple(&s->edges, r->worst), *id = view->model->id;
  s->host->warn(
      s->host,
      "at t = %g s, after %zu sweeps, %zu edges are still beyond their limits, by up to %.3g %% (particles %u "
      "and %u): allow more `sweeps`, or take stiffer springs or shorter steps",
      view->t, r->sweeps, r->left, 100 * r->excess, id[pair[0]], id[pair[1]]);
}

static hk_status correct(void *self, const hk_view *view, hk_correction *c) {
  strain_limit *s = self;
  hk_strain_pins(&s->limits, view, c);
  if (!hk_strain_screen(&s->limits, view->host, c->x)) return HK_OK;
  hk_strain_state state = {c->x, s->velocity == KEPT ? NULL : c->v, view->model->inverse_mass};
  hk_strain_result r = hk_strain_sweep(&s->limits, &state, (size_t)s->sweeps);
  c->changed = r.moves > 0;
  if (r.left) warn_of_the_rest(s, view, &r);
  return HK_OK;
}

static double violation(void *self, const hk_view *view) {
  return hk_strain_violation(&((strain_limit *)self)->limits, view->x);
}

static const hk_corrector corrector = {
    .size = sizeof(hk_corrector),
    .correct = correct,
    .violation = violation,
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CORRECTOR,
    .name = "strain_limit",
    .summary = "springs are shortened after each step to l = (1 + tau_c) L where they are drawn out further",
    .reference = "Provot 1995, Deformation constraints in a mass-spring model to describe rigid cloth behavior",
    .instance_size = sizeof(strain_limit),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .corrector = &corrector,
};
