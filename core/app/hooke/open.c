/* Making, describing and opening a run of libhooke. Parameters and options are kept as the words of a command line, so
 * that the table of options (core/app/options) checks and reads them as it does for the program. */
#define _GNU_SOURCE /* dladdr */
#include "core/app/hooke/internal.h"

#include <ctype.h>
#include <dlfcn.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* ---- the calling thread's own settings ---- */

void hooke_enter(hooke_surroundings *s) {
  s->locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  s->before = s->locale ? uselocale(s->locale) : (locale_t)0;
  feholdexcept(&s->environment);
  fesetenv(FE_DFL_ENV);
}

void hooke_leave(hooke_surroundings *s) {
  fesetenv(&s->environment);
  if (!s->locale) return;
  uselocale(s->before);
  freelocale(s->locale);
}

/* ---- errors ---- */

hooke_status hooke_fail(hooke_run *run, hk_status status, const char *format, ...) {
  va_list arguments;
  run->error = (hk_error){0};
  va_start(arguments, format);
  hk_error_setv(&run->error, status, format, arguments);
  va_end(arguments);
  return (hooke_status)status;
}

hooke_status hooke_failed(hooke_run *run, const hk_error *error) {
  if (error->status != HK_OK) run->error = *error;
  return (hooke_status)error->status;
}

const char *hooke_error(const hooke_run *run) { return run ? run->error.text : "there is no run: hooke_new gave none"; }

static hooke_status no_memory(hooke_run *run) { return hooke_fail(run, HK_NO_MEMORY, "no memory for a run"); }

/* ---- making ---- */

hooke_run *hooke_new(void) { return calloc(1, sizeof(hooke_run)); }

void hooke_free(hooke_run *run) {
  if (!run) return;
  hooke_surroundings own;
  hooke_enter(&own);
  if (run->run) hk_run_close(run->run, NULL);
  hk_run_destroy(run->run);
  hk_script_close(run->script);
  hk_registry_close(&run->registry);
  for (size_t k = 0; k < run->words; k++) free(run->word[k]);
  free(run->word);
  free(run->options.given);
  free(run->options.with);
  free(run->options.change);
  free(run->text);
  free(run->summary);
  free(run->declared);
  free(run);
  hooke_leave(&own);
}

/* ---- describing ---- */

static bool add_word(hooke_run *run, const char *prefix, const char *name, const char *value) {
  size_t size = strlen(prefix) + strlen(name) + (value ? strlen(value) : 0) + 2;
  char **grown = realloc(run->word, (run->words + 2) * sizeof *grown), *word = malloc(size);
  if (grown) run->word = grown;
  if (!grown || !word) {
    free(word);
    return false;
  }
  snprintf(word, size, "%s%s%s%s", prefix, name, value ? "=" : "", value ? value : "");
  run->word[run->words++] = word;
  return true;
}

static void drop_word(hooke_run *run) { free(run->word[--run->words]); }

static hooke_status check_new(hooke_run *run, const char *call) {
  if (run->stage == HOOKE_NEW && !run->busy) return HOOKE_OK;
  return hooke_fail(run, HK_BAD_PARAM, "%s: the run has been opened: make another one for it (hooke_new)", call);
}

hooke_status hooke_parameter(hooke_run *run, const char *name, const char *value) {
  if (!run) return HOOKE_BAD_PARAM;
  hooke_status status = check_new(run, "hooke_parameter");
  if (status != HOOKE_OK) return status;
  if (!name || !value) return hooke_fail(run, HK_BAD_PARAM, "hooke_parameter: the name or the value is NULL");
  if (!isalpha((unsigned char)*name) && *name != '_')
    return hooke_fail(run, HK_BAD_PARAM, "'%s' is no name of a parameter: it begins with a letter, as N=64", name);
  if (strchr(name, '='))
    return hooke_fail(run, HK_BAD_PARAM, "'%s': the value of a parameter is an argument of its own", name);
  return add_word(run, "", name, value) ? HOOKE_OK : no_memory(run);
}

/* What only a command line has a use for. */
static const char *refused(const hk_options *o) {
  if (o->json || o->quiet || o->summary) return "hooke_summary gives the figures, and nothing is printed";
  if (o->state) return "hooke_write_state writes the state";
  if (o->watch || o->port || o->forces) return "`hooke run` has the page of a run";
  return o->help ? "`hooke run --help` lists options" : NULL;
}

/* `change` is NAME=VALUE, as on the command line: a parameter of a run that goes on (option resume) has this value from
 * the checkpoint on. The word keeps the name, and the parameter is given as others are. */
static hooke_status take_change(hooke_run *run) {
  static const char prefix[] = "--change=";
  char *word = run->word[run->words - 1], *name = word + sizeof prefix - 1,
       *sign = strchr(word + sizeof prefix - 1, '=');
  bool resumed = false;
  for (size_t k = 0; k + 1 < run->words; k++) resumed = resumed || strncmp(run->word[k], "--resume=", 9) == 0;
  if (!resumed)
    return hooke_fail(run, HK_BAD_PARAM,
                      "'change' is of a run that goes on: give its checkpoint before, the option \"resume\"");
  if (!sign || sign == name)
    return hooke_fail(run, HK_BAD_PARAM, "change: '%s' is not the parameter and its value, as \"k=500\"", name);
  *sign = 0;
  size_t length = strlen(name);
  for (size_t k = 0; k < run->words; k++) { /* the value that it had until then */
    if (strncmp(run->word[k], name, length) != 0 || run->word[k][length] != '=') continue;
    free(run->word[k]);
    memmove(run->word + k, run->word + k + 1, (--run->words - k) * sizeof *run->word);
    break;
  }
  return add_word(run, "", name, sign + 1) ? HOOKE_OK : no_memory(run);
}

static hooke_status check_option(hooke_run *run, const char *name) {
  char scene[] = "scene", resume[] = "--resume=file", *words[] = {scene, run->word[run->words - 1], resume};
  hk_options o;
  hk_error error = {0};
  hk_status status = hk_options_parse(&o, strcmp(name, "change") == 0 ? 3 : 2, words, &error);
  const char *instead = refused(&o);
  free(o.given);
  free(o.with);
  free(o.change);
  if (instead) return hooke_fail(run, HK_BAD_PARAM, "'%s' is an option of the command line: %s", name, instead);
  return status == HK_OK ? HOOKE_OK : hooke_failed(run, &error);
}

hooke_status hooke_option(hooke_run *run, const char *name, const char *value) {
  if (!run) return HOOKE_BAD_PARAM;
  hooke_status status = check_new(run, "hooke_option");
  if (status != HOOKE_OK) return status;
  if (!name || !*name) return hooke_fail(run, HK_BAD_PARAM, "hooke_option: the name of the option is missing");
  if (*name == '-' || strchr(name, '='))
    return hooke_fail(run, HK_BAD_PARAM, "'%s': an option is named without dashes, its value apart", name);
  if (!add_word(run, "--", name, value && *value ? value : NULL)) return no_memory(run);
  status = check_option(run, name);
  if (status == HOOKE_OK && strcmp(name, "change") == 0) status = take_change(run);
  if (status != HOOKE_OK) drop_word(run);
  return status;
}

hooke_status hooke_on_frame(hooke_run *run, hooke_frame_function *function, void *context) {
  if (!run) return HOOKE_BAD_PARAM;
  hooke_status status = check_new(run, "hooke_on_frame");
  if (status == HOOKE_OK) run->on_frame = function, run->context = context;
  return status;
}

/* ---- opening ---- */

/* The frame 0 belongs to the opening, after which it is shown. */
static void frame_taken(void *context, const hk_snapshot *last_good, const hk_state *state) {
  hooke_run *run = context;
  (void)last_good, (void)state;
  if (run->run && run->on_frame) run->on_frame(run, run->context);
}

static hk_status find_parts(hooke_run *run, hk_error *error) {
  Dl_info own;
  int found = dladdr((const void *)(uintptr_t)hooke_new, &own);
  hk_status status = hk_installation_find(&run->installation, found ? own.dli_fname : NULL, error);
  snprintf(run->library, sizeof run->library, "%s/lib", run->installation.scripts);
  return status == HK_OK ? hk_registry_open(&run->registry, run->installation.plugins, NULL, error) : status;
}

/* Outputs write where a folder is named, and nowhere else. */
static void set_options(hooke_run *run) {
  hk_options *o = &run->options;
  o->run.compare = hk_options_comparison(o);
  o->run.no_output = o->run.no_output || !o->run.out;
  o->run.progress = -1;
  o->run.interrupted = &run->stopped;
  o->run.kept = frame_taken;
  o->run.kept_context = run;
  run->script_options = hk_options_of_script(o, &run->registry, run->library);
  run->script_options.silent = true;
  run->script_options.text = run->text;
}

static hk_status read_options(hooke_run *run, const char *path, hk_error *error) {
  if (!add_word(run, "", path, NULL)) return hk_error_set(error, HK_NO_MEMORY, "no memory for a run");
  char *scene = run->word[run->words - 1];
  memmove(run->word + 1, run->word, (run->words - 1) * sizeof *run->word);
  run->word[0] = scene;
  hk_status status = hk_options_parse(&run->options, (int)run->words, run->word, error);
  if (status == HK_OK && run->options.run.out) status = hk_target_folder("out", run->options.run.out, error);
  return status;
}

static hk_status open_scene(hooke_run *run, const char *path, hk_error *error) {
  hk_status status = find_parts(run, error);
  if (status == HK_OK) status = read_options(run, path, error);
  if (status != HK_OK) return status;
  set_options(run);
  status = hk_script_open(run->options.scene, &run->script_options, &run->script, error);
  if (status == HK_OK && !hk_script_scene(run->script))
    status =
        hk_error_set(error, HK_BAD_PARAM, "%s drives its own runs and returns no scene: `hooke run` runs it", path);
  if (status != HK_OK) return status;
  hk_run_options first = run->options.run;
  first.only_run = true; /* comparisons are runs of scenes of their own */
  return hk_run_open(hk_script_scene(run->script), &first, &run->run, error);
}

static hooke_status opened(hooke_run *run, const char *path) {
  hooke_surroundings own;
  hk_error error = {0};
  hooke_enter(&own);
  run->busy = true;
  hk_status status = open_scene(run, path, &error);
  run->stage = status == HK_OK ? HOOKE_RUNNING : HOOKE_ENDED;
  if (status == HK_OK && run->on_frame) run->on_frame(run, run->context);
  run->busy = false;
  hooke_leave(&own);
  return hooke_failed(run, &error);
}

hooke_status hooke_open(hooke_run *run, const char *path) {
  if (!run) return HOOKE_BAD_PARAM;
  hooke_status status = check_new(run, "hooke_open");
  if (status != HOOKE_OK) return status;
  if (!path || !*path) return hooke_fail(run, HK_BAD_PARAM, "hooke_open: the scene's path is missing");
  if (*path == '-' || *path == '=') return hooke_fail(run, HK_BAD_PARAM, "the scene '%s': write ./%s", path, path);
  return opened(run, path);
}

hooke_status hooke_open_text(hooke_run *run, const char *name, const char *text) {
  if (!run) return HOOKE_BAD_PARAM;
  hooke_status status = check_new(run, "hooke_open_text");
  if (status != HOOKE_OK) return status;
  if (!text) return hooke_fail(run, HK_BAD_PARAM, "hooke_open_text: the script is NULL");
  run->text = hk_string_copy(text);
  return run->text ? hooke_open(run, name ? name : "scene.lua") : no_memory(run);
}
