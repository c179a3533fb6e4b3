/* `hooke run --resume FILE`: the words that a run was asked for with, kept in its checkpoints. */
#ifndef HK_RESUME_H
#define HK_RESUME_H

#include "core/app/options/options.h"

/* The words of the command line that the result depends on, each with its 0, the scene's absolute path first, an empty
 * word at the end: in malloc's memory; NULL: no scene, or no memory. `argv` must be as it was given. */
char *hk_resume_words(int argc, char **argv);
/* Where --resume FILE is among the arguments: the scene, the words with which the run of the checkpoint was begun, then
 * the others. HK_BAD_PARAM: no scene is named or another one, or the file asks for what is the user's to ask for.
 * *list: the new arguments, *text: their memory; both are freed by the caller. Without it both are NULL. */
hk_status hk_resume_expand(int *argc, char ***argv, char ***list, char **text, hk_error *error);

/* After parsing: without --out, the folder of the checkpoint where that is the output folder of a run of the scene. */
void hk_resume_folder(hk_options *);

#endif
