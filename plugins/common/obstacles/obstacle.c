#include "plugins/common/obstacles/obstacle.h"
#include "plugins/common/obstacles/parabola.h"
#include "plugins/kit/vector3.h"

#include <float.h>
#include <string.h>

enum { MOST_EVENTS = 2000, REACTIONS = 4, MOST_REACTIONS = 100 };

/* The shortest flight between two bounces, as a part of the step; below it, at e = 1, a particle counts as lying. It
 * rises by a (1e-3 h)^2/8 in it. */
static const double shortest_flight = 1e-3;
/* Speeds below this part of what the step's acceleration makes are rest: far above rounding, far below what shows. */
static const double rest = 1e-10;

/* One particle on its way. Between events the path is the parabola from (x, u) to (x_end, u_end). */
typedef struct particle_path {
  const hk_obstacle_set *set;
  hk_obstacle_step *step;
  double s;                  /* part of the step that is done */
  double x[3], u[3];         /* now */
  double a[3];               /* m/s^2, without obstacles */
  double drift[3];           /* m/s, by which u differs from dx/dt in the method's step */
  double x_end[3], u_end[3]; /* at the end of the step, if nothing more happens */
  double until;              /* part of the step at which a sliding particle stops */
  uint64_t resting, stuck;   /* on whom it lies; whom it moves with */
  uint64_t leaving;          /* whose surface bends away from under it */
  int reactions;             /* since the last start */
} particle_path;

static double remaining(const particle_path *m) { return m->step->h * (1 - m->s); }

/* Goes on from here without reactions. */
static void start_anew(particle_path *m) {
  double tau = remaining(m);
  for (int c = 0; c < 3; c++) {
    m->u_end[c] = m->u[c] + tau * m->a[c];
    m->x_end[c] = m->x[c] + tau * (m->u[c] - m->drift[c] + tau / 2 * m->a[c]);
  }
  m->until = 1;
  m->resting = m->stuck = m->leaving = 0;
  m->reactions = 0;
}

double hk_obstacle_gap(const hk_obstacle *o, const hk_body_frame *f, const double x[3], size_t i, double n[3]) {
  double p[3], own[3];
  hk_body_point(f, x, p);
  double gap = hk_shape_distance(&o->shape, p, own) - hk_obstacle_radius(o, i);
  hk_body_direction(f, own, n);
  return gap;
}

double hk_obstacle_rounding(const hk_obstacle *o, const double *x_from, const double *x, size_t i) {
  const double *at = o->motion.end.origin;
  double scale = hk_shape_size(&o->shape) + hk_obstacle_radius(o, i);
  for (int c = 0; c < 3; c++) scale += fabs(x_from[c]) + fabs(x[c]) + fabs(at[c]);
  return 16 * DBL_EPSILON * scale;
}

static double tolerance(const hk_obstacle *o, const hk_obstacle_step *step) {
  return hk_obstacle_rounding(o, step->x_from, step->x, step->i);
}

/* The rest of the path in the obstacle's frame: through its position and velocity of now and its position at the end.
 * w: its velocity; w_end: that at the end. */
static hk_parabola path_past(const particle_path *m, const hk_obstacle *o, const hk_body_frame *now, double w[3],
                             double w_end[3]) {
  double tau = remaining(m), p_end[3], way[3];
  hk_parabola path = {.span = tau};
  hk_subtract(way, m->u, m->drift);
  hk_body_point(now, m->x, path.p);
  hk_body_velocity(now, m->x, way, path.w);
  hk_body_velocity(now, m->x, m->u, w);
  hk_body_point(&o->motion.end, m->x_end, p_end);
  hk_body_velocity(&o->motion.end, m->x_end, m->u_end, w_end);
  for (int c = 0; c < 3; c++)
    path.a[c] = o->motion.still ? (w_end[c] - w[c]) / tau : 2 * ((p_end[c] - path.p[c]) / tau - path.w[c]) / tau;
  return path;
}

/* ---- going on ---- */

/* By the time t. */
static void advance(particle_path *m, double t) {
  double tau = remaining(m);
  if (t <= 0) return;
  for (int c = 0; c < 3; c++) {
    double a = (m->u_end[c] - m->u[c]) / tau, u = (m->x_end[c] - m->x[c]) / tau - tau / 2 * a;
    m->x[c] += t * (u + t / 2 * a);
    m->u[c] += t * a;
  }
  m->s = fmin(1, m->s + t / m->step->h);
}

/* A meeting of the particle with an obstacle. */
typedef struct event {
  double t; /* s from now; INFINITY: none */
  const hk_obstacle *o;
  uint64_t bit;
  hk_parabola path;
  double w[3], w_end[3];
  hk_body_frame frame;
} event;

/* After an impact the particle is on its own: a drift away from the surface would be a hop without end. */
static void forget_drift(particle_path *m) { hk_subtract(m->drift, m->drift, m->drift); }

/* m/s, below which the velocity w is rest, or one that is along the surface. */
static double slowest(const particle_path *m, const double w[3]) {
  return rest * hk_length(m->a) * m->step->h + 16 * DBL_EPSILON * hk_length(w);
}

/* ---- impact ---- */

/* The restitution that counts: none where the bounces end within the step. */
static double restitution(const particle_path *m, const hk_obstacle *o, double closing, double pull) {
  double e = o->restitution, flight = 2 * e * closing / pull;
  if (!(pull > 0)) return e;
  return flight <= (1 - e) * remaining(m) || flight <= shortest_flight * m->step->h ? 0 : e;
}

static void strike(particle_path *m, const event *at, const double n[3]) {
  const double *w = at->w;
  double along = hk_dot(w, n), e = restitution(m, at->o, -along, -hk_dot(at->path.a, n)), across[3], change[3], du[3];
  for (int c = 0; c < 3; c++) across[c] = w[c] - along * n[c];
  double impulse = -(1 + e) * along, speed = hk_length(across), drag = fmin(at->o->friction * impulse, speed);
  for (int c = 0; c < 3; c++) change[c] = impulse * n[c] - (speed > 0 ? drag * across[c] / speed : 0);
  hk_body_direction(&at->frame, change, du);
  if (-along > hk_length(m->a) * m->step->h) m->step->landing = fmin(m->step->landing, m->s);
  hk_add_scaled(m->u, 1, du);
  forget_drift(m);
  start_anew(m);
}

/* ---- contact that lasts ---- */

/* The normal acceleration N that keeps the end of the path on the surface, and the normal there. On curved surfaces the
 * distance is not linear. */
static double reaction(const hk_parabola *path, const hk_obstacle *o, double radius, const double n[3],
                       double n_end[3]) {
  double p[3], w[3], N = 0, tau = path->span;
  hk_parabola_at(path, tau, p, w);
  for (int k = 0; k < REACTIONS; k++) {
    double more = -2 * (hk_shape_distance(&o->shape, p, n_end) - radius) / (tau * tau);
    if (k == 0 && more <= 0) return 0;
    if (fabs(more) <= 1e-14 * N) break;
    N += more;
    hk_add_scaled(p, tau * tau / 2 * more, n);
  }
  return fmax(N, 0);
}

/* 1/s: over the time in which a constant force of size `limit` (per mass) brings w to rest against the pull a: the
 * positive root q of |w q + a| = limit. */
static double stopping(const double w[3], const double a[3], double limit) {
  double wa = hk_dot(w, a), ww = hk_dot(w, w), square = wa * wa + ww * (limit * limit - hk_dot(a, a));
  return limit * limit > hk_dot(a, a) ? (sqrt(square) - wa) / ww : 0;
}

/* Adds friction of mu N = `limit` to `change`: that which brings the particle to rest, where it does so before the end
 * of the path, else against the velocity of the middle. False: it stays where it is. */
static bool slides(particle_path *m, const event *e, double limit, const double n[3], double change[3]) {
  double along = hk_dot(e->w, n), pull = hk_dot(e->path.a, n), tau = e->path.span, w[3], a[3], d[3];
  for (int c = 0; c < 3; c++) {
    w[c] = e->w[c] - along * n[c];
    a[c] = e->path.a[c] - pull * n[c];
  }
  double speed = hk_length(w), drive = hk_length(a);
  bool moves = speed > slowest(m, m->u);
  if (!moves && drive <= limit) return false;
  if (limit == 0) return true;
  double rate = moves ? stopping(w, a, limit) : 0;
  if (rate * tau > 1) {
    m->until = fmin(m->until, m->s + 1 / (rate * m->step->h));
    for (int c = 0; c < 3; c++) change[c] -= rate * w[c] + a[c];
    return true;
  }
  for (int c = 0; c < 3; c++) d[c] = moves ? w[c] + tau / 2 * (a[c] - limit * w[c] / speed) : a[c];
  hk_add_scaled(change, -limit / hk_length(d), d);
  return true;
}

/* The reaction that friction follows, where N keeps the end of the path on the surface: a drift towards it, of h a/2
 * over the number of its parts for a step in parts of order 1, is no load. */
static double load_of(const particle_path *m, const event *e, double N, double radius, const double n[3]) {
  hk_parabola own = e->path;
  double n_end[3];
  if (!(hk_length(m->drift) > rest * hk_length(m->a) * m->step->h)) return N;
  hk_copy(own.w, e->w);
  return reaction(&own, e->o, radius, n, n_end);
}

/* The velocity at the end is that of a normal which has turned half of the way: order 2 on curved surfaces. */
static void lie(particle_path *m, const event *e, const double n[3]) {
  const hk_obstacle *o = e->o;
  const hk_parabola *path = &e->path;
  double tau = path->span, radius = hk_obstacle_radius(o, m->step->i), along[3] = {0}, p[3], w[3], n_end[3], n_now[3];
  double N = reaction(path, o, radius, n, n_end);
  *(N > 0 ? &m->resting : &m->leaving) |= e->bit;
  if (N == 0) return;
  m->reactions++;
  bool moves = slides(m, e, o->friction * load_of(m, e, N, radius, n), n, along);
  forget_drift(m);
  if (!moves) m->stuck |= e->bit;
  double inside = radius - hk_shape_distance(&o->shape, path->p, n_now);
  hk_parabola_at(path, moves ? tau : 0, p, w);
  for (int c = 0; c < 3; c++) {
    p[c] += moves ? tau * tau / 2 * (along[c] + N * n[c]) : fmax(0, inside) * n[c];
    w[c] = moves ? e->w_end[c] + tau * (along[c] + N * (n[c] + n_end[c]) / 2) : 0;
  }
  hk_body_place(&o->motion.end, p, m->x_end);
  hk_body_move(&o->motion.end, m->x_end, w, m->u_end);
}

/* ---- one event after the other ---- */

/* Whether an obstacle on which the particle lies is entered by the path, pushed by another one. */
static bool pushed_in(const particle_path *m, const hk_obstacle *o, double least) {
  double n[3];
  return hk_obstacle_gap(o, &o->motion.end, m->x_end, m->step->i, n) < -least;
}

static event next_event(const particle_path *m) {
  event first = {.t = INFINITY};
  for (size_t k = 0; k < m->set->count; k++) {
    event e = {.o = m->set->member[k], .bit = (uint64_t)1 << k};
    double least = tolerance(e.o, m->step);
    hk_motion_at(&e.o->motion, m->s, &e.frame);
    e.path = path_past(m, e.o, &e.frame, e.w, e.w_end);
    if (m->leaving & e.bit)
      e.t = INFINITY;
    else if (m->resting & e.bit)
      e.t = m->until == 1 && m->reactions < MOST_REACTIONS && pushed_in(m, e.o, 4 * least) ? 0 : INFINITY;
    else
      e.t = hk_parabola_contact(&e.path, &e.o->shape, hk_obstacle_radius(e.o, m->step->i), least);
    if (e.t < first.t) first = e;
  }
  return first;
}

static void resolve(particle_path *m, const event *e) {
  double n[3];
  hk_shape_distance(&e->o->shape, e->path.p, n);
  if (hk_dot(e->w, n) < -slowest(m, m->u))
    strike(m, e, n);
  else
    lie(m, e, n);
}

/* False: there are too many. */
static bool go(particle_path *m) {
  for (int k = 0; k < MOST_EVENTS; k++) {
    event e = next_event(m);
    double stop = (m->until - m->s) * m->step->h;
    if (m->until < 1 && !(e.t <= stop)) {
      double until = m->until;
      advance(m, stop);
      m->s = until;
      start_anew(m);
      m->step->changed = true;
      continue;
    }
    if (!(e.t < remaining(m)) && e.t > 0) {
      advance(m, remaining(m));
      return true;
    }
    m->step->changed = true;
    if (e.t > 0) {
      advance(m, e.t);
      start_anew(m);
    } else
      resolve(m, &e);
  }
  return false;
}

/* ---- start and end of the step ---- */

/* Moves a particle that is inside to the surface. Whether it touches something. */
static bool put_outside(particle_path *m) {
  bool touches = false;
  for (size_t k = 0; k < m->set->count; k++) {
    const hk_obstacle *o = m->set->member[k];
    double n[3], least = tolerance(o, m->step), gap = hk_obstacle_gap(o, &o->motion.start, m->x, m->step->i, n);
    touches |= gap <= least;
    if (!(gap < -least)) continue;
    hk_add_scaled(m->x, -gap, n);
    m->step->depth = fmax(m->step->depth, -gap);
    m->step->changed = true;
  }
  return touches;
}

/* What lies on a surface has its speed along it, and none against it. */
static void move_with_surfaces(particle_path *m, double v[3]) {
  for (size_t k = 0; k < m->set->count; k++) {
    const hk_obstacle *o = m->set->member[k];
    const hk_body_frame *f = &o->motion.end;
    double n[3], w[3], p[3];
    if (!(m->resting >> k & 1)) continue;
    hk_body_point(f, m->x, p);
    double gap = hk_shape_distance(&o->shape, p, n) - hk_obstacle_radius(o, m->step->i);
    if (gap < 0) hk_add_scaled(p, -gap, n);
    hk_body_place(f, p, m->x);
    hk_body_velocity(f, m->x, v, w);
    double along = hk_dot(w, n);
    for (int c = 0; c < 3; c++) w[c] = m->stuck >> k & 1 ? 0 : w[c] - along * n[c];
    hk_body_move(f, m->x, w, v);
  }
}

/* The velocity at the start of the path. Methods of order 1 do not agree with themselves: their velocity differs by a
 * h/2 from that of the parabola through their positions, on which impacts are; the law is then applied to the latter,
 * and where the particle touches something, their own velocity makes the parabola. The difference, O(h^2) with other
 * methods, is carried on. Whether the method is of order 1. */
static bool start_velocity(particle_path *m, bool touches, double offset[3]) {
  const hk_obstacle_step *step = m->step;
  double h = step->h;
  for (int c = 0; c < 3; c++) {
    m->u[c] = step->v_from[c];
    m->drift[c] = m->u[c] - (step->x[c] - step->x_from[c]) / h + h / 2 * m->a[c];
    offset[c] = 0;
  }
  if (!(hk_length(m->drift) > 0.1 * h * hk_length(m->a))) return false;
  if (!touches) hk_copy(offset, m->drift);
  hk_subtract(m->u, m->u, offset);
  hk_subtract(m->drift, m->drift, m->drift);
  return true;
}

/* By definition: the change of the kinetic energy at the end of the step, less what the accelerations do over the way
 * between the ends. That is the energy lost in impacts and to friction, and what moving obstacles give. */
static double work_of(const particle_path *m, const double x_free[3], const double u_free[3], const double x[3],
                      const double u[3]) {
  double way[3];
  hk_subtract(way, x, x_free);
  return m->step->mass * ((hk_dot(u, u) - hk_dot(u_free, u_free)) / 2 - hk_dot(m->a, way));
}

void hk_obstacles_meet(const hk_obstacle_set *set, hk_obstacle_step *step) {
  particle_path m = {.set = set, .step = step};
  double offset[3], v[3], x_free[3], u_free[3], pushed[3];
  step->landing = 1;
  hk_copy(m.x, step->x_from);
  for (int c = 0; c < 3; c++) m.a[c] = (step->v[c] - step->v_from[c]) / step->h;
  bool touches = put_outside(&m), first_order = start_velocity(&m, touches, offset);
  start_anew(&m);
  hk_subtract(pushed, m.x, step->x_from);
  hk_subtract(x_free, m.x_end, pushed);
  hk_copy(u_free, m.u_end);
  if (!go(&m)) step->endless = true;
  if (first_order)
    step->landing = 1; /* steps of many lengths would cost it more than landing at the end of one gains */
  if (step->endless || !(step->changed || (first_order && touches))) return;
  for (int c = 0; c < 3; c++) v[c] = m.u[c] + offset[c];
  move_with_surfaces(&m, v);
  hk_subtract(m.u, v, offset);
  step->work = work_of(&m, x_free, u_free, m.x, m.u);
  step->changed = memcmp(step->x, m.x, sizeof m.x) != 0 || memcmp(step->v, v, sizeof v) != 0;
  hk_copy(step->x, m.x);
  hk_copy(step->v, v);
}

/* The distance changes by no more than the way, and the way is no longer than the straight one and twice the height of
 * the arc, h |v1 - v0|/8, on either side. */
static bool may_meet(const hk_obstacle *o, const hk_obstacle_step *step) {
  double n[3], p0[3], p1[3], w0[3], w1[3], way[3], bend[3], r = hk_obstacle_radius(o, step->i);
  hk_body_point(&o->motion.start, step->x_from, p0);
  hk_body_point(&o->motion.end, step->x, p1);
  hk_body_velocity(&o->motion.start, step->x_from, step->v_from, w0);
  hk_body_velocity(&o->motion.end, step->x, step->v, w1);
  hk_subtract(way, p1, p0);
  hk_subtract(bend, w1, w0);
  double arc = step->h * hk_length(bend) / 4, least = tolerance(o, step);
  if (o->shape.kind == HK_SHAPE_PLANE && !o->shape.hollow)
    return fmin(hk_dot(o->shape.normal, p0), hk_dot(o->shape.normal, p1)) - arc <= r + least;
  double gaps = hk_shape_distance(&o->shape, p0, n) + hk_shape_distance(&o->shape, p1, n);
  return gaps <= hk_length(way) + 2 * arc + 2 * (r + least);
}

bool hk_obstacles_near(const hk_obstacle_set *set, const hk_obstacle_step *step) {
  for (size_t k = 0; k < set->count; k++)
    if (may_meet(set->member[k], step)) return true;
  return false;
}
