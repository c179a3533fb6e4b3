#include "plugins/common/picture/geometry.h"

#include "plugins/common/colour/palette.h"
#include "plugins/common/occlusion/occlusion.h"
#include "plugins/common/picture/solid_mesh.h"

#include <string.h>

static void *renew(const hk_host *host, void *old, size_t count, size_t bytes) {
  host->release(host, old);
  return host->allocate(host, count * bytes);
}

static hk_status make_room(hk_painter *p, const hk_snapshot3d *s) {
  size_t tubes = s->lines + p->border.count;
  size_t vertices = s->triangles ? s->n + 3 * (s->triangles - s->cloth) : 0, triangles = s->triangles;
  for (size_t k = 0; k < s->solids; k++)
    vertices += hk_solid_vertices(s->solid + k), triangles += hk_solid_triangles(s->solid + k);
  if (s->n >= p->point_room) {
    p->point_room = s->n + s->n / 2 + 1;
    p->point = renew(p->host, p->point, p->point_room, sizeof *p->point);
  }
  if (vertices >= p->room) {
    p->room = vertices + vertices / 2 + 1;
    p->vertex = renew(p->host, p->vertex, p->room, sizeof *p->vertex);
  }
  if (triangles >= p->triangle_room) {
    p->triangle_room = triangles + triangles / 2 + 1;
    p->triangle = renew(p->host, p->triangle, p->triangle_room, sizeof *p->triangle);
  }
  if (tubes >= p->tube_room) {
    p->tube_room = tubes + tubes / 2 + 1;
    p->tube = renew(p->host, p->tube, p->tube_room, sizeof *p->tube);
  }
  if (p->vertex && p->point && p->triangle && p->tube) return HK_OK;
  p->room = p->triangle_room = p->tube_room = p->point_room = 0;
  return p->host->fail(p->host, HK_NO_MEMORY, "no memory to draw %zu particles", s->n);
}

typedef struct region {
  float middle[3], limit;
} region;

static region region_of(const hk_view_setup *setup) {
  region r = {.limit = (float)(50 * setup->size)};
  for (int c = 0; c < 3; c++) r.middle[c] = (float)setup->middle[c];
  return r;
}

static bool has_place(const float x[3], const region *r) {
  return fabsf(x[0] - r->middle[0]) < r->limit && fabsf(x[1] - r->middle[1]) < r->limit &&
         fabsf(x[2] - r->middle[2]) < r->limit;
}

/* Adds the triangles, and at each corner the sum of their normals weighted by area. */
static void add_triangles(hk_painter *p, const hk_snapshot3d *s, const region *here) {
  for (size_t k = 0; k < s->cloth; k++) {
    const uint32_t *t = s->triangle[k];
    const float *a = s->x[t[0]], *b = s->x[t[1]], *c = s->x[t[2]];
    if (!has_place(a, here) || !has_place(b, here) || !has_place(c, here)) continue;
    float u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    float normal[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    for (int i = 0; i < 3; i++)
      for (int d = 0; d < 3; d++) p->vertex[t[i]].normal[d] += normal[d];
    memcpy(p->triangle[p->triangles++], t, sizeof *s->triangle);
  }
}

/* Where particle i belongs to a strand with a radius of its own: not thinner than that. */
static float at_least_strand(const hk_snapshot3d *s, size_t i, double radius) {
  const float *own = s->extra[HK_EXTRA_TUBE];
  return own ? fmaxf(own[i], (float)radius) : (float)radius;
}

/* Normalises a vector here, since squares of small areas would underflow in the shader. */
static void normalize(float v[3]) {
  float most = fmaxf(fabsf(v[0]), fmaxf(fabsf(v[1]), fabsf(v[2])));
  if (most > 0)
    for (int c = 0; c < 3; c++) v[c] /= most;
}

static void add_point(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s, size_t i,
                      const uint8_t colour[4]) {
  const float *size = s->extra[HK_EXTRA_SIZE], *v = s->extra[HK_EXTRA_VELOCITY];
  hk_point_sprite *point = p->point + p->points++;
  memcpy(point->centre, s->x[i], sizeof point->centre);
  memcpy(point->colour, colour, sizeof point->colour);
  point->radius = size ? (float)(setup->point_unit * (double)size[i]) : at_least_strand(s, i, setup->point);
  for (size_t c = 0; c < 3; c++) point->tail[c] = v ? (float)(setup->streak * (double)v[3 * i + c]) : 0;
}

static void add_mesh(hk_painter *p, const hk_snapshot3d *s, uint8_t (*colour)[4], const region *here) {
  p->vertices = s->n;
  for (size_t i = 0; i < s->n; i++) {
    hk_vertex *v = p->vertex + i;
    memcpy(v->x, s->x[i], sizeof v->x);
    memset(v->normal, 0, sizeof v->normal);
    memcpy(v->colour, colour[i], sizeof v->colour);
  }
  add_triangles(p, s, here);
  for (size_t i = 0; i < s->n; i++) normalize(p->vertex[i].normal);
}

static void exchange(uint32_t a[3], uint32_t b[3]) {
  uint32_t other[3];
  memcpy(other, a, sizeof other);
  memcpy(a, b, sizeof other);
  memcpy(b, other, sizeof other);
}

/* What lies in the floor is the floor: the bodies' first faces are those that do not. */
static size_t faces_off_floor(const hk_view_setup *setup, const hk_snapshot3d *s, uint32_t (*face)[3], size_t faces) {
  size_t kept = 0;
  for (size_t k = 0; k < faces; k++) {
    float off = 0;
    for (int i = 0; i < 3; i++) off = fmaxf(off, fabsf(s->x[face[k][i]][2] - (float)setup->height));
    if (setup->floor && off < 1e-3f * (float)setup->size) continue;
    exchange(face[kept++], face[k]);
  }
  return kept;
}

static size_t faces_with_place(const hk_snapshot3d *s, const region *here, uint32_t (*face)[3], size_t faces) {
  size_t kept = 0;
  for (size_t k = 0; k < faces; k++) {
    bool placed = true;
    for (int i = 0; i < 3; i++) placed = placed && has_place(s->x[face[k][i]], here);
    if (placed) exchange(face[kept++], face[k]);
  }
  return kept;
}

/* Surfaces that ride on rigid bodies have creases, and the colours of their particles. */
static hk_status add_rigid(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s, uint8_t (*colour)[4],
                           const region *here) {
  uint8_t plain[4];
  uint32_t(*face)[3] = s->triangle + s->cloth;
  size_t faces = faces_with_place(s, here, face, s->rigid - s->cloth), first = p->vertices;
  if (faces == 0) return HK_OK;
  hk_solid_colour(setup, false, plain);
  hk_status status = hk_solid_add_faces(p, (const float(*)[3])s->x, s->n, (const uint32_t(*)[3])face, faces, plain);
  for (size_t k = 0; k < 3 * faces && status == HK_OK; k++)
    memcpy(p->vertex[first + k].colour, colour[face[k / 3][k % 3]], sizeof p->vertex->colour);
  return status;
}

/* Surfaces that are pinned as a whole are what others meet: they look like solids. */
static hk_status add_bodies(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s) {
  uint8_t colour[4];
  size_t faces = faces_off_floor(setup, s, s->triangle + s->rigid, s->triangles - s->rigid);
  if (faces == 0) return HK_OK;
  hk_solid_colour(setup, false, colour);
  return hk_solid_add_faces(p, (const float(*)[3])s->x, s->n, (const uint32_t(*)[3])s->triangle + s->rigid, faces,
                            colour);
}

/* A clear liquid is the last of them, and not one of these. */
static size_t opaque_solids(const hk_view_setup *setup, const hk_snapshot3d *s) {
  return s->solids - (s->liquid && setup->water.clear);
}

static hk_status add_planes(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < opaque_solids(setup, s) && status == HK_OK; k++)
    if (s->solid[k].kind == HK_SHAPE_PLANE) status = hk_solid_mesh_add(p, setup, s->solid + k, s->origin);
  return status;
}

static hk_status add_solid(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s, size_t k,
                           double opacity) {
  size_t first = p->vertices;
  hk_status status = hk_solid_mesh_add(p, setup, s->solid + k, s->origin);
  for (size_t v = first; v < p->vertices && opacity < 1; v++) p->vertex[v].colour[3] = (uint8_t)(255 * opacity + 0.5);
  return status;
}

/* What is to be seen: particles but for those of surfaces that are obstacles themselves, and the middles of bodies. */
static void take_sight(hk_sight *sight, const hk_view_setup *setup, const hk_snapshot3d *s) {
  for (int c = 0; c < 3; c++) sight->eye[c] = (float)setup->camera.eye[c];
  size_t bodies = s->solids - s->obstacles - s->liquid, most = HK_SIGHT_POINTS - HK_SIGHT_POINTS / 4 * (bodies > 0);
  size_t every = s->n / most + 1;
  for (size_t i = 0; i < s->n; i += every)
    if (!(s->mark[i] & HK_MARK_BODY)) hk_sight_add(sight, s->x[i]);
  for (size_t k = 0; k < bodies; k += bodies / (HK_SIGHT_POINTS / 4) + 1) {
    float middle[3];
    for (int c = 0; c < 3; c++) middle[c] = (float)(s->solid[s->obstacles + k].centre[c] - s->origin[c]);
    hk_sight_add(sight, middle);
  }
}

static bool may_hide(const hk_sight *sight, const hk_frame_solid *solid, const double origin[3]) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, middle[3], square = 0;
  hk_solid_box(solid, low, high);
  for (int c = 0; c < 3; c++) {
    middle[c] = (low[c] + high[c]) / 2 - origin[c];
    square += (high[c] - low[c]) * (high[c] - low[c]) / 4;
  }
  return solid->kind != HK_SHAPE_PLANE && hk_sight_may_meet(sight, middle, sqrt(square));
}

/* Notes the share of the motion that each obstacle hides, and what all hide. Their meshes are taken away again. */
static hk_status measure_obstacles(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s, hk_sight *sight) {
  size_t vertices = p->vertices, triangles = p->triangles;
  hk_status status = HK_OK;
  take_sight(sight, setup, s);
  for (size_t k = 0; k < s->obstacles && status == HK_OK; k++) {
    p->share[k] = 0;
    if (!may_hide(sight, s->solid + k, s->origin)) continue;
    status = add_solid(p, setup, s, k, 1);
    if (status == HK_OK)
      p->share[k] = (float)hk_sight_hidden_by(sight, p->vertex, sizeof *p->vertex,
                                              (const uint32_t(*)[3])p->triangle + triangles, p->triangles - triangles);
    p->vertices = vertices, p->triangles = triangles;
  }
  return status;
}

static hk_status make_share_room(hk_painter *p, size_t count) {
  if (count < p->share_room) return HK_OK;
  p->share_room = count + count / 2 + 1;
  p->share = renew(p->host, p->share, p->share_room, sizeof *p->share);
  if (p->share) return HK_OK;
  p->share_room = 0;
  return p->host->fail(p->host, HK_NO_MEMORY, "no memory to draw %zu obstacles", count);
}

/* Those that are opaque, and then those that are not. */
static hk_status add_solids(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s) {
  hk_sight sight = {0};
  bool measured = setup->see_through && s->obstacles;
  hk_status status = measured ? make_share_room(p, s->obstacles) : HK_OK;
  if (status == HK_OK && measured) status = measure_obstacles(p, setup, s, &sight);
  for (int faded = 0; faded < 2; faded++) {
    for (size_t k = 0; k < opaque_solids(setup, s) && status == HK_OK; k++) {
      double opacity = measured && k < s->obstacles ? hk_sight_opacity(&sight, (double)p->share[k]) : 1;
      if (k < s->obstacles) opacity = fmin(opacity, 1 - setup->obstacle_clearness);
      if (s->solid[k].kind != HK_SHAPE_PLANE && faded == (opacity < 1)) status = add_solid(p, setup, s, k, opacity);
    }
    if (!faded) p->opaque = p->triangles;
  }
  p->faded = p->triangles;
  return status;
}

static void add_pin(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s, size_t i) {
  hk_point_sprite *point = p->point + p->points++;
  *point = (hk_point_sprite){.radius = 1.1f * at_least_strand(s, i, setup->pin / 1.1)};
  memcpy(point->centre, s->x[i], sizeof point->centre);
  memcpy(point->colour, hk_palette_colours[HK_PALETTE_PIN], sizeof point->colour);
}

static void add_points(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s, uint8_t (*colour)[4],
                       const region *here) {
  for (size_t i = 0; i < s->n; i++) {
    if (!(s->mark[i] & (HK_MARK_PIN | HK_MARK_POINT)) || !has_place(s->x[i], here)) continue;
    if (s->mark[i] & HK_MARK_PIN)
      add_pin(p, setup, s, i);
    else if (colour[i][3])
      add_point(p, setup, s, i, colour[i]);
  }
}

static void add_tube(hk_painter *p, const hk_snapshot3d *s, const uint32_t end[2], double radius,
                     uint8_t (*colour)[4]) {
  hk_tube *tube = p->tube + p->tubes++;
  tube->radius = (float)radius;
  memcpy(tube->a, s->x[end[0]], sizeof tube->a);
  memcpy(tube->b, s->x[end[1]], sizeof tube->b);
  memcpy(tube->colour_a, colour[end[0]], sizeof tube->colour_a);
  memcpy(tube->colour_b, colour[end[1]], sizeof tube->colour_b);
}

/* The mean of both ends, of those that have a radius. */
static double tube_radius(const hk_view_setup *setup, const hk_snapshot3d *s, const uint32_t end[2]) {
  const float *own = s->extra[HK_EXTRA_TUBE];
  double a = own ? (double)own[end[0]] : 0, b = own ? (double)own[end[1]] : 0;
  return a > 0 && b > 0 ? (a + b) / 2 : a + b > 0 ? a + b : setup->tube;
}

static void add_tubes(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s, uint8_t (*colour)[4],
                      const region *here) {
  for (size_t k = 0; k < s->lines; k++)
    if (has_place(s->x[s->line[k][0]], here) && has_place(s->x[s->line[k][1]], here))
      add_tube(p, s, s->line[k], tube_radius(setup, s, s->line[k]), colour);
}

/* The rim between both sides of surfaces with a thickness is round. */
static void add_rim(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s, uint8_t (*colour)[4],
                    const region *here) {
  for (size_t k = 0; k < p->border.count; k++) {
    uint32_t end[2];
    hk_border_ends(&p->border, k, end);
    if (has_place(s->x[end[0]], here) && has_place(s->x[end[1]], here))
      add_tube(p, s, end, setup->thickness / 2, colour);
  }
}

hk_status hk_geometry_fill(hk_painter *p, const hk_view_setup *setup, const hk_snapshot3d *s, uint8_t (*colour)[4]) {
  region here = region_of(setup);
  hk_status status = setup->thickness > 0 ? hk_border_follow(&p->border, p->host, s) : HK_OK;
  if (status == HK_OK) status = make_room(p, s);
  if (status != HK_OK) return status;
  p->vertices = p->triangles = p->tubes = p->points = 0;
  if (s->triangles) add_mesh(p, s, colour, &here);
  p->cloth = p->triangles;
  status = add_rigid(p, setup, s, colour, &here);
  if (status == HK_OK) status = add_bodies(p, setup, s);
  p->bodies = p->triangles;
  p->opaque = p->faded = p->triangles;
  if (status == HK_OK) status = add_solids(p, setup, s);
  if (status == HK_OK) status = add_planes(p, setup, s);
  p->planes = p->triangles;
  if (status == HK_OK && opaque_solids(setup, s) < s->solids)
    status = hk_solid_add_liquid(p, s->solid + s->solids - 1, s->normal, s->origin);
  if (status != HK_OK) return status;
  add_tubes(p, setup, s, colour, &here);
  add_rim(p, setup, s, colour, &here);
  add_points(p, setup, s, colour, &here);
  return HK_OK;
}
