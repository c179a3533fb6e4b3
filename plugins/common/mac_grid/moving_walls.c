/* See moving_walls.h. Walls are few beside cells: one thread takes them in order. */
#include "plugins/common/mac_grid/moving_walls.h"
#include "plugins/kit/vector3.h"

#include <string.h>

void hk_moving_walls_clear(hk_moving_walls *s) { s->count = 0; }

hk_status hk_moving_walls_add(hk_moving_walls *s, const hk_host *host, const hk_moving_wall *wall) {
  if (s->count == s->room) {
    size_t room = 2 * s->room + 64;
    hk_moving_wall *grown = host->allocate(host, room * sizeof *grown);
    if (!grown) return host->fail(host, HK_NO_MEMORY, "no memory for %zu cells beside bodies in the liquid", room);
    if (s->count) memcpy(grown, s->wall, s->count * sizeof *grown);
    host->release(host, s->wall);
    s->wall = grown;
    s->room = room;
  }
  s->wall[s->count++] = *wall;
  return HK_OK;
}

static double along(const double a[6], const double b[6]) { return hk_dot(a, b) + hk_dot(a + 3, b + 3); }

void hk_moving_walls_reply(hk_moving_walls *s, const double *in) {
  for (size_t b = 0; b < s->bodies; b++) memset(s->body[b].sum, 0, sizeof s->body[b].sum);
  for (size_t k = 0; k < s->count; k++) {
    double *sum = s->body[s->wall[k].body].sum;
    for (int c = 0; c < 6; c++) sum[c] += in[s->wall[k].row] * s->wall[k].flux[c];
  }
  for (size_t b = 0; b < s->bodies; b++) {
    hk_moving_body *m = &s->body[b];
    for (int c = 0; c < 3; c++) {
      m->reply[c] = m->sum[c] / m->mass;
      m->reply[3 + c] = hk_dot(m->inverse_inertia + 3 * c, m->sum + 3);
    }
  }
}

double hk_moving_walls_multiply(hk_moving_walls *s, const double *in, double *out) {
  double product = 0;
  hk_moving_walls_reply(s, in);
  for (size_t k = 0; k < s->count; k++) out[s->wall[k].row] += along(s->wall[k].flux, s->body[s->wall[k].body].reply);
  for (size_t b = 0; b < s->bodies; b++) product += along(s->body[b].sum, s->body[b].reply);
  return product;
}
