/* See outlet.h. Places are uniform by length, area or volume, directions by solid angle. Triangles are chosen by their
 * areas at the start, so that the choice does not depend on the steps; their corners are taken back along their
 * velocities to the time of the birth. */
#include "plugins/common/emission/outlet.h"

static const double degree = 0.017453292519943295, turn = 6.283185307179586;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double out[3]) {
  for (int c = 0; c < 3; c++) out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

/* False: the vector is 0. */
static bool normalize(double v[3]) {
  double length = sqrt(dot(v, v));
  for (int c = 0; c < 3 && length > 0; c++) v[c] /= length;
  return length > 0;
}

/* The corner m of triangle k, `age` s before the view's time. */
static void corner(const hk_outlet *o, const hk_view *view, size_t k, int m, double age, double x[3]) {
  size_t i = hk_tuple(&o->triangles, k)[m];
  for (size_t c = 0; c < 3; c++) x[c] = view->x[3 * i + c] - age * view->v[3 * i + c];
}

/* Twice the area, along the normal. */
static void normal_of(const double x[3][3], double out[3]) {
  double a[3], b[3];
  for (int c = 0; c < 3; c++) a[c] = x[1][c] - x[0][c], b[c] = x[2][c] - x[0][c];
  cross(a, b, out);
}

static void add_areas(hk_outlet *o, const hk_view *view) {
  double sum = 0;
  o->areas = o->triangles.count;
  for (size_t k = 0; k < o->areas; k++) {
    double x[3][3], n[3];
    for (int m = 0; m < 3; m++) corner(o, view, k, m, 0, x[m]);
    normal_of((const double(*)[3])x, n);
    o->area[k] = sum += sqrt(dot(n, n)) / 2;
  }
}

static hk_status open_triangles(hk_outlet *o, const hk_host *host, const hk_view *view) {
  if (o->triangles.count == 0)
    return host->fail(host, HK_BAD_PARAM,
                      "shape 'triangles' needs triangles of particles: triangles = mesh:triangles()");
  o->area = host->allocate(host, o->triangles.count * sizeof *o->area);
  if (!o->area) return host->fail(host, HK_NO_MEMORY, "no memory for %zu triangles", o->triangles.count);
  add_areas(o, view);
  if (o->area[o->areas - 1] > 0) return HK_OK;
  return host->fail(host, HK_BAD_PARAM, "triangles: all %zu have the area 0", o->areas);
}

hk_status hk_outlet_open(hk_outlet *o, const hk_host *host, const hk_view *view) {
  if (!normalize(o->direction)) return host->fail(host, HK_BAD_PARAM, "direction: must not be zero");
  if (o->shape == HK_OUTLET_TRIANGLES) return open_triangles(o, host, view);
  if (o->triangles.count > 0)
    return host->fail(host, HK_BAD_PARAM, "triangles are for shape = \"triangles\", and the shape is another one");
  return HK_OK;
}

void hk_outlet_topology(hk_outlet *o, const hk_view *view) {
  if (o->area && o->areas != o->triangles.count) add_areas(o, view);
}

void hk_outlet_close(hk_outlet *o, const hk_host *host) { host->release(host, o->area); }

/* ---- drawing ---- */

/* Two unit vectors at right angles to a third and to each other. */
static void complete(const double axis[3], double u[3], double v[3]) {
  int least = 0;
  for (int c = 1; c < 3; c++)
    if (fabs(axis[c]) < fabs(axis[least])) least = c;
  cross(axis, (const double[3]){least == 0, least == 1, least == 2}, u);
  normalize(u);
  cross(axis, u, v);
}

/* Turns `axis`, a unit vector, by an angle in the cone, uniformly by solid angle. */
static void draw_direction(double cone, hk_draw *d, double axis[3]) {
  double along = 1 - hk_draw_uniform(d) * (1 - cos(cone * degree)), angle = turn * hk_draw_uniform(d);
  double across = sqrt(fmax(0, 1 - along * along)), u[3], v[3];
  if (cone == 0) return;
  complete(axis, u, v);
  for (int c = 0; c < 3; c++) axis[c] = along * axis[c] + across * (cos(angle) * u[c] + sin(angle) * v[c]);
}

static size_t choose_triangle(const hk_outlet *o, double u) {
  double wanted = u * o->area[o->areas - 1];
  size_t low = 0, high = o->areas - 1;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (o->area[middle] < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static void draw_on_triangle(const hk_outlet *o, const hk_view *view, double age, const double u[3], double position[3],
                             double velocity[3], double direction[3]) {
  size_t k = choose_triangle(o, u[2]);
  double root = sqrt(u[0]), weight[3] = {1 - root, root * (1 - u[1]), root * u[1]}, x[3][3], normal[3];
  for (int c = 0; c < 3; c++) position[c] = velocity[c] = 0;
  for (int m = 0; m < 3; m++) {
    size_t i = hk_tuple(&o->triangles, k)[m];
    corner(o, view, k, m, age, x[m]);
    for (size_t c = 0; c < 3; c++) {
      position[c] += weight[m] * x[m][c];
      velocity[c] += weight[m] * view->v[3 * i + c];
    }
  }
  normal_of((const double(*)[3])x, normal);
  if (normalize(normal))
    for (int c = 0; c < 3; c++) direction[c] = normal[c];
}

/* A unit vector, uniform on the sphere. */
static void draw_on_sphere(const double u[3], double out[3]) {
  double z = 1 - 2 * u[0], r = sqrt(fmax(0, 1 - z * z));
  out[0] = r * cos(turn * u[1]);
  out[1] = r * sin(turn * u[1]);
  out[2] = z;
}

static void draw_on_disc(const hk_outlet *o, const double u[3], double position[3]) {
  double a[3], b[3], r = o->radius * sqrt(u[0]);
  complete(o->direction, a, b);
  for (int c = 0; c < 3; c++) position[c] += r * (cos(turn * u[1]) * a[c] + sin(turn * u[1]) * b[c]);
}

static void take_even(const hk_outlet *o, uint64_t k, double u[3]) {
  /* the roots of f^(d+1) = f + 1 */
  static const double root[3] = {1.6180339887498949, 1.3247179572447460, 1.2207440846057595};
  int d = o->shape == HK_OUTLET_LINE ? 1 : o->shape == HK_OUTLET_DISC || o->shape == HK_OUTLET_SPHERE ? 2 : 3;
  double part = 1;
  for (int c = 0; c < d; c++) {
    double whole;
    part /= root[d - 1];
    u[c] = modf(0.5 + (double)k * part, &whole);
  }
}

void hk_outlet_draw(const hk_outlet *o, const hk_view *view, double age, uint64_t k, hk_draw *d, double position[3],
                    double velocity[3], double direction[3]) {
  double u[3] = {hk_draw_uniform(d), hk_draw_uniform(d), hk_draw_uniform(d)}, unit[3];
  if (o->places == HK_OUTLET_EVEN) take_even(o, k, u);
  for (int c = 0; c < 3; c++) {
    position[c] = o->position[c];
    velocity[c] = 0;
    direction[c] = o->direction[c];
  }
  draw_on_sphere(u, unit);
  for (int c = 0; c < 3; c++) {
    if (o->shape == HK_OUTLET_LINE) position[c] += u[0] * (o->end[c] - o->position[c]);
    if (o->shape == HK_OUTLET_SPHERE) position[c] += o->radius * (direction[c] = unit[c]);
    if (o->shape == HK_OUTLET_BALL) position[c] += o->radius * pow(u[2], 1.0 / 3) * unit[c];
  }
  if (o->shape == HK_OUTLET_DISC) draw_on_disc(o, u, position);
  if (o->shape == HK_OUTLET_TRIANGLES) draw_on_triangle(o, view, age, u, position, velocity, direction);
  draw_direction(o->cone, d, direction);
}
