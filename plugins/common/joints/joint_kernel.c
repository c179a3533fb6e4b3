/* Forces of joints, the formulas of joint.c without unit vectors: with s = |e_1 x e_2|, b = e_1 x e_2, z the moment,
 *     z grad_1 angle = (z/s) e_1 x b/|e_1|^2,    z grad_2 angle = (z/s) b x e_2/|e_2|^2,
 * (in a plane 1 and its normal for s and b), which go to i as they are and to k reversed; j gets what is left. Blocks
 * of joints are gathered, computed in loops that compilers turn into vectors, and scattered in order. Every width of
 * vectors does the same operations, so their results are bitwise equal.
 *
 * Where b = 0 there is no force: the energy of a joint straight at rest has no slope there. Its damping is that of the
 * direction that joint.c picks, so such joints go through there; they are few once a chain moves. */
#include "plugins/common/joints/joint_kernel.h"
#include "plugins/common/joints/joint.h"
#include "plugins/common/joints/joint_angle.h"

#include <float.h>
#include <string.h>

enum { BLOCK = 64 };

typedef struct block {
  double e[2][3][BLOCK], u[2][3][BLOCK]; /* edges, m, and their rates, m/s */
  double k[BLOCK], c[BLOCK], rest[BLOCK];
  double f[2][3][BLOCK]; /* z grad_m angle, N */
  double power[BLOCK];   /* W, taken by damping */
  double sine[BLOCK];    /* s; 0: no direction */
} block;

/* One loop of all, so that every number stays in its register. */
HK_INLINE void compute(block *q, const double *plane, bool damped) {
  const double pi = 3.14159265358979323846;
  for (int r = 0; r < BLOCK; r++) {
    double x1 = q->e[0][0][r], y1 = q->e[0][1][r], z1 = q->e[0][2][r];
    double x2 = q->e[1][0][r], y2 = q->e[1][1][r], z2 = q->e[1][2][r];
    double bx, by, bz, s, sine, cosine, off;
    if (plane) {
      bx = plane[0], by = plane[1], bz = plane[2];
      double d1 = x1 * bx + y1 * by + z1 * bz, d2 = x2 * bx + y2 * by + z2 * bz;
      x1 -= d1 * bx, y1 -= d1 * by, z1 -= d1 * bz;
      x2 -= d2 * bx, y2 -= d2 * by, z2 -= d2 * bz;
      sine = bx * (y1 * z2 - z1 * y2) + by * (z1 * x2 - x1 * z2) + bz * (x1 * y2 - y1 * x2);
      s = 1;
    } else {
      bx = y1 * z2 - z1 * y2, by = z1 * x2 - x1 * z2, bz = x1 * y2 - y1 * x2;
      sine = sqrt(bx * bx + by * by + bz * bz);
      s = sine > 0 ? sine : 1;
    }
    cosine = x1 * x2 + y1 * y2 + z1 * z2;
    double l1 = x1 * x1 + y1 * y1 + z1 * z1, l2 = x2 * x2 + y2 * y2 + z2 * z2;
    bool fine = l1 >= DBL_MIN && l2 >= DBL_MIN;
    double r1 = fine ? 1 / (s * l1) : 0, r2 = fine ? 1 / (s * l2) : 0;
    off = hk_joint_angle(sine, cosine) - q->rest[r];
    if (plane) off = off > pi ? off - 2 * pi : off < -pi ? off + 2 * pi : off;
    double gx1 = r1 * (y1 * bz - z1 * by), gy1 = r1 * (z1 * bx - x1 * bz), gz1 = r1 * (x1 * by - y1 * bx);
    double gx2 = r2 * (by * z2 - bz * y2), gy2 = r2 * (bz * x2 - bx * z2), gz2 = r2 * (bx * y2 - by * x2);
    double z = q->k[r] * off;
    if (damped) {
      double rate = gx1 * q->u[0][0][r] + gy1 * q->u[0][1][r] + gz1 * q->u[0][2][r] + gx2 * q->u[1][0][r] +
                    gy2 * q->u[1][1][r] + gz2 * q->u[1][2][r];
      z += q->c[r] * rate;
      q->power[r] = q->c[r] * rate * rate;
    }
    q->sine[r] = plane ? 1 : sine;
    q->f[0][0][r] = z * gx1, q->f[0][1][r] = z * gy1, q->f[0][2][r] = z * gz1;
    q->f[1][0][r] = z * gx2, q->f[1][1][r] = z * gy2, q->f[1][2][r] = z * gz2;
  }
}

HK_INLINE void compute_kind(block *q, const double *plane, bool damped) {
  if (plane && damped)
    compute(q, plane, true);
  else if (plane)
    compute(q, plane, false);
  else if (damped)
    compute(q, NULL, true);
  else
    compute(q, NULL, false);
}

HK_VERSIONS(static void, compute_many, (block * q, const double *plane, bool damped), compute_kind(q, plane, damped))

typedef struct task {
  const hk_joint_layout *layout;
  const hk_view *view;
  const double *plane;
  double *F;
  void (*compute)(block *, const double *plane, bool damped);
} task;

/* The differences of joints begin to begin + count of one array; lanes beyond get those of the first. */
static void gather(const task *t, const double *from, size_t begin, size_t count, double into[2][3][BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) {
    const uint32_t *node = t->layout->node[begin + (r < count ? r : 0)];
    const double *i = from + 3 * (size_t)node[0], *j = from + 3 * (size_t)node[1], *k = from + 3 * (size_t)node[2];
    for (int c = 0; c < 3; c++) into[0][c][r] = j[c] - i[c], into[1][c][r] = k[c] - j[c];
  }
}

/* The damping of a joint that is straight: joint.c picks its plane. */
static void straight(const task *t, size_t e, block *q, size_t r) {
  hk_joint joint;
  hk_joint_measure(t->view->x, t->layout->node[e], NULL, t->layout->rest[e] == 0, &joint);
  double rate = 0;
  for (int m = 0; m < 2; m++)
    for (int c = 0; c < 3; c++) rate += joint.l[m] > 0 ? joint.across[m][c] / joint.l[m] * q->u[m][c][r] : 0;
  q->power[r] = q->c[r] * rate * rate;
  for (int m = 0; m < 2; m++)
    for (int c = 0; c < 3; c++) q->f[m][c][r] = joint.l[m] > 0 ? q->c[r] * rate * joint.across[m][c] / joint.l[m] : 0;
}

static void take(const double *from, size_t begin, size_t count, double into[BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) into[r] = from[begin + (r < count ? r : 0)];
}

static double one_block(const task *t, size_t begin, size_t count) {
  const hk_joint_layout *s = t->layout;
  block q;
  double power = 0;
  gather(t, t->view->x, begin, count, q.e);
  take(s->k, begin, count, q.k);
  take(s->rest, begin, count, q.rest);
  if (s->damped) gather(t, t->view->v, begin, count, q.u);
  if (s->damped) take(s->c, begin, count, q.c);
  t->compute(&q, t->plane, s->damped);
  for (size_t r = 0; r < count; r++) {
    if (s->damped && q.sine[r] == 0) straight(t, begin + r, &q, r);
    if (s->damped) power += q.power[r];
    double *Fi = t->F + 3 * (size_t)s->node[begin + r][0], *Fj = t->F + 3 * (size_t)s->node[begin + r][1],
           *Fk = t->F + 3 * (size_t)s->node[begin + r][2];
    for (int c = 0; c < 3; c++) {
      Fi[c] += q.f[0][c][r];
      Fj[c] += q.f[1][c][r] - q.f[0][c][r];
      Fk[c] -= q.f[1][c][r];
    }
  }
  return power;
}

/* The joints of a part lie one after the other. */
static double add_items(const void *context, const hk_view *view, const uint32_t *item, size_t count, double *F) {
  task t = *(const task *)context;
  double power = 0;
  t.view = view, t.F = F;
  for (size_t e = 0; e < count; e += BLOCK) power -= one_block(&t, item[e], count - e < BLOCK ? count - e : BLOCK);
  return power;
}

void hk_joint_forces(const hk_joint_layout *s, const hk_view *view, const double plane[3], size_t part, double *F) {
  const task t = {.layout = s, .plane = plane, .compute = HK_WIDEST(view->host->lanes, compute_many)};
  hk_part_sums_add(&s->sums, view, part, add_items, &t, F);
}

/* ---- layout ---- */

static void copy(hk_joint_layout *s, const hk_elements *from, size_t e) {
  memcpy(s->node[s->count], hk_tuple(&from->node, e), sizeof *s->node);
  s->element[s->count] = (uint32_t)e;
  s->k[s->count] = hk_tuple_value(&from->stiffness, e);
  s->c[s->count] = hk_tuple_value(&from->damping, e);
  s->rest[s->count] = hk_tuple_value(&from->rest, e);
  s->damped = s->damped || s->c[s->count] > 0;
  s->count++;
}

static bool reserve(hk_joint_layout *s, const hk_host *host, size_t count) {
  void *old[] = {s->node, s->element, s->k, s->c, s->rest};
  for (size_t k = 0; k < sizeof old / sizeof *old; k++) host->release(host, old[k]);
  *s = (hk_joint_layout){.sums = s->sums};
  s->node = host->allocate(host, (count + 1) * sizeof *s->node);
  s->element = host->allocate(host, (count + 1) * sizeof *s->element);
  s->k = host->allocate(host, (count + 1) * sizeof *s->k);
  s->c = host->allocate(host, (count + 1) * sizeof *s->c);
  s->rest = host->allocate(host, (count + 1) * sizeof *s->rest);
  return s->node && s->element && s->k && s->c && s->rest;
}

hk_status hk_joint_layout_build(hk_joint_layout *s, const hk_view *view, const hk_elements *from) {
  const hk_host *host = view->host;
  if (!reserve(s, host, from->node.count))
    return host->fail(host, HK_NO_MEMORY, "no memory for %zu joints", from->node.count);
  hk_status status = hk_part_sums_sort(&s->sums, view, &from->node, NULL);
  for (uint32_t k = 0; status == HK_OK && k < s->sums.lists.count; k++) {
    copy(s, from, s->sums.lists.item[k]);
    s->sums.lists.item[k] = k;
  }
  return status;
}
