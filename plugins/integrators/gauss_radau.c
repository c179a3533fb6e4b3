/* Everhart's method of order 15 at Gauss-Radau points, iterated to rounding, with steps chosen so that its own errors
 * are below it: Rein and Spiegel's IAS15. For orbits and other smooth motion to sixteen digits; the energy of orbits
 * then does a random walk (Brouwer 1937), as x is added up with compensation.
 *
 * A step solves for the polynomials of radau.h by sweeps over the nodes, from what the polynomials of the last step
 * foretell, until the highest coefficient B_7 is settled. What tells its length is how fast the coefficients fall,
 * r = |B_7| / |a| of the particle where that is largest: r goes with h^7, and the error with h^16, so that a relative
 * error of a step of `tol` is taken to be r = 16 tol^(7/16), 2e-6 where tol is rounding: errors of the method show in
 * orbits of eccentricity 0.9 and in the Pythagorean problem from 4e-4 on. (Rein and Spiegel take r = 1e-9, for 2.5
 * times as many steps. Pham, Rein and Spiegel's criterion of 2024, by the first three derivatives, has steps of about
 * this length; it knows no error, and not what else than gravitation does.) B_6 guards against zeros of B_7, as swings
 * have them, and what the polynomials are at the end of the step foretells r of the next one, so that approaches do not
 * reject step after step.
 *
 * A step also looks just before its end, behind the last node, where a force may jump unseen: a mass in a force that
 * jumps between 1 and -40 m/s2 was off by 0.15 m at a tolerance of 1e-12, and is now by 4e-10 m, for 3 % more
 * evaluations.
 *
 * What is left is rounding of the forces: of twelve orbits of eccentricity 0.99 in as many directions the ends after
 * 1,000 periods are 8.4e-9 of their size off (RMS; REBOUND's IAS15 has 1.3e-8), of eight of 0.9 3.5e-10 (4.0e-10), of
 * 0.5 7e-11 (1e-10), by nbody. A digit of the forces is 2e-14 of the energy at a pericentre of 0.99, which walks at
 * random and turns into a phase that grows with t^(3/2): less takes forces beyond double precision. That walk needs all
 * of this: an integral that is not rounded (radau.c; twice the error without), places less what rounding took
 * from x, steps that end at a number, and forces without a bias (common/gravity/direct_sum.c; five times). An iteration
 * to 1e-16 instead of 1e-14 takes a fifth more evaluations for the same error.
 */
#include "core/plugin/facets/adaptive.h"
#include "plugins/common/integrate/radau.h"
#include "plugins/common/integrate/step_control.h"

#include <float.h>
#include <string.h>

enum { NODES = HK_RADAU_NODES, ROWS = HK_RADAU_ROWS, SWEEPS = 20 };

static const double safety = 0.9, least = 0.25, most = 4, farthest = 20; /* of the ratio of two steps */
static const double coefficient = 16, order_of_error = 16, order_of_ratio = 7;
/* Where a step is looked at behind its last node, 0.978, and what may be off there, of the slope, over sqrt(tol). */
static const double before_end = 1 - 1e-6, jump = 0.1;
/* B_7 and what the next sweep would change it by: of that the velocity gets an eighth, and rounding errors of the
 * forces make no less, as divided differences have a thousand times them. A change that falls no more is noise of the
 * forces. */
static const double settled = 64 * DBL_EPSILON, noise = 1e-7;
/* (theta^6/6!)^(7/6) and theta^7/7!, which a swing of phase theta has as B_6 and B_7, differ by this factor. */
static const double guard = 0.43;

typedef struct gauss_radau {
  int64_t primed;  /* whether `last` is the polynomial of the step before */
  int64_t started; /* whether a step has been taken */
  int64_t wait;    /* after a jump of a force (step_control.h) */
  double proposal; /* s, proposed length of the next step */
  double last_h;   /* s */
  hk_scales scales;
  double *B, *G; /* 8 and 7 rows of slopes, see radau.h; after G the B_7 of the sweep before */
  double *last;  /* rows 1 to 7 of the last step's B, then by how much they were off what was foretold */
  double *lost;  /* shaped as X, see hk_radau_finish */
  double *stage; /* state at a node */
  double *slope; /* there */
} gauss_radau;

static const hk_field fields[] = {
    {"primed", .integer = HK_AT(gauss_radau, primed)},
    {"started", .integer = HK_AT(gauss_radau, started)},
    {"wait", .integer = HK_AT(gauss_radau, wait)},
    {"proposal", .number = HK_AT(gauss_radau, proposal)},
    {"last_h", .number = HK_AT(gauss_radau, last_h)},
    {"speed", .number = HK_AT(gauss_radau, scales.speed)},
    {"acceleration", .number = HK_AT(gauss_radau, scales.acceleration)},
    {"coefficients", .state = HK_AT(gauss_radau, B), .width = ROWS, .flags = HK_SCRATCH},
    {"differences", .state = HK_AT(gauss_radau, G), .width = NODES + 1, .flags = HK_SCRATCH},
    {"last", .state = HK_AT(gauss_radau, last), .width = 2 * NODES},
    {"lost", .state = HK_AT(gauss_radau, lost), .width = 1},
    {"stage", .state = HK_AT(gauss_radau, stage), .width = 1, .flags = HK_SCRATCH},
    {"slope", .state = HK_AT(gauss_radau, slope), .width = 1, .flags = HK_SCRATCH},
    {0},
};

static void reset(void *self, hk_reason why) {
  gauss_radau *m = self;
  if (why != HK_CHECKPOINT) m->primed = 0;
}

static size_t length_of(const hk_system *s) { return s->size - 3 * s->n; }

/* ---- the polynomials of a step ---- */

/* From the polynomials of the step before, and by how much they erred there; 0 where there is none. */
static void foretell(gauss_radau *m, const hk_system *s, double h) {
  size_t length = length_of(s), count = NODES * length;
  double *B = m->B + length, q = m->primed ? h / m->last_h : INFINITY;
  if (q <= farthest) {
    hk_radau_foretell(m->last, length, q, m->B);
    for (size_t e = 0; e < count; e++) B[e] += m->last[count + e];
  } else
    memset(B, 0, count * sizeof *B);
  hk_radau_divide(m->B, length, m->G);
}

static double peak(const double *p, size_t count) {
  double most_seen = 0;
  for (size_t e = 0; e < count; e++) most_seen = fabs(p[e]) > most_seen ? fabs(p[e]) : most_seen;
  return most_seen;
}

static double larger(double a, double b) { return isnan(a) || a > b ? a : b; }

/* By how much B_7 has changed in a sweep, relative to the accelerations, or to the rates of a channel. */
static double change_of(const gauss_radau *m, const hk_system *s) {
  size_t length = length_of(s), v = 3 * s->n;
  const double *now = m->B + NODES * length;
  double *before = m->G + NODES * length, worst;
  for (size_t e = 0; e < length; e++) before[e] = now[e] - before[e];
  worst = hk_ratio(peak(before, v), fmax(peak(m->B, v), peak(m->slope, v)));
  for (size_t c = 0; c < s->model->channels; c++) {
    const hk_channel *channel = &s->model->channel[c];
    size_t begin = v + channel->offset * s->n, count = channel->size * s->n;
    worst = larger(
        worst, hk_ratio(peak(before + begin, count), fmax(peak(m->B + begin, count), peak(m->slope + begin, count))));
  }
  return worst;
}

/* One sweep over the nodes. A stage is a move: where there is contact, forces have to know of it before. */
static hk_status sweep(gauss_radau *m, hk_system *s, double h, double *change) {
  size_t v = 3 * s->n, length = length_of(s);
  double *X = m->stage;
  hk_status status = HK_OK;
  for (int k = 1; k <= NODES && status == HK_OK; k++) {
    double t = s->t + hk_radau_node[k] * h;
    hk_radau_place(m->B, s, h, k, s->X, m->lost, X);
    if (s->contact) status = s->contact->update(s, s->t, s->X, X);
    if (status == HK_OK) status = s->accelerations(s, t, X, X + v, X + 2 * v, m->slope, m->slope + v);
    if (k == NODES) memcpy(m->G + NODES * length, m->B + NODES * length, length * sizeof *m->G);
    if (status == HK_OK) hk_radau_refine(m->B, m->G, length, k, m->slope);
  }
  if (status == HK_OK) *change = change_of(m, s);
  return status;
}

/* A step that ends at a number: what time would lose by rounding at its end, the motion would be ahead of it. */
static double to_a_number(const hk_system *s, double h) {
  double end = s->t + h;
  return end - s->t;
}

/* HK_NOT_CONVERGED: the iteration does not converge at this h, or too slowly. */
static hk_status iterate(gauss_radau *m, hk_system *s, double h) {
  double change = INFINITY, last = INFINITY;
  foretell(m, s, h);
  for (int k = 1; k <= SWEEPS; k++, last = change) {
    hk_status status = sweep(m, s, h, &change);
    if (status != HK_OK) return status;
    if (!isfinite(change)) return HK_NOT_FINITE;
    double left = change * fmin(1, change / last); /* in the next sweep */
    if (k > 1 && left <= settled) return HK_OK;
    if (k > 2 && change >= last) return change <= noise ? HK_OK : HK_NOT_CONVERGED;
  }
  return HK_NOT_CONVERGED;
}

/* ---- the length of steps ---- */

typedef struct ratios {
  double here[2], ahead[2]; /* |B_6| and |B_7| relative to the slopes, largest; of this step, and of the next one */
} ratios;

static double norm(const double *p, size_t width) {
  double sum = 0;
  for (size_t c = 0; c < width; c++) sum += p[c] * p[c];
  return sqrt(sum);
}

/* Of `width` numbers from e on. The scale is what the slope and its first two derivatives are, in units of the step, at
 * its begin and, for the next one, at its end; `floor`: a scale below which changes are rounding. */
static void compare(const double *B, size_t length, size_t e, size_t width, double floor, ratios *r) {
  double low[3][3] = {{0}}, shifted[3];
  for (size_t c = 0; c < width; c++) {
    double b[ROWS];
    for (size_t j = 0; j < ROWS; j++) b[j] = B[j * length + e + c];
    low[0][c] = b[0] + b[1] + b[2] + b[3] + b[4] + b[5] + b[6] + b[7];
    low[1][c] = b[1] + 2 * b[2] + 3 * b[3] + 4 * b[4] + 5 * b[5] + 6 * b[6] + 7 * b[7];
    low[2][c] = b[2] + 3 * b[3] + 6 * b[4] + 10 * b[5] + 15 * b[6] + 21 * b[7];
    shifted[c] = b[6] + 7 * b[7];
  }
  double highest = norm(B + NODES * length + e, width);
  double scale = norm(B + e, width) + norm(B + length + e, width) + norm(B + 2 * length + e, width);
  double next = norm(low[0], width) + norm(low[1], width) + norm(low[2], width);
  scale = fmax(scale, floor), next = fmax(next, floor);
  r->here[0] = larger(hk_ratio(norm(B + (NODES - 1) * length + e, width), scale), r->here[0]);
  r->here[1] = larger(hk_ratio(highest, scale), r->here[1]);
  r->ahead[0] = larger(hk_ratio(norm(shifted, width), next), r->ahead[0]);
  r->ahead[1] = larger(hk_ratio(highest, next), r->ahead[1]);
}

static double together(const double r[2]) { return larger(r[1], guard * pow(r[0], order_of_ratio / 6)); }

static double allowed(const hk_system *s) { return coefficient * pow(s->tol, order_of_ratio / order_of_error); }

/* Of all particles that move freely, and of channels. Where the term of B_7 moves less than the rounding of the scene's
 * extent, it is none. */
static ratios compare_all(const gauss_radau *m, const hk_system *s, double h) {
  size_t length = length_of(s);
  double rounding = DBL_EPSILON / allowed(s), floor = rounding * hk_scales_extent(&m->scales, s, s->X) / (h * h);
  ratios r = {{0}, {0}};
  for (size_t i = 0; i < s->n; i++)
    if (s->model->inverse_mass[i] > 0) compare(m->B, length, 3 * i, 3, floor, &r);
  for (size_t c = 0; c < s->model->channels; c++) {
    const hk_channel *channel = &s->model->channel[c];
    size_t begin = channel->offset * s->n, count = channel->size * s->n;
    double size = rounding * peak(s->X + 6 * s->n + begin, count) / h;
    for (size_t e = 0; e < count; e++) compare(m->B, length, 3 * s->n + begin + e, 1, size, &r);
  }
  return r;
}

/* Of channels, see below. */
static double channels_off(const gauss_radau *m, const hk_system *s, double h, double most_off) {
  size_t length = length_of(s);
  double excess = 0;
  for (size_t c = 0; c < s->model->channels; c++) {
    const hk_channel *channel = &s->model->channel[c];
    size_t begin = channel->offset * s->n, count = channel->size * s->n;
    double floor = DBL_EPSILON / most_off * peak(s->X + 6 * s->n + begin, count) / h;
    for (size_t e = 3 * s->n + begin; e < 3 * s->n + begin + count; e++) {
      double off = fabs(m->slope[e] - hk_radau_slope(m->B, length, e, before_end));
      double scale = fmax(fabs(m->slope[e]) + fabs(m->B[e]) + fabs(m->B[length + e]), floor);
      excess = larger(hk_ratio(off, scale) / most_off, excess);
    }
  }
  return excess;
}

/* Behind the last node a force may jump, or a rope come taut, that no node sees: the slope just before the end is
 * compared with the polynomial. Of smooth motion B_8 makes it wrong by B_8/C(15, 7), which is 4e-3 sqrt(tol) at most.
 * Returns by how many times it is more than is allowed, so that a step twice as long makes it 2^8 times as much. */
static hk_status look_behind_nodes(gauss_radau *m, hk_system *s, double h, double *excess) {
  size_t length = length_of(s), v = 3 * s->n;
  double most_off = jump * sqrt(s->tol), *X = m->stage;
  double floor = DBL_EPSILON / most_off * hk_scales_extent(&m->scales, s, s->X) / (h * h);
  hk_radau_place_at(m->B, s, h, before_end, s->X, m->lost, X);
  hk_status status = s->contact ? s->contact->update(s, s->t, s->X, X) : HK_OK;
  if (status == HK_OK) status = s->accelerations(s, s->t + before_end * h, X, X + v, X + 2 * v, m->slope, m->slope + v);
  *excess = 0;
  for (size_t i = 0; i < s->n && status == HK_OK; i++) {
    double off[3], size[3];
    for (size_t c = 0; c < 3; c++) {
      off[c] = m->slope[3 * i + c] - hk_radau_slope(m->B, length, 3 * i + c, before_end);
      size[c] = fabs(m->slope[3 * i + c]) + fabs(m->B[3 * i + c]);
    }
    double scale = fmax(norm(size, 3) + norm(m->B + length + 3 * i, 3), floor);
    if (s->model->inverse_mass[i] > 0) *excess = larger(hk_ratio(norm(off, 3), scale) / most_off, *excess);
  }
  if (status == HK_OK) *excess = larger(channels_off(m, s, h, most_off), *excess);
  return status;
}

/* The error of a step is tol where r is `allowed`. */
static double error_of(const hk_system *s, double r) { return pow(r / allowed(s), order_of_error / order_of_ratio); }

static double next_length(const hk_system *s, double h, double r) {
  double factor = r > 0 ? safety * pow(allowed(s) / r, 1 / order_of_ratio) : most;
  return h * fmin(most, fmax(least, factor));
}

/* ---- a step ---- */

static hk_status begin(gauss_radau *m, hk_system *s, double span, double *h) {
  size_t v = 3 * s->n;
  double *X = s->X, *a = m->B, rate, small;
  if (!(*h > 0) || *h > span * (1 - 1e-12)) *h = span; /* exceeds h by rounding only */
  hk_status status = s->accelerations(s, s->t, X, X + v, X + 2 * v, a, a + v);
  if (status != HK_OK) return status;
  hk_scales_notice(&m->scales, s, X + v, a);
  if (!m->primed) memset(m->lost, 0, s->size * sizeof *m->lost);
  if (m->started) return HK_OK;
  status = hk_scales_foresee(&m->scales, s, span, m->stage, m->G);
  if (status == HK_OK) status = hk_scales_first(&m->scales, s, span, a, m->stage, m->slope, &rate, &small);
  if (status == HK_OK) *h = fmin(*h, rate > 0 ? pow(10 * allowed(s), 1 / order_of_ratio) / rate : small);
  return status;
}

static void accept(gauss_radau *m, hk_system *s, double h, bool lands, bool retried, const ratios *r, hk_step *out) {
  size_t length = length_of(s), count = NODES * length;
  double next = next_length(s, h, larger(together(r->here), together(r->ahead)));
  double *B = m->B + length, *guess = m->G + length; /* what G holds is needed no more */
  if (retried) next = fmin(next, h);
  if (lands && !retried && m->started) next = fmax(next, m->proposal); /* h was shortened to end at t_stop */
  hk_radau_finish(m->B, s, h, s->X, m->lost);
  if (m->primed && h / m->last_h <= farthest) {
    hk_radau_foretell(m->last, length, h / m->last_h, m->G);
    for (size_t e = 0; e < count; e++) m->last[count + e] = B[e] - guess[e];
  } else
    memset(m->last + count, 0, count * sizeof *m->last);
  memcpy(m->last, B, count * sizeof *B);
  hk_scales_notice(&m->scales, s, s->X + 3 * s->n, m->slope);
  m->primed = m->started = 1;
  m->last_h = h;
  m->proposal = next;
  *out = (hk_step){h, next, error_of(s, together(r->here))};
}

/* A step that ends beyond a jump, whose polynomials say nothing of what follows. */
static hk_status pass_jump(gauss_radau *m, hk_system *s, double h, const ratios *r, hk_step *out) {
  accept(m, s, h, false, true, r, out);
  m->primed = 0;
  m->proposal = h;
  *out = (hk_step){h, h, NAN};
  return HK_OK;
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  gauss_radau *m = self;
  double span = t_stop - s->t;
  (void)method;
  hk_status status = begin(m, s, span, &h);
  if (status != HK_OK) return status;
  if (h < span && 2 * h > span) h = span / 2; /* avoids a very short last step */
  for (bool retried = false;; retried = true) {
    ratios r = {{0}, {0}};
    double error = NAN, excess = 0;
    h = h < span ? to_a_number(s, h) : h;
    status = iterate(m, s, h);
    if (status == HK_OK) {
      r = compare_all(m, s, h);
      error = error_of(s, together(r.here));
      if (error <= 1) status = look_behind_nodes(m, s, h, &excess);
      if (status != HK_OK) return status;
      if (excess > 1) error = fmax(2, error);
    } else if (status != HK_NOT_FINITE && status != HK_NOT_CONVERGED)
      return status;
    if (error <= 1) {
      accept(m, s, h, h >= span, retried, &r, out);
      hk_jump_passed(&m->wait);
      return HK_OK;
    }
    double shorter = least * h;
    if (excess > 1)
      shorter = h * fmax(least, safety * pow(excess, -1 / (order_of_ratio + 1)));
    else if (error < INFINITY)
      shorter = fmin(next_length(s, h, together(r.here)), safety * h);
    if (!(shorter > hk_shortest_step(s, span))) {
      if (hk_jump_met(&m->wait, error)) return pass_jump(m, s, h, &r, out);
      return s->host->fail(s->host, HK_NOT_CONVERGED,
                           "no step from t = %.17g s meets the tolerance %g: tried down to %g s, where the error is %g "
                           "times as large; give a larger tol, or look for a force that jumps",
                           s->t, s->tol, shorter, error);
    }
    h = shorter;
  }
}

static const hk_adaptive_facet adaptive = {
    .size = sizeof adaptive, .tolerance = DBL_EPSILON, .finest = DBL_EPSILON / 200, .evaluations = 26};
static const hk_facet facets[] = {{HK_ADAPTIVE_ID, &adaptive}, {0}};

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 15,
                                         .stages = 16,
                                         .flags = HK_ADAPTIVE,
                                         .step = step,
                                         .reset = reset,
                                         .facets = facets};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "gauss_radau",
    .summary =
        "Everhart's method of order 15 at Gauss-Radau points, iterated to rounding, for orbits to sixteen digits; "
        "chooses its steps, some fifteen to thirty evaluations each",
    .reference = "Everhart 1985, in Dynamics of Comets; Rein and Spiegel 2015, MNRAS 446, 1424 (IAS15); Brouwer 1937, "
                 "Astron. J. 46",
    .instance_size = sizeof(gauss_radau),
    .fields = fields,
    .integrator = &integrator,
};
