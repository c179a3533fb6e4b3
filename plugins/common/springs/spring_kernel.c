/* The springs of a layout, group by group: runs and lists by the widest vectors of this processor, the few remaining
 * springs one by one with the same operations. */
#include "plugins/common/springs/spring_kernel.h"
#include "plugins/common/springs/spring_path.h"

enum { LANES = HK_SPRING_LANES, WIDEST = HK_SPRING_WIDEST, BLOCK = HK_SPRING_BLOCK };

static inline double scale(double l2, double w, double k, double c, double L, double *p) {
  double safe = l2 > HK_SPRING_TINY ? l2 : 1, l = sqrt(safe), r = 1 / safe, cwr = c * w * r;
  *p += cwr * w;
  return k * (l - L) * l * r + cwr;
}

typedef struct task {
  const hk_spring_layout *layout;
  const hk_spring_path *path;
  const double *x, *v;
  double *F;
  size_t first_group;
} task;

static double single(const task *t, size_t begin, size_t count) {
  const hk_spring_layout *s = t->layout;
  double sum = 0;
  for (size_t e = begin; e < begin + count; e++) {
    const double *xi = t->x + 3 * (size_t)s->pair[e][0], *xj = t->x + 3 * (size_t)s->pair[e][1];
    const double *vi = t->v + 3 * (size_t)s->pair[e][0], *vj = t->v + 3 * (size_t)s->pair[e][1];
    double *Fi = t->F + 3 * (size_t)s->pair[e][0], *Fj = t->F + 3 * (size_t)s->pair[e][1];
    double dx = xj[0] - xi[0], dy = xj[1] - xi[1], dz = xj[2] - xi[2];
    double w = s->damped ? dx * (vj[0] - vi[0]) + dy * (vj[1] - vi[1]) + dz * (vj[2] - vi[2]) : 0;
    double f = scale(dx * dx + dy * dy + dz * dz, w, s->k[s->each_k ? e : 0], s->c[s->each_c ? e : 0],
                     s->L[s->each_L ? e : 0], &sum);
    Fi[0] += f * dx;
    Fi[1] += f * dy;
    Fi[2] += f * dz;
    Fj[0] -= f * dx;
    Fj[1] -= f * dy;
    Fj[2] -= f * dz;
  }
  return sum;
}

static double one_block(const task *t, const hk_spring_numbers *all, hk_spring_kind kind, size_t begin, size_t n) {
  const hk_spring_layout *s = t->layout;
  const uint32_t(*pair)[2] = (const uint32_t(*)[2])s->pair + begin;
  hk_spring_numbers q = *all;
  q.k += begin & q.each_k;
  q.c += begin & q.each_c;
  q.L += begin & q.each_L;
  if (kind == HK_SPRING_LIST) return t->path->list(&q, n, pair, t->x, t->v, t->F, s->damped);
  size_t i = 3 * (size_t)pair[0][0], j = 3 * (size_t)pair[0][1], apart = i < j ? j - i : i - j;
  return (apart > 3 * BLOCK ? t->path->far_run : t->path->near_run)(&q, n, t->x + i, t->x + j, t->v + i, t->v + j,
                                                                    t->F + i, t->F + j, s->damped);
}

static double one_run(const task *t, const hk_spring_numbers *q, const hk_spring_run *run) {
  size_t whole = run->kind == HK_SPRING_SINGLE ? 0 : run->count / LANES * LANES;
  double power = 0;
  for (size_t e = 0; e < whole; e += BLOCK)
    power += one_block(t, q, run->kind, run->begin + e, whole - e < BLOCK ? whole - e : BLOCK);
  return power + single(t, run->begin + whole, run->count - whole);
}

static void one_group(const task *t, size_t group) {
  const hk_spring_layout *s = t->layout;
  double k[WIDEST], c[WIDEST], L[WIDEST], power = 0;
  hk_spring_numbers q = {s->each_k ? s->k : k,       s->each_c ? s->c : c,       s->each_L ? s->L : L,
                         s->each_k ? ~(size_t)0 : 0, s->each_c ? ~(size_t)0 : 0, s->each_L ? ~(size_t)0 : 0};
  for (int r = 0; r < WIDEST; r++) k[r] = *s->k, c[r] = *s->c, L[r] = *s->L;
  for (size_t r = s->group[group]; r < s->group[group + 1]; r++) power += one_run(t, &q, &s->run[r]);
  s->group_power[group] = power;
}

static void groups(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  const task *t = context;
  for (size_t g = begin; g < end; g++) one_group(t, t->first_group + g);
}

static const hk_spring_path *widest_path(void) {
  const hk_spring_path *wide8 = hk_spring_wide8(), *wide = wide8 ? wide8 : hk_spring_wide();
  return wide ? wide : &hk_spring_narrow;
}

void hk_spring_forces(const hk_spring_layout *s, const hk_host *host, const double *x, const double *v, double *F,
                      double *power) {
  task t = {s, widest_path(), x, v, F, 0};
  if (s->runs == 1 && s->run[0].kind == HK_SPRING_SINGLE) { /* a small scene: no threads, no vectors */
    double p = single(&t, 0, s->count);
    if (power) *power -= p;
    return;
  }
  for (size_t r = 0; r < s->rounds; r++) {
    t.first_group = s->round[r];
    host->parallel_for(host, s->round[r + 1] - s->round[r], 1, groups, &t);
  }
  for (size_t g = 0; power && g < s->groups; g++) *power -= s->group_power[g];
}
