/* See gauss_seidel.h. Velocities follow positions: only an impact that pushes positions apart in this step has an
 * impulse, so that pairs that approach without contact are left alone; and those that rest: of redundant contacts the
 * positions need some only, now these, now those. */
#include "plugins/common/contact/impulses/gauss_seidel.h"

#include "plugins/kit/vector3.h"

static void apply(const hk_impact *k, const double impulse[3], const double *inverse_mass, double *y) {
  for (int i = 0; i < 4; i++)
    hk_add_scaled(y + 3 * (size_t)k->pair.vertex[i], k->frame.w[i] * inverse_mass[k->pair.vertex[i]], impulse);
}

static void relative(double out[3], const hk_impact *k, const hk_impact_level *level, const double *y) {
  for (int c = 0; c < 3; c++) out[c] = -level->origin[c];
  for (int i = 0; i < 4; i++) hk_add_scaled(out, k->frame.w[i], y + 3 * (size_t)k->pair.vertex[i]);
}

/* Friction that would stop the sliding, no larger than the law allows. Returns the size of the change, N s. */
static double rub(const hk_impact *k, hk_impact_level *level, double friction, const double r[3], double change[3]) {
  double along = hk_dot(r, k->frame.n), wanted[3];
  for (int c = 0; c < 3; c++) wanted[c] = level->slide[c] - (r[c] - along * k->frame.n[c]) / k->mobility;
  double square = hk_dot(wanted, wanted), most = friction * level->push, moved = 0;
  double part = square > most * most ? most / sqrt(square) : 1;
  for (int c = 0; c < 3; c++) {
    double next = part * wanted[c], step = next - level->slide[c];
    change[c] += step;
    moved += step * step;
    level->slide[c] = next;
  }
  return sqrt(moved);
}

/* Of the particles that the impact moves. */
static void note(uint64_t *when, const hk_impact *k, const double *inverse_mass, uint64_t now) {
  for (int i = 0; i < 4; i++)
    if (k->frame.w[i] * inverse_mass[k->pair.vertex[i]] != 0) when[k->pair.vertex[i]] = now;
}

/* Returns by how much the impact has changed its own distance or speed. */
static double relax(const hk_contact_solver *s, const hk_impact *k, hk_impact_level *level, const double *inverse_mass,
                    double *y) {
  double r[3], change[3];
  relative(r, k, level, y);
  double wanted = level->push + (level->target - hk_dot(r, k->frame.n)) / k->mobility;
  double next = wanted > 0 ? wanted : 0, step = next - level->push;
  if (next == 0 && step == 0) return 0;
  level->push = next;
  for (int c = 0; c < 3; c++) change[c] = step * k->frame.n[c];
  double moved = fabs(step);
  if (s->friction > 0) moved += rub(k, level, s->friction, r, change);
  note(s->touched, k, inverse_mass, s->now);
  apply(k, change, inverse_mass, y);
  return moved * k->mobility;
}

typedef struct sweeping {
  double *y;
  const double *inverse_mass;
  double tolerance;
  size_t level; /* offset of the level in an impact */
} sweeping;

static hk_impact_level *level_of(hk_impact *k, const sweeping *w) {
  return (hk_impact_level *)(void *)((char *)k + w->level);
}

static bool takes_part(const hk_impact *k, const sweeping *w) {
  return w->level == offsetof(hk_impact, place) || k->place.push > 0 || k->rested;
}

/* All that have a nearest point that is not pinned. */
static void wake_all(hk_contact_solver *s, const sweeping *w) {
  hk_awake_none(s->awake);
  for (size_t e = 0; e < s->count; e++)
    if (s->impact[e].mobility > 0 && takes_part(&s->impact[e], w)) hk_awake_set(s->awake, (uint32_t)e);
}

/* The next one that is awake, most of the time. */
static void fetch_ahead(const hk_contact_solver *s, uint32_t e) {
  uint64_t others = s->awake->word[e >> 6] & -(2ull << (e & 63));
  if (!others) return;
  const char *k = (const char *)&s->impact[(e & ~63u) + (uint32_t)__builtin_ctzll(others)];
  for (size_t line = 0; line < sizeof(hk_impact); line += 64) __builtin_prefetch(k + line);
}

/* Returns whether anything was moved by more than the tolerance. */
static bool sweep(hk_contact_solver *s, const sweeping *w) {
  bool moved = false;
  uint32_t from = 0, e;
  while (hk_awake_next(s->awake, &from, &e)) {
    hk_impact *k = &s->impact[e];
    fetch_ahead(s, e);
    s->now++;
    if (!takes_part(k, w)) continue;
    if (!(relax(s, k, level_of(k, w), w->inverse_mass, w->y) > w->tolerance)) continue;
    note(s->moved, k, w->inverse_mass, s->now);
    hk_awake_wake(s->awake, k->pair.vertex, e);
    moved = true;
  }
  return moved;
}

/* The impulses that the impacts are given with (warm_start.h). */
static void apply_given(hk_contact_solver *s, const sweeping *w) {
  for (size_t e = 0; e < s->count; e++) {
    hk_impact *k = &s->impact[e];
    hk_impact_level *level = level_of(k, w);
    double given[3];
    if (!(level->push > 0)) continue;
    if (!takes_part(k, w)) {
      level->push = level->slide[0] = level->slide[1] = level->slide[2] = 0;
      continue;
    }
    for (int c = 0; c < 3; c++) given[c] = level->push * k->frame.n[c] + level->slide[c];
    note(s->touched, k, w->inverse_mass, ++s->now);
    note(s->moved, k, w->inverse_mass, s->now);
    apply(k, given, w->inverse_mass, w->y);
  }
}

static size_t sweep_all(hk_contact_solver *s, const sweeping *w) {
  size_t sweeps = 1;
  apply_given(s, w);
  wake_all(s, w);
  while (sweep(s, w) && sweeps < s->most) sweeps++;
  return sweeps;
}

void hk_gauss_seidel_calm(hk_contact_solver *s, double h, double least) {
  const double part = 0.01; /* of the motion; ten layers turn a tolerance into some 20 times the speed */
  double motion = 0, usual = s->tolerance;
  for (size_t e = 0; e < s->count; e++) motion = fmax(motion, s->impact[e].motion);
  s->tolerance = fmin(usual, fmax(least, part * h * motion));
  s->calm = usual > 0 ? 1 - s->tolerance / usual : 0;
  s->near = usual;
}

hk_gauss_seidel_result hk_gauss_seidel(hk_contact_solver *s, hk_step_move *m) {
  hk_gauss_seidel_result done = {0};
  done.sweeps = sweep_all(s, &(sweeping){m->x, m->inverse_mass, s->tolerance, offsetof(hk_impact, place)});
  sweep_all(s, &(sweeping){m->v, m->inverse_mass, s->tolerance / m->h, offsetof(hk_impact, speed)});
  for (size_t e = 0; e < s->count; e++) {
    done.pushing += s->impact[e].place.push > 0;
    done.impulse += s->impact[e].speed.push;
  }
  return done;
}
