/* Where the parts of hooke are, and the commands that it has. */
#ifndef HK_INSTALLATION_H
#define HK_INSTALLATION_H

#include "core/engine/base/base.h"

#include <limits.h>

typedef struct hk_installation {
  char plugins[PATH_MAX], scripts[PATH_MAX], tools[PATH_MAX], include[PATH_MAX]; /* "": it has none */
} hk_installation;

/* Beside the file `of`, a program or a library: the folders of the build tree, or those of an installation. NULL:
 * beside the program of this process. HK_IO: there are no plugins. */
hk_status hk_installation_find(hk_installation *, const char *of, hk_error *error);
bool hk_installation_command(const hk_installation *, const char *name); /* whether it is one: run, or a tool */
/* The tool of that name, in path[PATH_MAX + 128]. HK_BAD_PARAM: there is none; the message says what may be meant. */
hk_status hk_installation_tool(const hk_installation *, const char *name, char *path, hk_error *error);
/* Leaves in PATH, for the programs that are started, the absolute folders: "." and what is relative mean another folder
 * wherever hooke is called. HK_NO_MEMORY. */
hk_status hk_installation_programs(hk_error *error);
/* HK_BAD_PARAM: the list of folders, the value of that variable, has a relative one. */
hk_status hk_installation_absolute(const char *variable, const char *list, hk_error *error);
/* The flags with which a compiler builds plugins, on standard output: the folder of the headers and `numbers`. As
 * pkg-config does, a backslash goes before what a shell, or a Makefile's, would take for more than a letter. */
void hk_installation_flags(const hk_installation *, const char *numbers);
void hk_installation_help(const hk_installation *); /* all commands and what they do, on standard output */

#endif
