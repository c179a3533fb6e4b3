/* libhooke: runs of hooke's scenes inside of a program.
 *
 *     hooke_run *run = hooke_new();
 *     if (hooke_parameter(run, "N", "64") == HOOKE_OK && hooke_option(run, "accuracy", "1e-3") == HOOKE_OK &&
 *         hooke_open(run, "cloth.lua") == HOOKE_OK && hooke_finish(run) == HOOKE_OK)
 *       printf("%s: %s\n", hooke_verdict(run), hooke_summary(run));
 *     else
 *       fprintf(stderr, "%s\n", hooke_error(run));
 *     hooke_free(run);
 *
 * A run belongs to one thread at a time; runs of different threads share nothing and give the bits that they give
 * alone. The library prints nothing, catches no signal and changes no setting of the process: the rounding mode and the
 * locale are put back before each function returns. A scene's `print` says nothing. Nothing is written unless the
 * option "out" names a folder. A scene runs in Lua's sandbox; the confinement of the whole process that the program
 * `hooke` adds is left to the caller. A plugin that crashes takes the process along: scenes of strangers belong into a
 * process of their own. HDF5, which the output `trajectory` uses, is not made for several threads at once in most
 * systems.
 *
 * Texts are UTF-8 and end with 0. What a function returns belongs to the run. Where nothing else is said, a pointer is
 * valid until the next call of hooke_advance, hooke_finish or hooke_free, and before hooke_open the answer is NULL, 0
 * or NAN. Units are SI. */
#ifndef HOOKE_H
#define HOOKE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HOOKE_API __attribute__((visibility("default")))

typedef enum hooke_status {
  HOOKE_OK,
  HOOKE_BAD_PARAM,     /* a value, a name or the order of calls is wrong */
  HOOKE_FAILED,        /* a plugin cannot do what it was asked */
  HOOKE_NO_MEMORY,     /* an allocation failed */
  HOOKE_IO,            /* a file cannot be read or written */
  HOOKE_NOT_FINITE,    /* the run diverged */
  HOOKE_NOT_CONVERGED, /* a solver stopped above its tolerance, and the step cannot be made smaller */
  HOOKE_SCRIPT,        /* the scene's script has an error */
  HOOKE_INTERRUPTED    /* hooke_stop was called */
} hooke_status;

typedef struct hooke_run hooke_run;

/* ---- a run: made, described, opened ---- */

/* NULL: no memory. */
HOOKE_API hooke_run *hooke_new(void);
HOOKE_API void hooke_free(hooke_run *); /* NULL is fine */
/* Why the last call that failed did, in one sentence with cause, place and remedy; "": none has. Valid until the next
 * call that fails. */
HOOKE_API const char *hooke_error(const hooke_run *);

/* A parameter of the scene, what param() declares: its value as on the command line, name=value. Before hooke_open,
 * which checks name and range. */
HOOKE_API hooke_status hooke_parameter(hooke_run *, const char *name, const char *value);
/* An option of `hooke run` without its dashes, "accuracy", "integrator", "until", "threads", "out": checked at once.
 * `value` NULL or "": of a flag, such as "trust". Before hooke_open. */
HOOKE_API hooke_status hooke_option(hooke_run *, const char *name, const char *value);

/* Runs the scene's script and takes the run to its frame 0. After a failure the run can only be freed. */
HOOKE_API hooke_status hooke_open(hooke_run *, const char *path);
/* The same with a script in memory; `name` stands for its file in errors, and NULL for "scene.lua". Modules and meshes
 * are looked for in the folder of `name`. */
HOOKE_API hooke_status hooke_open_text(hooke_run *, const char *name, const char *text);

/* ---- running ---- */

/* Called at each frame, also the first, after the scene's own outputs, in the thread that runs; the functions that look
 * may be called in it, hooke_summary and hooke_stop. NULL: nobody is called. Before hooke_open. */
typedef void hooke_frame_function(hooke_run *, void *context);
HOOKE_API hooke_status hooke_on_frame(hooke_run *, hooke_frame_function *, void *context);

/* Takes steps until the time t, s; the end of the scene if that is earlier. A time that has passed changes nothing. NAN
 * is an error. A run that has failed, was stopped or finished is not advanced. */
HOOKE_API hooke_status hooke_advance(hooke_run *, double t);
/* Goes to the end, closes the outputs, and judges the run, which for a small scene or with an accuracy means further
 * runs of it, of which nobody is told. HOOKE_OK also where the verdict is "inaccurate". */
HOOKE_API hooke_status hooke_finish(hooke_run *);
/* Ends what is under way at its next step, with HOOKE_INTERRUPTED. The one function that any thread, or a signal
 * handler, may call at any time. */
HOOKE_API void hooke_stop(hooke_run *);

/* ---- looking: nothing is copied ---- */

HOOKE_API double hooke_time(const hooke_run *);              /* s */
HOOKE_API double hooke_end(const hooke_run *);               /* s */
HOOKE_API size_t hooke_count(const hooke_run *);             /* n, particles; births and deaths change it */
HOOKE_API const double *hooke_positions(const hooke_run *);  /* n x 3, m */
HOOKE_API const double *hooke_velocities(const hooke_run *); /* n x 3, m/s */
HOOKE_API const double *hooke_masses(const hooke_run *);     /* n, kg */
HOOKE_API const uint32_t *hooke_ids(const hooke_run *);      /* n, from 1: what scripts call the particles */
/* n: rows in the order of ids; row order[k] is of the k-th id. NULL: the rows are in this order. */
HOOKE_API const uint32_t *hooke_order(const hooke_run *);
/* n x *size, in the channel's own unit; NULL: the scene has no such channel, and *size is 0. */
HOOKE_API const double *hooke_channel(const hooke_run *, const char *name, size_t *size);
HOOKE_API const char *hooke_channel_name(const hooke_run *, size_t k); /* NULL: there are no more */
/* J: kinetic, potential of the forces that have one, and what pins and other forces have done since the start. Any of
 * the pointers may be NULL. */
HOOKE_API void hooke_energy(hooke_run *, double *kinetic, double *potential, double *work);
/* The measures of the scene and their values at the last frame, in their own units. */
HOOKE_API const char *hooke_measure_name(const hooke_run *, size_t k); /* NULL: there are no more */
HOOKE_API double hooke_measure(const hooke_run *, size_t k);           /* NAN: not known */

/* ---- results ---- */

/* Writes what a run needs to go on from here, as the option "resume" then does with the same scene, parameters and
 * options; behind it the option "change", "k=500", gives a parameter another value from there on. */
HOOKE_API hooke_status hooke_checkpoint(hooke_run *, const char *path);
/* Writes the state as a table: id,x,y,z,vx,vy,vz,mass and the channels; of a run that diverged the last good one. */
HOOKE_API hooke_status hooke_write_state(hooke_run *, const char *path);
/* All figures of the run as a JSON object, as --json prints them; NULL: no memory, or not opened. Valid until the next
 * call of it. */
HOOKE_API const char *hooke_summary(hooke_run *);
/* What the scene declares by param(), as a JSON object {"parameters":[{name, type, initial, value, help, min, max}, ...]};
 * NULL: no memory, or not opened. Valid until the next call of it. */
HOOKE_API const char *hooke_parameters(hooke_run *);
/* "running", "ok", "inaccurate", "diverged" or "interrupted"; final after hooke_finish. */
HOOKE_API const char *hooke_verdict(const hooke_run *);

#ifdef __cplusplus
}
#endif
#endif
