/* See sundials.h. Errors are weighted by 1 / (tol scale), and the largest weighted error of all numbers counts
 * (sundials_vector.c), as in step_control.h: the tolerance holds for every particle, wherever the origin lies. The
 * scale of positions is the RMS distance of the particles from their mean or, if that is larger, V^2/A; that of
 * velocities the largest RMS speed V so far; that of a number of a channel its largest magnitude so far. Before a step
 * SUNDIALS asks for the weights at its state, so a scale follows motion that begins late. The work and the particles
 * that pins lead have the weight 0. */
#include "plugins/common/sundials/sundials.h"
#include "plugins/common/implicit/safe_move.h"
#include "plugins/common/integrate/step_control.h"
#include "plugins/common/sundials/sundials_vector.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

static const double no_weight = 1e-100;

/* What counts as rest: this part of the extent in the time to the next stop, and this part of a channel's largest
 * number (step_control.c). */
static const double at_rest = 1e-6;
/* m, the extent where nothing says what it is: one place, no motion and no force. What moves later sets its own. */
static const double nothing = 1e-9;
/* sqrt 3: an error of one component of a particle counts as part of the RMS of its three (step_control.c). */
static const double components = 1.7320508075688772;
static const double rounding = 16 * DBL_EPSILON; /* errors below this part of the largest number do not count */

enum { RECOVERABLE = 1, FATAL = -1, MEM_FAIL = -20 /* CV_MEM_FAIL and ARK_MEM_FAIL */ };

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

static hk_status no_memory(const hk_sundials *m, size_t size) {
  return m->host->fail(m->host, HK_NO_MEMORY, "no memory for SUNDIALS' vectors of %zu numbers", size);
}

hk_status hk_sundials_stuck(hk_sundials *m) {
  keep(m, "its step no longer moves the time");
  return hk_sundials_failed(m, 0, false);
}

hk_status hk_sundials_failed(hk_sundials *m, int flag, bool rates) {
  if (is_fatal(m->status) || (rates && m->status != HK_OK)) return m->status;
  if (flag == MEM_FAIL || hk_sundials_vector_failed(m->X)) return no_memory(m, (size_t)N_VGetLength(m->X));
  return m->host->fail(m->host, HK_NOT_CONVERGED,
                       "no step from t = %.17g s meets the tolerance %g (SUNDIALS, %d: %s); give a larger tol, or look "
                       "for a force that jumps",
                       m->system->t, m->system->tol, flag, *m->message ? m->message : "no word");
}

hk_status hk_sundials_setup(hk_sundials *m, int flag) {
  if (hk_sundials_vector_failed(m->X)) return no_memory(m, (size_t)N_VGetLength(m->X));
  if (flag == 0) return HK_OK;
  return m->host->fail(m->host, HK_FAILED, "SUNDIALS does not start (%d: %s): is there memory for %zu numbers?", flag,
                       *m->message ? m->message : "no word", m->X ? (size_t)N_VGetLength(m->X) : (size_t)0);
}

/* ---- life ---- */

hk_status hk_sundials_open(hk_sundials *m, const hk_host *host, const hk_view *view) {
  size_t size = 6 * view->n + 1;
  hk_sundials_close(m);
  m->host = host;
  m->channels = view->model->channels;
  for (size_t c = 0; c < m->channels; c++) size += view->model->channel[c].size * view->n;
  hk_status status = hk_channels_open(&m->rates, host, view);
  if (status != HK_OK) return status;
  m->channel = host->allocate(host, (m->rates.width + 1) * sizeof *m->channel);
  if (!m->channel) return no_memory(m, size);
  if (make_context(m) != 0) {
    m->context = NULL; /* one that is half made: SUNContext_Free of SUNDIALS 6 would crash */
    return no_memory(m, size);
  }
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
  hk_channels_close(&m->rates);
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

static double peak(const double *y, size_t count, size_t stride) {
  double most = 0;
  for (size_t i = 0; i < count; i++) most = fmax(most, fabs(y[i * stride]));
  return most;
}

/* Increases the scales of a channel's numbers, the first of which is `scale`, to those of y. */
static void rescale_channel(const hk_channel *channel, size_t n, const double *y, double part, double *scale) {
  double whole = 0;
  for (size_t k = 0; k < channel->size; k++) {
    scale[k] = fmax(scale[k], part * peak(y + k, n, channel->size));
    whole = fmax(whole, scale[k]);
  }
  for (size_t k = 0; k < channel->size; k++) scale[k] = fmax(scale[k], at_rest * whole);
}

static void rescale(hk_sundials *m, const double *X) {
  hk_system *s = m->system;
  size_t v = 3 * s->n, k = 0;
  hk_scales known = {m->speed = fmax(m->speed, hk_rms_free(s, X + v)), m->acceleration};
  m->length = fmax(m->length, hk_scales_extent(&known, s, X));
  for (size_t c = 0; c < m->channels; k += s->model->channel[c++].size)
    rescale_channel(&s->model->channel[c], s->n, X + (6 + s->model->channel[c].offset) * s->n, 1, m->channel + k);
}

double hk_sundials_longest(double h, double planned, double *most) {
  static const double very_short = 1e-3; /* of the planned step */
  bool known = planned < INFINITY, limited = known && h < planned * (1 - 1e-12);
  if (limited && h > very_short * planned) *most = h;
  if (limited || !known) return *most > 0 ? fmin(*most, h) : h;
  if (*most > 0) *most = fmax(*most, h); /* what the host offers it allows */
  return *most > 0 ? *most : INFINITY;
}

double hk_sundials_next(double said, double taken, double left, double most) {
  static const double growth = 10; /* at most, from a step to the next, in CVODE and ARKODE */
  bool cut = said >= left * (1 - 1e-3);
  return cut && most > 0 ? fmax(said, growth * taken) : said;
}

void hk_sundials_notice(hk_sundials *m, double h) {
  hk_system *s = m->system;
  size_t v = 3 * s->n;
  double *change = m->work;
  for (size_t e = 0; e < v; e++) change[e] = m->state[v + e] - s->X[v + e];
  m->acceleration = fmax(m->acceleration, hk_rms_free(s, change) / h);
}

/* The scale of a channel that is 0 is the change that its rates cause until the next stop, or 1 where they are 0 too.
 */
static void start_channels(hk_sundials *m, hk_system *s, const double *dX, double span) {
  size_t k = 0;
  for (size_t c = 0; c < m->channels; k += s->model->channel[c++].size) {
    const hk_channel *channel = &s->model->channel[c];
    if (!(m->channel[k] > 0)) rescale_channel(channel, s->n, dX + (6 + channel->offset) * s->n, span, m->channel + k);
    for (size_t e = 0; e < channel->size; e++)
      if (!(m->channel[k + e] > 0)) m->channel[k + e] = 1;
  }
}

/* The speed from rest is the one that the forces cause until the next stop or, if that is less, over the extent; forces
 * that are 0 at present are looked at later, at times that are no multiples of each other. */
hk_status hk_sundials_scale(hk_sundials *m, hk_system *s, double span) {
  static const double later[] = {0, 1, 0.61803398874989485};
  size_t v = 3 * s->n;
  double *X = m->work, *dX = m->work + s->size, A = 0;
  m->length = m->speed = m->acceleration = 0;
  memset(m->channel, 0, m->rates.width * sizeof *m->channel);
  hk_channels_forget(&m->rates);
  rescale(m, s->X);
  for (int k = 0; k < 3 && A == 0; k++) {
    memcpy(X, s->X, s->size * sizeof *X);
    hk_status status = s->rates(s, s->t + later[k] * span, X, dX);
    if (status != HK_OK) return status;
    A = hk_rms_free(s, dX + v);
    if (k == 0) start_channels(m, s, dX, span);
  }
  m->acceleration = A;
  rescale(m, s->X);
  m->speed = fmax(m->speed, m->length > 0 ? fmin(sqrt(m->length * A), A * span) : A * span);
  if (!(m->length > 0)) m->length = fmax(m->speed * span, nothing);
  m->speed = fmax(m->speed, at_rest * m->length / span);
  return HK_OK;
}

/* A scale below the rounding of the numbers themselves could not be met. */
static void weigh(const double *x, double *weight, size_t count, size_t stride, double tol, double scale) {
  double least = fmax(tol * scale, rounding * peak(x, count, stride)), w = least > 0 ? 1 / least : 1;
  for (size_t i = 0; i < count; i++) weight[i * stride] = w;
}

int hk_sundials_weights(N_Vector X, N_Vector weight, void *self) {
  hk_sundials *m = self;
  const hk_system *s = m->system;
  double *x = NV_DATA_S(X), *w = NV_DATA_S(weight);
  size_t v = 3 * s->n, number = 0;
  rescale(m, x);
  weigh(x, w, v, 1, s->tol, components * m->length);
  weigh(x + v, w + v, v, 1, s->tol, components * m->speed);
  for (size_t e = 0; e < v; e++)
    if (!(s->model->inverse_mass[e / 3] > 0)) w[e] = w[v + e] = no_weight;
  for (size_t c = 0; c < m->channels; c++) {
    const hk_channel *channel = &s->model->channel[c];
    for (size_t k = 0; k < channel->size; k++, number++) {
      size_t at = (6 + channel->offset) * s->n + k;
      weigh(x + at, w + at, s->n, channel->size, s->tol, m->channel[number]);
    }
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

bool hk_sundials_follows(hk_sundials *m, hk_system *s, double tol) {
  size_t v = 3 * s->n;
  double *X = m->state;
  if (memcmp(X, s->X, s->size * sizeof *X) == 0) return true;
  s->impose(s, s->t, X, X + v);
  double away = fmax(distance(X, s->X, v, m->length), distance(X + v, s->X + v, v, m->speed));
  if (!(away <= tol)) return false;
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
