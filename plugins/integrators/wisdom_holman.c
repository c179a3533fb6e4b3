/* Wisdom and Holman's splitting of orbits about a heavy body: between kicks each body moves along a conic section about
 * the centre of mass of those inside it, exactly, and a kick is all that it feels beside that (common/orbits). Errors
 * are by the ratio e of the other masses to the heavy one, or of any further force to its pull: of e h^10, e^2 h^6 and
 * e^3 h^4, by the eight kicks of Blanes et al., symmetric, symplectic, and without the correctors that Wisdom's own
 * leapfrog needs before every state that is looked at.
 *
 * It does not look into forces. At the start, and when the host changes the state or particles come and go, it asks
 * which constant G makes the accelerations relative to the heaviest body Newton's; that of `nbody` comes out to
 * rounding. What the conic sections leave of the accelerations is the kick, whatever it is. Where Newton's law leaves a
 * tenth, or the others have a tenth of the heaviest body's mass (and are more than one), there are no such orbits:
 * motion between kicks is straight then, and a warning says so. Bodies are the particles without a pin; others move
 * straight between kicks. Encounters of two light bodies are not resolved by the splitting: gauss_radau is for those.
 * The largest step is that of the kicks in straight lines; what is accurate is a tenth to a thirtieth of the shortest
 * turn.
 *
 * The sun and five planets, 1,000 orbits of Jupiter, largest error of a place over its distance from the sun;
 * evaluations and seconds of a run, the least of three, two cores shared with others: 3e-7    dt = 600     57,768 0.09
 * stoermer8 7e-7 in 216,630, 0.33; kahan_li8 2e-7 in 736,542, 0.60 1.5e-8  dt = 400     86,648   0.09 kahan_li8 3.5e-8
 * in 920,669, 0.67; gauss_radau 2e-11 in 0.34 3e-10   dt = 300    115,536   0.17    stoermer8 4e-10 in 433,259, 0.50
 * Below, roundings of 1,000 orbits are left. Wisdom's leapfrog with correctors of order 17 and a kernel of two
 * evaluations (Rein, Tamayo and Brown 2019) takes half the evaluations to 3e-9, as long as nobody looks at a state.
 */
#include "plugins/common/integrate/splitting.h"
#include "plugins/common/orbits/felt_gravity.h"
#include "plugins/common/orbits/jacobi.h"
#include "plugins/common/orbits/kepler.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* Blanes, Casas, Farres, Laskar, Makazaga and Murua 2013, table 3, ABA(10, 6, 4): drifts a_1 to a_5 and back, kicks
 * b_1 to b_4 and back. The list of splitting.h begins and ends with a kick, here of no length. */
#define A1 0.03809449742241219545697532230863756534060
#define A2 0.1452987161169137492940200726606637497442
#define A3 0.2076276957255412507162056113249882065158
#define A4 0.4359097036515261592231548624010651844006
#define A5 -0.6538612258327867093807117373907094120024
#define B1 0.09585888083707521061077150377145884776921
#define B2 0.2044461531429987806805077839164344779763
#define B3 0.2170703479789911017143385924306336714532
#define B4 -0.01737538195906509300561788011852699719871
enum { KICKS = 8 };
static const hk_splitting_method method = {
    .stages = KICKS + 1, .kick = {0, B1, B2, B3, B4, B4, B3, B2, B1, 0}, .drift = {A1, A2, A3, A4, A5, A4, A3, A2, A1}};

/* What the law of gravitation may leave of accelerations, and what masses beside the heaviest body. */
static const double most_off = 0.1, most_others = 0.1;

typedef struct wisdom_holman {
  int64_t primed;   /* whether `slope` is that of the last kick */
  int64_t arranged; /* whether G and `rank` are those of the particles */
  double G;         /* m^3/(kg s^2); 0: straight lines */
  double *rank;     /* n: the place of a body in the order of the bodies, from 1; 0: it is none of them */
  double *slope;    /* (a, dy) of the last kick, a without the pull of the orbits */
  double *seen;     /* shaped as X: v and y in the middle of a kick */
  double *orbits;   /* shaped as X: places and velocities of the bodies in Jacobi's coordinates */
  double *kicks;    /* shaped as X: the accelerations of a kick, in these */
  size_t room;      /* n that there is memory for */
  bool listed;      /* whether `bodies` is what G and `rank` say */
  hk_jacobi bodies;
} wisdom_holman;

static const hk_field fields[] = {
    {"primed", .integer = HK_AT(wisdom_holman, primed)},
    {"arranged", .integer = HK_AT(wisdom_holman, arranged)},
    {"G", .number = HK_AT(wisdom_holman, G)},
    {"rank", .per_particle = HK_AT(wisdom_holman, rank), .width = 1},
    {"slope", .state = HK_AT(wisdom_holman, slope), .width = 1},
    {"seen", .state = HK_AT(wisdom_holman, seen), .width = 1, .flags = HK_SCRATCH},
    {"orbits", .state = HK_AT(wisdom_holman, orbits), .width = 1, .flags = HK_SCRATCH},
    {"kicks", .state = HK_AT(wisdom_holman, kicks), .width = 1, .flags = HK_SCRATCH},
    {0},
};

/* A pin may have been released, too. */
static void reset(void *self, hk_reason why) {
  wisdom_holman *m = self;
  if (why != HK_CHECKPOINT) m->primed = 0;
  if (why == HK_PARTICLES_CHANGED || why == HK_STATE_CHANGED) m->arranged = 0, m->listed = false;
}

static hk_status topology(void *self, const hk_view *view) {
  (void)view;
  ((wisdom_holman *)self)->listed = false;
  return HK_OK;
}

/* ---- which bodies go round ---- */

static hk_status reserve(wisdom_holman *m, const hk_host *host, size_t n) {
  hk_jacobi *j = &m->bodies;
  if (n <= m->room) return HK_OK;
  host->release(host, j->order);
  host->release(host, j->part);
  host->release(host, j->upto);
  m->room = 0;
  j->order = host->allocate(host, n * sizeof *j->order);
  j->part = host->allocate(host, n * sizeof *j->part);
  j->upto = host->allocate(host, n * sizeof *j->upto);
  if (!j->order || !j->part || !j->upto) return host->fail(host, HK_NO_MEMORY, "no memory for %zu bodies", n);
  m->room = n;
  return HK_OK;
}

/* By the accelerations of X, which are in `slope`. */
static hk_status arrange(wisdom_holman *m, hk_system *s) {
  hk_felt_gravity felt;
  if (!hk_felt_gravity_find(s->host, s->model, s->X, m->slope, m->bodies.order, &felt))
    return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu bodies", s->n);
  bool fits = felt.off <= most_off && (felt.bodies == 2 || felt.others <= most_others);
  m->G = fits ? felt.G : 0;
  memset(m->rank, 0, s->n * sizeof *m->rank);
  for (size_t k = 0; k < felt.bodies; k++) m->rank[m->bodies.order[k]] = (double)k + 1;
  if (!fits)
    s->host->warn(s->host,
                  "no orbits about a heavy body are found: none is ten times as heavy as all others together and draws "
                  "them by Newton's law to a tenth, so that motion between kicks is straight; blanes_moan needs fewer "
                  "evaluations for the same error");
  m->arranged = 1;
  m->listed = false;
  return HK_OK;
}

static void list(wisdom_holman *m, const hk_model *model) {
  m->bodies.count = 0;
  for (size_t i = 0; i < model->n && m->G > 0; i++)
    if (m->rank[i] > 0) {
      m->bodies.order[(size_t)m->rank[i] - 1] = (uint32_t)i;
      m->bodies.count++;
    }
  hk_jacobi_weigh(&m->bodies, model->mass);
  m->listed = true;
}

/* ---- kicks and drifts ---- */

/* Takes the pull of the orbits out of the accelerations in `slope`; `kicks`: the rest in Jacobi's coordinates. */
static void leave_orbits(wisdom_holman *m) {
  const hk_jacobi *j = &m->bodies;
  hk_jacobi_from(j, m->slope, m->kicks);
  for (size_t k = 1; k < j->count; k++) {
    const double *r = m->orbits + 3 * k;
    double square = hk_dot(r, r);
    hk_add_scaled(m->kicks + 3 * k, m->G * j->upto[k] / (square * sqrt(square)), r);
  }
  hk_jacobi_to(j, m->kicks, m->slope);
}

static hk_status prepare(wisdom_holman *m, hk_system *s) {
  size_t v = 3 * s->n;
  bool fresh = !m->primed || !m->arranged;
  hk_status status = reserve(m, s->host, s->n);
  m->primed = 0; /* until the end of the step, which writes over the slope */
  if (status == HK_OK && fresh)
    status = s->accelerations(s, s->t, s->X, s->X + v, s->X + 2 * v, m->slope, m->slope + v);
  if (status == HK_OK && !m->arranged) status = arrange(m, s);
  if (status != HK_OK) return status;
  if (!m->listed) list(m, s->model);
  hk_jacobi_from(&m->bodies, s->X, m->orbits);
  hk_jacobi_from(&m->bodies, s->X + v, m->orbits + v);
  if (fresh) leave_orbits(m);
  return HK_OK;
}

/* Of all in straight lines, then of the bodies along their orbits, by h. */
static hk_status drift(wisdom_holman *m, hk_system *s, double h, double *X) {
  const hk_jacobi *j = &m->bodies;
  size_t v = 3 * s->n;
  double *x = m->orbits, *u = m->orbits + v;
  for (size_t e = 0; e < v; e++) X[e] += h * X[v + e];
  if (j->count == 0) return HK_OK;
  hk_add_scaled(x, h, u);
  for (size_t k = 1; k < j->count; k++)
    if (!hk_kepler_move(m->G * j->upto[k], h, x + 3 * k, u + 3 * k))
      return s->host->fail(s->host, HK_NOT_FINITE,
                           "particle %u cannot be moved along its orbit after t = %g s, as it is at the centre of mass "
                           "of those inside it or not at a finite place: use gauss_radau for collisions",
                           s->model->id[j->order[k]], s->t);
  hk_jacobi_to(j, x, X);
  hk_jacobi_to(j, u, X + v);
  return HK_OK;
}

/* A kick of h at the time t, with v and y seen in its middle. */
static hk_status kick(wisdom_holman *m, hk_system *s, double t, double h, double *X) {
  size_t v = 3 * s->n;
  double *seen = m->seen, *rates = m->slope;
  for (size_t e = v; e < s->size; e++) seen[e] = X[e] + h / 2 * rates[e - v];
  hk_status status = s->accelerations(s, t, X, seen + v, seen + 2 * v, rates, rates + v);
  if (status != HK_OK) return status;
  leave_orbits(m);
  for (size_t e = v; e < s->size; e++) X[e] += h * rates[e - v];
  for (size_t e = 0; e < 3 * m->bodies.count; e++) m->orbits[v + e] += h * m->kicks[e];
  return HK_OK;
}

static hk_status step(void *self, const void *table, hk_system *s, double t_stop, double h, hk_step *out) {
  wisdom_holman *m = self;
  const hk_splitting_method *f = table;
  double *X = s->spare, t = s->t, end = fmin(t_stop, s->t + h);
  hk_status status = prepare(m, s);
  (void)out;
  memcpy(X, s->X, s->size * sizeof *X);
  for (int i = 0; i < KICKS && status == HK_OK; i++) {
    status = drift(m, s, f->drift[i] * h, X);
    t += f->drift[i] * h;
    if (status == HK_OK) status = kick(m, s, t, f->kick[i + 1] * h, X);
  }
  if (status == HK_OK) status = drift(m, s, f->drift[KICKS] * h, X);
  if (status != HK_OK) return status;
  s->impose(s, end, X, X + 3 * s->n);
  s->exchange(s);
  m->primed = 1;
  return HK_OK;
}

static const hk_constrained_facet constrained = {.size = sizeof constrained,
                                                 .refused = "its orbits between kicks know no multipliers"};
static const hk_facet facets[] = {{HK_CONSTRAINED_ID, &constrained}, {0}};

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 4,
                                         .stages = KICKS,
                                         .flags = HK_SYMPLECTIC | HK_REVERSIBLE | HK_USES_SPARE,
                                         .method = &method,
                                         .step = step,
                                         .reset = reset,
                                         .growth = hk_splitting_growth,
                                         .facets = facets};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "wisdom_holman",
    .summary =
        "splitting for orbits about a heavy body: conic sections, and kicks by all else, eight evaluations a step; "
        "errors of e h^10, e^2 h^6 and e^3 h^4, e the ratio of the masses; order 4 where none is small, 2 in what "
        "depends on the velocity",
    .reference = "Wisdom and Holman 1991, AJ 102; Blanes et al. 2013, Appl. Numer. Math. 68, ABA(10, 6, 4); Rein and "
                 "Tamayo 2015, MNRAS 452",
    .instance_size = sizeof(wisdom_holman),
    .fields = fields,
    .topology = topology,
    .integrator = &integrator,
};
