/* Every solid is a grid of (rows + 1) x (columns + 1) points in its own axes, in which it is a sphere, cylinder or cube
 * of half extent 1; points of a grid that have a normal of their own are entered twice. */
#include "plugins/common/picture/solid_mesh.h"

#include "plugins/common/colour/palette.h"

#include <string.h>

enum { ROWS = 32, COLUMNS = 64 };

typedef struct maker {
  hk_painter *painter;
  const hk_frame_solid *solid;
  const double *origin;
  double inverse[3][3]; /* rows: what normals are made of */
  uint8_t colour[4];
} maker;

static void cross(const double a[3], const double b[3], double out[3]) {
  for (int c = 0; c < 3; c++) out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

void hk_solid_colour(const hk_view_setup *setup, bool plane, uint8_t colour[4]) {
  bool night = hk_is_dark(setup->background);
  int thing = plane   ? night ? HK_PALETTE_PLANE_AT_NIGHT : HK_PALETTE_PLANE
              : night ? HK_PALETTE_BODY_AT_NIGHT
                      : HK_PALETTE_BODY;
  memcpy(colour, hk_palette_colours[thing], 4);
}

size_t hk_solid_vertices(const hk_frame_solid *s) {
  return s->kind == HK_SHAPE_MESH ? 3 * s->faces : (ROWS + 2) * (COLUMNS + 1);
}

size_t hk_solid_triangles(const hk_frame_solid *s) {
  return s->kind == HK_SHAPE_MESH ? s->faces : 2 * (ROWS + 1) * COLUMNS;
}

/* Normals of stretched bodies are turned by the cofactors of the axes. */
static maker make_maker(hk_painter *p, const hk_view_setup *setup, const hk_frame_solid *solid,
                        const double origin[3]) {
  maker m = {p, solid, origin, {{0}}, {0}};
  hk_solid_colour(setup, solid->kind == HK_SHAPE_PLANE, m.colour);
  if (solid->colour[3]) memcpy(m.colour, solid->colour, sizeof m.colour);
  for (int k = 0; k < 3; k++) cross(solid->axis[(k + 1) % 3], solid->axis[(k + 2) % 3], m.inverse[k]);
  return m;
}

/* Adds the point p of the solid's own axes. */
static void add_vertex(const maker *m, const double p[3], const double normal[3]) {
  hk_vertex *v = m->painter->vertex + m->painter->vertices++;
  double n[3] = {0};
  for (int c = 0; c < 3; c++) {
    double x = m->solid->centre[c] - m->origin[c];
    for (int k = 0; k < 3; k++) x += p[k] * m->solid->axis[k][c], n[c] += normal[k] * m->inverse[k][c];
    v->x[c] = (float)x;
  }
  for (int c = 0; c < 3; c++) v->normal[c] = (float)(n[c] / fmax(length(n), 1e-300));
  memcpy(v->colour, m->colour, sizeof v->colour);
}

/* Joins the last (rows + 1) x (columns + 1) vertices. */
static void join(hk_painter *p, uint32_t rows, uint32_t columns) {
  uint32_t first = (uint32_t)p->vertices - (rows + 1) * (columns + 1);
  for (uint32_t i = 0; i < rows; i++)
    for (uint32_t j = 0; j < columns; j++) {
      uint32_t a = first + i * (columns + 1) + j, b = a + columns + 1;
      memcpy(p->triangle[p->triangles++], (uint32_t[]){a, a + 1, b + 1}, 3 * sizeof(uint32_t));
      memcpy(p->triangle[p->triangles++], (uint32_t[]){a, b + 1, b}, 3 * sizeof(uint32_t));
    }
}

static void add_sphere(const maker *m) {
  const double pi = acos(-1);
  for (int i = 0; i <= ROWS; i++)
    for (int j = 0; j <= COLUMNS; j++) {
      double latitude = pi * ((double)i / ROWS - 0.5), longitude = 2 * pi * j / COLUMNS;
      double p[3] = {cos(latitude) * cos(longitude), cos(latitude) * sin(longitude), sin(latitude)};
      add_vertex(m, p, p);
    }
  join(m->painter, ROWS, COLUMNS);
}

/* Two half spheres, each with the equator of its own, and between these the straight part. */
static void add_capsule(const maker *m) {
  const double pi = acos(-1), *a = m->solid->axis[2];
  double straight = 1 - length(m->solid->axis[0]) / length(a); /* of the half length; the caps are the rest */
  for (int i = 0; i <= ROWS + 1; i++)
    for (int j = 0; j <= COLUMNS; j++) {
      bool upper = i > ROWS / 2;
      double latitude = pi * ((double)(upper ? i - 1 : i) / ROWS - 0.5), longitude = 2 * pi * j / COLUMNS;
      double n[3] = {cos(latitude) * cos(longitude), cos(latitude) * sin(longitude), sin(latitude)};
      double z = (upper ? straight : -straight) + (1 - straight) * n[2];
      /* The normal's third entry is in units of the axis, which is longer than the cap. */
      add_vertex(m, (double[]){n[0], n[1], z}, (double[]){n[0], n[1], n[2] / (1 - straight)});
    }
  join(m->painter, ROWS + 1, COLUMNS);
}

hk_status hk_solid_add_faces(hk_painter *p, const float (*x)[3], size_t vertices, const uint32_t (*face)[3],
                             size_t faces, const uint8_t colour[4]) {
  hk_status status = hk_corner_normals_reserve(&p->normals, p->host, vertices, faces);
  if (status != HK_OK) return status;
  if (faces >= p->corner_room) {
    p->corner_room = faces + faces / 2 + 1;
    p->host->release(p->host, p->corner);
    p->corner = p->host->allocate(p->host, 3 * p->corner_room * sizeof *p->corner);
  }
  if (!p->corner) {
    p->corner_room = 0;
    return p->host->fail(p->host, HK_NO_MEMORY, "no memory to draw %zu triangles", faces);
  }
  hk_corner_normals_find(&p->normals, x, vertices, face, faces, p->corner);
  for (size_t k = 0; k < 3 * faces; k++) {
    hk_vertex *v = p->vertex + p->vertices;
    memcpy(v->x, x[face[k / 3][k % 3]], sizeof v->x);
    memcpy(v->normal, p->corner[k], sizeof v->normal);
    memcpy(v->colour, colour, sizeof v->colour);
    p->triangle[p->triangles + k / 3][k % 3] = (uint32_t)p->vertices++;
  }
  p->triangles += faces;
  return HK_OK;
}

static hk_status add_surface(const maker *m) {
  hk_painter *p = m->painter;
  const hk_frame_solid *s = m->solid;
  const hk_host *host = p->host;
  float(*x)[3] = host->allocate(host, s->vertices * sizeof *x);
  if (!x) return host->fail(host, HK_NO_MEMORY, "no memory to draw a mesh of %zu vertices", s->vertices);
  for (size_t i = 0; i < s->vertices; i++)
    for (int c = 0; c < 3; c++) {
      double at = s->centre[c] - m->origin[c];
      for (int k = 0; k < 3; k++) at += s->vertex[3 * i + (size_t)k] * s->axis[k][c];
      x[i][c] = (float)at;
    }
  hk_status status = hk_solid_add_faces(p, (const float(*)[3])x, s->vertices, s->face, s->faces, m->colour);
  host->release(host, x);
  return status;
}

hk_status hk_solid_add_liquid(hk_painter *p, const hk_frame_solid *solid, const double *normal,
                              const double origin[3]) {
  static const hk_view_setup day = {.background = {1, 1, 1}};
  maker m = make_maker(p, &day, solid, origin);
  if (!normal) return add_surface(&m);
  uint32_t first = (uint32_t)p->vertices;
  for (size_t i = 0; i < solid->vertices; i++) add_vertex(&m, solid->vertex + 3 * i, normal + 3 * i);
  for (size_t k = 0; k < 3 * solid->faces; k++)
    p->triangle[p->triangles + k / 3][k % 3] = first + solid->face[k / 3][k % 3];
  p->triangles += solid->faces;
  return HK_OK;
}

static void add_cylinder(const maker *m) {
  for (int part = -1; part <= 1; part++) { /* bottom, side, top */
    for (int i = 0; i <= 1; i++)
      for (int j = 0; j <= COLUMNS; j++) {
        double angle = 2 * acos(-1) * j / COLUMNS, r = part == 0 ? 1 : part < 0 ? i : 1 - i;
        double p[3] = {r * cos(angle), r * sin(angle), part == 0 ? 2 * i - 1 : part};
        add_vertex(m, p, part == 0 ? (double[]){cos(angle), sin(angle), 0} : (double[]){0, 0, part});
      }
    join(m->painter, 1, COLUMNS);
  }
}

/* One side of the cube: at `sign` along axis c. */
static void add_side(const maker *m, int c, double sign) {
  double normal[3] = {0};
  normal[c] = sign;
  for (int i = 0; i <= 1; i++)
    for (int j = 0; j <= 1; j++) {
      double p[3];
      p[c] = sign, p[(c + 1) % 3] = 2 * j - 1, p[(c + 2) % 3] = sign * (2 * i - 1);
      add_vertex(m, p, normal);
    }
  join(m->painter, 1, 1);
}

static void add_box(const maker *m) {
  for (int c = 0; c < 3; c++)
    for (int sign = -1; sign <= 1; sign += 2) add_side(m, c, sign);
}

/* A square around the point nearest to the middle of the motion. */
static void add_plane(hk_painter *p, const hk_view_setup *setup, const hk_frame_solid *solid, const double origin[3]) {
  hk_frame_solid square = {.kind = HK_SHAPE_PLANE};
  double *u = square.axis[0], *v = square.axis[1], *n = square.axis[2], across = 0, size = length(solid->axis[2]);
  for (int c = 0; c < 3; c++) n[c] = solid->axis[2][c] / fmax(size, 1e-300);
  bool level = fabs(n[2]) > 1 - 1e-9;
  if (level && setup->floor && fabs(solid->centre[2] - origin[2] - setup->height) < 1e-3 * setup->size) return;
  cross(level ? (double[]){0, 1, 0} : (double[]){0, 0, 1}, n, u);
  for (int c = 0; c < 3; c++) across += n[c] * ((setup->low[c] + setup->high[c]) / 2 + origin[c] - solid->centre[c]);
  double scale = 1.5 * setup->size / length(u);
  for (int c = 0; c < 3; c++) {
    square.centre[c] = (setup->low[c] + setup->high[c]) / 2 + origin[c] - across * n[c];
    u[c] *= scale;
  }
  cross(n, u, v);
  maker m = make_maker(p, setup, &square, origin);
  for (int i = 0; i <= 1; i++)
    for (int j = 0; j <= 1; j++) add_vertex(&m, (double[]){2 * j - 1, 2 * i - 1, 0}, (double[]){0, 0, 1});
  join(p, 1, 1);
}

/* Turns what was added since inside out. */
static void turn_round(hk_painter *p, size_t vertices, size_t triangles) {
  for (size_t k = vertices; k < p->vertices; k++)
    for (int c = 0; c < 3; c++) p->vertex[k].normal[c] *= -1;
  for (size_t k = triangles; k < p->triangles; k++) {
    uint32_t *t = p->triangle[k], first = t[0];
    t[0] = t[1], t[1] = first;
  }
}

hk_status hk_solid_mesh_add(hk_painter *p, const hk_view_setup *setup, const hk_frame_solid *solid,
                            const double origin[3]) {
  maker m = make_maker(p, setup, solid, origin);
  size_t vertices = p->vertices, triangles = p->triangles;
  hk_status status = HK_OK;
  switch (solid->kind) {
  case HK_SHAPE_PLANE:
    add_plane(p, setup, solid, origin);
    break;
  case HK_SHAPE_SPHERE:
    add_sphere(&m);
    break;
  case HK_SHAPE_BOX:
    add_box(&m);
    break;
  case HK_SHAPE_CYLINDER:
    add_cylinder(&m);
    break;
  case HK_SHAPE_CAPSULE:
    add_capsule(&m);
    break;
  case HK_SHAPE_MESH:
    status = add_surface(&m);
  }
  if (solid->hollow) turn_round(p, vertices, triangles);
  return status;
}
