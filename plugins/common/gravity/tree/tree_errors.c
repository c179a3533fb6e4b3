/* Four bodies of every so manieth group: the tree's sums are those of hk_tree_pull, which forces use. */
#include "plugins/common/gravity/tree/tree_errors.h"

#include <stdlib.h>

enum { BLOCK = HK_GRAVITY_BLOCK, SAMPLE_GROUPS = 64, EACH = 4, SAMPLE = EACH * SAMPLE_GROUPS };

/* Bodies with their sums of m d/s^3, scaled: by the tree, and exact. */
typedef struct pull_sample {
  uint32_t body[SAMPLE]; /* position in the order; UINT32_MAX: none */
  double found[SAMPLE][3], exact[SAMPLE][3];
} pull_sample;

typedef struct task {
  hk_tree_pulls pulls;
  size_t stride;
  pull_sample sample;
} task;

static void sum_exactly(const hk_gravity_bodies *g, const uint32_t *body, size_t count, double (*into)[3]) {
  hk_targets at;
  hk_pull sum = {0};
  for (size_t l = 0; l < BLOCK; l++) {
    size_t k = body[l < count ? l : 0];
    at.x[0][l] = g->at.x[k], at.x[1][l] = g->at.y[k], at.x[2][l] = g->at.z[k];
  }
  g->path->pull(&g->at, 0, g->count, &at, g->eps2, &sum);
  for (size_t l = 0; l < count; l++)
    for (size_t c = 0; c < 3; c++) into[l][c] = sum.a[c][l];
}

/* Bodies evenly spaced in a group. */
static void sample_groups(void *context, size_t begin, size_t end, size_t chunk) {
  task *t = context;
  const hk_gravity_tree *tree = t->pulls.tree;
  (void)chunk;
  for (size_t s = begin; s < end; s++) {
    size_t index = s * t->stride, first = tree->group[index], count = tree->group[index + 1] - first;
    double a[HK_GROUP][3];
    size_t each = count < EACH ? count : EACH;
    hk_tree_pull(&t->pulls, index, a);
    for (size_t e = 0; e < each; e++) {
      size_t l = (2 * e + 1) * count / (2 * each);
      t->sample.body[EACH * s + e] = (uint32_t)(first + l);
      for (size_t c = 0; c < 3; c++) t->sample.found[EACH * s + e][c] = a[l][c];
    }
    sum_exactly(t->pulls.g, t->sample.body + EACH * s, each, t->sample.exact + EACH * s);
  }
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double length(const double d[3]) { /* of any range */
  double most = fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2]))), sum = 0;
  if (!(most > 0) || !isfinite(most)) return most;
  for (size_t c = 0; c < 3; c++) sum += d[c] / most * (d[c] / most);
  return most * sqrt(sum);
}

/* The relative errors of the sample; adds their power, with G and the scale left out. */
static size_t compare(const pull_sample *t, const hk_gravity_bodies *g, const double *v, double *off, double *power) {
  size_t count = 0;
  for (size_t s = 0; s < SAMPLE; s++) {
    if (t->body[s] == UINT32_MAX) continue;
    const double *speed = v + 3 * (size_t)g->order[t->body[s]];
    double d[3], work = 0, size = length(t->exact[s]);
    for (size_t c = 0; c < 3; c++) d[c] = t->found[s][c] - t->exact[s][c], work += d[c] * speed[c];
    *power += g->at.m[t->body[s]] * fabs(work);
    off[count++] = size > 0 ? length(d) / size : 0;
  }
  return count;
}

static void errors_of(const pull_sample *t, const hk_gravity_bodies *g, double G, const double *v,
                      hk_force_errors *out) {
  double off[SAMPLE], power = 0, sum = 0;
  size_t count = compare(t, g, v, off, &power);
  *out = (hk_force_errors){.particles = count};
  if (count == 0) return;
  qsort(off, count, sizeof *off, by_size);
  for (size_t k = 0; k < count; k++) sum += off[k] * off[k];
  out->rms = sqrt(sum / (double)count);
  out->p99 = off[(count - 1) * 99 / 100];
  out->largest = off[count - 1];
  out->power = G * g->scale * g->scale * power * (double)g->count / (double)count;
}

void hk_tree_errors(hk_gravity_tree *tree, hk_gravity_bodies *g, const hk_tree_accuracy *accuracy, double G,
                    const double *v, hk_force_errors *out) {
  task t = {.pulls = hk_tree_pulls_of(tree, g, accuracy), .stride = tree->groups / SAMPLE_GROUPS + 1};
  for (size_t s = 0; s < SAMPLE; s++) t.sample.body[s] = UINT32_MAX;
  g->host->parallel_for(g->host, (tree->groups + t.stride - 1) / t.stride, 1, sample_groups, &t);
  errors_of(&t.sample, g, G, v, out);
}
