/* Correctors: they modify x and v after a step. */
#ifndef HK_PLUGIN_CORRECTOR_H
#define HK_PLUGIN_CORRECTOR_H

#include "core/plugin/contact.h"
#include "core/plugin/model.h"

enum {                      /* hk_corrector.flags */
       HK_WANTS_BEFORE = 1, /* the host fills x_before and v_before */
       HK_REPORTS_WORK = 2, /* the corrector fills `work`, so the energy balance stays known */
       HK_MAY_REJECT = 4,   /* the host reads `reject` */
       HK_TAKES_BODIES = 8, /* it meets rigid bodies at the points of their surface (hk_rider.touches), and moves them
                              as "bodies/1" says; of others a scene with rigid bodies warns */
       HK_TAKES_SKINS = 16 /* it meets rigid bodies as what their skins (hk_body_skin) enclose, and moves those that are
                              free */
};

typedef struct hk_correction {
  double h;               /* s, length of the step just taken */
  const double *x_before; /* n x 3, positions before the step; NULL without HK_WANTS_BEFORE */
  double *x;              /* n x 3, to be modified; pins and constraints are imposed again afterwards */
  double *v;              /* n x 3 */
  bool changed;           /* to be set when x or v was changed: integrators then reset their history */
  double work;            /* J, change of the scene's energy by the correction */
  bool reject; /* the host is to repeat the step with half its length; it restores the state, not the fields of
                  correctors */
  const double *v_before; /* n x 3, velocities before the step; NULL without HK_WANTS_BEFORE */
  double part; /* with reject: the step is repeated as two, of this part of its length, in (0, 1), and of the rest, to
                  end one where something happens; 0: as two halves */
  /* n x 3: zeroes the directions that pins forbid; NULL: no pin slides */
  void (*filter)(const struct hk_correction *, double *vector);
  const void *pins; /* the host's, for `filter` */
  bool last; /* the step cannot be made shorter: `reject` ends the run, and what would only end a step where something
                happens is to be left; since minor 2 */
} hk_correction;

/* A number that a corrector measured in the run so far, for the summary and the verdict. */
typedef struct hk_own_figure {
  const char *name; /* one word, constant */
  const char *unit; /* constant; "": none */
  double value;     /* NAN: not known */
  double limit;     /* a run whose figure is larger in size is not ok; INFINITY: none */
} hk_own_figure;

enum { HK_OWN_FIGURES = 8 }; /* of one corrector, at most */

typedef struct hk_corrector {
  size_t size;
  unsigned flags;
  hk_status (*correct)(void *self, const hk_view *view, hk_correction *c);
  double (*violation)(void *self, const hk_view *view); /* m, 0 when satisfied; asked at frames, for the
 verdict; may be NULL */
  /* For contact of surfaces: called at frames. False: this run has none. NULL: as false. */
  bool (*contacts)(void *self, const hk_view *view, hk_contact_report *out);
  /* For contact of any kind: adds the places where something touches at `view`, for pictures, at frames; it changes
   * nothing. NULL: nothing ever does. */
  void (*contact_points)(const void *self, const hk_view *view, const hk_contact_points *points);
  /* s, above 0: the longest next step from the state `view`; asked before every step. a: n x 3, m/s^2, what the forces
   * give there before the first step; NULL later. NULL: no bound; since minor 3. */
  double (*longest_step)(void *self, const hk_view *view, const double *a);
  /* Fills figures of the run so far, at most HK_OWN_FIGURES, and returns how many; it changes nothing. NULL: none;
   * since minor 3. */
  size_t (*figures)(void *self, const hk_view *view, hk_own_figure *figure);
  /* For the forces of constraints at frames: F += the mean force over the last step of the impulses that what
   * constraints join has had from this corrector, N, n x 3; of rigid bodies at the riders where they touch. NULL: they
   * are not told, and a script that asks is warned; since minor 4. */
  void (*mean_forces)(const void *self, const hk_view *view, double *F);
} hk_corrector;

#endif
