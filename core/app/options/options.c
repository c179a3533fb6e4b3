/* Options are one table that drives parsing, checking and help; name=value is kept for the script's param(). */
#include "core/app/options/options.h"
#include "core/engine/text/text.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum option_type { FLAG, TEXT, POSITIVE, NOT_NEGATIVE, COUNT, WHOLE, LIST, CHANGE } option_type;

typedef struct option {
  const char *name, *value, *help;
  option_type type;
  size_t offset;
  bool kept; /* the result depends on it: a run that goes on from a checkpoint has it, too */
} option;

#define AT(field) offsetof(hk_options, field)

static const option options[] = {
    {"--integrator", "NAME",
     "in place of the scene's choice; NAME:parameter=value,... sets its own; auto: chosen by measuring", TEXT,
     AT(run.integrator), true},
    {"--solver", "NAME", "the linear solver, in place of the scene's choice; auto: by the forces and the size", TEXT,
     AT(run.solver), true},
    {"--dt", "SECONDS", "the longest step", POSITIVE, AT(run.dt), true},
    {"--tol", "X", "relative tolerance of adaptive integrators", POSITIVE, AT(run.tol), true},
    {"--accuracy", "METRES", "of the positions (RMS); the run is then checked by other runs of the scene", POSITIVE,
     AT(run.accuracy), true},
    {"--accuracy-at", "WHEN", "frames: the accuracy holds at every frame (the default); end: at the end of the run",
     TEXT, AT(run.accuracy_at), true},
    {"--until", "SECONDS", "end there instead of at the scene's duration", NOT_NEGATIVE, AT(run.until), true},
    {"--threads", "N", "number of threads; results do not depend on it", COUNT, AT(threads), false},
    {"--seed", "N", "seed of all random numbers, default 0", WHOLE, AT(seed), true},
    {"--resume", "FILE", "go on from a checkpoint of the scene (output checkpoint), with its parameters and options",
     TEXT, AT(run.resume), false},
    {"--change", "NAME=VALUE",
     "with --resume: a parameter of the scene has this value from the checkpoint on; may be repeated", CHANGE,
     AT(run.change), false},
    {"--state", "FILE", "write the final state: id,x,y,z,vx,vy,vz,mass and the channels", TEXT, AT(state), false},
    {"--out", "DIR", "folder of the outputs, default out/SCENE; with --resume that of the checkpoint", TEXT,
     AT(run.out), false},
    {"--json", NULL, "the summary as one JSON object in a line on standard output; of --watch, of every run", FLAG,
     AT(json), false},
    {"--summary", "FILE", "the same into a file, beside what is printed", TEXT, AT(summary), false},
    {"--quiet", NULL, "no progress and no summary", FLAG, AT(quiet), false},
    {"--with", "KIND:NAME",
     "a plugin beside those of the scene, KIND:NAME:parameter=value,... sets its parameters; may be repeated; an "
     "output that the scene has is not doubled",
     LIST, AT(run.with), true},
    {"--draft", NULL, "pictures of half the size, for a quick look", FLAG, AT(run.draft), false},
    {"--no-output", NULL, "switch the scene's outputs off", FLAG, AT(run.no_output), false},
    {"--verify", NULL, "run again with half the step and print the largest difference of all frames", FLAG, AT(verify),
     false},
    {"--no-check", NULL, "without an accuracy no other run of the scene is made to estimate the error", FLAG,
     AT(no_check), false},
    {"--watch", NULL,
     "in a browser while it runs: a page on this machine's own address, to look, stop, take hold and try values", FLAG,
     AT(watch), false},
    {"--port", "N", "of the page of --watch, default 0: any that is free", WHOLE, AT(port), false},
    {"--at-once", NULL, "the run under --watch begins by itself; otherwise it waits for \"start\" on its page", FLAG,
     AT(at_once), false},
    {"--forces", NULL, "the page of --watch has each force by itself, as colours and arrows", FLAG, AT(forces), false},
    {"--trust", NULL, "lift the script's sandbox and allow plugins beside it", FLAG, AT(trust), false},
    {"--help", NULL, "this text, with the scene's own parameters when one is named; with --json these alone, as JSON",
     FLAG, AT(help), false},
};

enum { OPTIONS = sizeof options / sizeof *options };

static const char *option_name(const void *context, size_t k) {
  (void)context;
  return k < OPTIONS ? options[k].name + strlen("--") : NULL;
}

/* What looks like no option is taken for a parameter of the scene. */
static hk_status unknown(const char *word, hk_error *error) {
  const char *name = word + strspn(word, "-");
  char plain[64];
  snprintf(plain, sizeof plain, "%.*s", (int)strcspn(name, "="), name);
  const char *near = hk_nearest_name(plain, option_name, NULL);
  if (near) return hk_error_set(error, HK_BAD_PARAM, "unknown option '%s'; did you mean '--%s'?", word, near);
  return hk_error_set(
      error, HK_BAD_PARAM,
      "unknown option '%s'; a parameter of the scene is written %s=VALUE, and options are in: hooke run "
      "--help",
      word, *plain ? plain : "name");
}

static hk_status bad_value(const option *o, const char *value, hk_error *error) {
  static const char *const wanted[] = {
      "", "", "a positive number", "a number from 0 on", "a whole number from 1 to 1024", "a whole number", "", ""};
  return hk_error_set(error, HK_BAD_PARAM, "%s: '%s' is not %s: %s %s", o->name, value, wanted[o->type], o->name,
                      o->value);
}

static hk_status store(const option *o, hk_options *into, const char *value, hk_error *error) {
  void *field = (char *)into + o->offset;
  char *end;
  errno = 0;
  switch (o->type) {
  case FLAG:
    *(bool *)field = true;
    return HK_OK;
  case TEXT:
    *(const char **)field = value;
    return HK_OK;
  case LIST:
    into->with[into->run.with_count++] = value;
    *(const char *const **)field = into->with;
    return HK_OK;
  case CHANGE: /* the same word is a parameter, too, which cuts it in two: it is checked before (resume.c) */
    into->change[into->run.change_count++] = value;
    *(const char *const **)field = into->change;
    return HK_OK;
  case POSITIVE:
  case NOT_NEGATIVE: {
    double number = strtod(value, &end);
    bool fine =
        end != value && *end == 0 && isfinite(number) && (number > 0 || (o->type == NOT_NEGATIVE && number == 0));
    if (!fine) return bad_value(o, value, error);
    *(double *)field = number;
    return HK_OK;
  }
  case COUNT: {
    long number = strtol(value, &end, 10);
    if (end == value || *end || errno || number < 1 || number > 1024) return bad_value(o, value, error);
    *(int *)field = (int)number;
    return HK_OK;
  }
  case WHOLE: {
    unsigned long long number = strtoull(value, &end, 10);
    if (end == value || *end || errno || *value == '-') return bad_value(o, value, error);
    *(uint64_t *)field = number;
    return HK_OK;
  }
  }
  return HK_FAILED;
}

/* "--name value" and "--name=value"; `used` is the number of words beyond the first. */
static hk_status parse_option(hk_options *into, const char *word, const char *next, int *used, hk_error *error) {
  size_t length = strcspn(word, "=");
  if (strcmp(word, "-h") == 0) word = "--help", length = strlen(word);
  for (size_t k = 0; k < OPTIONS; k++) {
    const option *o = &options[k];
    if (strlen(o->name) != length || strncmp(o->name, word, length) != 0) continue;
    if (o->type == FLAG && word[length]) return hk_error_set(error, HK_BAD_PARAM, "%s takes no value", o->name);
    const char *value = word[length] ? word + length + 1 : next;
    *used = o->type != FLAG && !word[length];
    if (o->type != FLAG && !value)
      return hk_error_set(error, HK_BAD_PARAM, "%s needs a value: %s %s", o->name, o->name, o->value);
    return store(o, into, value, error);
  }
  return unknown(word, error);
}

bool hk_option_given(int argc, char **argv, const char *name) {
  for (int i = 0; i < argc; i++) {
    bool takes_value = false;
    if (strcmp(argv[i], name) == 0) return true;
    hk_option_kept(argv[i], &takes_value);
    i += takes_value && !strchr(argv[i], '=');
  }
  return false;
}

bool hk_option_kept(const char *word, bool *takes_value) {
  size_t length = strcspn(word, "=");
  for (size_t k = 0; k < OPTIONS; k++)
    if (strlen(options[k].name) == length && strncmp(options[k].name, word, length) == 0) {
      *takes_value = options[k].type != FLAG;
      return options[k].kept;
    }
  return false;
}

/* NAME=VALUE in place: the word is cut in two. */
static void keep_param(hk_options *into, char *word) {
  char *equals = strchr(word, '=');
  *equals = 0;
  into->given[into->given_count++] = (hk_param_given){word, equals + 1, false};
}

static hk_status misplaced(const hk_options *into, const char *word, hk_error *error) {
  if (strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") == strlen(word))
    return hk_error_set(error, HK_BAD_PARAM,
                        "'%s' is neither an option nor name=value; a parameter of the scene is written %s=VALUE", word,
                        word);
  return hk_error_set(error, HK_BAD_PARAM, "'%s' is neither an option nor name=value; the scene of this run is %s",
                      word, into->scene);
}

hk_status hk_options_parse(hk_options *into, int argc, char **argv, hk_error *error) {
  *into = (hk_options){.run = {.dt = NAN, .tol = NAN, .until = NAN, .accuracy = NAN}};
  into->given = calloc((size_t)argc + 1, sizeof *into->given);
  into->with = calloc((size_t)argc + 1, sizeof *into->with);
  into->change = calloc((size_t)argc + 1, sizeof *into->change);
  if (!into->given || !into->with || !into->change)
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the options");
  for (int i = 0; i < argc; i++) {
    int used = 0;
    hk_status status = HK_OK;
    if (argv[i][0] == '-' && argv[i][1])
      status = parse_option(into, argv[i], i + 1 < argc ? argv[i + 1] : NULL, &used, error);
    else if (argv[i][0] == '=')
      status = hk_error_set(error, HK_BAD_PARAM, "'%s': a parameter has a name, NAME=VALUE, without blanks", argv[i]);
    else if (strchr(argv[i], '=') && into->scene)
      keep_param(into, argv[i]);
    else if (!into->scene)
      into->scene = argv[i];
    else
      status = misplaced(into, argv[i], error);
    if (status != HK_OK) return status;
    i += used;
  }
  if (!into->scene && !into->help) return hk_error_set(error, HK_BAD_PARAM, "no scene given: hooke run SCENE.lua");
  if (into->run.change_count && !into->run.resume && !into->help)
    return hk_error_set(error, HK_BAD_PARAM,
                        "--change %s is of a run that goes on: give its checkpoint as well, --resume FILE, or write %s "
                        "alone for a run from the start",
                        into->change[0], into->change[0]);
  if ((into->port || into->forces || into->at_once) && !into->watch && !into->help)
    return hk_error_set(error, HK_BAD_PARAM, "%s is of the page of --watch: give --watch as well",
                        into->port     ? "--port"
                        : into->forces ? "--forces"
                                       : "--at-once");
  return HK_OK;
}

/* A script with full rights may write files: it is not run again unasked. */
int hk_options_comparison(const hk_options *o) {
  return o->verify ? HK_COMPARE_ALWAYS : o->trust || o->no_check ? HK_COMPARE_ASKED : HK_COMPARE_SMALL;
}

hk_script_options hk_options_of_script(const hk_options *o, hk_registry *registry, const char *library) {
  return (hk_script_options){.registry = registry,
                             .library = library,
                             .trust = o->trust,
                             .run = &o->run,
                             .threads = o->threads,
                             .seed = o->seed,
                             .given_count = o->given_count,
                             .given = o->given};
}

void hk_options_print(void) {
  printf("usage: hooke run SCENE.lua [name=value ...] [options]\n\n");
  for (size_t k = 0; k < OPTIONS; k++) {
    char left[64];
    snprintf(left, sizeof left, "%s %s", options[k].name, options[k].value ? options[k].value : "");
    printf("  %-20s %s\n", left, options[k].help);
  }
  printf("\nexit: 0 ok, 1 wrong use, 2 plugin failed, 3 diverged, 4 file error, 5 inaccurate, 130 interrupted\n");
}
