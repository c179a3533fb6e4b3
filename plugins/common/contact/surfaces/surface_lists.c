/* The sides of all triangles are sorted by their two particles (two stable counting sorts, in linear time); equal ones
 * follow each other then, and are one edge of the mesh. */
#include "plugins/common/contact/surfaces/surface_lists.h"

#include "plugins/common/space/union_find.h"
#include "plugins/kit/vector3.h"

#include <string.h>

static const double welded = 1e-6; /* of the radius: what is nearer than that is one place */

typedef struct side {
  uint32_t end[2]; /* rising */
  uint32_t triangle, corner;
} side;

typedef struct builder {
  hk_surface_lists *lists;
  const hk_host *host;
  const hk_view *view;
  const hk_surface_request *request;
  const bool *left;
  bool *in_triangle, *in_strand; /* n */
  uint32_t *place;               /* n + 1: of the sort */
  side *sides, *spare;
  size_t count; /* of sides */
} builder;

/* ---- memory ---- */

static void release_scratch(builder *b) {
  void *scratch[] = {b->in_strand, b->place, b->sides, b->spare};
  for (size_t k = 0; k < sizeof scratch / sizeof *scratch; k++) b->host->release(b->host, scratch[k]);
}

void hk_surface_lists_free(hk_surface_lists *l, const hk_host *host) {
  void *memory[] = {l->point, l->edge, l->edge_faces, l->triangle, l->part, l->radius, l->solid, l->in_triangle};
  for (size_t k = 0; k < sizeof memory / sizeof *memory; k++) host->release(host, memory[k]);
  hk_joined_bodies_free(&l->joined, host);
  *l = (hk_surface_lists){0};
}

/* At most, every side is an edge of its own, and every particle is alone. */
static bool reserve(builder *b) {
  const hk_model *m = b->view->model;
  const hk_host *host = b->host;
  size_t n = m->n, edges, sides = 3 * m->triangles.count + m->edges.count;
  for (size_t l = 0; l < m->join_lists; l++) sides += m->join[l]->count;
  edges = sides + n;
  hk_surface_lists *l = b->lists;
  l->in_triangle = b->in_triangle = host->allocate(host, n * sizeof *b->in_triangle);
  b->in_strand = host->allocate(host, n * sizeof *b->in_strand);
  b->place = host->allocate(host, (n + 1) * sizeof *b->place);
  b->sides = host->allocate(host, sides * sizeof *b->sides);
  b->spare = host->allocate(host, sides * sizeof *b->spare);
  l->triangle = host->allocate(host, m->triangles.count * sizeof *b->lists->triangle);
  l->edge = host->allocate(host, edges * sizeof *b->lists->edge);
  l->edge_faces = host->allocate(host, edges * sizeof *b->lists->edge_faces);
  l->point = host->allocate(host, n * sizeof *b->lists->point);
  l->part = host->allocate(host, n * sizeof *b->lists->part);
  l->radius = host->allocate(host, n * sizeof *b->lists->radius);
  l->solid = host->allocate(host, n * sizeof *b->lists->solid);
  l->mesh.point = l->point;
  l->mesh.edge = (const uint32_t(*)[2])l->edge;
  l->mesh.edge_faces = (const uint32_t(*)[2])l->edge_faces;
  l->mesh.triangle = (const uint32_t(*)[3])l->triangle;
  l->mesh.part = l->part;
  l->mesh.radius = l->radius;
  return b->in_triangle && b->in_strand && b->place && b->sides && b->spare && b->lists->triangle && b->lists->edge &&
         b->lists->edge_faces && b->lists->point && b->lists->part && b->lists->radius && b->lists->solid;
}

/* ---- sides ---- */

static void sort_by(builder *b, int end) {
  size_t n = b->view->n;
  memset(b->place, 0, (n + 1) * sizeof *b->place);
  for (size_t k = 0; k < b->count; k++) b->place[b->sides[k].end[end] + 1]++;
  for (size_t i = 0; i < n; i++) b->place[i + 1] += b->place[i];
  for (size_t k = 0; k < b->count; k++) b->spare[b->place[b->sides[k].end[end]]++] = b->sides[k];
  side *sorted = b->spare;
  b->spare = b->sides;
  b->sides = sorted;
}

static void add_side(builder *b, uint32_t p, uint32_t q, uint32_t triangle, uint32_t corner) {
  b->sides[b->count++] = (side){{p < q ? p : q, p < q ? q : p}, triangle, corner};
}

static bool same_ends(const side *a, const side *b) { return a->end[0] == b->end[0] && a->end[1] == b->end[1]; }

static uint32_t opposite(const builder *b, const side *s) {
  return b->lists->triangle[s->triangle][(s->corner + 2) % 3];
}

static hk_status many_at_edge(const builder *b, const side *first) {
  const uint32_t *id = b->view->model->id;
  return b->host->fail(
      b->host, HK_BAD_PARAM,
      "the edge from particle %u to %u has more than two triangles (their third corners are %u, %u, "
      "%u): contact needs surfaces of which each edge has one or two; give one of them particles of its "
      "own",
      id[first->end[0]], id[first->end[1]], id[opposite(b, first)], id[opposite(b, first + 1)],
      id[opposite(b, first + 2)]);
}

static hk_status duplicate(const builder *b, const side *s) {
  const uint32_t *id = b->view->model->id, *t = b->lists->triangle[s->triangle];
  return b->host->fail(b->host, HK_BAD_PARAM, "the triangle %u %u %u stands in the mesh twice: remove one", id[t[0]],
                       id[t[1]], id[t[2]]);
}

static hk_status check_edge(const builder *b, const side *first, size_t count) {
  for (size_t k = 0; k < count; k++)
    for (size_t l = 0; l < k; l++)
      if (opposite(b, first + k) == opposite(b, first + l)) return duplicate(b, first + k);
  return count > 2 ? many_at_edge(b, first) : HK_OK;
}

/* ---- triangles and their edges ---- */

static hk_status check_triangle(const builder *b, const uint32_t t[3]) {
  const uint32_t *id = b->view->model->id;
  if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) return HK_OK;
  return b->host->fail(b->host, HK_BAD_PARAM, "the triangle %u %u %u names a particle twice: remove it", id[t[0]],
                       id[t[1]], id[t[2]]);
}

static void add_triangle(builder *b, const uint32_t t[3]) {
  size_t k = b->lists->mesh.triangles++;
  memcpy(b->lists->triangle[k], t, sizeof *b->lists->triangle);
  for (uint32_t c = 0; c < 3; c++) add_side(b, t[c], t[(c + 1) % 3], (uint32_t)k, c);
}

static hk_status take_triangles(builder *b) {
  const hk_tuples *all = &b->view->model->triangles;
  for (size_t k = 0; k < all->count; k++) {
    const uint32_t *t = hk_tuple(all, k);
    hk_status status = check_triangle(b, t);
    if (status != HK_OK) return status;
    for (int c = 0; c < 3; c++) b->in_triangle[t[c]] = true;
    if (b->left[t[0]] || b->left[t[1]] || b->left[t[2]]) continue;
    add_triangle(b, t);
  }
  return HK_OK;
}

static void add_edge(builder *b, uint32_t p, uint32_t q, uint32_t face, uint32_t other_face) {
  size_t e = b->lists->mesh.edges++;
  memcpy(b->lists->edge[e], (uint32_t[]){p, q}, sizeof *b->lists->edge);
  memcpy(b->lists->edge_faces[e], (uint32_t[]){face, other_face}, sizeof *b->lists->edge_faces);
}

static hk_status take_sides(builder *b) {
  sort_by(b, 1);
  sort_by(b, 0);
  for (size_t k = 0, count; k < b->count; k += count) {
    for (count = 1; k + count < b->count && same_ends(&b->sides[k], &b->sides[k + count]);) count++;
    hk_status status = check_edge(b, &b->sides[k], count);
    if (status != HK_OK) return status;
    const side *first = &b->sides[k];
    add_edge(b, first->end[0], first->end[1], first->triangle, count > 1 ? first[1].triangle : UINT32_MAX);
  }
  b->lists->surface_edges = b->lists->mesh.edges;
  return HK_OK;
}

/* ---- strands and isolated particles ---- */

/* An edge between two particles of triangles is one of theirs, or a spring across them; it takes no room. */
static void take_strand(builder *b, const uint32_t e[2]) {
  if (b->in_triangle[e[0]] && b->in_triangle[e[1]]) return;
  b->in_strand[e[0]] = b->in_strand[e[1]] = true;
  if (!b->left[e[0]] && !b->left[e[1]]) add_side(b, e[0], e[1], UINT32_MAX, 0);
}

/* Whether what a constraint joins is a strand: points of rigid bodies are no ends, and a weld of one place no length.
 */
static bool is_strand(const builder *b, const uint32_t e[2]) {
  const hk_model *m = b->view->model;
  double way[3];
  hk_subtract(way, b->view->x + 3 * (size_t)e[0], b->view->x + 3 * (size_t)e[1]);
  return m->pin[e[0]] != HK_PIN_RIDES && m->pin[e[1]] != HK_PIN_RIDES && hk_length(way) > welded * b->request->radius;
}

static void take_strands(builder *b) {
  const hk_model *m = b->view->model;
  b->count = 0;
  for (size_t k = 0; k < m->edges.count; k++) take_strand(b, hk_tuple(&m->edges, k));
  for (size_t l = 0; l < m->join_lists; l++)
    for (size_t k = 0; k < m->join[l]->count; k++)
      if (is_strand(b, hk_tuple(m->join[l], k))) take_strand(b, hk_tuple(m->join[l], k));
  sort_by(b, 1);
  sort_by(b, 0);
  for (size_t k = 0; k < b->count; k++)
    if (k == 0 || !same_ends(&b->sides[k - 1], &b->sides[k]))
      add_edge(b, b->sides[k].end[0], b->sides[k].end[1], UINT32_MAX, UINT32_MAX);
  b->lists->strand_edges = b->lists->mesh.edges - b->lists->surface_edges;
}

static void take_isolated(builder *b) {
  for (uint32_t i = 0; i < b->view->n; i++)
    if (!b->left[i] && !b->in_triangle[i] && !b->in_strand[i]) add_edge(b, i, i, UINT32_MAX, UINT32_MAX);
}

/* The ends of all edges. A particle whose features all have a member that is left out has none, and no part in contact.
 */
static void take_points(builder *b) {
  hk_surface_mesh *m = &b->lists->mesh;
  bool *listed = b->in_strand; /* its content is not needed any more */
  memset(listed, 0, b->view->n * sizeof *listed);
  for (size_t e = 0; e < m->edges; e++) listed[m->edge[e][0]] = listed[m->edge[e][1]] = true;
  for (uint32_t i = 0; i < b->view->n; i++)
    if (listed[i]) b->lists->point[m->points++] = i;
}

/* ---- connected parts ---- */

static void number_parts(builder *b) {
  hk_surface_mesh *m = &b->lists->mesh;
  uint32_t *parent = b->place;
  for (uint32_t i = 0; i < b->view->n; i++) parent[i] = i, b->lists->part[i] = UINT32_MAX;
  for (size_t e = 0; e < m->edges; e++) hk_unite(parent, b->lists->edge[e][0], b->lists->edge[e][1]);
  for (size_t k = 0; k < m->points; k++) {
    uint32_t i = b->lists->point[k], root = hk_root_of(parent, i);
    if (b->lists->part[root] == UINT32_MAX) b->lists->part[root] = (uint32_t)m->parts++;
    b->lists->part[i] = b->lists->part[root];
  }
}

/* ---- radii ---- */

static void find_radii(builder *b) {
  const hk_surface_mesh *m = &b->lists->mesh;
  bool *moves = b->in_strand; /* by part */
  memset(moves, 0, b->view->n * sizeof *moves);
  for (size_t k = 0; k < m->points; k++)
    moves[b->lists->part[b->lists->point[k]]] |= hk_model_moves(b->view->model, b->lists->point[k]);
  for (size_t k = 0; k < m->points; k++) {
    uint32_t i = b->lists->point[k];
    double thickness = moves[b->lists->part[i]] ? b->request->thickness : b->request->body_thickness;
    b->lists->radius[i] = b->in_triangle[i] ? thickness / 2 : b->request->radius;
  }
}

/* ---- rigid bodies ---- */

/* Their surfaces, and what has a radius of its own. */
static void take_solids(builder *b) {
  const hk_model *m = b->view->model;
  for (size_t i = 0; i < b->view->n; i++) b->lists->solid[i] = UINT32_MAX;
  for (size_t k = 0; k < m->riders; k++) {
    const hk_rider *r = &m->rider[k];
    if (r->touches) b->lists->solid[r->particle] = r->carrier[0];
    if (r->touches && r->radius > 0) b->lists->radius[r->particle] = r->radius;
  }
}

/* ---- all ---- */

static hk_status build(builder *b) {
  if (!reserve(b))
    return b->host->fail(b->host, HK_NO_MEMORY, "no memory for the surfaces of %zu particles", b->view->n);
  hk_status status = take_triangles(b);
  if (status == HK_OK) status = take_sides(b);
  if (status != HK_OK) return status;
  take_strands(b);
  take_isolated(b);
  take_points(b);
  number_parts(b);
  find_radii(b);
  take_solids(b);
  return hk_joined_bodies_find(&b->lists->joined, b->host, b->view, b->request);
}

hk_status hk_surface_lists_build(hk_surface_lists *lists, const hk_host *host, const hk_view *view,
                                 const hk_surface_request *request, const bool *left) {
  builder b = {.lists = lists, .host = host, .view = view, .request = request, .left = left};
  hk_surface_lists_free(lists, host);
  hk_status status = build(&b);
  release_scratch(&b);
  if (status != HK_OK) hk_surface_lists_free(lists, host);
  return status;
}
