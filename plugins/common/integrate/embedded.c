/* See embedded.h. */
#include "plugins/common/integrate/embedded.h"

#include <string.h>

static const double share_of_second = 0.01;

void hk_embedded_reset(void *self, hk_reason why) {
  (void)why;
  ((hk_embedded_state *)self)->primed = 0;
}

/* The error by one list of weights. */
static double measure(hk_embedded_state *m, const hk_embedded *p, const hk_system *s, double h, const double *weight) {
  const hk_tableau *T = p->tableau;
  const double *X = hk_rk_stage_state(T, s, m->k);
  memset(m->error, 0, s->size * sizeof *m->error);
  hk_rk_combine(T, s, h, m->k, weight, T->stages, 0, m->error, m->error);
  return hk_scales_error(&m->scales, s, h, X, hk_rk_slope(s, m->k, T->stages - 1), m->error);
}

/* The estimated error of the step, relative to tol. */
static double estimate(hk_embedded_state *m, const hk_embedded *p, const hk_system *s, double h) {
  double error = measure(m, p, s, h, p->weight);
  if (!p->has_second || error == 0) return error / s->tol;
  double other = measure(m, p, s, h, p->second);
  return error * (error / sqrt(error * error + share_of_second * other * other)) / s->tol;
}

/* The first step follows from Hairer's rule that (h rate)^order is a hundredth of the tolerance, so that the choice
 * does not depend on the unit of time. */
static hk_status first_step(hk_embedded_state *m, const hk_embedded *p, hk_system *s, double span, double *h) {
  double rate, small;
  hk_status status = hk_scales_first(&m->scales, s, span, hk_rk_slope(s, m->k, 0),
                                     hk_rk_stage_state(p->tableau, s, m->k), hk_rk_slope(s, m->k, 1), &rate, &small);
  *h = status != HK_OK ? span : rate > 0 ? pow(0.01 * s->tol, 1 / p->order) / rate : small;
  return status;
}

static hk_status begin(hk_embedded_state *m, const hk_embedded *p, hk_system *s, double span, double *h) {
  size_t v = 3 * s->n;
  double *X = s->X, *a = hk_rk_slope(s, m->k, 0);
  hk_status status = HK_OK;
  if (!(*h > 0) || *h > span * (1 - 1e-12)) *h = span; /* exceeds h by rounding only */
  if (m->primed)
    memcpy(a, m->first, (s->size - v) * sizeof *a);
  else
    status = s->accelerations(s, s->t, X, X + v, X + 2 * v, a, a + v);
  if (status != HK_OK) return status;
  hk_scales_notice(&m->scales, s, X + v, a);
  if (m->started) return HK_OK;
  double first = span;
  status = hk_scales_foresee(&m->scales, s, span, hk_rk_stage_state(p->tableau, s, m->k), m->error);
  if (status == HK_OK) status = first_step(m, p, s, span, &first);
  *h = fmin(*h, first);
  return status;
}

/* What an attempt has come to. */
typedef struct attempt {
  double h, error;
  bool lands, retried; /* ends at the stop; is shorter than a rejected one */
} attempt;

static void accept(hk_embedded_state *m, const hk_embedded *p, hk_system *s, attempt a, hk_step *out) {
  size_t v = 3 * s->n;
  const double *X = hk_rk_stage_state(p->tableau, s, m->k), *end = hk_rk_slope(s, m->k, p->tableau->stages - 1);
  double last = m->started ? m->last_error : 1e-4;
  double change = p->safety * pow(last, p->beta) / pow(a.error, 1 / p->order - 0.75 * p->beta);
  double next = a.h * fmin(p->most, fmax(p->least, change));
  if (a.retried) next = fmin(next, a.h);
  if (a.lands && !a.retried && m->started) next = fmax(next, m->proposal); /* h was shortened to end at t_stop */
  memcpy(s->X, X, s->size * sizeof *X);
  memcpy(m->first, end, (s->size - v) * sizeof *end);
  hk_scales_notice(&m->scales, s, X + v, end);
  m->primed = m->started = 1;
  m->last_error = fmax(a.error, 1e-4);
  m->proposal = next;
  *out = (hk_step){a.h, next, a.error};
}

hk_status hk_embedded_step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  hk_embedded_state *m = self;
  const hk_embedded *p = method;
  double span = t_stop - s->t;
  hk_status status = begin(m, p, s, span, &h);
  if (status != HK_OK) return status;
  if (h < span && 2 * h > span) h = span / 2; /* avoids a very short last step */
  for (bool retried = false;; retried = true) {
    double error = NAN;
    status = hk_rk_stages(p->tableau, s, h, m->k, 1);
    if (status == HK_OK)
      error = estimate(m, p, s, h);
    else if (status != HK_NOT_FINITE && status != HK_NOT_CONVERGED)
      return status;
    double shorter = h * (error < INFINITY ? fmax(p->least, p->safety * pow(error, -1 / p->order)) : p->least);
    bool jump = !(error <= 1) && !(shorter > hk_shortest_step(s, span)) && hk_jump_met(&m->wait, error);
    if (error <= 1 || jump) {
      accept(m, p, s, (attempt){h, fmin(error, 1), h >= span, retried}, out);
      if (jump)
        out->error = NAN;
      else
        hk_jump_passed(&m->wait);
      return HK_OK;
    }
    if (!(shorter > hk_shortest_step(s, span)))
      return s->host->fail(s->host, HK_NOT_CONVERGED,
                           "no step from t = %.17g s meets the tolerance %g: tried down to %g s, where the error is %g "
                           "times as large; give a larger tol, or look for a force that jumps",
                           s->t, s->tol, shorter, error);
    h = shorter;
  }
}

double hk_embedded_growth(const void *self, const void *method, double hw, double hg, double hb) {
  return hk_rk_growth(self, ((const hk_embedded *)method)->tableau, hw, hg, hb);
}
