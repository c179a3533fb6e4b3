/* Outputs: they read the state at frames and do not change it. */
#ifndef HK_PLUGIN_OUTPUT_H
#define HK_PLUGIN_OUTPUT_H

#include "core/plugin/contact.h"
#include "core/plugin/model.h"

typedef enum hk_verdict { HK_RUNNING, HK_VERDICT_OK, HK_INACCURATE, HK_DIVERGED, HK_STOPPED } hk_verdict;

/* Forces in what joins two particles, one by one. */
typedef struct hk_pair_forces {
  void *context;
  void (*add)(void *context, uint32_t i, uint32_t j, double force); /* N, positive in tension */
} hk_pair_forces;

typedef struct hk_frame hk_frame;
struct hk_frame {
  size_t index; /* 0 is the start */
  size_t steps; /* steps taken so far */
  double fps;
  double kinetic, potential, work;         /* J; potential: of the forces that have an energy; work: done by pins and
                                              non-conservative forces since the start */
  double momentum[3], angular_momentum[3]; /* kg m/s, kg m^2/s about the origin */
  size_t measures;
  const char *const *measure_name;
  const double *measure;
  double step;   /* s, length of the last step; 0: there was none yet */
  double error;  /* largest error estimate of the steps since the last frame, relative to the tolerance; NAN: the method
                    estimates none */
  size_t forces; /* of the scene, in its order */
  const char *const *force_name; /* their labels */
  /* f (n x 3, N): the force of plugin k alone at the state of this frame, 0 where it does not act at this time. It
   * costs an evaluation of that force, of which nothing stays. HK_FAILED: the force failed. */
  hk_status (*force)(const hk_frame *, size_t k, double *f);
  void *run;         /* the host's, for `force` */
  const char *scene; /* path of the scene's script, as given */
  const char
      *origin; /* what the scene was made from, a line "what<TAB>value" each, parameters with them; may be NULL */
  /* u (count x 3, m/s): the velocity of force k's medium, as a stream of air is one, at the places x (count x 3, m).
   * False: it has none, or does not act at this time, and u is as it was. */
  bool (*flow)(const hk_frame *, size_t k, const double *x, size_t count, double *u);
  /* Adds all places where something touches, as forces and correctors tell. False: nothing of this scene ever does.
   * NULL for the points: to know just that. */
  bool (*contact_points)(const hk_frame *, const hk_contact_points *);
  /* Adds the forces in links of a length: those of constraints' equations that act between two particles along their
   * line. They are those that keep the equations under the forces of this time; it costs an evaluation, of which
   * nothing stays. HK_OK also where there are none; otherwise why they cannot be told. NULL: this host tells none;
   * since minor 4. */
  hk_status (*bar_forces)(const hk_frame *, const hk_pair_forces *);
  /* Of each measure, as "kg m/s"; "" where the scene does not say it. NULL: this host tells none; since minor 4. */
  const char *const *measure_unit;
};

/* `view` in the calls of an output is at the frame's time. Between open and close the scene may gain and lose
 * particles. `close` is called once for each open that succeeded, for any verdict. */
typedef struct hk_output {
  size_t size;
  hk_status (*open)(void *self, const hk_view *view, const hk_frame *frame); /* before frame 0, same state; or NULL */
  hk_status (*frame)(void *self, const hk_view *view, const hk_frame *frame);
  hk_status (*close)(void *self, hk_verdict verdict); /* may be NULL */
} hk_output;

#endif
