#include "core/app/command/auto.h"
#include "core/engine/base/base.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool hk_auto_asked(const hk_options *o, const hk_scene *scene) {
  return o->run.integrator ? strcmp(o->run.integrator, "auto") == 0 : scene->integrator_auto;
}

/* The words after "hooke" that ask tools/auto.lua: what `run` was given, with the accuracy. */
typedef struct words {
  int count;
  char **word;
} words;

static bool add_word(words *w, const char *format, ...) {
  char text[PATH_MAX];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return (w->word[w->count++] = hk_string_copy(text)) != NULL;
}

static bool question(words *w, const hk_options *o, double accuracy) {
  w->count = 0;
  w->word = calloc(o->given_count + 12, sizeof *w->word);
  bool fine = w->word && add_word(w, "auto") && add_word(w, "%s", o->scene);
  for (size_t k = 0; k < o->given_count && fine; k++) fine = add_word(w, "%s=%s", o->given[k].name, o->given[k].value);
  fine = fine && add_word(w, "--accuracy") && add_word(w, "%.17g", accuracy);
  if (fine && !isnan(o->run.until)) fine = add_word(w, "--until") && add_word(w, "%.17g", o->run.until);
  if (fine && o->quiet) fine = add_word(w, "--quiet");
  if (fine && o->trust) fine = add_word(w, "--trust");
  return fine;
}

hk_status hk_auto_choose(hk_options *o, const hk_scene *scene, const char *tools, const hk_script_options *script,
                         hk_choice *choice, hk_error *error) {
  double accuracy = isnan(o->run.accuracy) ? scene->accuracy : o->run.accuracy;
  char path[PATH_MAX + 16];
  const char *line = o->run.integrator ? NULL : scene->auto_where;
  words w;
  int code = 0;
  if (!(accuracy > 0))
    return hk_error_set(error, HK_BAD_PARAM,
                        "%s%sintegrator 'auto' needs to know the accuracy that is asked for: accuracy = 1e-3 (m) in "
                        "hooke.scene{}, or --accuracy 1e-3",
                        line ? line : "", line ? ": " : "");
  snprintf(path, sizeof path, "%s/auto.lua", tools);
  hk_run_options run = {.dt = NAN, .tol = NAN, .until = NAN, .accuracy = NAN, .interrupted = o->run.interrupted};
  run.acting = o->run.acting;
  hk_script_options options = {.registry = script->registry, .library = script->library, .trust = true, .run = &run};
  options.pulse = script->pulse;
  hk_status status = question(&w, o, accuracy) ? hk_tool_run(path, w.count, w.word, &options, &code, choice, error)
                                               : hk_error_set(error, HK_NO_MEMORY, "no memory to choose an integrator");
  for (int k = 0; k < w.count; k++) free(w.word[k]);
  free(w.word);
  if (status == HK_OK && (code != 0 || !*choice->integrator))
    status = hk_error_set(error, code == 1 ? HK_BAD_PARAM : HK_FAILED,
                          "no integrator was chosen for %s: name one (--integrator NAME)", o->scene);
  if (status != HK_OK) return status;
  o->run.integrator = choice->integrator;
  if (isnan(o->run.dt)) o->run.dt = choice->dt;
  if (isnan(o->run.tol)) o->run.tol = choice->tol;
  return HK_OK;
}
