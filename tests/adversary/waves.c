/* Functions of time, in pieces that are smooth: value and rate in long double, the times where a piece ends, and the
 * same function in Lua. */
#include "tests/adversary/adversary.h"

#include <math.h>

adv_real adv_wave_at(const adv_wave *f, adv_real t, adv_real inside, adv_real *rate) {
  adv_real a = f->a, b = f->b, w = f->w, t0 = f->t0, t1 = f->t1, u;
  *rate = 0;
  switch (f->shape) {
  case ADV_CONSTANT:
    return b;
  case ADV_SINE:
    *rate = a * w * cosl(w * (t + t0) + t1);
    return b + a * sinl(w * (t + t0) + t1);
  case ADV_PULSE:
    return inside >= t0 && inside < t1 ? b + a : b;
  case ADV_TRAIN:
    u = inside - t0;
    return u - w * floorl(u / w) < t1 ? b + a : b;
  case ADV_RAMP:
    if (inside < t0) return b;
    if (inside >= t1) return b + a * (t1 - t0);
    *rate = a;
    return b + a * (t - t0);
  case ADV_JUMP:
    return inside >= t0 ? b + a : b;
  case ADV_BUMP:
    u = (t - t0) / w;
    *rate = -2 * u / w * a * expl(-u * u);
    return b + a * expl(-u * u);
  }
  return 0;
}

void adv_wave_cuts(const adv_wave *f, adv_real end, void (*cut)(void *, adv_real), void *context) {
  adv_real widths[] = {-8, -4, -2, -1, 0, 1, 2, 4, 8};
  adv_real w = f->w, t0 = f->t0, t1 = f->t1;
  if (f->shape == ADV_PULSE || f->shape == ADV_RAMP || f->shape == ADV_JUMP) cut(context, t0);
  if (f->shape == ADV_PULSE || f->shape == ADV_RAMP) cut(context, t1);
  for (int k = 0; k < 9 && f->shape == ADV_BUMP; k++) cut(context, t0 + widths[k] * w);
  for (adv_real k = floorl(-t0 / w); f->shape == ADV_TRAIN && t0 + k * w < end; k++)
    cut(context, t0 + k * w), cut(context, t0 + k * w + t1);
}

void adv_wave_write(const adv_wave *f, const char *name, FILE *out) {
  fprintf(out, "local a, b, w, t0, t1 = %.17g, %.17g, %.17g, %.17g, %.17g\n", f->a, f->b, f->w, f->t0, f->t1);
  const char *value = "b", *rate = "0";
  switch (f->shape) {
  case ADV_CONSTANT:
    break;
  case ADV_SINE:
    value = "b + a * math.sin(w * (t + t0) + t1)", rate = "a * w * math.cos(w * (t + t0) + t1)";
    break;
  case ADV_PULSE:
    value = "b + (t >= t0 and t < t1 and a or 0)";
    break;
  case ADV_TRAIN:
    value = "b + ((t - t0) % w < t1 and a or 0)";
    break;
  case ADV_RAMP:
    value = "b + a * (math.min(math.max(t, t0), t1) - t0)", rate = "(t >= t0 and t < t1 and a or 0)";
    break;
  case ADV_JUMP:
    value = "b + (t >= t0 and a or 0)";
    break;
  case ADV_BUMP:
    value = "b + a * math.exp(-((t - t0) / w) ^ 2)";
    rate = "-2 * (t - t0) / w ^ 2 * a * math.exp(-((t - t0) / w) ^ 2)";
    break;
  }
  fprintf(out, "function %s(t) return %s end\nfunction %s_rate(t) return %s end\n", name, value, name, rate);
}
