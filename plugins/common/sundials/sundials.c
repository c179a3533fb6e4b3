/* See sundials.h. Errors are weighted by 1 / (tol (|X_e| + scale)), where the scale of positions is the RMS distance of
 * the particles from their mean or, if that is larger, V^2/A (as in dopri5), that of velocities the largest RMS speed V
 * or, from rest, sqrt(L A), that of a channel its RMS; so tol is SUNDIALS' relative tolerance without a change. The
 * work has the weight 0. */
#include "plugins/common/sundials/sundials.h"
#include "plugins/common/integrate/safe_move.h"
#include "plugins/common/integrate/step_control.h"
#include "plugins/common/sundials/sundials_vector.h"

#include <stdio.h>
#include <string.h>

static const double no_weight = 1e-100;

enum { RECOVERABLE = 1, FATAL = -1 };

/* ---- errors ---- */

static bool is_fatal(hk_status status) {
  return status != HK_OK && status != HK_NOT_FINITE && status != HK_NOT_CONVERGED;
}

int hk_sundials_code(hk_sundials *m, hk_status status) {
  if (is_fatal(m->status)) return FATAL;
  if (status == HK_OK) return 0;
  m->status = status;
  return is_fatal(status) ? FATAL : RECOVERABLE;
}

static void keep(hk_sundials *m, const char *text) {
  size_t length = strcspn(text, "\n");
  while (length && text[length - 1] == '.') length--;
  snprintf(m->message, sizeof m->message, "%.*s", (int)length, text);
}

#if SUNDIALS_VERSION_MAJOR < 7
void hk_sundials_hear(int code, const char *module, const char *function, char *message, void *self) {
  (void)module, (void)function;
  if (code < 0) keep(self, message);
}

static int make_context(hk_sundials *m) { return SUNContext_Create(NULL, &m->context); }
#else
static void keep_message(int line, const char *function, const char *file, const char *message, SUNErrCode code,
                         void *self, SUNContext context) {
  (void)line, (void)function, (void)file, (void)code, (void)context;
  if (message) keep(self, message);
}

static int make_context(hk_sundials *m) {
  int flag = SUNContext_Create(SUN_COMM_NULL, &m->context);
  if (flag == 0) flag = SUNContext_ClearErrHandlers(m->context);
  return flag == 0 ? SUNContext_PushErrHandler(m->context, keep_message, m) : flag;
}
#endif

hk_status hk_sundials_stuck(hk_sundials *m) {
  keep(m, "its step no longer moves the time");
  return hk_sundials_failed(m, 0, false);
}

hk_status hk_sundials_failed(hk_sundials *m, int flag, bool rates) {
  if (is_fatal(m->status) || (rates && m->status != HK_OK)) return m->status;
  return m->host->fail(m->host, HK_NOT_CONVERGED,
                       "no step from t = %.17g s meets the tolerance %g (SUNDIALS, %d: %s); give a larger tol, or look "
                       "for a force that jumps",
                       m->system->t, m->system->tol, flag, *m->message ? m->message : "no word");
}

hk_status hk_sundials_setup(hk_sundials *m, int flag) {
  if (flag == 0) return HK_OK;
  return m->host->fail(m->host, HK_FAILED, "SUNDIALS does not start (%d: %s): is there memory for %zu numbers?", flag,
                       *m->message ? m->message : "no word", m->X ? (size_t)N_VGetLength(m->X) : (size_t)0);
}

/* ---- life ---- */

static hk_status no_memory(const hk_sundials *m, size_t size) {
  return m->host->fail(m->host, HK_NO_MEMORY, "no memory for SUNDIALS' vectors of %zu numbers", size);
}

hk_status hk_sundials_open(hk_sundials *m, const hk_host *host, const hk_view *view) {
  size_t size = 6 * view->n + 1;
  hk_sundials_close(m);
  m->host = host;
  m->channels = view->model->channels;
  for (size_t c = 0; c < m->channels; c++) size += view->model->channel[c].size * view->n;
  m->channel = host->allocate(host, (m->channels + 1) * sizeof *m->channel);
  if (!m->channel || make_context(m) != 0) return no_memory(m, size);
  m->X = hk_sundials_vector(size, m->state, m->context);
  if (!m->X) return no_memory(m, size);
  if (m->preconditioner == HK_PRECONDITION_BLOCK_JACOBI) {
    m->inverse = host->allocate(host, (9 * view->n + 1) * sizeof *m->inverse);
    if (!m->inverse) return no_memory(m, size);
  }
  return HK_OK;
}

void hk_sundials_close(hk_sundials *m) {
  if (!m->host) return;
  if (m->linear) SUNLinSolFree(m->linear);
  if (m->nonlinear) SUNNonlinSolFree(m->nonlinear);
  if (m->matrix) SUNMatDestroy(m->matrix);
  if (m->X) N_VDestroy(m->X);
  if (m->context) SUNContext_Free(&m->context);
  m->host->release(m->host, m->channel);
  m->host->release(m->host, m->inverse);
  m->linear = NULL;
  m->nonlinear = NULL;
  m->matrix = NULL;
  m->X = NULL;
  m->context = NULL;
  m->channel = m->inverse = NULL;
}

/* ---- weights ---- */

void hk_sundials_rescale(hk_sundials *m, hk_system *s) {
  size_t v = 3 * s->n;
  m->length = fmax(m->length, hk_scales_extent(&(hk_scales){0, 0}, s, s->X));
  m->speed = fmax(m->speed, hk_rms(s->X + v, v));
  for (size_t c = 0; c < m->channels; c++) {
    const hk_channel *channel = &s->model->channel[c];
    m->channel[c] = fmax(m->channel[c], hk_rms(s->X + (6 + channel->offset) * s->n, channel->size * s->n));
  }
}

/* A scale that is 0 at the start is replaced by the change that the rates cause until the next stop, or by 1 when the
 * rates are 0 as well. */
hk_status hk_sundials_scale(hk_sundials *m, hk_system *s, double span) {
  size_t v = 3 * s->n;
  double *X = m->work, *dX = m->work + s->size, A = 0;
  m->length = m->speed = 0;
  memset(m->channel, 0, m->channels * sizeof *m->channel);
  hk_sundials_rescale(m, s);
  for (int k = 0; k < 2 && A == 0; k++) {
    memcpy(X, s->X, s->size * sizeof *X);
    hk_status status = s->rates(s, s->t + k * span, X, dX);
    if (status != HK_OK) return status;
    A = hk_rms(dX + v, v);
  }
  if (A > 0) m->length = fmax(m->length, m->speed * m->speed / A);
  m->speed = fmax(m->speed, m->length > 0 ? sqrt(m->length * A) : A * span);
  if (!(m->length > 0)) m->length = m->speed * span;
  if (!(m->length > 0)) m->length = 1;
  if (!(m->speed > 0)) m->speed = m->length / span;
  for (size_t c = 0; c < m->channels; c++) {
    const hk_channel *channel = &s->model->channel[c];
    if (m->channel[c] > 0) continue;
    m->channel[c] = span * hk_rms(dX + (6 + channel->offset) * s->n, channel->size * s->n);
    if (!(m->channel[c] > 0)) m->channel[c] = 1;
  }
  return HK_OK;
}

static void weigh(const double *restrict X, double *restrict weight, size_t count, double tol, double scale) {
  double least = tol * scale;
  for (size_t e = 0; e < count; e++) weight[e] = 1 / (tol * fabs(X[e]) + least);
}

int hk_sundials_weights(N_Vector X, N_Vector weight, void *self) {
  const hk_sundials *m = self;
  const hk_system *s = m->system;
  const double *x = NV_DATA_S(X);
  double *w = NV_DATA_S(weight);
  size_t v = 3 * s->n;
  weigh(x, w, v, s->tol, m->length);
  weigh(x + v, w + v, v, s->tol, m->speed);
  for (size_t c = 0; c < m->channels; c++) {
    const hk_channel *channel = &s->model->channel[c];
    size_t begin = (6 + channel->offset) * s->n;
    weigh(x + begin, w + begin, channel->size * s->n, s->tol, m->channel[c]);
  }
  w[s->size - 1] = no_weight;
  return 0;
}

double hk_sundials_norm(N_Vector error, N_Vector weight) { return N_VWrmsNorm(error, weight); }

static double distance(const double *a, const double *b, size_t count, double scale) {
  double sum = 0;
  for (size_t e = 0; e < count; e++) sum += (a[e] - b[e]) * (a[e] - b[e]);
  return sum > 0 ? sqrt(sum) / (scale * sqrt((double)count)) : 0;
}

bool hk_sundials_follows(hk_sundials *m, hk_system *s) {
  size_t v = 3 * s->n;
  double *X = m->state;
  if (memcmp(X, s->X, s->size * sizeof *X) == 0) return true;
  s->impose(s, s->t, X, X + v);
  double away = fmax(distance(X, s->X, v, m->length), distance(X + v, s->X + v, v, m->speed));
  if (!(away <= s->tol)) return false;
  return memcmp(X + 2 * v, s->X + 2 * v, (s->size - 1 - 2 * v) * sizeof *X) == 0;
}

/* ---- f ---- */

/* Fails where the straight line from the start of the step to X is not safe; SUNDIALS then tries a shorter step. Its
 * new state may differ from the last state evaluated; the host checks it. */
static hk_status approach(hk_sundials *m, double t, const double *X) {
  hk_system *s = m->system;
  double *dx = m->work, part = 1;
  for (size_t e = 0; e < 3 * s->n; e++) dx[e] = X[e] - s->X[e];
  hk_status status = hk_safe_part(s, t, s->X, dx, dx + 3 * s->n, &part);
  if (status != HK_OK || part >= 1) return status;
  return m->host->fail(m->host, HK_NOT_CONVERGED, "the step from t = %.17g s leads through a contact", s->t);
}

int hk_sundials_rates(double t, N_Vector X, N_Vector dX, void *self) {
  hk_sundials *m = self;
  if (is_fatal(m->status)) return hk_sundials_code(m, m->status);
  hk_status status = m->system->contact ? approach(m, t, NV_DATA_S(X)) : HK_OK;
  if (status != HK_OK) return hk_sundials_code(m, status);
  return hk_sundials_code(m, m->system->rates(m->system, t, NV_DATA_S(X), NV_DATA_S(dX)));
}
