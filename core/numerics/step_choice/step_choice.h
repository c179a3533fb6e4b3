/* The choice of the step: dt of the scene or the command line, checked against the stable limit, or that limit times a
 * safety factor, reviewed while the scene moves. */
#ifndef HK_STEP_CHOICE_H
#define HK_STEP_CHOICE_H

#include "core/engine/loop/loop.h"
#include "core/numerics/stability/stability.h"

typedef struct hk_step_choice {
  hk_step_length length; /* first member: what the loop sees */
  const hk_integrator *method;
  const void *parameters;        /* of the method */
  const hk_instance *integrator; /* whose they are */
  double tol;                    /* relative tolerance that suits the method */
  double fps;
  hk_spectrum spectrum;
  hk_watch watch;
  double dt_suggested; /* s, by the last limit */
  double dt_estimated; /* s, dt as the estimates have it; the watch may have lowered it until the next */
  double dt_limit;     /* s, the smallest largest stable step so far; INFINITY: no limit, NAN: not known */
  double growth_rate;  /* 1/s */
  bool chosen, growth_expected;
  size_t estimate_cost;  /* evaluations */
  size_t estimates_cost; /* of all of them that no time or event called for, evaluations */
  size_t estimated_at;   /* number of evaluations at the last estimate */
  double lightest;       /* kg, the least mass of a newborn; 0: there was none */
  size_t births_cost;    /* of all estimates after births and deaths, evaluations */
  size_t turnover;       /* births and deaths since the last of them */
} hk_step_choice;

/* Of a run with this integrator; the functions of `length` are set. The caller frees it. NULL: no memory. */
hk_step_choice *hk_step_choice_open(const hk_instance *integrator, double fps);
/* That of a loop to whose run it belongs. */
static inline hk_step_choice *hk_step_choice_of(const hk_loop *loop) { return (hk_step_choice *)(void *)loop->step; }
hk_status hk_step_estimate(hk_step_choice *, hk_dynamics *); /* the spectrum and the stable limit, for any method */
/* Sets dt to `given` (s), or, where that is NAN, by the stable limit. */
hk_status hk_step_choose(hk_step_choice *, hk_dynamics *, double given);

#endif
