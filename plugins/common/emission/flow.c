#include "plugins/common/emission/flow.h"

hk_status hk_flow_check(const hk_flow *f, const hk_host *host) {
  for (size_t k = 1; k < f->burst_at.count; k++)
    if (f->burst_at.value[k] < f->burst_at.value[k - 1])
      return host->fail(host, HK_BAD_PARAM, "burst_at[%zu]: %g s is before the one before it, %g s", k + 1,
                        f->burst_at.value[k], f->burst_at.value[k - 1]);
  if (f->burst > 0 && f->burst_at.count == 0)
    return host->fail(host, HK_BAD_PARAM, "burst: when? burst_at = { 0.5, 1 } says it, in s");
  if (f->burst == 0 && f->burst_at.count > 0)
    return host->fail(host, HK_BAD_PARAM, "burst_at: how many are born then? burst = 100 says it");
  if (f->to <= f->from) return host->fail(host, HK_BAD_PARAM, "to: %g s is not after from: %g s", f->to, f->from);
  return HK_OK;
}

static hk_status ask(const hk_flow *f, const hk_host *host, int64_t cell, double *rate) {
  double t = f->from + (double)cell * f->cell;
  hk_status status = host->call(host, f->of_time, &t, 1, rate, 1);
  if (status == HK_OK && *rate < 0)
    return host->fail(host, HK_BAD_PARAM, "rate_of_time: %g births a second at t = %g s: it has to be 0 at least",
                      *rate, t);
  return status;
}

static hk_status begin(hk_flow *f, const hk_host *host) {
  if (f->asked) return HK_OK;
  f->asked = 1;
  hk_status status = ask(f, host, 0, &f->begin);
  return status == HK_OK ? ask(f, host, 1, &f->end) : status;
}

static double cell_starts(const hk_flow *f) { return f->from + (double)f->cells * f->cell; }
static double born_in_cell(const hk_flow *f) { return (f->begin + f->end) / 2 * f->cell; }

static hk_status go_on(hk_flow *f, const hk_host *host) {
  f->before += born_in_cell(f);
  f->begin = f->end;
  f->cells++;
  return ask(f, host, f->cells + 1, &f->end);
}

/* s from the start of the cell until `count` have been born in it: the root of a s^2 + b s = count that is not
 * negative, in the form without a difference of like numbers. */
static double when_in_cell(const hk_flow *f, double count) {
  double a = (f->end - f->begin) / (2 * f->cell), b = f->begin;
  double root = sqrt(fmax(b * b + 4 * a * count, 0));
  return count > 0 ? 2 * count / (b + root) : 0;
}

static hk_status next_of_function(hk_flow *f, const hk_host *host, int64_t k, double t, double *at) {
  hk_status status = begin(f, host);
  while (status == HK_OK && f->before + born_in_cell(f) <= (double)k && cell_starts(f) + f->cell <= t)
    status = go_on(f, host);
  if (status == HK_OK && f->before + born_in_cell(f) > (double)k)
    *at = cell_starts(f) + when_in_cell(f, (double)k - f->before);
  return status;
}

hk_status hk_flow_next(hk_flow *f, const hk_host *host, int64_t k, double t, double *at) {
  hk_status status = HK_OK;
  *at = INFINITY;
  if (f->of_time)
    status = next_of_function(f, host, k, t, at);
  else if (f->rate > 0)
    *at = f->from + (double)k / f->rate;
  if (*at >= f->to || *at > t) *at = INFINITY;
  return status;
}

double hk_flow_next_burst(const hk_flow *f) {
  size_t k = f->burst > 0 ? (size_t)(f->bursts / f->burst) : f->burst_at.count;
  return k < f->burst_at.count ? f->burst_at.value[k] : INFINITY;
}

static double births_of_bursts(const hk_flow *f, double t) {
  double count = -(double)f->bursts;
  for (size_t k = 0; k < f->burst_at.count; k++) count += f->burst_at.value[k] <= t ? (double)f->burst : 0;
  return count;
}

hk_status hk_flow_births(const hk_flow *f, const hk_host *host, int64_t k, double t, double *count) {
  double end = t < f->to || isnan(f->to) ? t : f->to, whole = (end - f->from) * f->rate;
  hk_flow ahead = *f;
  hk_status status = HK_OK;
  *count = births_of_bursts(f, t);
  if (!(end >= f->from)) return HK_OK;
  if (f->of_time) {
    status = begin(&ahead, host);
    while (status == HK_OK && cell_starts(&ahead) + f->cell <= end) status = go_on(&ahead, host);
    whole = ahead.before + born_in_cell(&ahead);
  }
  *count += fmax(0, whole - (double)k + 2);
  return status;
}
