/* The matrix of the global step, M + h^2 L: springs and dampers, the pairs of the elements' members by their weights.
 */
#include "plugins/common/local_global/local_global.h"

#include <string.h>

static hk_status lay_out(hk_local_global *m, const hk_host *host, const hk_partition *partition) {
  const hk_tuples edges = {m->edges.count, 2, m->edges.count ? &m->edges.pair[0][0] : NULL};
  double zero = 0;
  const hk_per_tuple none = {1, &zero}, k = {edges.count, m->edges.stiffness}, c = {edges.count, m->edges.damping},
                     rest = {edges.count, m->edges.rest};
  hk_spring_layout_free(&m->springs, host);
  hk_spring_layout_free(&m->dampers, host);
  if (edges.count == 0) return HK_OK;
  hk_status status = hk_spring_layout_build(&m->springs, host, partition, &edges, &k, &none, &rest, NULL);
  double damping = 0;
  for (size_t e = 0; e < edges.count; e++) damping = fmax(damping, m->edges.damping[e]);
  if (status != HK_OK || damping == 0) return status;
  return hk_spring_layout_build(&m->dampers, host, partition, &edges, &none, &c, &none, NULL);
}

/* The pairs of the matrix: springs, then the pairs of the elements' members. */
static hk_status build_matrix(hk_local_global *m, size_t n) {
  const hk_host *host = m->host;
  size_t edges = m->edges.count, pairs = edges + m->elements.pairs;
  uint32_t(*pair)[2] = host->allocate(host, (pairs + 1) * sizeof *pair);
  host->release(host, m->weight);
  host->release(host, m->diagonal);
  m->weight = host->allocate(host, (pairs + 1) * sizeof *m->weight);
  m->diagonal = host->allocate(host, (n + 1) * sizeof *m->diagonal);
  if (!pair || !m->weight || !m->diagonal) {
    host->release(host, pair);
    return host->fail(host, HK_NO_MEMORY, "no memory for the weights of %zu springs", pairs);
  }
  memcpy(pair, m->edges.pair, edges * sizeof *pair);
  hk_element_energy_pairs(&m->elements, pair + edges);
  hk_status status = hk_laplacian_build(&m->laplacian, host, n, pairs, (const uint32_t(*)[2])pair);
  host->release(host, pair);
  return status;
}

static void keep_weights(hk_local_global *m) {
  if (m->steepness.count > 0) memcpy(m->steepness.item, m->elements.steepness, m->steepness.count * sizeof(double));
}

/* Computes the elements' weights at X; at the first step after a checkpoint those of the checkpoint are used. */
static hk_status weigh_elements(hk_local_global *m, hk_system *s, bool fresh) {
  hk_status status = hk_element_energy_take(&m->elements, m->host, s->model, s->X, fresh);
  size_t count = m->elements.tuples.count;
  bool resumed = !m->weighed && count > 0 && m->steepness.count == count;
  m->weighed = true;
  if (status == HK_OK && resumed) memcpy(m->elements.steepness, m->steepness.item, count * sizeof(double));
  if (status != HK_OK || resumed) return status;
  if (m->steepness.count != count) status = m->host->resize(m->host, &m->steepness, count);
  if (status == HK_OK) keep_weights(m);
  return status;
}

static hk_status rebuild(hk_local_global *m, hk_system *s, bool fresh) {
  hk_status status = hk_slide_pins_build(&m->slides, m->host, &m->edges);
  if (status == HK_OK) status = weigh_elements(m, s, fresh);
  if (status == HK_OK) status = build_matrix(m, s->n);
  if (status == HK_OK) status = lay_out(m, m->host, s->model->partition);
  if (status == HK_OK && m->acceleration == HK_LOCAL_GLOBAL_ANDERSON)
    status = hk_anderson_reserve(&m->anderson, m->host, 3 * s->n, (size_t)m->window);
  return status;
}

static hk_status make_matrix(hk_local_global *m, hk_system *s, double h) {
  size_t edges = m->edges.count;
  for (size_t e = 0; e < edges; e++) m->weight[e] = h * (h * m->edges.stiffness[e] + m->edges.damping[e]);
  memcpy(m->diagonal, s->model->mass, s->n * sizeof *m->diagonal);
  hk_element_energy_weights(&m->elements, h, m->weight + edges, m->diagonal);
  hk_laplacian_fill(&m->laplacian, m->diagonal, s->model->inverse_mass, m->weight);
  m->h = 0;
  hk_status status = s->linear->factorize(s, &m->laplacian.matrix);
  if (status == HK_OK) status = hk_slide_pins_factorize(&m->slides, s, m->r, m->dx);
  if (status == HK_OK) m->h = h;
  return status;
}

hk_status hk_local_global_prepare(hk_local_global *m, hk_system *s, double h) {
  bool fresh = !m->edges.valid, changed;
  hk_status status = hk_element_edges_take(&m->edges, s, m->scratch, &changed);
  if (status != HK_OK) return status;
  if (changed) {
    m->h = 0;
    status = rebuild(m, s, fresh);
    if (status != HK_OK) hk_element_edges_drop(&m->edges); /* the next attempt builds everything again */
  }
  return status != HK_OK || h == m->h ? status : make_matrix(m, s, h);
}

hk_status hk_local_global_stiffen(hk_local_global *m, hk_system *s, double h) {
  m->soft = false;
  if (!hk_element_energy_raise(&m->elements)) return HK_OK;
  keep_weights(m);
  hk_anderson_clear(&m->anderson);
  return make_matrix(m, s, h);
}
