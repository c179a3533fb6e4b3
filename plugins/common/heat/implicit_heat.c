#include "plugins/common/heat/implicit_heat.h"

#include <float.h>
#include <string.h>

enum { MOST_STEPS = 500, MOST_ITERATIONS = 2000, VECTORS = 5 };

static const double by_newton = 1e-4; /* that gradients leave of a step's residual */

hk_status hk_implicit_heat_open(hk_implicit_heat *s, const hk_host *host, size_t most) {
  hk_implicit_heat_close(s);
  *s = (hk_implicit_heat){.host = host, .most = most};
  size_t bytes = (most + 1) * sizeof(double);
  double **list[] = {&s->mass, &s->before, &s->wall_way,  &s->source,  &s->h,
                     &s->heat, &s->given,  &s->potential, &s->diagonal};
  bool all = (s->other = host->allocate(host, (most + 1) * sizeof *s->other)) != NULL;
  all &= (s->way = host->allocate(host, (most + 1) * sizeof *s->way)) != NULL;
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) all &= (*list[k] = host->allocate(host, bytes)) != NULL;
  all &= (s->vectors = host->allocate(host, VECTORS * bytes)) != NULL;
  all &= (s->loop.part = host->allocate(host, (hk_gradients_chunks(most) + 1) * sizeof *s->loop.part)) != NULL;
  return all ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for the heat of %zu cells: take larger ones", most);
}

void hk_implicit_heat_close(hk_implicit_heat *s) {
  void *all[] = {s->mass, s->before, s->other,     s->way,      s->wall_way, s->source,   s->h,
                 s->heat, s->given,  s->potential, s->diagonal, s->vectors,  s->loop.part};
  for (size_t k = 0; k < sizeof all / sizeof *all && s->host; k++) s->host->release(s->host, all[k]);
  *s = (hk_implicit_heat){0};
}

/* ---- sweeps ---- */

/* J/kg: the h for which m h + a theta(h) = b. */
static double solve_one(const hk_heat_law *l, double m, double a, double b) {
  const double *k = l->conductivity, *c = l->capacity;
  double solid = m + a * k[HK_SOLID] / c[HK_SOLID];
  if (!hk_heat_melts(l) || b < 0) return b / solid;
  double within = a * hk_heat_potential(l, l->latent), full = m * l->latent + within;
  if (b < full) return l->latent * (b / full);
  return l->latent + (b - full) / (m + a * k[HK_MOLTEN] / c[HK_MOLTEN]);
}

/* m, of all ways of the cell; *from: W, what would come to it at the potential 0. */
static double ways_of(const hk_implicit_heat *s, size_t i, double *from) {
  double sum = s->wall_way[i];
  *from = s->source[i];
  for (int k = 0; k < HK_HEAT_SIDES; k++) {
    sum += s->way[i][k];
    *from += s->way[i][k] * s->potential[s->other[i][k]];
  }
  return sum;
}

static void relax(hk_implicit_heat *s, size_t i) {
  double from, ways = ways_of(s, i, &from);
  s->h[i] = solve_one(s->law, s->mass[i], s->tau * ways, s->mass[i] * s->before[i] + s->tau * from);
  s->potential[i] = hk_heat_potential(s->law, s->h[i]);
}

static void sweep(hk_implicit_heat *s) {
  for (size_t i = 0; i < s->rows; i++) relax(s, i);
  for (size_t i = s->rows; i-- > 0;) relax(s, i);
  s->sweeps++;
}

/* J: r, what the equations are off by; returns the largest by the mass, J/kg, beyond what rounding comes to. */
static double residual(const hk_implicit_heat *s, double *r) {
  double most = 0;
  for (size_t i = 0; i < s->rows; i++) {
    double from, ways = ways_of(s, i, &from), lost = s->tau * (ways * s->potential[i]);
    r[i] = s->mass[i] * (s->before[i] - s->h[i]) + (s->tau * from - lost);
    double rounding = s->mass[i] * (fabs(s->before[i]) + fabs(s->h[i])) + s->tau * fabs(from) + fabs(lost);
    most = fmax(most, (fabs(r[i]) - 8 * DBL_EPSILON * rounding) / s->mass[i]);
  }
  return most;
}

/* ---- Newton's steps ---- */

/* Of the change of theta: (M/theta' + tau L) phi = r where theta has a slope; elsewhere phi is 0. */
static void fill_diagonal(hk_implicit_heat *s, double *r) {
  for (size_t i = 0; i < s->rows; i++) {
    double from, slope = hk_heat_potential_slope(s->law, s->h[i]);
    s->diagonal[i] = slope > 0 ? s->mass[i] / slope + s->tau * ways_of(s, i, &from) : 0;
    if (!(slope > 0)) r[i] = 0;
  }
}

static double product(void *context, const double *p, double *q) {
  const hk_implicit_heat *s = context;
  double sum = 0;
  for (size_t i = 0; i < s->rows; i++) {
    double from = 0;
    for (int k = 0; k < HK_HEAT_SIDES; k++) from += s->way[i][k] * p[s->other[i][k]];
    q[i] = s->diagonal[i] > 0 ? s->diagonal[i] * p[i] - s->tau * from : 0;
    sum += p[i] * q[i];
  }
  return sum;
}

/* Symmetric Gauss and Seidel: (D - L) D^-1 (D - U) z = r. */
static double precondition(void *context, const double *r, double *z) {
  const hk_implicit_heat *s = context;
  double sum = 0;
  for (size_t i = 0; i < s->rows; i++) {
    double from = 0;
    for (int k = 0; k < HK_HEAT_SIDES; k++)
      if (s->other[i][k] < i) from += s->way[i][k] * z[s->other[i][k]];
    z[i] = s->diagonal[i] > 0 ? (r[i] + s->tau * from) / s->diagonal[i] : 0;
  }
  for (size_t i = s->rows; i-- > 0;) {
    double from = 0;
    for (int k = 0; k < HK_HEAT_SIDES; k++)
      if (s->other[i][k] > i) from += s->way[i][k] * z[s->other[i][k]];
    if (s->diagonal[i] > 0) z[i] += s->tau * from / s->diagonal[i];
    sum += r[i] * z[i];
  }
  return sum;
}

/* The functional whose derivative by theta is -r, and which the solution makes least.
 * It is convex: integrals of h over theta, and tau/2 of the squares of differences. */
static double functional(const hk_implicit_heat *s, const double *theta) {
  double sum = 0;
  for (size_t i = 0; i < s->rows; i++) {
    double squares = s->wall_way[i] * theta[i] * theta[i];
    for (int k = 0; k < HK_HEAT_SIDES; k++) {
      double d = theta[s->other[i][k]] - theta[i];
      squares += s->way[i][k] * d * d / 2;
    }
    sum += s->mass[i] * (hk_heat_integral(s->law, theta[i]) - s->before[i] * theta[i]) +
           s->tau * (squares / 2 - s->source[i] * theta[i]);
  }
  return sum;
}

/* theta + part phi, which stays in its phase: at a corner of the law it stops. */
static double limited(const hk_heat_law *l, double h, double theta, double change) {
  double to = theta + change, within = hk_heat_melts(l) ? hk_heat_potential(l, l->latent) : 0;
  if (!hk_heat_melts(l)) return to;
  if (h < 0) return fmin(to, 0);
  return h < l->latent ? fmax(0, fmin(to, within)) : fmax(to, within);
}

/* The longest part of phi, by halves, that makes the functional less; the sweep that follows does the rest. */
static void change_by(hk_implicit_heat *s, const double *phi, double *theta) {
  double before = functional(s, s->potential);
  for (double part = 1; part > 1e-3; part /= 2) {
    for (size_t i = 0; i < s->rows; i++)
      theta[i] = s->diagonal[i] > 0 ? limited(s->law, s->h[i], s->potential[i], part * phi[i]) : s->potential[i];
    if (!(functional(s, theta) < before + 1e-14 * fabs(before))) continue;
    for (size_t i = 0; i < s->rows; i++) {
      if (s->diagonal[i] > 0) s->h[i] += (theta[i] - s->potential[i]) / hk_heat_potential_slope(s->law, s->h[i]);
      s->potential[i] = theta[i];
    }
    return;
  }
}

/* r: as of `residual`. False: gradients did not converge. */
static bool newton(hk_implicit_heat *s, const double *r) {
  hk_gradients_loop *l = &s->loop;
  double *vector[VECTORS];
  for (int k = 0; k < VECTORS; k++) vector[k] = s->vectors + (size_t)k * (s->most + 1);
  *l = (hk_gradients_loop){.host = s->host,
                           .unknowns = s->rows,
                           .x = s->heat,
                           .r = vector[0],
                           .z = vector[1],
                           .p = vector[2],
                           .q = vector[3],
                           .part = l->part,
                           .context = s,
                           .product = product,
                           .precondition = precondition};
  memcpy(l->r, r, s->rows * sizeof *r);
  memset(l->x, 0, s->rows * sizeof *l->x);
  fill_diagonal(s, l->r);
  for (size_t i = 0; i < s->rows; i++) {
    l->left.squares += l->r[i] * l->r[i];
    l->left.largest = fmax(l->left.largest, fabs(l->r[i]));
  }
  s->steps++;
  hk_residual goal = {by_newton * by_newton * l->left.squares, INFINITY};
  if (l->left.squares > 0 && !hk_gradients_iterate(l, &goal, MOST_ITERATIONS)) return false;
  s->iterations += l->iterations;
  change_by(s, l->x, l->z);
  return true;
}

/* ---- the step ---- */

static void share_out(hk_implicit_heat *s) {
  for (size_t i = 0; i < s->rows; i++) {
    double between = 0, outside = s->source[i] - s->wall_way[i] * s->potential[i];
    for (int k = 0; k < HK_HEAT_SIDES; k++) between += s->way[i][k] * (s->potential[s->other[i][k]] - s->potential[i]);
    s->given[i] = s->tau * outside / s->mass[i];
    s->heat[i] = s->tau * (between + outside) / s->mass[i];
  }
}

hk_status hk_implicit_heat_solve(hk_implicit_heat *s, double tolerance) {
  double *r = s->given; /* until the heat is shared out */
  s->sweeps = s->steps = s->iterations = 0;
  for (size_t i = 0; i < s->rows; i++) {
    s->h[i] = s->before[i];
    s->potential[i] = hk_heat_potential(s->law, s->h[i]);
  }
  double goal = tolerance * residual(s, r), last = INFINITY, left;
  for (int k = 0; k < MOST_STEPS; k++) {
    sweep(s);
    left = residual(s, r);
    if (left <= goal) break;
    /* a step of Newton's, where sweeps alone come on slowly */
    if (left > 0.1 * last && !newton(s, r)) break;
    last = left;
  }
  if (!(left <= goal))
    return s->host->fail(s->host, HK_NOT_CONVERGED,
                         "the heat of %zu cells is off by %.2g J/kg after %d steps of Newton's method, where %.2g was "
                         "asked for: take shorter steps",
                         s->rows, left, s->steps, goal);
  share_out(s);
  return HK_OK;
}
