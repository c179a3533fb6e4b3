/* Sums by the tree, group by group: what a list names is summed for the blocks of the group. A group's sums have the
 * order of its walk, so they have the same bits for any number of threads. */
#include "plugins/common/gravity/tree/tree_sum.h"
#include "plugins/common/gravity/tree/single_sum.h"
#include "plugins/common/gravity/tree/tree_walk.h"

#include <string.h>

enum { BLOCK = HK_GRAVITY_BLOCK };

/* R/r at most, of the walk for the stiffness, which is a bound, and the looser the larger this is. */
static const double stiff = 0.25;

/* The sums of one group. */
typedef struct job {
  const hk_gravity_tree *tree;
  const hk_gravity_bodies *g;
  hk_group group;
  size_t blocks;
  hk_targets at[HK_GROUP_BLOCKS];
  hk_pull pull[HK_GROUP_BLOCKS];
  double sum[HK_GROUP]; /* of potential or stiffness */
  hk_walk_list list;
} job;

typedef struct task {
  hk_tree_pulls pulls;
  double G, *out;
} task;

static void open_job(job *j, const hk_tree_pulls *t, size_t index) {
  memset(j->pull, 0, sizeof j->pull);
  memset(j->sum, 0, sizeof j->sum);
  j->tree = t->tree;
  j->g = t->g;
  j->group = hk_group_of(t->tree, t->g, index);
  j->blocks = (j->group.count + BLOCK - 1) / BLOCK;
  for (size_t b = 0; b < j->blocks; b++) {
    size_t left = j->group.count - b * BLOCK;
    hk_gravity_targets(t->g, j->group.first + b * BLOCK, left < BLOCK ? left : BLOCK, &j->at[b]);
  }
}

static void over_groups(const hk_tree_pulls *t, void (*body)(void *, size_t, size_t, size_t), void *context) {
  t->g->host->parallel_for(t->g->host, t->tree->groups, 1, body, context);
}

/* ---- the parts of a list ---- */

static void pull_of_ranges(job *j, const hk_walk_list *l) {
  for (size_t b = 0; b < j->blocks; b++)
    for (size_t r = 0; r < l->ranges; r++)
      j->g->path->pull(&j->g->at, l->range[r][0], l->range[r][1], &j->at[b], j->g->eps2, &j->pull[b]);
}

static void pull_of_list(void *context, const hk_walk_list *l) {
  job *j = context;
  for (size_t b = 0; b < j->blocks; b++)
    j->g->path->pull_of_cells((const double(*)[HK_CELL_NUMBERS])j->tree->moment, l->cell, l->cells, &j->at[b],
                              j->g->eps2, &j->pull[b]);
  pull_of_ranges(j, l);
}

/* ---- forces ---- */

static void pull_group(job *j, const hk_tree_pulls *t, size_t index) {
  open_job(j, t, index);
  j->group.factor = hk_tree_factor(t, index);
  hk_tree_walk(t->tree, &j->group, HK_WALK_NEEDS, &j->list, pull_of_list, j);
}

static bool is_finite(const job *j) {
  double all = 0;
  for (size_t l = 0; l < j->group.count; l++)
    for (size_t c = 0; c < 3; c++) all += 0 * j->pull[l / BLOCK].a[c][l % BLOCK];
  return all == 0;
}

size_t hk_tree_pull(const hk_tree_pulls *t, size_t index, double (*a)[3]) {
  job j;
  if (t->tree->single && hk_single_pull(t, index, a)) return 0;
  size_t met = 0;
  pull_group(&j, t, index);
  if (!is_finite(&j)) { /* estimates of roots may leave the range of floats, see direct_sum.c */
    hk_gravity_bodies plain = *t->g;
    hk_tree_pulls again = *t;
    plain.path = hk_gravity_path_of(2);
    again.g = &plain;
    pull_group(&j, &again, index);
  }
  for (size_t l = 0; l < j.group.count; l++) {
    for (size_t c = 0; c < 3; c++) a[l][c] = j.pull[l / BLOCK].a[c][l % BLOCK];
    if (met == 0 && j.pull[l / BLOCK].zeros[l % BLOCK] > 1) met = 1 + j.group.first + l;
  }
  return met;
}

static void force_groups(void *context, size_t begin, size_t end, size_t chunk) {
  task *t = context;
  const hk_gravity_bodies *g = t->pulls.g;
  size_t met = 0;
  for (size_t index = begin; index < end; index++) {
    size_t first = t->pulls.tree->group[index], count = t->pulls.tree->group[index + 1] - first;
    double a[HK_GROUP][3];
    size_t here = hk_tree_pull(&t->pulls, index, a);
    if (met == 0) met = here;
    for (size_t l = 0; l < count; l++) {
      double f = t->G * g->at.m[first + l] * (g->scale * g->scale);
      for (size_t c = 0; c < 3; c++) t->out[3 * (size_t)g->order[first + l] + c] += f * a[l][c];
    }
  }
  g->part[chunk] = (double)met;
}

bool hk_tree_forces(hk_gravity_tree *tree, hk_gravity_bodies *g, const hk_tree_accuracy *accuracy, double G,
                    double *F) {
  task t = {hk_tree_pulls_of(tree, g, accuracy), G, F};
  memset(g->part, 0, g->parts * sizeof *g->part);
  over_groups(&t.pulls, force_groups, &t);
  return hk_gravity_apart(g, tree->groups);
}

/* ---- sums of one number: the group's own bodies apart from the others, since none acts on itself ---- */

static void scalar_of_ranges(job *j, const hk_walk_list *l, int power) {
  uint32_t first = (uint32_t)j->group.first, last = (uint32_t)(j->group.first + j->group.count);
  for (size_t b = 0; b < j->blocks; b++)
    for (size_t r = 0; r < l->ranges; r++) {
      uint32_t begin = l->range[r][0], end = l->range[r][1];
      uint32_t until = begin < first ? (end < first ? end : first) : begin,
               from = end > last ? (begin > last ? begin : last) : end;
      j->g->path->scalar(&j->g->at, begin, until, &j->at[b], j->g->eps2, power, j->sum + b * BLOCK);
      j->g->path->scalar(&j->g->at, from, end, &j->at[b], j->g->eps2, power, j->sum + b * BLOCK);
    }
}

static void scalar_of_group(job *j, int power) {
  for (size_t k = 0; k < j->group.count; k++)
    for (size_t l = 0; l < j->group.count; l++) {
      double w = l == k ? 0 : 1 / hk_gravity_distance(j->g, j->group.first + l, j->group.first + k);
      j->sum[k] += j->g->at.m[j->group.first + l] * (power == 3 ? w * w * w : w);
    }
}

static void potential_of_list(void *context, const hk_walk_list *l) {
  job *j = context;
  for (size_t b = 0; b < j->blocks; b++)
    j->g->path->potential_of_cells((const double(*)[HK_CELL_NUMBERS])j->tree->moment, l->cell, l->cells, &j->at[b],
                                   j->g->eps2, j->sum + b * BLOCK);
  scalar_of_ranges(j, l, 1);
}

static void energy_groups(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  job j;
  (void)chunk;
  for (size_t index = begin; index < end; index++) {
    double sum = 0;
    open_job(&j, &t->pulls, index);
    j.group.factor = hk_tree_factor(&t->pulls, index);
    hk_tree_walk(t->pulls.tree, &j.group, HK_WALK_NEEDS, &j.list, potential_of_list, &j);
    scalar_of_group(&j, 1);
    for (size_t l = 0; l < j.group.count; l++) sum += j.g->at.m[j.group.first + l] * j.sum[l];
    j.g->part[index] = sum;
  }
}

double hk_tree_energy(hk_gravity_tree *tree, hk_gravity_bodies *g, const hk_tree_accuracy *accuracy, double G) {
  task t = {hk_tree_pulls_of(tree, g, accuracy), G, NULL};
  double sum = 0;
  over_groups(&t.pulls, energy_groups, &t);
  for (size_t k = 0; k < tree->groups; k++) sum += g->part[k];
  return -G * g->scale * sum / 2;
}

/* What a cell adds to the stiffness at most: all of it at its nearest, r - R instead of r. */
static double at_its_nearest(const job *j, uint32_t cell) {
  const hk_walk_cell *c = &j->tree->walk[cell];
  return pow(1 - sqrt(c->radius2 / hk_group_distance2(&j->group, c)), -3);
}

static void stiffness_of_list(void *context, const hk_walk_list *l) {
  job *j = context;
  hk_walk_points p;
  hk_walk_points_of(j->tree, l, &p);
  for (size_t k = 0; k < l->cells; k++) p.at.m[k] *= at_its_nearest(j, l->cell[k]);
  for (size_t b = 0; b < j->blocks; b++)
    j->g->path->scalar(&p.at, 0, l->cells, &j->at[b], j->g->eps2, 3, j->sum + b * BLOCK);
  scalar_of_ranges(j, l, 3);
}

static void stiffness_groups(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const double scale = t->pulls.g->scale;
  job j;
  (void)chunk;
  for (size_t index = begin; index < end; index++) {
    open_job(&j, &t->pulls, index);
    j.group.factor = stiff * stiff;
    hk_tree_walk(t->pulls.tree, &j.group, HK_WALK_RADII, &j.list, stiffness_of_list, &j);
    scalar_of_group(&j, 3);
    for (size_t l = 0; l < j.group.count; l++) t->out[j.group.first + l] = t->G * scale * scale * scale * j.sum[l];
  }
}

void hk_tree_stiffness(hk_gravity_tree *tree, hk_gravity_bodies *g, double G, double *pull) {
  task t = {{tree, g, NULL, 0}, G, pull};
  over_groups(&t.pulls, stiffness_groups, &t);
}
