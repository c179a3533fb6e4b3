/* Triangles are filled by their edge functions. On the processor this takes a fraction of the time of OpenGL in
 * software, which would fill depths for one side of the picture's triangles after the other. */
#include "plugins/common/picture/height_map.h"

#include <math.h>
#include <string.h>

enum { SIZE = HK_HEIGHT_MAP_SIZE };

void hk_height_map_begin(hk_height_map *m) {
  int count = m->rows[1] > m->rows[0] ? m->rows[1] - m->rows[0] : 0;
  memset(m->height + (size_t)m->rows[0] * SIZE * (count > 0), 0, sizeof *m->height * SIZE * (size_t)count);
  m->rows[0] = SIZE, m->rows[1] = 0;
}

static void touch(hk_height_map *m, int bottom, int top) {
  if (bottom < m->rows[0]) m->rows[0] = bottom;
  if (top >= m->rows[1]) m->rows[1] = top + 1;
}

/* Texels, and the height in units of the map. */
static void project(const hk_height_map *m, const float x[3], float out[3]) {
  float scale = SIZE / m->side;
  for (int k = 0; k < 2; k++) out[k] = (x[k] - m->lean[k] * (x[2] - m->floor) - m->corner[k]) * scale;
  out[2] = (x[2] - m->low) / (m->high - m->low) * HK_HEIGHT_MAP_TOP;
}

static float least(float a, float b, float c) { return fminf(a, fminf(b, c)); }
static float most(float a, float b, float c) { return fmaxf(a, fmaxf(b, c)); }
static int clamp(float at) { return at < 0 ? 0 : at > SIZE - 1 ? SIZE - 1 : (int)at; }

typedef struct plane { /* value = start + along x + across y, texels from the triangle's lower left */
  float start, along, across;
} plane;

/* The function that is 0 on the edge from a to b, and rises to the left of it. */
static plane edge_function(const float a[3], const float b[3], float turn, float left, float bottom) {
  plane e = {0, turn * (a[1] - b[1]), turn * (b[0] - a[0])};
  e.start = e.along * (left + 0.5f - a[0]) + e.across * (bottom + 0.5f - a[1]);
  return e;
}

/* Fills the texels whose middle is inside. */
static void fill(hk_height_map *m, const float p[3][3]) {
  float low[3], high[3];
  for (int c = 0; c < 3; c++) low[c] = least(p[0][c], p[1][c], p[2][c]), high[c] = most(p[0][c], p[1][c], p[2][c]);
  if (!(high[0] >= 0 && high[1] >= 0 && low[0] < SIZE && low[1] < SIZE)) return;
  float area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
  int left = clamp(low[0]), right = clamp(high[0]), bottom = clamp(low[1]), top = clamp(high[1]);
  float turn = area < 0 ? -1 : 1, inverse = area == 0 ? 0 : 1 / fabsf(area);
  plane e[3], h = {0, 0, 0};
  for (int k = 0; k < 3; k++) {
    e[k] = edge_function(p[k], p[(k + 1) % 3], turn, (float)left, (float)bottom);
    float share = p[(k + 2) % 3][2] * inverse;
    h.start += share * e[k].start, h.along += share * e[k].along, h.across += share * e[k].across;
  }
  touch(m, bottom, top);
  float floor = fmaxf(low[2], 1), roof = fminf(high[2], HK_HEIGHT_MAP_TOP);
  for (int y = bottom; y <= top; y++) {
    float dy = (float)(y - bottom), a = e[0].start + dy * e[0].across, b = e[1].start + dy * e[1].across;
    float c = e[2].start + dy * e[2].across, z = h.start + dy * h.across;
    uint16_t *row = m->height + (size_t)y * SIZE;
    for (int x = left; x <= right; x++) {
      float here = fmaxf(fminf(z, roof), floor);
      if (a >= 0 && b >= 0 && c >= 0 && here > (float)row[x]) row[x] = (uint16_t)here;
      a += e[0].along, b += e[1].along, c += e[2].along, z += h.along;
    }
  }
}

void hk_height_map_triangle(hk_height_map *m, const float a[3], const float b[3], const float c[3]) {
  float p[3][3];
  project(m, a, p[0]), project(m, b, p[1]), project(m, c, p[2]);
  fill(m, (const float(*)[3])p);
}

void hk_height_map_tube(hk_height_map *m, const float a[3], const float b[3], float radius) {
  float end[2][3], half = fmaxf(radius * SIZE / m->side, 0.5f);
  project(m, a, end[0]), project(m, b, end[1]);
  float along[2] = {end[1][0] - end[0][0], end[1][1] - end[0][1]};
  float length = sqrtf(along[0] * along[0] + along[1] * along[1]);
  if (!(length > 0)) return;
  float side[2] = {-along[1] / length * half, along[0] / length * half}, p[4][3];
  for (int k = 0; k < 4; k++) {
    const float *from = end[k / 2];
    float sign = k == 0 || k == 3 ? -1 : 1;
    p[k][0] = from[0] + sign * side[0], p[k][1] = from[1] + sign * side[1], p[k][2] = from[2];
  }
  fill(m, (const float[3][3]){{p[0][0], p[0][1], p[0][2]}, {p[1][0], p[1][1], p[1][2]}, {p[2][0], p[2][1], p[2][2]}});
  fill(m, (const float[3][3]){{p[0][0], p[0][1], p[0][2]}, {p[2][0], p[2][1], p[2][2]}, {p[3][0], p[3][1], p[3][2]}});
}

/* Across the light a sphere is as high as its middle, give or take what no eye sees. */
void hk_height_map_sphere(hk_height_map *m, const float centre[3], float radius) {
  float p[3], r = fmaxf(radius * SIZE / m->side, 0.75f);
  project(m, centre, p);
  if (!(p[0] + r >= 0 && p[0] - r < SIZE && p[1] + r >= 0 && p[1] - r < SIZE)) return;
  float height = fmaxf(fminf(p[2], HK_HEIGHT_MAP_TOP), 1);
  touch(m, clamp(p[1] - r), clamp(p[1] + r));
  for (int y = clamp(p[1] - r); y <= clamp(p[1] + r); y++)
    for (int x = clamp(p[0] - r); x <= clamp(p[0] + r); x++) {
      float dx = (float)x + 0.5f - p[0], dy = (float)y + 0.5f - p[1];
      uint16_t *at = m->height + (size_t)y * SIZE + x;
      if (dx * dx + dy * dy <= r * r && height > (float)*at) *at = (uint16_t)height;
    }
}
