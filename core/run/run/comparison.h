/* The runs with which a run is compared, and what the comparison says of its error. */
#ifndef HK_COMPARISON_H
#define HK_COMPARISON_H

#include "core/run/run/run.h"

enum { HK_MOST_CUTS = 2 * (HK_SAMPLING_PIECES + HK_SAMPLING_JUMPS) };

/* What is asked of a run, and what comparisons have found. Errors are relative to what is asked: the largest of that of
 * the positions and those of the channels. */
typedef struct hk_comparison {
  const hk_scene_loader *loader;
  const hk_run_options *first;
  hk_run *whole;
  hk_summary *summary;
  double accuracy;      /* m; NAN: not asked for positions, but for channels */
  double *channel;      /* the accuracy that each channel is to have */
  hk_sampling sampling; /* functions of time between the evaluations of the run */
  double cut[HK_MOST_CUTS];
  size_t cuts; /* where other runs end a step, because a function of time changes fast there */
  hk_comparison_run half;
  bool compared;      /* there is half */
  bool has_reference; /* the error is that to a reference */
  double error;       /* relative; NAN: not known */
  double position;    /* m */
  double order;       /* see hk_comparisons */
  hk_distance worst;  /* the distance it is from */
  char how[160];
} hk_comparison;

/* ---- comparison.c ---- */

/* Sets the accuracies and looks for functions of time that change between evaluations. */
hk_status hk_comparison_open(hk_comparison *, hk_error *error);
void hk_comparison_close(hk_comparison *);
hk_status hk_comparison_take_half(hk_comparison *, hk_error *error); /* with half the step */
void hk_comparison_use_half(hk_comparison *);                        /* the error by half the step */
/* The error by the ratio of two distances; false: no order is seen, and the error remains that by half the step. */
bool hk_comparison_use_order(hk_comparison *);
/* The error by an independent method, where that is worth it; `coarse`: with less confidence, if need be. */
void hk_comparison_reference(hk_comparison *, hk_effort, bool coarse);
/* The error by an independent method over the first frames, where it is above what half the step shows: for swings that
 * both lose (hk_comparison_may_lose_swings), where no reference is affordable to the end. Where the accuracy holds
 * at the end only, what the scene's own damping would end until then is not counted. */
void hk_comparison_use_beginning(hk_comparison *, hk_effort);
/* Where a run agrees with half its step and not with the reference, a stricter reference decides. */
void hk_comparison_tie_break(hk_comparison *, hk_effort);
/* The error by a stricter reference in its place, where the effort allows one: it may be the one that is wrong. */
void hk_comparison_sharpen(hk_comparison *, hk_effort);
/* Where there is no reference of the whole run: whether one of its first part says that errors which add up may be
 * beyond what is asked at the end. */
bool hk_comparison_may_drift(hk_comparison *, hk_effort);
/* Whether so many times the distance to half the step is within what is asked; 2: so is the error, whatever the order.
 */
bool hk_comparison_agrees(const hk_comparison *, double times);
double hk_comparison_difference(const hk_comparison *); /* m, of the positions, to half the step */

/* ---- contradictions.c: what two runs of one method can have in common ---- */

bool hk_comparison_energy_converges(const hk_comparison *);
/* m, RMS: how far energy that both runs have damped away would have taken the particles as a speed. */
double hk_comparison_damped_energy(const hk_comparison *);
/* Whether the method may have damped swings that it does not resolve. */
bool hk_comparison_damped_modes(const hk_comparison *);
/* Whether half the step, too, halves the amplitude of the fastest swings by the end of the run. */
bool hk_comparison_may_lose_swings(const hk_comparison *);

#endif
