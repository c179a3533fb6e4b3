/* The work of steps that correctors end, in scenes that have correctors. */
#ifndef HK_CORRECTIONS_H
#define HK_CORRECTIONS_H

#include "core/engine/loop/loop.h"

hk_status hk_corrections_open(hk_loop *);    /* sets what the loop calls; before its first step */
void hk_corrections_close(hk_corrections *); /* NULL: nothing */

#endif
