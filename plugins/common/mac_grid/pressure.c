/* The matrix of the pressure, its preconditioners and its solution. */
#include "plugins/common/mac_grid/pressure.h"

#include <string.h>

enum { PIECE = HK_GRADIENTS_CHUNK, MOST_ITERATIONS = 2000, MANY = 4096 /* rows, from which the V-cycle costs less */ };

static const double modification = 0.97, safety = 0.25; /* Bridson 2015, figure 5.8 */

hk_status hk_pressure_open(hk_pressure *p, const hk_host *host, const hk_liquid_grid *g) {
  size_t most = g->cells[0] * g->cells[1] * g->cells[2];
  memset(p, 0, sizeof *p);
  p->host = host;
  p->most = most;
  p->axis[0] = hk_liquid_inner(g);
  p->axis[1] = hk_liquid_middle(g);
  p->axis[2] = g->slab;
  double **numbers[] = {&p->diagonal, &p->side[0], &p->side[1], &p->side[2], &p->pivot, &p->b,
                        &p->x,        &p->r,       &p->z,       &p->s,       &p->q};
  uint32_t **lists[] = {&p->cell,     &p->next[0],  &p->next[1],  &p->next[2],
                        &p->prior[0], &p->prior[1], &p->prior[2], &p->part};
  bool all = (p->sums = host->allocate(host, (most / PIECE + 2) * sizeof(double))) != NULL;
  all &= (p->loop.part = host->allocate(host, (most / PIECE + 2) * sizeof *p->loop.part)) != NULL;
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
    all &= (*numbers[k] = host->allocate(host, (most + 1) * sizeof(double))) != NULL;
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
    all &= (*lists[k] = host->allocate(host, (most + 1) * sizeof(uint32_t))) != NULL;
  const size_t cells[3] = {g->cells[p->axis[0]], g->cells[p->axis[1]], g->cells[p->axis[2]]};
  if (all && hk_vcycle_open(&p->vcycle, host, cells) == HK_OK) return HK_OK;
  hk_pressure_close(p);
  return HK_NO_MEMORY;
}

void hk_pressure_close(hk_pressure *p) {
  if (!p->host) return;
  double *numbers[] = {p->diagonal, p->side[0], p->side[1], p->side[2], p->pivot, p->b,
                       p->x,        p->r,       p->z,       p->s,       p->q,     p->sums};
  uint32_t *lists[] = {p->cell, p->next[0], p->next[1], p->next[2], p->prior[0], p->prior[1], p->prior[2], p->part};
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) p->host->release(p->host, numbers[k]);
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) p->host->release(p->host, lists[k]);
  p->host->release(p->host, p->loop.part);
  if (p->vcycle.host) hk_vcycle_close(&p->vcycle);
  p->host->release(p->host, p->walls.wall);
  p->host->release(p->host, p->walls.body);
  memset(p, 0, sizeof *p);
}

/* ---- incomplete factors ---- */

static void factorize(hk_pressure *p) {
  for (size_t i = 0; i < p->rows; i++) {
    double e = p->diagonal[i];
    for (int c = 0; c < 3; c++) {
      size_t j = p->prior[c][i];
      double w = p->side[c][j] * p->pivot[j];
      double others = p->side[0][j] + p->side[1][j] + p->side[2][j] - p->side[c][j];
      e -= w * w + modification * w * others * p->pivot[j];
    }
    if (e < safety * p->diagonal[i]) e = p->diagonal[i];
    p->pivot[i] = e > 0 ? 1 / sqrt(e) : 0;
  }
}

static void solve_factors(hk_pressure *p) {
  for (size_t i = 0; i < p->rows; i++) {
    double t = p->r[i];
    for (int c = 0; c < 3; c++) {
      size_t j = p->prior[c][i];
      t += p->side[c][j] * p->q[j];
    }
    p->q[i] = t * p->pivot[i] * p->pivot[i];
  }
  for (size_t i = p->rows; i-- > 0;) {
    double t = 0;
    for (int c = 0; c < 3; c++) t += p->side[c][i] * p->z[p->next[c][i]];
    p->z[i] = p->q[i] + t * p->pivot[i] * p->pivot[i];
  }
}

/* ---- the V-cycle ---- */

static void fill_piece(void *context, size_t begin, size_t end, size_t piece) {
  hk_pressure *p = context;
  hk_vcycle_level *l = &p->vcycle.level[0];
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    l->diagonal[p->cell[k]] = (float)(p->diagonal[k] / p->unit);
    for (int a = 0; a < 3; a++) l->side[a][p->cell[k]] = (float)(p->side[p->axis[a]][k] / p->unit);
  }
}

static void build_cycle(hk_pressure *p) {
  p->unit = 0;
  for (size_t k = 0; k < p->rows; k++) p->unit = fmax(p->unit, p->diagonal[k]);
  hk_vcycle_clear(&p->vcycle);
  if (p->unit > 0) p->host->parallel_for(p->host, p->rows, PIECE, fill_piece, p);
  hk_vcycle_build(&p->vcycle);
}

/* In single precision: the largest number of r becomes 1. */
static void give_piece(void *context, size_t begin, size_t end, size_t piece) {
  hk_pressure *p = context;
  double unit = 1 / p->loop.left.largest;
  (void)piece;
  for (size_t k = begin; k < end; k++) p->vcycle.level[0].b[p->cell[k]] = (float)(unit * p->r[k]);
}

/* The sum is r.z. */
static void take_piece(void *context, size_t begin, size_t end, size_t piece) {
  hk_pressure *p = context;
  double unit = p->loop.left.largest / p->unit, sum = 0;
  for (size_t k = begin; k < end; k++) {
    p->z[k] = unit * (double)p->vcycle.level[0].x[p->cell[k]];
    sum += p->r[k] * p->z[k];
  }
  p->sums[piece] = sum;
}

void hk_pressure_prepare(hk_pressure *p) {
  size_t none = p->rows;
  p->pivot[none] = p->x[none] = p->z[none] = p->s[none] = p->q[none] = p->r[none] = 0;
  for (int c = 0; c < 3; c++) p->side[c][none] = 0;
  p->cycles = p->way == HK_PRESSURE_AUTO ? p->rows > MANY : p->way == HK_PRESSURE_VCYCLE;
  if (p->cycles)
    build_cycle(p);
  else
    factorize(p);
}

/* ---- products and sums ---- */

typedef struct task {
  hk_pressure *p;
  const double *in;
  double *out;
} task;

static double times(const hk_pressure *p, const double *in, size_t i) {
  double t = p->diagonal[i] * in[i];
  for (int c = 0; c < 3; c++) {
    size_t j = p->prior[c][i];
    t -= p->side[c][i] * in[p->next[c][i]] + p->side[c][j] * in[j];
  }
  return t;
}

/* out = A in; the sum is in.out. */
static void multiply_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  double sum = 0;
  for (size_t i = begin; i < end; i++) {
    t->out[i] = times(t->p, t->in, i);
    sum += t->in[i] * t->out[i];
  }
  t->p->sums[piece] = sum;
}

static void dot_piece(void *context, size_t begin, size_t end, size_t piece) {
  hk_pressure *p = context;
  double sum = 0;
  for (size_t i = begin; i < end; i++) sum += p->r[i] * p->z[i];
  p->sums[piece] = sum;
}

typedef void (*piece_body)(void *, size_t, size_t, size_t);

static double total(hk_pressure *p, piece_body body, void *context) {
  p->host->parallel_for(p->host, p->rows, PIECE, body, context);
  double sum = 0;
  for (size_t k = 0; k * PIECE < p->rows; k++) sum += p->sums[k];
  return sum;
}

static double product(void *context, const double *in, double *out) {
  hk_pressure *p = context;
  double sum = total(p, multiply_piece, &(task){p, in, out});
  return p->walls.count ? sum + hk_moving_walls_multiply(&p->walls, in, out) : sum;
}

/* From r of the pressure to z, which are the loop's. */
static double precondition(void *context, const double *r, double *z) {
  hk_pressure *p = context;
  (void)r;
  (void)z;
  if (!p->cycles) {
    solve_factors(p);
    return total(p, dot_piece, p);
  }
  p->host->parallel_for(p->host, p->rows, PIECE, give_piece, p);
  hk_vcycle_run(&p->vcycle);
  return total(p, take_piece, p);
}

/* ---- parts without a surface ---- */

/* The row from which i is reached: `part` is a forest of links to rows that come before. */
static uint32_t root_of(uint32_t *part, uint32_t i) {
  while (part[i] != i) i = part[i] = part[part[i]];
  return i;
}

static void join(uint32_t *part, uint32_t i, uint32_t j) {
  uint32_t a = root_of(part, i), b = root_of(part, j);
  part[a > b ? a : b] = a > b ? b : a;
}

/* Rows beside the same body that pressure moves: cloth between two closed parts, say. */
static void join_by_walls(hk_pressure *p) {
  hk_moving_walls *walls = &p->walls;
  for (size_t b = 0; b < walls->bodies && walls->count; b++) walls->body[b].row = UINT32_MAX;
  for (size_t k = 0; k < walls->count; k++) {
    hk_moving_body *body = &walls->body[walls->wall[k].body];
    if (hk_moving_body_is_held(body)) continue;
    if (body->row == UINT32_MAX) body->row = walls->wall[k].row;
    join(p->part, body->row, walls->wall[k].row);
  }
}

static void join_parts(hk_pressure *p) {
  for (size_t i = 0; i < p->rows; i++) {
    p->part[i] = (uint32_t)i;
    for (int c = 0; c < 3; c++) {
      size_t j = p->prior[c][i];
      if (j == p->rows || !(p->side[c][j] > 0)) continue;
      join(p->part, (uint32_t)j, (uint32_t)i);
    }
  }
  join_by_walls(p);
  for (size_t i = 0; i < p->rows; i++) p->part[i] = root_of(p->part, (uint32_t)i);
}

/* z: what bodies do where the pressure is the same in all rows: 0 in a part that they can neither widen nor narrow. */
static void push_all(hk_pressure *p) {
  memset(p->z, 0, p->rows * sizeof(double));
  if (p->walls.count == 0) return;
  for (size_t i = 0; i < p->rows; i++) p->r[i] = 1;
  hk_moving_walls_multiply(&p->walls, p->r, p->z);
}

/* Of a part without a surface, nor cloth that gives way, the sum of b has to be zero. What its rows have on the
 * diagonal beyond their neighbours, and by bodies, is its hold, z of its first row; s: sum of b; q: rows. */
static void take_means(hk_pressure *p) {
  join_parts(p);
  push_all(p);
  memset(p->s, 0, p->rows * sizeof(double));
  memset(p->q, 0, p->rows * sizeof(double));
  for (size_t i = 0; i < p->rows; i++) {
    uint32_t k = p->part[i];
    double hold = p->diagonal[i] + fabs(p->z[i]);
    for (int c = 0; c < 3; c++) hold -= p->side[c][i] + p->side[c][p->prior[c][i]];
    p->z[k] = fmax(i == k ? 0 : p->z[k], hold / p->diagonal[i]);
    p->s[k] += p->b[i];
    p->q[k]++;
  }
  for (size_t i = 0; i < p->rows; i++) {
    uint32_t k = p->part[i];
    if (p->z[k] < 1e-9) p->b[i] -= p->s[k] / p->q[k];
  }
}

static double largest_of(const double *v, size_t rows) {
  double most = 0;
  for (size_t i = 0; i < rows; i++) most = fmax(most, fabs(v[i]));
  return most;
}

/* ---- the solution ---- */

/* The residual of the first guess, which is dropped where it is worse than none. Returns its largest number. */
static double begin(hk_pressure *p) {
  product(p, p->x, p->q);
  for (size_t i = 0; i < p->rows; i++) p->r[i] = p->b[i] - p->q[i];
  double most = largest_of(p->r, p->rows), without = largest_of(p->b, p->rows);
  if (most < without) return most;
  memset(p->x, 0, p->rows * sizeof(double));
  memcpy(p->r, p->b, p->rows * sizeof(double));
  return without;
}

bool hk_pressure_solve(hk_pressure *p, double tolerance, double floor) {
  p->iterations = 0;
  if (p->rows == 0) return true;
  const hk_residual goal = {INFINITY, fmax(floor, tolerance * largest_of(p->b, p->rows))};
  take_means(p);
  double most = begin(p);
  memset(p->s, 0, p->rows * sizeof(double));
  hk_gradients_loop *loop = &p->loop;
  *loop = (hk_gradients_loop){.host = p->host,
                              .unknowns = p->rows,
                              .x = p->x,
                              .r = p->r,
                              .z = p->z,
                              .p = p->s,
                              .q = p->q,
                              .part = loop->part,
                              .context = p,
                              .product = product,
                              .precondition = precondition,
                              .left = {0, most}};
  if (most <= goal.largest) return true;
  bool done = hk_gradients_iterate(loop, &goal, MOST_ITERATIONS);
  p->iterations = loop->iterations;
  return done && loop->left.largest <= goal.largest;
}
