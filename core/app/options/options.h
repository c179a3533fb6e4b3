/* The options of a run: those of the command line of `hooke run`, and of libhooke. */
#ifndef HK_OPTIONS_H
#define HK_OPTIONS_H

#include "core/run/run/run.h"
#include "core/app/lua/lua.h"

#include <limits.h>
#include <stdio.h>

typedef struct hk_options {
  hk_run_options run;
  const char *scene, *state, *summary;
  int threads;
  uint64_t seed, port;
  bool json, quiet, trust, verify, no_check, watch, at_once, forces, help;
  size_t given_count;
  hk_param_given *given; /* one per argument at most */
  const char **with;     /* as many */
  const char **change;   /* as many */
  char beside[PATH_MAX]; /* the folder of the checkpoint, where run.out is that */
} hk_options;

/* `argv` from the word after "run". HK_BAD_PARAM with the nearest option's name. Free `given`, `with`
 * and `change` afterwards. */
hk_status hk_options_parse(hk_options *, int argc, char **argv, hk_error *error);
/* Whether the flag of that name, "--name", is among the words. */
bool hk_option_given(int argc, char **argv, const char *name);
/* Whether the option of that word, "--name" or "--name=value", is kept in checkpoints. *takes_value is set to true
 * where it does, and else left alone. */
bool hk_option_kept(const char *word, bool *takes_value);
/* With which other runs this one is compared, HK_COMPARE_... */
int hk_options_comparison(const hk_options *);
/* What a script is opened with, nobody watching it. They point into the options. */
hk_script_options hk_options_of_script(const hk_options *, hk_registry *, const char *library);
void hk_options_print(void); /* the help, on standard output */

/* parameters.c: those that the script declares, on standard output: a table for people, or a list as JSON. */
void hk_parameters_print(const hk_script *, bool json);
void hk_parameters_write(FILE *, const hk_script *); /* the list as JSON */

#endif
