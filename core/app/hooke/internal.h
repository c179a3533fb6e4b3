/* A run of libhooke, shared by the files of this room. */
#ifndef HOOKE_INTERNAL_H
#define HOOKE_INTERNAL_H

#include "core/app/hooke/hooke.h"
#include "core/app/installation/installation.h"
#include "core/app/options/options.h"
#include "core/engine/host/host.h"

#include <fenv.h>
#include <locale.h>
#include <signal.h>

typedef enum hooke_stage { HOOKE_NEW, HOOKE_RUNNING, HOOKE_ENDED } hooke_stage;

struct hooke_run {
  hooke_stage stage;
  bool busy; /* in a call that takes steps, of which on_frame is a part */
  hk_error error;
  size_t words;
  char **word; /* of a command line: options and parameters, the scene first once it is opened */
  hk_options options;
  char *text; /* of the script; NULL: it is a file */
  hk_installation installation;
  char library[PATH_MAX + 8]; /* folder of scripts/lib */
  hk_registry registry;
  hk_script_options script_options;
  hk_script *script;
  hk_run *run;
  volatile sig_atomic_t stopped;
  hooke_frame_function *on_frame;
  void *context;
  char *summary, *declared; /* texts as JSON, of the last call that asked for them */
};

/* What of the calling thread is the program's, while the library computes: how numbers are written and rounded. */
typedef struct hooke_surroundings {
  locale_t locale, before;
  fenv_t environment;
} hooke_surroundings;

void hooke_enter(hooke_surroundings *);
void hooke_leave(hooke_surroundings *);

/* Keeps the sentence and returns the status. */
hooke_status hooke_fail(hooke_run *, hk_status status, const char *format, ...) HK_PRINTF(3, 4);
hooke_status hooke_failed(hooke_run *, const hk_error *); /* HOOKE_OK where it is no error */

#endif
