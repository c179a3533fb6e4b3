/* The springs of a layout, part by part: runs and lists by the widest vectors of this processor, the few remaining
 * springs one by one with the same operations. */
#include "plugins/common/springs/spring_kernel.h"
#include "plugins/common/springs/spring_path.h"

enum { LANES = HK_SPRING_LANES, WIDEST = HK_SPRING_WIDEST, BLOCK = HK_SPRING_BLOCK, FAR = HK_SPRING_FAR };

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
} task;

/* `count` springs of a run from its t-th on. */
static double single(const task *t, const hk_spring_run *run, size_t from, size_t count) {
  const hk_spring_layout *s = t->layout;
  double sum = 0;
  for (size_t q = from; q < from + count; q++) {
    uint32_t end[2];
    hk_spring_ends(s, run, q, end);
    size_t i = 3 * (size_t)end[0], j = 3 * (size_t)end[1], e = run->begin + q;
    const double *xi = t->x + i, *xj = t->x + j, *vi = t->v + i, *vj = t->v + j;
    double *Fi = t->F + i, *Fj = t->F + j;
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

static hk_spring_numbers numbers_from(const hk_spring_numbers *all, size_t e) {
  return (hk_spring_numbers){all->k + (e & all->each_k),
                             all->c + (e & all->each_c),
                             all->L + (e & all->each_L),
                             all->each_k,
                             all->each_c,
                             all->each_L};
}

/* n springs of a run from its t-th on. */
static double one_block(const task *t, const hk_spring_numbers *all, const hk_spring_run *run, size_t from, size_t n) {
  const hk_spring_layout *s = t->layout;
  const hk_spring_numbers q = numbers_from(all, run->begin + from);
  size_t i = 3 * (run->i + from), j = 3 * (run->j + from), apart = i < j ? j - i : i - j;
  return (apart >= 3 * FAR ? t->path->far_run : t->path->near_run)(&q, n, t->x + i, t->x + j, t->v + i, t->v + j,
                                                                   t->F + i, t->F + j, s->damped);
}

static double one_list(const task *t, const hk_spring_numbers *all, const hk_spring_run *run) {
  const hk_spring_layout *s = t->layout;
  const hk_spring_numbers q = numbers_from(all, run->begin);
  const hk_spring_list list = {run->count, (const uint32_t(*)[2])s->pair + run->pair, s->lanes + run->lanes};
  return t->path->list(&q, &list, t->x, t->v, t->F, s->damped);
}

static double one_run(const task *t, const hk_spring_numbers *q, const hk_spring_run *run) {
  if (run->kind == HK_SPRING_LIST) return one_list(t, q, run);
  size_t whole = run->kind == HK_SPRING_SINGLE ? 0 : run->count / LANES * LANES;
  double power = 0;
  for (size_t e = 0; e < whole; e += BLOCK) power += one_block(t, q, run, e, whole - e < BLOCK ? whole - e : BLOCK);
  return power + single(t, run, whole, run->count - whole);
}

static double one_part(const task *t, size_t part) {
  const hk_spring_layout *s = t->layout;
  double k[WIDEST], c[WIDEST], L[WIDEST], power = 0;
  hk_spring_numbers q = {s->each_k ? s->k : k,       s->each_c ? s->c : c,       s->each_L ? s->L : L,
                         s->each_k ? ~(size_t)0 : 0, s->each_c ? ~(size_t)0 : 0, s->each_L ? ~(size_t)0 : 0};
  for (int r = 0; r < WIDEST; r++) k[r] = *s->k, c[r] = *s->c, L[r] = *s->L;
  for (size_t r = s->part[part]; r < s->part[part + 1]; r++) power += one_run(t, &q, &s->run[r]);
  return power;
}

static const hk_spring_path *widest_path(void) {
  const hk_spring_path *wide8 = hk_spring_wide8(), *wide = wide8 ? wide8 : hk_spring_wide();
  return wide ? wide : &hk_spring_narrow;
}

static task begin(const hk_spring_layout *s, const double *x, const double *v, double *F) {
  return (task){s, widest_path(), x, v, F};
}

void hk_spring_part(const hk_spring_layout *s, size_t part, const double *x, const double *v, double *F,
                    double *power) {
  task t = begin(s, x, v, F);
  double p = one_part(&t, part);
  if (power) *power -= p;
}

static void sum_part(const void *context, size_t part) {
  const task *t = context;
  t->layout->power[part] = one_part(t, part);
}

void hk_spring_forces(const hk_spring_layout *s, const hk_host *host, const double *x, const double *v, double *F,
                      double *power) {
  if (s->count == 0) return;      /* also of a layout that was not built */
  if (s->partition.blocks == 1) { /* a small scene: no threads */
    hk_spring_part(s, 0, x, v, F, power);
    return;
  }
  task t = begin(s, x, v, F);
  hk_parts_each(host, &s->partition, s->part, sum_part, &t);
  for (size_t p = 0; power && p < s->partition.parts; p++)
    if (s->part[p] < s->part[p + 1]) *power -= s->power[p];
}
