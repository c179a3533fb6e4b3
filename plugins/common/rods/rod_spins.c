/* With the angle of an edge's section s/radius, s the x of its particle, a joint adds d^2E/(ds ds') of its two edges,
 * and d^2E/(ds dx) of them and its three nodes: those of rod_relaxed.c over the radius. */
#include "plugins/common/rods/rod_angles.h"
#include "plugins/common/rods/rod_joint.h"

enum { LANES = HK_ROD_LANES, SPIN_BLOCKS = 16 /* of a joint */ };

typedef struct members {
  uint32_t spin[2], node[3];
} members;

static members members_of(const hk_rods *r, const hk_rod_batch *b, size_t lane, size_t k) {
  size_t last = k + 2 <= b->count[lane] ? k + 2 : 1, after = k + 1 < b->count[lane] ? k + 1 : 0;
  const uint32_t *node = r->rows.node + (b->first + b->number) * LANES + lane;
  const uint32_t *edge = r->rows.edge + b->first * LANES + lane;
  return (members){{r->spins.index[edge[k * LANES]], r->spins.index[edge[after * LANES]]},
                   {node[k * LANES], node[(k + 1) * LANES], node[last * LANES]}};
}

void hk_rod_spins_pattern(const hk_rods *r, hk_pattern *p) {
  for (size_t q = 0; q < r->batches; q++)
    for (size_t lane = 0; lane < LANES; lane++)
      for (size_t k = 0; k < hk_rod_joints(&r->batch[q], lane); k++) {
        members m = members_of(r, &r->batch[q], lane, k);
        for (int c = 0; c < 4; c++) p->block(p, m.spin[c / 2], m.spin[c % 2]);
        for (int c = 0; c < 6; c++)
          p->block(p, m.spin[c / 3], m.node[c % 3]), p->block(p, m.node[c % 3], m.spin[c / 3]);
      }
}

/* `slot` of the joint's blocks, in the order of the pattern. Only x of a spin counts: row, or column, 0. */
static void add_joint(const hk_rods *r, const hk_rod_joint *j, bool definite, const size_t *slot, double *K) {
  double g[2][6], m[6], size = 1 / r->radius;
  hk_rod_joint_gradients(j, g, m);
  double h = j->bend[0] * j->k[1] * j->k[1] + j->bend[1] * j->k[0] * j->k[0];
  double w0 = definite ? 0 : j->w[0], w1 = definite ? 0 : j->w[1];
  h = (h - w0 * j->k[0] - w1 * j->k[1]) / 4;
  for (int c = 0; c < 4; c++) K[9 * slot[c]] += (h + (c / 2 == c % 2 ? j->twist : -j->twist)) * size * size;
  for (int s = 0; s < 2; s++)
    for (int q = 0; q < 6; q++) {
      double half = ((j->bend[0] * j->k[1] - w1) * g[0][q] + (w0 - j->bend[1] * j->k[0]) * g[1][q]) / 2;
      double slope = (half + (s == 0 ? -j->twist : j->twist) * m[q]) * size;
      for (int end = 0; end < 2; end++) { /* an edge is its second node less its first */
        const size_t *pair = slot + 4 + 2 * (3 * s + q / 3 + end);
        K[9 * pair[0] + (size_t)q % 3] += end ? slope : -slope;
        K[9 * pair[1] + 3 * ((size_t)q % 3)] += end ? slope : -slope;
      }
    }
}

void hk_rod_spins_add(const hk_rods *r, size_t joints, const hk_blocks *into) {
  const size_t *slot = into->slot + 9 * joints;
  for (size_t q = 0; q < r->batches; q++)
    for (size_t lane = 0; lane < LANES; lane++)
      for (size_t k = 0; k < hk_rod_joints(&r->batch[q], lane); k++, slot += SPIN_BLOCKS) {
        hk_rod_joint j;
        hk_rod_joint_at(r, &r->batch[q], lane, k, &j);
        add_joint(r, &j, into->want & HK_WANT_DEFINITE, slot, into->K);
        if (!(r->retardation > 0)) continue;
        hk_rod_joint_damping(r, (r->batch[q].first + k) * LANES + lane, &j);
        add_joint(r, &j, true, slot, into->D);
      }
}
