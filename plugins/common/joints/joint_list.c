/* Joints of edges in their order. With l_1 and l_2 the initial lengths of its edges, an edge between two pinned
 * particles counted as 0, a joint has k + 1/(l_1/(2 EI_1) + l_2/(2 EI_2)) and the rest angle curvature (l_1 + l_2)/2.
 */
#include "plugins/common/joints/joint_list.h"
#include "plugins/kit/springs/edge.h"

#include <stdlib.h>
#include <string.h>

typedef struct making {
  const hk_view *view;
  const hk_tuples *edges;
  const hk_joint_numbers *given;
  size_t count, given_count; /* joints so far; those given as joints */
  uint32_t (*node)[3];
  size_t (*edge)[2]; /* of a joint made of edges */
} making;

/* Joins edges a and b where they share one end and no more, but not at the particle `taken`. */
static void join(making *m, size_t a, size_t b, uint32_t taken) {
  const uint32_t *p = hk_tuple(m->edges, a), *q = hk_tuple(m->edges, b);
  for (int c = 0; c < 4; c++) {
    uint32_t shared = p[c / 2], from = p[1 - c / 2], to = q[1 - c % 2];
    if (shared != q[c % 2] || from == to || shared == taken) continue;
    memcpy(m->node[m->count], (uint32_t[]){from, shared, to}, sizeof *m->node);
    m->edge[m->count][0] = a;
    m->edge[m->count++][1] = b;
    return;
  }
}

/* Every run of edges that share ends, with the joint that closes it. */
static void join_edges(making *m) {
  size_t first = 0, count = m->edges->count;
  for (size_t e = 1; e <= count; e++) {
    size_t before = m->count;
    if (e < count) join(m, e - 1, e, UINT32_MAX);
    if (m->count > before) continue;
    if (e - first > 2) join(m, e - 1, first, m->node[before - (e - first - 1)][1]);
    first = e;
  }
}

/* 0: the edge is a wall. */
static double length_of(const hk_view *view, uint32_t i, uint32_t j) {
  double d[3], length = hk_edge_difference(view->x, (uint32_t[]){i, j}, d);
  return view->model->inverse_mass[i] == 0 && view->model->inverse_mass[j] == 0 ? 0 : length;
}

static double EI_of(const making *m, size_t joint, int side) {
  const hk_per_tuple *EI = m->given->EI;
  if (!EI->count) return 0;
  if (EI->count == 1) return EI->value[0];
  return joint < m->given_count ? 0 : EI->value[m->edge[joint][side]];
}

static double value_of(const hk_per_tuple *p, size_t k) { return p->count ? hk_tuple_value(p, k) : 0; }

static void fill(const making *m, double *k, double *damping, double *rest) {
  for (size_t e = 0; e < m->count; e++) {
    const uint32_t *node = m->node[e];
    double l[2], yields = 0, own = value_of(m->given->k, e);
    bool bends = true;
    for (int side = 0; side < 2; side++) {
      double EI = EI_of(m, e, side);
      l[side] = length_of(m->view, node[side], node[side + 1]);
      bends = bends && EI > 0;
      yields += EI > 0 ? l[side] / (2 * EI) : 0;
    }
    k[e] = own + (bends && yields > 0 ? 1 / yields : 0);
    damping[e] = value_of(m->given->damping, e) + m->given->retardation * k[e];
    if (rest) rest[e] = m->given->curvature * (l[0] + l[1]) / 2;
  }
}

static hk_status no_memory(const hk_host *host) { return host->fail(host, HK_NO_MEMORY, "no memory for the joints"); }

static bool any(const double *value, size_t count) {
  for (size_t k = 0; k < count; k++)
    if (value[k] > 0) return true;
  return count == 0;
}

static hk_status fill_numbers(const making *m, const hk_host *host) {
  const hk_joint_numbers *given = m->given;
  bool curved = !isnan(given->curvature);
  double *k = host->allocate(host, (m->count + 1) * sizeof *k), *c = host->allocate(host, (m->count + 1) * sizeof *c);
  double *rest = curved ? host->allocate(host, (m->count + 1) * sizeof *rest) : NULL;
  if (!k || !c || (curved && !rest)) return no_memory(host);
  fill(m, k, c, rest);
  if (!any(k, m->count) && !any(c, m->count))
    return host->fail(host, HK_BAD_PARAM, "no joint has a stiffness: give EI, or k");
  *given->k = (hk_per_tuple){m->count, k};
  *given->damping = (hk_per_tuple){m->count, c};
  if (rest) *given->rest = (hk_per_tuple){m->count, rest};
  return HK_OK;
}

hk_status hk_joint_list_make(const hk_view *view, const hk_tuples *edges, hk_tuples *joints,
                             const hk_joint_numbers *given) {
  const hk_host *host = view->host;
  size_t most = joints->count + edges->count;
  making m = {.view = view, .edges = edges, .given = given, .count = joints->count, .given_count = joints->count};
  m.node = host->allocate(host, (most + 1) * sizeof *m.node);
  m.edge = host->allocate(host, (most + 1) * sizeof *m.edge);
  if (!m.node || !m.edge) return no_memory(host);
  if (joints->count) memcpy(m.node, joints->index, joints->count * sizeof *m.node);
  join_edges(&m);
  if (edges->count && m.count == joints->count)
    return host->fail(host, HK_BAD_PARAM,
                      "edges: none shares an end with the one before it; list them along the chain, or give joints");
  hk_status status = fill_numbers(&m, host);
  host->release(host, m.edge);
  *joints = (hk_tuples){m.count, 3, &m.node[0][0]};
  return status;
}
