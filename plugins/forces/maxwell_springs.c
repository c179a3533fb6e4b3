/* Springs with a Maxwell branch beside, the standard linear solid: f = k (l - L) + m along the spring, where the
 * branch, a spring k_m and a dashpot k_m tau in line, carries m' = k_m l' - m / tau,   m = 0 at the start. Under
 * constant length its force falls as exp(-t/tau); driven with the frequency w it stores like the stiffness k + k_m (w
 * tau)^2 / (1 + (w tau)^2) and loses like the stiffness k_m w tau / (1 + (w tau)^2).
 *
 * Within a step of which time t has gone, z = t/tau, the length is taken to be the cubic that has the lengths and rates
 * (l_n, l'_n) at its beginning and (l, l') at t; for it the equation is solved exactly, whatever z is: with D = l - l_n
 * and J_q the integral of exp(-z (1 - c)) c^q over c from 0 to 1, m = exp(-z) m_n + k_m (t l'_n (J_0 - 4 J_1 + 3 J_2) +
 * t l' (3 J_2 - 2 J_1) + 6 D (J_1 - J_2)). So no tau asks for a shorter step, and each method keeps its own order up to
 * 4: that of the cubic (Taylor, Pister and Goudreau 1970 take a straight line, of order 2; Simo and Hughes 1998,
 * Computational Inelasticity, 10.3). Within a step the potential of m is m^2 / 2 (dm/dl), and m^2 / 2 k_m at its end.
 * The branch dissipates the integral of m^2/(k_m tau).
 */
#include "plugins/common/springs/edge_laws.h"
#include "plugins/kit/springs/edge.h"

enum { FORCE, LENGTH, RATE, VARIABLES }; /* per edge, at the last accepted state: m, N; l, m; l', m/s */

typedef struct maxwell_springs {
  hk_edge_laws laws; /* with the edges */
  hk_per_tuple k, k_m, tau, rest;
  double *variable; /* edges x VARIABLES */
} maxwell_springs;

static const hk_param params[] = {
    {"edges", "", "pairs of particles to join", .edges = HK_AT(maxwell_springs, laws.edges), .flags = HK_REQUIRED},
    {"k", "N/m", "stiffness that lasts", .per_tuple = HK_AT(maxwell_springs, k), .limits = HK_AT_LEAST(0)},
    {"k_m", "N/m", "stiffness of the branch, which relaxes", .per_tuple = HK_AT(maxwell_springs, k_m),
     .limits = HK_ABOVE(0), .flags = HK_REQUIRED},
    {"tau", "s", "time of relaxation; damping of the branch over k_m", .per_tuple = HK_AT(maxwell_springs, tau),
     .limits = HK_AT_LEAST(1e-100), .flags = HK_REQUIRED},
    {"rest", "m", "rest length; left out: the initial length", .per_tuple = HK_AT(maxwell_springs, rest),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {0},
};

static const hk_field fields[] = {
    {"variable", .per_tuple = HK_AT(maxwell_springs, variable), .list = "edges", .width = VARIABLES},
    {0},
};

/* ---- the branch ---- */

typedef struct weights {
  double decay, J[3]; /* exp(-z) */
  double J12;         /* J_1 - J_2 */
} weights;

/* For any z; the series of J_2 where z is small, since the recursion 1 = q J_(q-1) + z J_q loses digits in one
 * direction. */
static weights weights_of(double z) {
  weights w = {.decay = exp(-z)};
  if (fabs(z) >= 1) {
    w.J[0] = (1 - w.decay) / z;
    w.J[1] = (1 - w.J[0]) / z;
    w.J[2] = (1 - 2 * w.J[1]) / z;
    w.J12 = (1 + w.decay - 2 * w.J[0]) / z / z;
    return w;
  }
  double term = 1.0 / 3;
  for (int q = 4; fabs(term) > 1e-18; q++) {
    w.J[2] += term;
    term *= -z / q;
  }
  w.J[1] = (1 - z * w.J[2]) / 2;
  w.J[0] = 1 - z * w.J[1];
  w.J12 = w.J[1] - w.J[2];
  return w;
}

/* A step's beginning, and its length and rate when the time t has gone. */
typedef struct stretch {
  double k_m, tau, m, l, rate; /* at the beginning */
  double t, l_now, rate_now;
} stretch;

static stretch stretch_of(const maxwell_springs *s, size_t e, double t, double l, double rate) {
  const double *q = s->variable + VARIABLES * e, tau = hk_tuple_value(&s->tau, e);
  return (stretch){.k_m = hk_tuple_value(&s->k_m, e),
                   .tau = tau,
                   .m = q[FORCE],
                   .l = q[LENGTH],
                   .rate = q[RATE],
                   .t = fmax(t, -tau), /* looking back a little may be asked for; the past is not known */
                   .l_now = l,
                   .rate_now = rate};
}

/* The force of the branch, N; its derivatives by the length, N/m, and by the rate, N s/m. */
static double branch(const stretch *s, double *by_length, double *by_rate) {
  const weights w = weights_of(s->t / s->tau);
  *by_length = 6 * s->k_m * w.J12;
  *by_rate = s->k_m * s->t * (3 * w.J[2] - 2 * w.J[1]);
  return w.decay * s->m + s->k_m * s->t * s->rate * (w.J[0] - 4 * w.J[1] + 3 * w.J[2]) + *by_rate * s->rate_now +
         *by_length * (s->l_now - s->l);
}

/* The force of the branch at the part c of the step, on the cubic of the whole step. */
static double branch_at(const stretch *s, double c) {
  const weights w = weights_of(c * s->t / s->tau);
  double slope = (s->l_now - s->l) / s->t, linear = 6 * slope - 4 * s->rate - 2 * s->rate_now,
         square = 3 * (s->rate + s->rate_now) - 6 * slope;
  return w.decay * s->m + s->k_m * c * s->t * (s->rate * w.J[0] + c * (linear * w.J[1] + c * square * w.J[2]));
}

/* J, what the step dissipates: Gauss' rule of four points in pieces of tau, up to the time at which all that decays has
 * gone and m is a polynomial of degree 2, for which the rule is exact. */
static double dissipated(const stretch *s) {
  static const double node[2] = {0.3399810435848563, 0.8611363115940526},
                      weight[2] = {0.6521451548625461, 0.3478548451374538};
  enum { PIECES = 40 };
  double z = s->t / s->tau, sum = 0, begin = 0;
  while (begin < 1) {
    double end = z <= 1 || begin * z >= PIECES ? 1 : fmin(1, begin + 1 / z), half = (end - begin) / 2;
    for (int p = 0; p < 4; p++) {
      double m = branch_at(s, begin + half * (1 + (p % 2 ? 1 : -1) * node[p / 2]));
      sum += half * weight[p / 2] * m * m;
    }
    begin = end;
  }
  return sum * s->t / (s->k_m * s->tau);
}

static void law(const void *self, const hk_view *view, size_t e, double l, double rate, hk_edge_answer *a) {
  const maxwell_springs *s = self;
  double k = hk_tuple_value(&s->k, e), stretched = l - hk_tuple_value(&s->rest, e), by_length, by_rate;
  const stretch now = stretch_of(s, e, view->t - view->model->t, l, rate);
  double m = branch(&now, &by_length, &by_rate);
  *a = (hk_edge_answer){.force = k * stretched + m,
                        .energy = k * stretched * stretched / 2 + m * m / (2 * by_length),
                        .stiffness = k + by_length,
                        .damping = by_rate};
}

static double stiffest(const void *self, size_t e) {
  const maxwell_springs *s = self;
  return hk_tuple_value(&s->k, e) + hk_tuple_value(&s->k_m, e);
}

/* At the end of a step of h s; returns what was dissipated, J. */
static double move(maxwell_springs *s, const hk_view *view, size_t e, double h) {
  double n[3], rate, *q = s->variable + VARIABLES * e, ignored[2];
  double l = hk_edge_laws_measure(view, hk_tuple(&s->laws.edges, e), n, &rate);
  const stretch step = stretch_of(s, e, h, l, rate);
  double lost = h > 0 ? dissipated(&step) : 0;
  q[FORCE] = branch(&step, &ignored[0], &ignored[1]);
  q[LENGTH] = l;
  q[RATE] = rate;
  return lost;
}

static hk_status evolve(void *self, const hk_view *view, double h, hk_evolution *report) {
  maxwell_springs *s = self;
  for (size_t e = 0; e < s->laws.edges.count; e++)
    if (hk_edge_acts(view, hk_tuple(&s->laws.edges, e))) report->dissipated += move(s, view, e, h);
  return HK_OK;
}

/* ---- tables ---- */

/* The state may be another one than that of the last step, taken from a file, say: the branch answers as a spring. */
static hk_status topology(void *self, const hk_view *view) {
  maxwell_springs *s = self;
  for (size_t e = 0; e < s->laws.edges.count; e++) move(s, view, e, 0);
  return hk_edge_laws_topology(self, view);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  maxwell_springs *s = self;
  hk_status status = hk_edge_rest(host, view, &s->laws.edges, &s->rest);
  s->laws.law = law;
  s->laws.stiffest = stiffest;
  if (status == HK_OK) status = topology(self, view);
  for (size_t e = 0; e < s->laws.edges.count; e++) s->variable[VARIABLES * e + FORCE] = 0;
  return status;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_CONSERVES_MOMENTUM |
             HK_CONSERVES_ANGULAR_MOMENTUM | HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add_part = hk_edge_laws_add_part,
    .energy = hk_edge_laws_energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = hk_edge_laws_pattern, .jacobian = hk_edge_laws_jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = hk_edge_laws_bound),
                        HK_PARTS_FACET(.touch = hk_edge_laws_touch), HK_INTERNAL_FACET(.evolve = evolve)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "maxwell_springs",
    .summary = "springs with a branch that relaxes, f = k (l - L) + m, m' = k_m l' - m/tau",
    .reference = "Maxwell 1867; Simo and Hughes 1998, Computational Inelasticity, 10.3",
    .instance_size = sizeof(maxwell_springs),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
