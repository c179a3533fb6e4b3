/* The Hessian of a joint in the vectors e0, e1 of its edges, with the notation of rod_loops.h and angles that are
 * transported with the edges. With g_c = dk_c/de and m' = dm/de = kb/(2|e|),
 *     H = sum_c bend_c g_c g_c^T + twist m' m'^T + sum_c w_c k_c'' + T m''.
 * Of k'' the blocks are those of Bergou and others 2010 (as written out in Jawed, Novelia and O'Reilly 2018, A Primer
 * on the Kinematics of Discrete Elastic Rods), which are for the mean of the components on both edges; k is longer than
 * that by 1/cos(m/2), which at equal directors adds k m' m'^T/4. The first two terms are never negative (Gauss and
 * Newton): HK_WANT_DEFINITE leaves out the others.
 *
 * The angles of the sections follow the positions, which softens the rod: u.Hu is never below the second derivative of
 * the energy of least angles, and is equal to it where no directions of sections matter. What is left out joins all
 * particles of a rod with each other.
 *
 * The damping is the retardation times the first two terms, with the stiffness against rates of twist, less what its
 * sections' turning softens (rod_damping.c): its blocks, too, are never softer than it. How it changes with the
 * positions is left out of K. */
#include "plugins/common/rods/rods.h"
#include "plugins/common/rods/rod_joint.h"
#include "plugins/common/rods/rod_angles.h"
#include "plugins/kit/vector3.h"

enum { LANES = HK_ROD_LANES, GRAIN = 8 };

/* H += s p q^T, of 6 x 6 */
static void add_outer(double H[36], double s, const double p[6], const double q[6]) {
  for (int r = 0; r < 6; r++)
    for (int c = 0; c < 6; c++) H[6 * r + c] += s * p[r] * q[c];
}

/* The block of rows `a` and columns `b`, 0 or 1, of H. */
static double *block(double H[36], int a, int b) { return H + 18 * a + 3 * b; }

/* B[q r] += s p q^T */
static void add_product(double *B, double s, const double p[3], const double q[3]) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) B[6 * r + c] += s * p[r] * q[c];
}

static void add_unit(double *B, double s) {
  for (int r = 0; r < 3; r++) B[7 * r] += s;
}

/* sum_c w_c k_c'' */
static void add_bending(const hk_rod_joint *j, double H[36]) {
  double w0[3], w1[3], W[3], one[3], two[3], wk = j->w[0] * j->k[0] + j->w[1] * j->k[1];
  const double a = j->inverse[0] * j->inverse[0], b = j->inverse[1] * j->inverse[1], ab = j->inverse[0] * j->inverse[1];
  for (int q = 0; q < 3; q++) {
    w0[q] = j->w[0] * j->d[1][q] - j->w[1] * j->d[0][q];
    w1[q] = j->w[0] * j->e[1][q] - j->w[1] * j->e[0][q];
    W[q] = (w0[q] + w1[q]) / j->chi;
  }
  hk_cross(one, j->t1, W);
  hk_cross(two, j->t0, W);
  double *ee = block(H, 0, 0), *ff = block(H, 1, 1), *ef = block(H, 0, 1), *fe = block(H, 1, 0);
  double *const all[] = {ee, ff, ef, fe};
  const double scale[] = {a, b, ab, ab};
  for (int k = 0; k < 4; k++) add_product(all[k], 2 * wk * scale[k], j->mean, j->mean);
  add_product(ee, -a, one, j->mean), add_product(ee, -a, j->mean, one);
  add_product(ff, b, two, j->mean), add_product(ff, b, j->mean, two);
  add_product(ef, -ab, one, j->mean), add_product(ef, ab, j->mean, two);
  add_product(fe, -ab, j->mean, one), add_product(fe, ab, two, j->mean);
  add_unit(ee, -a * wk / j->chi), add_product(ee, a * wk / j->chi, j->t0, j->t0);
  add_unit(ff, -b * wk / j->chi), add_product(ff, b * wk / j->chi, j->t1, j->t1);
  add_unit(ef, -ab * wk / j->chi), add_product(ef, -ab * wk / j->chi, j->t0, j->t1);
  add_unit(fe, -ab * wk / j->chi), add_product(fe, -ab * wk / j->chi, j->t1, j->t0);
  add_product(ee, a / 4, j->kb, w0), add_product(ee, a / 4, w0, j->kb);
  add_product(ff, b / 4, j->kb, w1), add_product(ff, b / 4, w1, j->kb);
  for (int r = 0; r < 3; r++) { /* -[W] of rows e and columns f */
    int c = (r + 1) % 3, q = (r + 2) % 3;
    ef[6 * r + c] += ab * W[q], ef[6 * c + r] -= ab * W[q];
    fe[6 * c + r] += ab * W[q], fe[6 * r + c] -= ab * W[q];
  }
}

/* T m'' */
static void add_twisting(const hk_rod_joint *j, double H[36]) {
  double s0[3], s1[3], T = j->torque, ab = T * j->inverse[0] * j->inverse[1] / 2;
  const double a = -T * j->inverse[0] * j->inverse[0] / 4, b = -T * j->inverse[1] * j->inverse[1] / 4;
  for (int q = 0; q < 3; q++) s0[q] = j->t0[q] + j->mean[q], s1[q] = j->t1[q] + j->mean[q];
  double *ee = block(H, 0, 0), *ff = block(H, 1, 1), *ef = block(H, 0, 1), *fe = block(H, 1, 0);
  add_product(ee, a, j->kb, s0), add_product(ee, a, s0, j->kb);
  add_product(ff, b, j->kb, s1), add_product(ff, b, s1, j->kb);
  add_product(ef, -ab, j->kb, j->mean), add_product(fe, -ab, j->mean, j->kb);
  for (int r = 0; r < 3; r++) { /* 2/chi [t0] of rows e and columns f */
    int c = (r + 1) % 3, q = (r + 2) % 3;
    double t = 2 * ab / j->chi * j->t0[q];
    ef[6 * r + c] -= t, ef[6 * c + r] += t;
    fe[6 * c + r] -= t, fe[6 * r + c] += t;
  }
}

static void hessian(const hk_rod_joint *j, bool definite, double H[36]) {
  double g[2][6], m[6];
  hk_rod_joint_gradients(j, g, m);
  for (int q = 0; q < 36; q++) H[q] = 0;
  for (int c = 0; c < 2; c++) add_outer(H, j->bend[c], g[c], g[c]);
  add_outer(H, j->twist, m, m);
  if (definite) return;
  add_outer(H, (j->w[0] * j->k[0] + j->w[1] * j->k[1]) / 4, m, m);
  add_bending(j, H);
  if (j->torque != 0) add_twisting(j, H);
}

/* The block of nodes i and k (0 to 2) of the joint: edges are differences of nodes. */
static double of_nodes(const double H[36], int i, int k, int q) {
  double sum = 0;
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) {
      double sign = (i == a ? -1 : i == a + 1 ? 1 : 0) * (k == b ? -1 : k == b + 1 ? 1 : 0);
      sum += sign * H[6 * (3 * a + q / 3) + 3 * b + q % 3];
    }
  return sum;
}

/* The particles of joint k. */
static void nodes_of(const hk_rods *r, const hk_rod_batch *b, size_t lane, size_t k, uint32_t node[3]) {
  const uint32_t *at = r->rows.node + (b->first + b->number) * LANES + lane;
  node[0] = at[k * LANES];
  node[1] = at[(k + 1) * LANES];
  node[2] = k + 2 <= b->count[lane] ? at[(k + 2) * LANES] : at[LANES];
}

void hk_rod_blocks_pattern(const hk_rods *r, hk_pattern *p) {
  for (size_t q = 0; q < r->batches; q++)
    for (size_t lane = 0; lane < LANES; lane++)
      for (size_t k = 0; k < hk_rod_joints(&r->batch[q], lane); k++) {
        uint32_t node[3];
        nodes_of(r, &r->batch[q], lane, k, node);
        for (int c = 0; c < 9; c++) p->block(p, node[c / 3], node[c % 3]);
      }
  if (r->spins.count)
    hk_rod_spins_pattern(r, p);
  else if (r->jacobian == HK_ROD_EXACT)
    hk_rod_relaxed_pattern(r, p);
}

typedef struct task {
  const hk_rods *rods;
  const hk_blocks *into;
} task;

/* The second derivatives of a joint to the blocks of its nodes. */
static void add_joint(const hk_rod_joint *j, bool definite, const size_t *slot, double *to) {
  double H[36];
  hessian(j, definite, H);
  for (int c = 0; c < 9; c++)
    for (int e = 0; e < 9; e++) to[9 * slot[c] + (size_t)e] += of_nodes(H, c / 3, c % 3, e);
}

/* Slots follow the pattern: every lane of a batch has room for its joints in order. */
static void add_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  const hk_rods *r = t->rods;
  (void)chunk;
  for (size_t q = first; q < end; q++) {
    const hk_rod_batch *b = &r->batch[q];
    const size_t *slot = t->into->slot + 9 * b->joint;
    for (size_t lane = 0; lane < LANES; lane++)
      for (size_t k = 0; k < hk_rod_joints(b, lane); k++, slot += 9) {
        hk_rod_joint j;
        hk_rod_joint_at(r, b, lane, k, &j);
        add_joint(&j, t->into->want & HK_WANT_DEFINITE, slot, t->into->K);
        if (!(r->retardation > 0)) continue;
        hk_rod_joint_damping(r, (b->first + k) * LANES + lane, &j);
        add_joint(&j, true, slot, t->into->D);
      }
  }
}

static size_t joints_of(const hk_rods *r) {
  const hk_rod_batch *end = r->batches ? &r->batch[r->batches - 1] : NULL;
  size_t joints = end ? end->joint : 0;
  for (size_t lane = 0; end && lane < LANES; lane++) joints += hk_rod_joints(end, lane);
  return joints;
}

void hk_rod_blocks_add(const hk_rods *r, const hk_host *host, const hk_blocks *into) {
  task t = {r, into};
  if (r->shared)
    add_chunk(&t, 0, r->batches, 0);
  else
    host->parallel_for(host, r->batches, GRAIN, add_chunk, &t);
  if (r->spins.count)
    hk_rod_spins_add(r, joints_of(r), into);
  else if (r->jacobian == HK_ROD_EXACT && !(into->want & HK_WANT_DEFINITE))
    hk_rod_relaxed_subtract(r, joints_of(r), into);
}

/* At most the largest factor by which a 3 x 3 matrix lengthens a vector. */
static double norm_of(const double H[36], int i, int k) {
  double rows = 0, columns = 0;
  for (int r = 0; r < 3; r++) {
    double row = 0, column = 0;
    for (int c = 0; c < 3; c++) row += fabs(of_nodes(H, i, k, 3 * r + c)), column += fabs(of_nodes(H, i, k, 3 * c + r));
    rows = fmax(rows, row), columns = fmax(columns, column);
  }
  return sqrt(rows * columns);
}

/* u.K u <= sum_ik |u_i| |u_k| |K_ik| <= sum_i u_i^2 sum_k |K_ik|, over particles that move. On a straight uniform rod
 * that is reached, up to what the norm is too large in directions across the axes. */
void hk_rod_blocks_bound(const hk_rods *r, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  for (size_t q = 0; q < r->batches; q++)
    for (size_t lane = 0; lane < LANES; lane++)
      for (size_t k = 0; k < hk_rod_joints(&r->batch[q], lane); k++) {
        hk_rod_joint j;
        double H[36];
        uint32_t node[3];
        nodes_of(r, &r->batch[q], lane, k, node);
        hk_rod_joint_at(r, &r->batch[q], lane, k, &j);
        bool damping = part == HK_DAMPING_WHOLE;
        if (damping) hk_rod_joint_damping(r, (r->batch[q].first + k) * LANES + lane, &j);
        hessian(&j, damping, H);
        for (int c = 0; c < 9; c++) {
          if (view->model->inverse_mass[node[c / 3]] == 0 || view->model->inverse_mass[node[c % 3]] == 0) continue;
          double most = norm_of(H, c / 3, c % 3);
          for (int d = 0; d < 6; d += d < 3 ? 3 : 2) block[node[c / 3]][d] += most;
        }
      }
}
