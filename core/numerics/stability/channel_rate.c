/* The largest rate of the channels, d(dy/dt)/dy, by power iteration on central differences in the largest norm: each
 * channel is scaled by its own largest value, all its numbers are perturbed at once by at most the difference step, and
 * the largest response is the rate. The first response does not count: in it a channel that others feed, and that feeds
 * none, is as fast as its scale is small. Where the rate of a number depends on that number alone, the second response
 * is exact; where neighbours are coupled (diffusion), the iteration approaches the largest eigenvalue from a start
 * vector of mixed signs. Channels that do not change, such as a radius, are left as they are: what others make of them
 * is no rate. The result is an estimate. */
#include "core/numerics/stability/channel_rate.h"
#include "core/numerics/stability/lanczos.h"

#include <string.h>

enum { STEPS = 6 };

static const double relative_step = 1e-6;

static double channel_scale(const double *y, size_t count) {
  double most = 0;
  for (size_t e = 0; e < count; e++) most = fmax(most, fabs(y[e]));
  return relative_step * (most > 0 ? most : 1);
}

/* One power iteration: the response to `direction`, in dy[0]; *largest: the largest magnitude in it. */
static hk_status compute_response(hk_system *system, const hk_channel_scratch *s, double *largest) {
  const hk_model *model = system->model;
  const double *y = system->X + 6 * system->n;
  for (int side = 0; side < 2; side++) {
    memcpy(s->x, system->X, 3 * system->n * sizeof *s->x);
    memcpy(s->v, system->X + 3 * system->n, 3 * system->n * sizeof *s->v);
    memcpy(s->y, y, (system->size - 6 * system->n) * sizeof *s->y);
    for (size_t k = 0; k < model->channels; k++) {
      size_t begin = model->channel[k].offset * system->n, count = model->channel[k].size * system->n;
      double step = channel_scale(y + begin, count) * (side == 0 ? 1 : -1);
      for (size_t e = begin; e < begin + count; e++) s->y[e] += step * s->direction[e];
    }
    hk_status status = system->accelerations(system, system->t, s->x, s->v, s->y, s->a, s->dy[side]);
    if (status != HK_OK) return status;
  }
  *largest = 0;
  for (size_t k = 0; k < model->channels; k++) {
    size_t begin = model->channel[k].offset * system->n, count = model->channel[k].size * system->n;
    double step = channel_scale(y + begin, count);
    for (size_t e = begin; e < begin + count; e++) {
      s->dy[0][e] = (s->dy[0][e] - s->dy[1][e]) / (2 * step);
      *largest = fmax(*largest, fabs(s->dy[0][e]));
    }
  }
  return HK_OK;
}

/* Sets the direction to 0 for channels without any response; whether there are such. */
static bool leave_constant(const hk_system *system, const hk_channel_scratch *s) {
  bool left = false;
  for (size_t k = 0; k < system->model->channels; k++) {
    size_t begin = system->model->channel[k].offset * system->n, count = system->model->channel[k].size * system->n;
    bool constant = true;
    for (size_t e = begin; e < begin + count; e++) constant &= s->dy[0][e] == 0;
    if (constant && count) memset(s->direction + begin, 0, count * sizeof *s->direction);
    left |= constant;
  }
  return left;
}

hk_status hk_bound_channel_rate(hk_system *system, const hk_channel_scratch *s, double *rate, size_t *evaluations) {
  size_t numbers = system->size - 6 * system->n;
  double before = 0;
  *rate = 0;
  hk_lanczos_random(s->direction, numbers);
  for (size_t e = 0; e < numbers; e++) s->direction[e] = s->direction[e] > 0 ? 1 : -1;
  for (int i = 0; i < STEPS; i++) {
    double largest;
    hk_status status = compute_response(system, s, &largest);
    if (status != HK_OK) return status;
    *evaluations += 2;
    if (i == 0 && largest > 0 && leave_constant(system, s)) continue; /* the others' own response is the next one */
    if (i > 0) *rate = fmax(*rate, largest);
    if (!(largest > 0) || fabs(largest - before) <= 1e-3 * largest) break; /* the rate has converged */
    for (size_t e = 0; e < numbers; e++) s->direction[e] = s->dy[0][e] / largest;
    before = largest;
  }
  return HK_OK;
}
