/* How much of the lamp's light comes through the smoke to each cell. */
#include "plugins/common/volume/volume.h"

static const double deepest = 6; /* of optical depth: darker is dark */

double hk_volume_value(const hk_volume *v, const double *array, const double x[3]) {
  size_t at = 0;
  double f[3];
  for (int c = 0; c < 3; c++) {
    double s = (x[c] - v->low[c]) / v->spacing[c], most = (double)v->cells[c];
    if (s < 0 || s > most) return 0;
    s = fmax(1, fmin(most, s + 0.5)); /* the centre of cell 1 is at 0.5 */
    size_t i = s < most || most < 2 ? (size_t)s : v->cells[c] - 1;
    f[c] = s - (double)i;
    at += i * v->stride[c];
  }
  const double *a = array + at;
  const size_t *s = v->stride;
  double value[2];
  for (int k = 0; k < 2; k++, a += s[2]) {
    double low = a[0] + f[0] * (a[s[0]] - a[0]), high = a[s[1]] + f[0] * (a[s[1] + s[0]] - a[s[1]]);
    value[k] = low + f[1] * (high - low);
  }
  return value[0] + f[2] * (value[1] - value[0]);
}

typedef struct task {
  const hk_volume_draw *draw;
  double *light, step;
} task;

static double light_at(const task *t, const double from[3]) {
  const hk_volume_draw *d = t->draw;
  const hk_volume *v = d->volume;
  double depth = 0, x[3] = {from[0], from[1], from[2]};
  for (int n = 0; depth < deepest; n++) {
    bool inside = true;
    for (int c = 0; c < 3; c++) {
      x[c] += t->step * d->key[c];
      inside &= x[c] >= v->low[c] && x[c] <= v->low[c] + v->spacing[c] * (double)v->cells[c];
    }
    if (!inside) break;
    depth += d->optics->extinction * t->step * fmax(0, hk_volume_value(v, v->smoke, x));
  }
  return exp(-depth);
}

static void light_layers(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  const hk_volume *v = t->draw->volume;
  (void)piece;
  for (size_t k = begin; k < end; k++)
    for (size_t j = 0; j < v->cells[1]; j++)
      for (size_t i = 0; i < v->cells[0]; i++) {
        const size_t at[3] = {i, j, k};
        double x[3];
        size_t place = 0;
        for (int c = 0; c < 3; c++) {
          x[c] = v->low[c] + v->spacing[c] * ((double)at[c] + 0.5);
          place += (at[c] + 1) * v->stride[c];
        }
        t->light[place] = light_at(t, x);
      }
}

void hk_volume_light(const hk_volume_draw *d, double *light) {
  const double *s = d->volume->spacing;
  task t = {d, light, fmin(s[0], fmin(s[1], s[2]))};
  d->host->parallel_for(d->host, d->volume->cells[2], 1, light_layers, &t);
}
